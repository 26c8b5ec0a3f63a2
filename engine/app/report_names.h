// Which room answers for which figure: a figure of a room that is not built is null.
#ifndef APP_REPORT_NAMES_H
#define APP_REPORT_NAMES_H

#include "app/report.h"

typedef struct app_accuracy_name {
    const char *name, *room;
    bool peak; // has a _peak
} app_accuracy_name;
extern const app_accuracy_name app_accuracy_names[APP_ACCURACY_COUNT];
extern const char *const app_count_rooms[CORE_COUNT_TOTAL];
const char *app_stage_room(core_stage stage);
double app_count_value(const app_report *r, core_count count); // NaN: the room is not built

#define APP_MEMORY_LINES 8
typedef struct app_memory_line {
    const char *name, *room;
    double value; // peak_rss_kb in kB, others in bytes; NaN: the room is not built
} app_memory_line;
void app_memory_lines(const app_report *r, app_memory_line line[APP_MEMORY_LINES]);

#endif
