// The program: which command, then that command.
#include <stdio.h>
#include <string.h>

#include "app/commands.h"
#include "app/report.h"
#include "core/nearest.h"

typedef struct command {
    const char *name, *arguments, *help;
    int (*run)(int argc, const char *const *argv); // argv[0]: the first word after the name
} command;

static const command commands[] = {
    {"run", "SCENE.lua|DIR [options] [-- ARGS]", "run a scene or a game", app_command_run},
    {"new", "DIR", "make a project that runs", app_command_new},
    {"convert", "IN OUT_DIR [--dry-run]", "a model to the engine's files", app_command_convert},
    {"info", "", "versions, instruction sets, graphics", app_command_info},
    {"compare", "SCENE --a NAME=VALUE... --b ...", "a scene twice: mm and ms apart, a picture",
     app_command_compare},
    {"doctor", "SCENE [options of run]", "what in a scene its methods cannot hold",
     app_command_doctor},
    {"lab", "[NAME...] [--quick] [--out DIR]", "chart speed against accuracy", app_command_lab},
    {"tune", "SCENE --error 'METRIC<=VALUE' ...", "the cheapest settings that keep the bounds",
     app_command_tune},
    {"lab-run", "NAME [--case JSON]", "run one lab kernel on one case", app_command_lab_run},
};

static void usage(FILE *out) {
    fprintf(out, "corsac %s: a data-oriented game engine, scripted in Lua\n\n", APP_VERSION);
    for (size_t i = 0; i < CORE_COUNT_OF(commands); i++) {
        char left[64];
        snprintf(left, sizeof left, "%s %s", commands[i].name, commands[i].arguments);
        fprintf(out, "  corsac %-38s %s\n", left, commands[i].help);
    }
    fprintf(out, "\n`corsac run --help` lists the options of a run.\n");
}

static int unknown(const char *word) {
    const char *names[CORE_COUNT_OF(commands)];
    for (size_t i = 0; i < CORE_COUNT_OF(commands); i++) {
        names[i] = commands[i].name;
    }
    const char *near = core_nearest(word, names, CORE_COUNT_OF(commands));
    if (near) {
        core_fail("corsac: no command '%s', did you mean '%s'?", word, near);
    } else {
        core_fail("corsac: no command '%s'; `corsac help` lists all", word);
    }
    return 2;
}

int main(int argc, char **argv) {
    const char *word = argc > 1 ? argv[1] : "";
    if (!word[0]) {
        usage(stderr);
        return 2;
    }
    if (strcmp(word, "help") == 0 || strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0) {
        usage(stdout);
        return 0;
    }
    if (strcmp(word, "--version") == 0) {
        puts("corsac " APP_VERSION);
        return 0;
    }
    for (size_t i = 0; i < CORE_COUNT_OF(commands); i++) {
        if (strcmp(word, commands[i].name) == 0) {
            return commands[i].run(argc - 2, (const char *const *)argv + 2);
        }
    }
    return unknown(word);
}
