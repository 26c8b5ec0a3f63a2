// Writers of a run's figures: JSON, CSV, the readable table, the receipt.
#include <errno.h>
#include <math.h>
#include <string.h>

#include "app/report_names.h"
#include "core/file.h"
#include "core/json.h"
#include "core/simd.h"

static void put_summary(core_json *j, const char *key, core_summary s, bool built, bool full) {
    core_json_object(j, key);
    if (full) {
        core_json_number(j, "mean", s.mean);
    }
    core_json_number(j, "p50", built ? s.p50 : NAN);
    core_json_number(j, "p95", built ? s.p95 : NAN);
    if (full) {
        core_json_number(j, "p99", s.p99);
    }
    core_json_number(j, "max", built ? s.max : NAN);
    if (!full) {
        core_json_number(j, "total", built ? s.total : NAN);
    }
    core_json_end_object(j);
}

static void put_run(core_json *j, const app_report *r) {
    char hash[17];
    snprintf(hash, sizeof hash, "%016llx", (unsigned long long)r->hash);
    core_json_string(j, "corsac", APP_VERSION);
    core_json_string(j, "scene", r->scene_name);
    core_json_int(j, "seed", (int64_t)r->seed);
    core_json_int(j, "threads", r->threads);
    core_json_string(j, "simd", core_simd_name(core_simd_active()));
    core_json_number(j, "dt", r->dt);
    core_json_int(j, "steps", (int64_t)r->steps);
    core_json_string(j, "hash", hash);
    core_json_number(j, "wall_s", r->wall_s);
    core_json_number(j, "realtime_factor", r->wall_s > 0 ? r->simulated_s / r->wall_s : NAN);
    put_summary(j, "step_ms", core_metrics_step(r->metrics), true, true);
}

static void put_rooms(core_json *j, const app_report *r) {
    core_json_object(j, "stages");
    for (int i = 0; i < CORE_STAGE_TOTAL; i++) {
        put_summary(j, core_stage_name((core_stage)i),
                    core_metrics_stage(r->metrics, (core_stage)i),
                    scene_room_built(app_stage_room((core_stage)i)), false);
    }
    core_json_end_object(j);
    core_json_object(j, "counts");
    for (int i = 0; i < CORE_COUNT_TOTAL; i++) {
        core_json_number(j, core_count_name((core_count)i), app_count_value(r, (core_count)i));
    }
    core_json_end_object(j);
    core_json_object(j, "accuracy");
    for (int i = 0; i < APP_ACCURACY_COUNT; i++) {
        char peak[64];
        snprintf(peak, sizeof peak, "%s_peak", app_accuracy_names[i].name);
        core_json_number(j, app_accuracy_names[i].name, r->accuracy[i]);
        if (app_accuracy_names[i].peak) {
            core_json_number(j, peak, r->peak[i]);
        }
    }
    core_json_end_object(j);
    core_json_object(j, "memory");
    app_memory_line line[APP_MEMORY_LINES];
    app_memory_lines(r, line);
    for (size_t i = 0; i < APP_MEMORY_LINES; i++) {
        core_json_number(j, line[i].name, line[i].value);
    }
    core_json_end_object(j);
}

static void put_list(core_json *j, const char *key, const app_text_list *list) {
    core_json_array(j, key);
    for (uint32_t i = 0; i < list->count; i++) {
        core_json_string(j, NULL, list->text[i]);
    }
    if (list->more) {
        char text[64];
        snprintf(text, sizeof text, "and %u more", list->more);
        core_json_string(j, NULL, text);
    }
    core_json_end_array(j);
}

static void write_mods(core_json *j, const app_report *r) {
    core_json_array(j, "mods");
    for (int i = 0; i < r->mod_count; i++) {
        const script_mod_info *m = &r->mod[i];
        core_json_object(j, NULL);
        core_json_string(j, "name", m->name);
        core_json_string(j, "version", m->version);
        core_json_bool(j, "enabled", m->enabled);
        core_json_int(j, "calls", (int64_t)m->calls);
        core_json_int(j, "instructions", (int64_t)m->instructions);
        core_json_number(j, "ms", m->ms);
        core_json_int(j, "bytes", (int64_t)m->bytes);
        core_json_int(j, "errors", m->errors);
        core_json_end_object(j);
    }
    core_json_end_array(j);
}

static void put_rest(core_json *j, const app_report *r) {
    core_json_int(j, "steady_allocations", (int64_t)app_report_steady_allocations(r));
    core_json_object(j, "loop");
    core_json_int(j, "frames", (int64_t)r->frames);
    core_json_int(j, "capped_frames", (int64_t)r->capped_frames);
    core_json_number(j, "dropped_s", r->dropped_s);
    core_json_end_object(j);
    if (r->device[0]) {
        core_json_string(j, "device", r->device);
    } else {
        core_json_null(j, "device");
    }
    put_list(j, "warnings", &r->warnings);
    put_list(j, "asserts", &r->asserts);
    write_mods(j, r);
    core_json_object(j, "user");
    for (uint32_t i = 0; i < r->user_count; i++) {
        core_json_number(j, r->user[i].name, r->user[i].value);
    }
    core_json_end_object(j);
}

