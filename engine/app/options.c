#include "app/options.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/nearest.h"

typedef struct option_spec {
    const char *name, *argument; // argument NULL: a flag
    bool (*read)(app_options *o, const struct option_spec *option, const char *text);
    size_t at;        // offset of the field
    size_t given;     // offset of a bool that records that it was given, 0: none
    double low, high; // numbers
    const char *const *choice;
    const char *help;
} option_spec;

static void *field(app_options *o, const option_spec *option) { return (char *)o + option->at; }

static bool read_flag(app_options *o, const option_spec *option, const char *text) {
    (void)text;
    *(bool *)field(o, option) = true;
    return true;
}

static bool read_text(app_options *o, const option_spec *option, const char *text) {
    if (!text[0]) {
        return core_fail("corsac run: --%s needs %s, got an empty text", option->name,
                         option->argument);
    }
    *(const char **)field(o, option) = text;
    return true;
}

static bool read_choice(app_options *o, const option_spec *option, const char *text) {
    char list[128] = "";
    size_t count = 0;
    for (; option->choice[count]; count++) {
        if (strcmp(text, option->choice[count]) == 0) {
            *(const char **)field(o, option) = option->choice[count];
            return true;
        }
        strcat(list, count ? ", " : "");
        strcat(list, option->choice[count]);
    }
    const char *near = core_nearest(text, option->choice, count);
    return core_fail("corsac run: --%s is '%s'%s%s%s, expected one of %s", option->name, text,
                     near ? " (did you mean '" : "", near ? near : "", near ? "'?)" : "", list);
}

static bool read_whole(const char *text, uint64_t *out, const char **end) {
    char *stop;
    errno = 0;
    if (text[0] < '0' || text[0] > '9') {
        return false;
    }
    *out = strtoull(text, &stop, text[0] == '0' && (text[1] == 'x' || text[1] == 'X') ? 16 : 10);
    *end = stop;
    return stop != text && errno == 0;
}

static bool read_count(app_options *o, const option_spec *option, const char *text) {
    uint64_t value;
    const char *end;
    if (!read_whole(text, &value, &end) || *end || (double)value < option->low ||
        (double)value > option->high) {
        return core_fail("corsac run: --%s is '%s', expected a whole number from %.0f to %.0f",
                         option->name, text, option->low, option->high);
    }
    *(uint64_t *)field(o, option) = value;
    return true;
}

static bool read_number(app_options *o, const option_spec *option, const char *text) {
    char *end;
    double value = strtod(text, &end);
    if (end == text || *end || !isfinite(value) || value <= option->low || value > option->high) {
        return core_fail("corsac run: --%s is '%s', expected a number above %g, at most %g",
                         option->name, text, option->low, option->high);
    }
    *(double *)field(o, option) = value;
    return true;
}

static bool read_size(app_options *o, const option_spec *option, const char *text) {
    uint64_t w, h;
    const char *x, *end;
    if (!read_whole(text, &w, &x) || *x != 'x' || !read_whole(x + 1, &h, &end) || *end ||
        w < option->low || h < option->low || w > option->high || h > option->high) {
        return core_fail("corsac run: --size is '%s', expected WIDTHxHEIGHT, each %.0f to %.0f",
                         text, option->low, option->high);
    }
    o->size[0] = (uint32_t)w;
    o->size[1] = (uint32_t)h;
    return true;
}

static bool read_set(app_options *o, const option_spec *option, const char *text) {
    (void)option;
    const char *equals = strchr(text, '=');
    app_set set = {0};
    if (!equals || equals == text || (size_t)(equals - text) >= sizeof set.name ||
        strlen(equals + 1) >= sizeof set.value) {
        return core_fail("corsac run: --set is '%s', expected NAME=VALUE (each at most %zu bytes), "
                         "as n=2500 or phys.solver=soft",
                         text, sizeof set.value - 1);
    }
    memcpy(set.name, text, (size_t)(equals - text));
    strcpy(set.value, equals + 1);
    for (uint32_t i = 0; i < o->set_count; i++) {
        if (strcmp(o->set[i].name, set.name) == 0) {
            o->set[i] = set; // the last one counts
            return true;
        }
    }
    if (o->set_count == APP_MAX_SETS) {
        return core_fail("corsac run: more than %d different --set", APP_MAX_SETS);
    }
    o->set[o->set_count++] = set;
    return true;
}

