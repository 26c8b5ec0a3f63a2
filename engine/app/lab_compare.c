// `corsac compare SCENE --a NAME=VALUE... --b NAME=VALUE...`: the same scene twice in one process,
// step by step side by side: distances of the entities in mm, cost in ms, the first divergence, and
// one picture with the ghost of b over a.
#include "app/commands.h"
#include "app/lab_gap.h"
#include "app/run.h"

#include <math.h>
#include <stb_image_write.h>
#include <stdlib.h>
#include <string.h>

#include "core/clock.h"
#include "core/json.h"

#define MAX_WORDS 300

typedef struct side {
    const char *word[MAX_WORDS];
    int words;
    char settings[512]; // as given, for people
    app_options options;
    app_run *run;
    uint64_t cpu_ns;
    double time; // s, simulated
    uint8_t *pixels;
} side;

typedef struct comparison {
    side a, b;
    const char *picture, *metrics;
    app_gap last, peak;
    double first_time, visible_time, peak_time; // s; < 0: never
    char first_name[SCENE_NAME_MAX + 32];
} comparison;

static const char *const usage =
    "corsac compare: usage: corsac compare SCENE [options of run] --a NAME=VALUE... --b "
    "NAME=VALUE... [--shot FILE.png] [--metrics FILE.json|-]; names: settings as phys.solver, "
    "parameters of the scene, dt, seed, substeps, simd, threads";

static void push(side *s, const char *word) {
    if (s->words < MAX_WORDS) {
        s->word[s->words++] = word;
    }
}

// "dt=0.01" is an option of the run, all else a setting or parameter.
static bool push_setting(side *s, const char *text) {
    static const char *const own[] = {"dt", "seed", "substeps", "simd", "threads"};
    const char *equals = strchr(text, '=');
    if (!equals || equals == text) {
        return core_fail("corsac compare: '%s' after --a or --b, expected NAME=VALUE", text);
    }
    size_t used = strlen(s->settings);
    snprintf(s->settings + used, sizeof s->settings - used, "%s%s", used ? " " : "", text);
    for (size_t i = 0; i < CORE_COUNT_OF(own); i++) {
        if (strlen(own[i]) == (size_t)(equals - text) &&
            strncmp(own[i], text, strlen(own[i])) == 0) {
            static const char *const option[] = {"--dt", "--seed", "--substeps", "--simd",
                                                 "--threads"};
            push(s, option[i]);
            push(s, equals + 1);
            return true;
        }
    }
    push(s, "--set");
    push(s, text);
    return true;
}

static bool read_words(comparison *c, int argc, const char *const *argv) {
    side *into = NULL; // NULL: both
    for (int i = 0; i < argc; i++) {
        const char *word = argv[i];
        bool last = i + 1 == argc;
        if (strcmp(word, "--a") == 0 || strcmp(word, "--b") == 0) {
            into = word[2] == 'a' ? &c->a : &c->b;
        } else if ((strcmp(word, "--shot") == 0 || strcmp(word, "--metrics") == 0) && !last) {
            *(word[2] == 's' ? &c->picture : &c->metrics) = argv[++i];
            into = NULL;
        } else if (into && word[0] != '-') {
            if (!push_setting(into, word)) {
                return false;
            }
        } else {
            into = NULL;
            push(&c->a, word);
            push(&c->b, word);
            if (word[0] == '-' && !last && argv[i + 1][0] != '-' && !strchr(word, '=')) {
                push(&c->a, argv[++i]);
                push(&c->b, argv[i]);
            }
        }
    }
    return (c->a.settings[0] || c->b.settings[0]) || core_fail("%s", usage);
}

static bool open_side(side *s) {
    push(s, "--headless");
    push(s, "--quiet");
    push(s, "--set");
    push(s, "metrics.accuracy=off");
    if (!app_options_parse(&s->options, s->words, s->word)) {
        return false;
    }
    if (!s->options.scene) {
        return core_fail("%s", usage);
    }
    s->run = app_run_create(&s->options);
    return app_run_open(s->run);
}

static bool advance(side *s) {
    uint64_t start = core_clock_cpu_ns();
    bool more = app_step(s->run);
    s->cpu_ns += core_clock_cpu_ns() - start;
    s->time = (double)s->run->report.steps * (double)scene_dt(s->run->scene);
    return more;
}