bool app_report_write_json(const app_report *r, const char *path) {
    core_json j;
    core_json_init(&j, true);
    core_json_object(&j, NULL);
    put_run(&j, r);
    put_rooms(&j, r);
    put_rest(&j, r);
    core_json_end_object(&j);
    bool ok = true;
    if (strcmp(path, "-") == 0) {
        ok = printf("%s\n", j.text) > 0 && fflush(stdout) == 0;
        ok = ok || core_fail("cannot write metrics to stdout: %s", strerror(errno));
    } else {
        ok = core_file_write(path, j.text, j.length);
    }
    core_json_release(&j);
    return ok;
}

// ---- CSV: a line per step ----

bool app_report_open_csv(app_report *r, const char *path) {
    r->csv = fopen(path, "w");
    if (!r->csv) {
        return core_fail("cannot write '%s': %s", path, strerror(errno));
    }
    fputs("step,step_ms", r->csv);
    for (int i = 0; i < CORE_STAGE_TOTAL; i++) {
        fprintf(r->csv, ",%s_ms", core_stage_name((core_stage)i));
    }
    for (int i = 0; i < CORE_COUNT_TOTAL; i++) {
        fprintf(r->csv, ",%s", core_count_name((core_count)i));
    }
    for (int i = 0; i < APP_ACCURACY_COUNT; i++) {
        fprintf(r->csv, ",%s", app_accuracy_names[i].name);
    }
    fputc('\n', r->csv);
    return true;
}

static void put_cell(FILE *csv, double value) {
    if (isfinite(value)) {
        fprintf(csv, ",%.9g", value);
    } else {
        fputc(',', csv);
    }
}

void app_report_csv_line(app_report *r) {
    fprintf(r->csv, "%llu", (unsigned long long)r->steps);
    put_cell(r->csv, core_metrics_step_last(r->metrics));
    for (int i = 0; i < CORE_STAGE_TOTAL; i++) {
        bool built = scene_room_built(app_stage_room((core_stage)i));
        put_cell(r->csv, built ? core_metrics_stage_last(r->metrics, (core_stage)i) : NAN);
    }
    for (int i = 0; i < CORE_COUNT_TOTAL; i++) {
        put_cell(r->csv, app_count_value(r, (core_count)i));
    }
    for (int i = 0; i < APP_ACCURACY_COUNT; i++) {
        put_cell(r->csv, r->accuracy[i]);
    }
    fputc('\n', r->csv);
}

// ---- for people ----

static void row(FILE *out, const char *name, double value, const char *unit) {
    if (isnan(value)) {
        fprintf(out, "  %-24s %14s\n", name, "-");
    } else {
        bool whole = value == floor(value) && fabs(value) < 1e15;
        fprintf(out, whole ? "  %-24s %14.0f%s%s\n" : "  %-24s %14.6g%s%s\n", name, value,
                unit[0] ? " " : "", unit);
    }
}

void app_report_table(const app_report *r, FILE *out) {
    core_summary step = core_metrics_step(r->metrics);
    fprintf(out, "%s: %llu steps in %.2f s (%.1f times real time), hash %016llx\n", r->scene_name,
            (unsigned long long)r->steps, r->wall_s,
            r->wall_s > 0 ? r->simulated_s / r->wall_s : 0.0, (unsigned long long)r->hash);
    fprintf(out, "step    p50 %.3f ms  p95 %.3f ms  max %.3f ms   seed %llu, %d threads, %s\n",
            step.p50, step.p95, step.max, (unsigned long long)r->seed, r->threads,
            core_simd_name(core_simd_active()));
    fprintf(out, "stages of the step          p50 ms     p95 ms   total ms\n");
    for (int i = 0; i < CORE_STAGE_TOTAL; i++) {
        core_summary s = core_metrics_stage(r->metrics, (core_stage)i);
        if (s.total > 0) {
            fprintf(out, "  %-20s %10.4f %10.4f %10.1f\n", core_stage_name((core_stage)i), s.p50,
                    s.p95, s.total);
        }
    }
    fprintf(out, "counts at the last step\n");
    for (int i = 0; i < CORE_COUNT_TOTAL; i++) {
        double value = app_count_value(r, (core_count)i);
        if (value > 0) {
            row(out, core_count_name((core_count)i), value, "");
        }
    }
    fprintf(out, "accuracy                            last           peak\n");
    for (int i = 0; i < APP_ACCURACY_COUNT; i++) {
        if (isnan(r->accuracy[i])) {
            continue;
        }
        fprintf(out, "  %-24s %14.6g", app_accuracy_names[i].name, r->accuracy[i]);
        if (app_accuracy_names[i].peak) {
            fprintf(out, " %14.6g", r->peak[i]);
        }
        fputc('\n', out);
    }
    app_memory_line line[APP_MEMORY_LINES];
    app_memory_lines(r, line);
    fprintf(out, "memory                  %14.1f MB peak; %llu allocations in the last half\n",
            line[0].value / 1024.0, (unsigned long long)app_report_steady_allocations(r));
    for (uint32_t i = 0; i < r->user_count; i++) {
        row(out, r->user[i].name, r->user[i].value, "");
    }
    for (uint32_t i = 0; i < r->warnings.count; i++) {
        fprintf(out, "warning: %s\n", r->warnings.text[i]);
    }
}
