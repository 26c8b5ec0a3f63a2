// The commands of the program. Each gets the words after its name and gives the exit code.
#ifndef APP_COMMANDS_H
#define APP_COMMANDS_H

int app_command_run(int argc, const char *const *argv);
int app_command_new(int argc, const char *const *argv);
int app_command_convert(int argc, const char *const *argv);
int app_command_info(int argc, const char *const *argv);
int app_command_compare(int argc, const char *const *argv);
int app_command_doctor(int argc, const char *const *argv);
int app_command_lab(int argc, const char *const *argv);
int app_command_tune(int argc, const char *const *argv);
int app_command_lab_run(int argc, const char *const *argv);

#endif
