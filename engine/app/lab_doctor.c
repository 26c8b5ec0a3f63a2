// `corsac doctor SCENE`: runs the scene, watches what comes near the edge of its methods, and looks
// it up in the stability maps: object, failing regime, and the setting that mends it. Exit code 3
// when it found something.
#include "app/commands.h"
#include "app/lab_maps.h"
#include "app/run.h"

#include <string.h>

#include "core/clock.h"
#include "phys/lab_observe.h"

#define CONTACTS_EVERY 30 // steps
#define MAX_WORDS      300

// A regime that depends on the step. What fails there may go on to numbers that say nothing (a body
// that spins up without end), so the first sight of it is kept.
typedef struct rate {
    const char *map_name;
    app_map *map;
    phys_observed tried, bad; // last value looked up; first that fails, 0: none
} rate;

typedef struct doctor {
    app_run *run;
    phys_observation seen;
    rate spin, stiffness;
    bool maps_missing;
    uint64_t observe_ns, step_ns;
    int found;
} doctor;

static void look_up(doctor *d, rate *r, const phys_observed *seen) {
    if (r->bad.value > 0 || d->maps_missing || seen->value <= 1.05 * r->tried.value) {
        return;
    }
    if (!r->map) {
        phys_effort e = phys_observe_effort(scene_phys_if(d->run->scene));
        r->map = app_map_read(d->run->vfs, r->map_name, e.solver);
        d->maps_missing = !r->map;
    }
    r->tried = *seen;
    if (r->map && seen->value >= r->map->y_lo &&
        strcmp(app_map_at(r->map, (double)scene_dt(d->run->scene), seen->value), "stable") != 0) {
        r->bad = *seen;
    }
}

static void watch(doctor *d) {
    phys_world *world = scene_phys_if(d->run->scene);
    if (!world) {
        return;
    }
    uint64_t start = core_clock_ns();
    phys_observe_motion(world, &d->seen);
    if (d->run->report.steps % CONTACTS_EVERY == 0) {
        phys_observe_contacts(world, &d->seen);
    }
    d->observe_ns += core_clock_ns() - start;
    look_up(d, &d->spin, &d->seen.spin);
    look_up(d, &d->stiffness, &d->seen.stiffness);
}

static const char *object(const doctor *d, phys_body body, char *out, size_t size) {
    scene_entity e = scene_entity_of_body(d->run->scene, body);
    const char *name = scene_alive(d->run->scene, e) ? scene_entity_name(d->run->scene, e) : "";
    if (name[0]) {
        snprintf(out, size, "'%s' (entity %u:%u)", name, e.index, e.generation);
    } else {
        snprintf(out, size, "entity %u:%u", e.index, e.generation);
    }
    return out;
}

// What the effort of a solver is called.
static const char *effort_name(const phys_effort *e) {
    return strcmp(e->solver, "sequential") == 0 ? "iterations" : "substeps";
}

static void say(doctor *d, const char *what, const char *verdict, const char *mend) {
    d->found++;
    printf("%s: %s\n  mend: %s\n", verdict, what, mend);
}

// Maps of a load against the solver's effort: mass ratio, height of a stack.
static bool judge_load(doctor *d, const char *map_name, const phys_observed *seen, const char *what,
                       const char *else_mend) {
    phys_effort e = phys_observe_effort(scene_phys_if(d->run->scene));
    double effort = strcmp(e.solver, "sequential") == 0 ? e.iterations : e.substeps;
    if (seen->value <= 1) {
        return true;
    }
    app_map *map = app_map_read(d->run->vfs, map_name, e.solver);
    if (!map) {
        return false;
    }
    const char *verdict = app_map_at(map, seen->value, effort);
    if (strcmp(verdict, "stable") != 0) {
        char text[512], mend[256];
        double better = app_map_mend_y(map, seen->value, effort);
        snprintf(text, sizeof text, "%s; %s with %g %s fails there", what, e.solver, effort,
                 effort_name(&e));
        if (better > 0) {
            snprintf(mend, sizeof mend, "--set phys.%s=%.0f", effort_name(&e), better);
        } else {
            snprintf(mend, sizeof mend, "no %s up to %.0f hold it: %s", effort_name(&e), map->y_hi,
                     else_mend);
        }
        say(d, text, verdict, mend);
    }
    core_free(map);
    return true;
}

// Maps of a rate against the step: spin, stiffness of fields.
static void judge_rate(doctor *d, const rate *r, const char *what) {
    if (r->bad.value <= 0) {
        return;
    }
    double dt = (double)scene_dt(d->run->scene), better = app_map_mend_x(r->map, dt, r->bad.value);
    char text[512], mend[128];
    snprintf(text, sizeof text, "%s; a step of %.4g s fails there", what, dt);
    if (better > 0) {
        snprintf(mend, sizeof mend, "--dt %.4g", better);
    } else {
        snprintf(mend, sizeof mend, "no step down to %.4g s holds it: lower the rate",
                 r->map->x_lo);
    }
    say(d, text, app_map_at(r->map, dt, r->bad.value), mend);
}