static void note(comparison *c) {
    double t = c->a.time;
    c->last = app_gap_measure(c->a.run->scene, c->b.run->scene);
    if (c->last.max_mm > 0 && c->first_time < 0) {
        const char *name = scene_entity_name(c->a.run->scene, c->last.worst);
        c->first_time = t;
        snprintf(c->first_name, sizeof c->first_name, "entity %u:%u%s%s%s", c->last.worst.index,
                 c->last.worst.generation, name[0] ? " '" : "", name, name[0] ? "'" : "");
    }
    if (c->last.max_mm >= 1.0 && c->visible_time < 0) {
        c->visible_time = t;
    }
    if (c->last.max_mm > c->peak.max_mm) {
        c->peak = c->last;
        c->peak_time = t;
    }
}

// Whoever is behind steps; figures are taken where both clocks meet (within a tenth of a step).
static void run_both(comparison *c) {
    side *a = &c->a, *b = &c->b;
    double end_a = (double)a->run->last_step * a->run->report.dt;
    b->run->last_step = (uint64_t)(end_a / b->run->report.dt + 0.5);
    bool more_a = true, more_b = true;
    while (more_a && more_b) {
        double meet = 0.1 * CORE_MIN(a->run->report.dt, b->run->report.dt);
        if (a->time < b->time - meet) {
            more_a = advance(a);
        } else if (b->time < a->time - meet) {
            more_b = advance(b);
        } else {
            more_a = advance(a);
            more_b = advance(b);
        }
        if (fabs(a->time - b->time) < meet) {
            note(c);
        }
    }
}

// ---- picture ----

static bool draw_side(side *s, const char *caption) {
    app_run *r = s->run;
    if (!app_device_open(r, false)) {
        return false;
    }
    r->caption = caption;
    s->pixels = core_alloc((size_t)r->width * r->height * 4);
    return app_frame(r, 1.0f) && gfx_device_read(r->device, s->pixels);
}

// Where b differs from a, its picture lies over a's, half transparent and tinted blue.
static void lay_over(uint8_t *a, const uint8_t *b, size_t pixels) {
    static const int tint[3] = {90, 160, 255};
    for (size_t i = 0; i < pixels; i++) {
        const uint8_t *g = b + 4 * i;
        uint8_t *p = a + 4 * i;
        int differ = abs(p[0] - g[0]) + abs(p[1] - g[1]) + abs(p[2] - g[2]);
        for (int k = 0; k < 3 && differ > 12; k++) {
            p[k] = (uint8_t)((2 * p[k] + g[k] + tint[k]) / 4);
        }
    }
}

static bool write_picture(comparison *c) {
    char caption[1536];
    snprintf(caption, sizeof caption,
             "a: %s   %.3g ms a step\nb (blue): %s   %.3g ms a step\n"
             "apart: mean %.3g mm, max %.3g mm after %.3g s",
             c->a.settings[0] ? c->a.settings : "as it is",
             (double)c->a.cpu_ns * 1e-6 / (double)c->a.run->report.steps,
             c->b.settings[0] ? c->b.settings : "as it is",
             (double)c->b.cpu_ns * 1e-6 / (double)c->b.run->report.steps, c->last.mean_mm,
             c->last.max_mm, c->a.time);
    app_run *r = c->a.run;
    bool fine =
        app_output_ready(c->picture) && draw_side(&c->a, caption) && draw_side(&c->b, caption);
    if (fine) {
        lay_over(c->a.pixels, c->b.pixels, (size_t)r->width * r->height);
        fine = stbi_write_png(c->picture, (int)r->width, (int)r->height, 4, c->a.pixels,
                              (int)r->width * 4) != 0 ||
               core_fail("%s: the picture cannot be written", c->picture);
    }
    core_free(c->a.pixels);
    core_free(c->b.pixels);
    return fine;
}

// ---- figures ----

static double ms_of(const side *s) {
    return s->run->report.steps ? (double)s->cpu_ns * 1e-6 / (double)s->run->report.steps : 0;
}

static phys_accuracy accuracy_of(const side *s) {
    phys_accuracy found = {0};
    phys_world *world = scene_phys_if(s->run->scene);
    if (world) {
        phys_world_accuracy(world, &found);
    }
    return found;
}

