// The receipt: what the scene paid for, and zeros for what it did not use.
#include <math.h>
#include <string.h>

#include "app/report_names.h"

static double stage_us(const app_report *r, const char *room, double *total_ms) {
    // A room's own stage holds its parts; gfx has only parts.
    double us = 0;
    *total_ms = 0;
    for (int i = 0; i < CORE_STAGE_TOTAL; i++) {
        const char *name = core_stage_name((core_stage)i);
        bool own = strcmp(name, room) == 0;
        bool part = strcmp(room, "gfx") == 0 && strncmp(name, "gfx.", 4) == 0;
        if (own || part) {
            core_summary s = core_metrics_stage(r->metrics, (core_stage)i);
            us += s.p50 * 1000.0;
            *total_ms += s.total;
        }
    }
    return us;
}

static void put_room(const app_report *r, const char *room, double bytes, const char *what,
                     FILE *out) {
    double total;
    double us = stage_us(r, room, &total);
    if (isnan(bytes)) {
        fprintf(out, "  %-8s %12s  %10s %10s  %s\n", room, "not built", "-", "-", "");
    } else {
        fprintf(out, "  %-8s %12.0f  %10.2f %10.2f  %s\n", room, bytes, us, total, what);
    }
}

static void put_counts(const app_report *r, const char *room, FILE *out) {
    bool first = true;
    for (int i = 0; i < CORE_COUNT_TOTAL; i++) {
        if (strcmp(app_count_rooms[i], room) == 0) {
            double value = app_count_value(r, (core_count)i);
            fprintf(out, "%s%s %.0f", first ? "           " : ", ", core_count_name((core_count)i),
                    isnan(value) ? 0.0 : value);
            first = false;
        }
    }
    if (!first) {
        fputc('\n', out);
    }
}

static void put_passes(const app_report *r, FILE *out) {
    for (uint32_t i = 0; i < r->pass_count; i++) {
        const gfx_pass_use *p = &r->pass[i];
        fprintf(out, "  pass %-12s %6llu times", p->name, (unsigned long long)p->runs);
        if (p->gpu_ms > 0.0) {
            fprintf(out, ", %8.3f ms of GPU at least", p->gpu_ms);
        }
        fputc('\n', out);
    }
}

void app_report_receipt(const app_report *r, FILE *out) {
    app_memory_line line[APP_MEMORY_LINES];
    app_memory_lines(r, line);
    fprintf(out, "receipt: %s, %llu steps\n", r->scene_name, (unsigned long long)r->steps);
    fprintf(out, "  %-8s %12s  %10s %10s\n", "room", "bytes", "us a step", "ms in all");
    put_room(r, "scene", line[1].value, "", out);
    put_counts(r, "scene", out);
    for (size_t i = 2; i < APP_MEMORY_LINES; i++) {
        put_room(r, line[i].room, line[i].value, "", out);
        put_counts(r, line[i].room, out);
    }
    fprintf(out, "  frames %llu, passes %u, shader variants %u\n", (unsigned long long)r->frames,
            r->passes, r->shader_variants);
    put_passes(r, out);
    fprintf(out, "error paid (worst of the run)\n");
    for (int i = 0; i < APP_ACCURACY_COUNT; i++) {
        if (app_accuracy_names[i].peak && !isnan(r->peak[i])) {
            fprintf(out, "  %-20s %.6g\n", app_accuracy_names[i].name, r->peak[i]);
        }
    }
}