static bool read_shot(app_options *o, const option_spec *option, const char *text) {
    if (o->shot_count == APP_MAX_SHOTS) {
        return core_fail("corsac run: more than %d --%s", APP_MAX_SHOTS, option->name);
    }
    app_shot shot = {.path = text, .path_length = strlen(text)};
    const char *at = strrchr(text, '@'), *end = strstr(text, ".png:");
    if (end) { // FILE.png:PASS@STEP
        end += 4;
        shot.path_length = (uint64_t)(end - text);
        size_t length = at > end ? (size_t)(at - end) - 1 : strlen(end + 1);
        if (length >= sizeof shot.pass) {
            return core_fail("corsac run: --shot is '%s': there is no such pass", text);
        }
        memcpy(shot.pass, end + 1, length);
    }
    if (at && at[1]) {
        if (!read_whole(at + 1, &shot.step, &end) || *end || !shot.step) {
            return core_fail("corsac run: --shot is '%s', expected FILE.png[:PASS] or "
                             "FILE.png[:PASS]@STEP with STEP from 1",
                             text);
        }
        shot.path_length = shot.pass[0] ? shot.path_length : (uint64_t)(at - text);
    }
    if (shot.path_length < 5 || strncmp(text + shot.path_length - 4, ".png", 4) != 0) {
        return core_fail("corsac run: --shot is '%s', expected a file name that ends in .png",
                         text);
    }
    o->shot[o->shot_count++] = shot;
    return true;
}

static bool read_mod(app_options *o, const option_spec *option, const char *text) {
    if (o->mod_count == APP_MAX_MODS) {
        return core_fail("corsac run: more than %d --%s", APP_MAX_MODS, option->name);
    }
    o->mod[o->mod_count++] = text;
    return true;
}

static const char *const simd_names[] = {"auto", "sse2", "avx2", "avx512", NULL};
static const char *const render_names[] = {"auto", "forward", "clustered", "none", NULL};

#define AT(member)          .at = offsetof(app_options, member)
#define AT_GIVEN(m, given_) .at = offsetof(app_options, m), .given = offsetof(app_options, given_)

static const option_spec table[] = {
    {"headless", NULL, read_flag, AT(headless), .help = "no window"},
    {"steps", "N", read_count, AT_GIVEN(steps, has_steps), .low = 0, .high = 1e12,
     .help = "end after N steps (headless: conf.steps, else 600)"},
    {"seconds", "S", read_number, AT(seconds), .low = 0, .high = 1e9,
     .help = "end after S simulated seconds"},
    {"dt", "S", read_number, AT(dt), .low = 0, .high = 1, .help = "length of a step (1/60)"},
    {"seed", "N", read_count, AT_GIVEN(seed, has_seed), .low = 0, .high = 18446744073709549568.0,
     .help = "seed of the run (12345)"},
    {"threads", "N", read_count, AT_GIVEN(threads, has_threads), .low = 0, .high = 64,
     .help = "workers; 0: one per processor (0)"},
    {"simd", "SET", read_choice, AT(simd), .choice = simd_names,
     .help = "auto, sse2, avx2 or avx512: speed only, the results are the same bits"},
    {"substeps", "N", read_count, AT(substeps), .low = 1, .high = 64,
     .help = "as --set phys.substeps=N"},
    {"set", "NAME=VALUE", read_set, 0,
     .help = "a setting (phys.solver=soft) or a parameter of the scene (n=2500); repeatable"},
    {"render", "HOW", read_choice, AT(render), .choice = render_names,
     .help = "auto, forward, clustered or none"},
    {"size", "WxH", read_size, AT(size), .low = 16, .high = 16384,
     .help = "pixels of window, shots and video (1280x720)"},
    {"shot", "FILE.png[:PASS][@STEP]", read_shot, 0,
     .help = "picture of a step (the last one), or of a pass: hdr, depth, ao, bloom; repeatable"},
    {"video", "DIR", read_text, AT(video), .help = "a picture of every step in DIR"},
    {"audio", "FILE.wav", read_text, AT(audio), .help = "what the listener hears, in step time"},
    {"metrics", "FILE.json|-", read_text, AT(metrics), .help = "all figures of the run as JSON"},
    {"metrics-csv", "FILE.csv", read_text, AT(metrics_csv), .help = "a line of figures per step"},
    {"trace", "FILE.json", read_text, AT(trace), .help = "Chrome trace events"},
    {"hash", NULL, read_flag, AT(hash), .help = "print the state's hash, 16 hex digits"},
    {"receipt", NULL, read_flag, AT(receipt), .help = "print what the scene paid for"},
    {"record", "FILE", read_text, AT(record), .help = "write input and state hashes of every step"},
    {"replay", "FILE", read_text, AT(replay),
     .help = "run a recording again and compare every step"},
    {"mod", "DIR", read_mod, 0, .help = "load a mod; repeatable"},
    {"watch", NULL, read_flag, AT(watch),
     .help = "run scripts anew when their files change; the world stays"},
    {"keep-going", NULL, read_flag, AT(keep_going), .help = "go on after a script's error"},
    {"quiet", NULL, read_flag, AT(quiet), .help = "only warnings, errors and what was asked for"},
    {"help", NULL, read_flag, AT(help), .help = "this text"},
};