static void print_side(FILE *out, const char *name, const side *s) {
    phys_accuracy found = accuracy_of(s);
    fprintf(out, "  %s  %9.4f ms a step   overlap mean %.3g mm, max %.3g mm   %s\n", name, ms_of(s),
            1e3 * found.penetration_mean_m, 1e3 * found.penetration_max_m,
            s->settings[0] ? s->settings : "(as it is)");
}

static void print_table(FILE *out, const comparison *c) {
    fprintf(out, "%s, %.4g s\n", c->a.options.scene, c->a.time);
    print_side(out, "a", &c->a);
    print_side(out, "b", &c->b);
    double a = ms_of(&c->a), b = ms_of(&c->b);
    fprintf(out, "  b costs %.2f times a\n", a > 0 ? b / a : 0);
    fprintf(out,
            "  apart at the end: mean %.4g mm, max %.4g mm (%u entities, %u in one run only)\n",
            c->last.mean_mm, c->last.max_mm, c->last.shared, c->last.single);
    if (c->first_time < 0) {
        fprintf(out, "  the runs do not diverge\n");
        return;
    }
    fprintf(out, "  first apart after %.4g s (step %.0f of a): %s\n", c->first_time,
            c->first_time / c->a.run->report.dt, c->first_name);
    if (c->visible_time >= 0) {
        fprintf(out, "  1 mm apart after %.4g s; most, %.4g mm, after %.4g s\n", c->visible_time,
                c->peak.max_mm, c->peak_time);
    }
}

static void json_side(core_json *out, const char *name, const side *s) {
    phys_accuracy found = accuracy_of(s);
    core_json_object(out, name);
    core_json_string(out, "settings", s->settings);
    core_json_int(out, "steps", s->run->report.steps);
    core_json_number(out, "ms_per_step", ms_of(s));
    core_json_number(out, "penetration_mean_m", found.penetration_mean_m);
    core_json_number(out, "penetration_max_m", found.penetration_max_m);
    core_json_end_object(out);
}

static bool write_json(const comparison *c) {
    core_json out;
    core_json_init(&out, true);
    core_json_object(&out, NULL);
    core_json_string(&out, "scene", c->a.options.scene);
    json_side(&out, "a", &c->a);
    json_side(&out, "b", &c->b);
    core_json_number(&out, "error_mean_mm", c->last.mean_mm);
    core_json_number(&out, "error_max_mm", c->last.max_mm);
    core_json_number(&out, "error_peak_mm", c->peak.max_mm);
    core_json_int(&out, "entities", c->last.shared);
    core_json_number(&out, "first_divergence_s", c->first_time < 0 ? NAN : c->first_time);
    core_json_string(&out, "first_divergence_object", c->first_name);
    core_json_end_object(&out);
    FILE *file = strcmp(c->metrics, "-") == 0   ? stdout
                 : app_output_ready(c->metrics) ? fopen(c->metrics, "w")
                                                : NULL;
    if (file) {
        fprintf(file, "%s\n", out.text);
    }
    if (file && file != stdout) {
        fclose(file);
    }
    core_json_release(&out);
    return file != NULL;
}

static int close_side(side *s) {
    if (!s->run) {
        return APP_EXIT_USAGE;
    }
    app_scene_close(s->run);
    return app_run_destroy(s->run);
}

int app_command_compare(int argc, const char *const *argv) {
    comparison *c = core_alloc(sizeof *c);
    c->first_time = c->visible_time = c->peak_time = -1;
    c->picture = "out/compare.png";
    int code = APP_EXIT_USAGE;
    if (read_words(c, argc, argv)) {
        bool fine = open_side(&c->a) && open_side(&c->b);
        if (fine) {
            run_both(c);
            fine = write_picture(c) && (!c->metrics || write_json(c));
            bool quiet = c->metrics && strcmp(c->metrics, "-") == 0;
            print_table(quiet ? stderr : stdout, c);
            fprintf(quiet ? stderr : stdout, "  %s: the ghost of b (blue) over a\n", c->picture);
        }
        int a = close_side(&c->a), b = close_side(&c->b);
        code = a == APP_EXIT_FINE || a == APP_EXIT_EXPECTATION ? b : a;
        code = code == APP_EXIT_EXPECTATION ? APP_EXIT_FINE : code;
        code = fine || code != APP_EXIT_FINE ? code : APP_EXIT_USAGE;
    }
    core_free(c);
    return code;
}