// The map was made at 1/60 s; what counts is the way of one step.
static bool judge_speed(doctor *d, const char *what) {
    const phys_observed *seen = &d->seen.speed;
    if (seen->value <= 0 || d->seen.thickness <= 0) {
        return true;
    }
    phys_effort e = phys_observe_effort(scene_phys_if(d->run->scene));
    double speed = seen->value * (double)scene_dt(d->run->scene) * 60.0;
    app_map *map = app_map_read(d->run->vfs, "map_bullet", e.solver);
    if (!map) {
        return false;
    }
    const char *verdict = app_map_at(map, d->seen.thickness, speed);
    if (strcmp(verdict, "stable") != 0) {
        say(d, what, verdict, "a shorter step (--dt) or a thicker wall");
    }
    core_free(map);
    return true;
}

static bool judge(doctor *d) {
    const phys_observation *o = &d->seen;
    char a[128], b[128], text[400];
    object(d, o->mass.body, a, sizeof a);
    object(d, o->mass.other, b, sizeof b);
    snprintf(text, sizeof text, "mass ratio: %s is %.3g times as heavy as %s that carries it", a,
             o->mass.value, b);
    if (!judge_load(d, "map_mass", &o->mass, text, "bring the masses closer together")) {
        return false;
    }
    object(d, o->stack.body, a, sizeof a);
    snprintf(text, sizeof text,
             "stack height: %s is the top of %.0f bodies that rest on one another", a,
             o->stack.value);
    if (!judge_load(d, "map_stack", &o->stack, text, "lower the stack or widen its foot")) {
        return false;
    }
    const phys_observed *spin = &d->spin.bad, *stiff = &d->stiffness.bad;
    object(d, spin->body, a, sizeof a);
    snprintf(text, sizeof text, "spin: %s turns with %.3g rad/s after %.3g s", a, spin->value,
             spin->time);
    judge_rate(d, &d->spin, text);
    object(d, stiff->body, a, sizeof a);
    snprintf(text, sizeof text, "stiffness: a force field pulls %s with %.3g 1/s^2 after %.3g s", a,
             stiff->value, stiff->time);
    judge_rate(d, &d->stiffness, text);
    object(d, o->speed.body, a, sizeof a);
    snprintf(text, sizeof text,
             "speed: %s goes %.3g m/s after %.3g s, %.3g times the thinnest wall "
             "(%.3g m) in a step",
             a, o->speed.value, o->speed.time,
             o->speed.value * (double)scene_dt(d->run->scene) / CORE_MAX(o->thickness, 1e-9),
             o->thickness);
    return judge_speed(d, text);
}

static int examine(const app_options *options) {
    doctor d = {.run = app_run_create(options),
                .spin.map_name = "map_spin",
                .stiffness.map_name = "map_field"};
    bool fine = app_run_open(d.run);
    if (fine) {
        watch(&d); // what the scene starts with
        for (bool more = true; more;) {
            uint64_t start = core_clock_ns();
            more = app_step(d.run);
            d.step_ns += core_clock_ns() - start;
            if (more) {
                watch(&d);
            }
        }
        fine = judge(&d) && !d.maps_missing;
        printf("%s: %d finding%s in %llu steps; watching cost %.2f %% of the steps\n",
               options->scene, d.found, d.found == 1 ? "" : "s",
               (unsigned long long)d.run->report.steps,
               d.step_ns ? 100.0 * (double)d.observe_ns / (double)d.step_ns : 0.0);
    }
    core_free(d.spin.map);
    core_free(d.stiffness.map);
    app_scene_close(d.run);
    int code = app_run_destroy(d.run);
    code = code == APP_EXIT_EXPECTATION ? APP_EXIT_FINE : code;
    if (code != APP_EXIT_FINE) {
        return code;
    }
    return !fine ? APP_EXIT_ENVIRONMENT : d.found ? APP_EXIT_EXPECTATION : APP_EXIT_FINE;
}

int app_command_doctor(int argc, const char *const *argv) {
    const char *words[MAX_WORDS] = {"--headless", "--quiet", "--set", "metrics.accuracy=off"};
    int n = 4;
    for (int i = 0; i < argc && n < MAX_WORDS; i++) {
        words[n++] = argv[i];
    }
    app_options *o = core_alloc(sizeof *o);
    int code = app_options_parse(o, n, words) ? examine(o) : APP_EXIT_USAGE;
    core_free(o);
    return code;
}