static const option_spec *find(const char *name, size_t length) {
    for (size_t i = 0; i < CORE_COUNT_OF(table); i++) {
        if (strlen(table[i].name) == length && strncmp(table[i].name, name, length) == 0) {
            return &table[i];
        }
    }
    return NULL;
}

static bool unknown(const char *word) {
    const char *names[CORE_COUNT_OF(table)];
    for (size_t i = 0; i < CORE_COUNT_OF(table); i++) {
        names[i] = table[i].name;
    }
    const char *near = core_nearest(word + strspn(word, "-"), names, CORE_COUNT_OF(table));
    return near ? core_fail("corsac run: no option '%s', did you mean '--%s'?", word, near)
                : core_fail("corsac run: no option '%s'; `corsac run --help` lists all", word);
}

// "--name value" and "--name=value".
static bool read_option(app_options *o, int argc, const char *const *argv, int *i) {
    const char *word = argv[*i];
    if (strncmp(word, "--", 2) != 0) {
        return unknown(word);
    }
    const char *equals = strchr(word, '=');
    size_t length = equals ? (size_t)(equals - word - 2) : strlen(word) - 2;
    const option_spec *option = find(word + 2, length);
    if (!option) {
        return unknown(word);
    }
    const char *value = equals ? equals + 1 : NULL;
    if (!option->argument && value) {
        return core_fail("corsac run: --%s takes no value, got '%s'", option->name, value);
    }
    if (option->argument && !value) {
        if (*i + 1 >= argc) {
            return core_fail("corsac run: --%s needs %s", option->name, option->argument);
        }
        value = argv[++*i];
    }
    if (!option->read(o, option, value)) {
        return false;
    }
    if (option->given) {
        *(bool *)((char *)o + option->given) = true;
    }
    return true;
}

static bool combination_ok(const app_options *o) {
    if (o->help) {
        return true;
    }
    if (!o->scene) {
        return core_fail("corsac run: which scene? give a .lua file or a folder with main.lua");
    }
    if (o->has_steps && o->seconds > 0) {
        return core_fail("corsac run: --steps and --seconds exclude each other");
    }
    if (o->replay && o->record) {
        return core_fail("corsac run: --record and --replay exclude each other");
    }
    if (o->replay && (o->has_seed || o->dt > 0 || o->set_count || o->substeps)) {
        return core_fail("corsac run: --replay takes seed, dt and settings from the recording; "
                         "leave out --seed, --dt, --set and --substeps");
    }
    return true;
}

bool app_options_parse(app_options *o, int argc, const char *const *argv) {
    *o = (app_options){0};
    for (int i = 0; i < argc; i++) {
        if (strcmp(argv[i], "--") == 0) {
            o->argc = argc - i - 1;
            o->argv = argv + i + 1;
            break;
        }
        if (argv[i][0] == '-' && argv[i][1]) {
            if (!read_option(o, argc, argv, &i)) {
                return false;
            }
        } else if (o->scene) {
            return core_fail("corsac run: '%s' after the scene '%s': only one scene; words for the "
                             "script come after --",
                             argv[i], o->scene);
        } else {
            o->scene = argv[i];
        }
    }
    char substeps[64];
    snprintf(substeps, sizeof substeps, "phys.substeps=%llu", (unsigned long long)o->substeps);
    return combination_ok(o) && (!o->substeps || read_set(o, NULL, substeps));
}

void app_options_help(void) {
    puts("corsac run SCENE.lua|DIR [options] [-- ARGS]\n");
    for (size_t i = 0; i < CORE_COUNT_OF(table); i++) {
        char left[64];
        snprintf(left, sizeof left, "--%s %s", table[i].name,
                 table[i].argument ? table[i].argument : "");
        printf("  %-24s %s\n", left, table[i].help);
    }
    puts("\nExit codes: 0 fine; 1 a script failed; 2 bad usage; 3 an expectation fell short;\n"
         "4 a replay diverged; 5 something is missing here; 130 interrupted.");
}
