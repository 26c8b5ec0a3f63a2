// The world: creation, settings by name, and the order of a step.
#include "phys/world.h"

#include "core/nearest.h"

#include <stdlib.h>
#include <string.h>

static const phys_broad_method *const broads[] = {&phys_broad_tree, &phys_broad_sap,
                                                  &phys_broad_brute};
static const phys_solver_method *const solvers[] = {&phys_solver_soft, &phys_solver_sequential,
                                                    &phys_solver_impulse};

phys_world_desc phys_world_desc_default(void) {
    return (phys_world_desc){.gravity = {0.0f, -9.81f, 0.0f}, .cookie = PHYS_WORLD_COOKIE};
}

const char *const *phys_method_names(const char *kind) {
    static const char *const solver[] = {"soft", "sequential", "impulse", NULL};
    static const char *const broad[] = {"auto", "tree", "sap", "brute", NULL};
    static const char *const integrator[] = {"exact",  "auto", "semi", "euler",
                                             "verlet", "rk4",  NULL};
    static const char *const none[] = {NULL};
    if (strcmp(kind, "integrator") == 0) {
        return integrator;
    }
    return strcmp(kind, "solver") == 0 ? solver : strcmp(kind, "broad") == 0 ? broad : none;
}

static bool pick_broad(phys_world *w, const char *name) {
    w->pairs_stale = w->trees_stale = true;
    if (strcmp(name, "auto") == 0) {
        w->broad = broads[0];
        return true;
    }
    for (size_t i = 0; i < CORE_COUNT_OF(broads); i++) {
        if (strcmp(name, broads[i]->name) == 0) {
            w->broad = broads[i];
            return true;
        }
    }
    return core_fail("phys setting broad: '%s' is unknown, expected auto, tree, sap or brute",
                     name);
}

static bool pick_solver(phys_world *w, const char *name) {
    for (size_t i = 0; i < CORE_COUNT_OF(solvers); i++) {
        if (strcmp(name, solvers[i]->name) == 0) {
            if (solvers[i] != &phys_solver_soft && core_columns_count(&w->joints.set) != 0) {
                return core_fail("phys setting solver: '%s' has no joints, of which there are %u",
                                 name, core_columns_count(&w->joints.set));
            }
            w->solver = solvers[i];
            phys_wake_all(w);
            return true;
        }
    }
    return core_fail("phys setting solver: '%s' is unknown, expected soft, sequential or impulse",
                     name);
}

static bool check_desc(const phys_world_desc *d) {
    if (d->cookie != PHYS_WORLD_COOKIE) {
        return core_fail("phys world: description was not made by phys_world_desc_default");
    }
    if (!phys_finite3(d->gravity)) {
        return core_fail("phys world: gravity (%g, %g, %g) is not finite", (double)d->gravity.x,
                         (double)d->gravity.y, (double)d->gravity.z);
    }
    if (d->substeps < 0 || d->substeps > 64) {
        return core_fail("phys world: substeps is %d, expected 0 (default) or 1..64", d->substeps);
    }
    if (d->iterations < 0 || d->iterations > 256) {
        return core_fail("phys world: iterations is %d, expected 0 (default) or 1..256",
                         d->iterations);
    }
    return true;
}

static bool make_storage(phys_world *w, uint32_t max_bodies) {
    uint32_t pairs = max_bodies > UINT32_MAX / 32 ? UINT32_MAX / 2 : max_bodies * 16;
    return phys_bodies_init(&w->bodies, "phys.bodies", max_bodies) &&
           phys_shapes_init(&w->shapes, "phys.shapes", max_bodies * 2) &&
           phys_balls_init(&w->balls, "phys.balls", pairs) &&
           phys_contacts_init(&w->contacts, "phys.contacts", pairs) &&
           phys_mesh_pairs_init(&w->mesh_pairs, "phys.mesh_pairs", pairs) &&
           phys_joints_init(&w->joints, "phys.joints", 1u << 20) &&
           phys_triggers_init(&w->triggers, "phys.triggers", 1u << 16) &&
           phys_visits_init(&w->visits, "phys.visits", 1u << 20) &&
           phys_fields_init(&w->fields, "phys.fields", 1u << 12) &&
           phys_movers_init(&w->movers, "phys.movers", 1u << 16) &&
           phys_cloths_init(&w->cloths, "phys.cloths", 1u << 16) &&
           phys_particles_init(&w->particles, "phys.particles", PHYS_CLOTH_PARTICLES) &&
           phys_holds_init(&w->holds, "phys.holds", PHYS_CLOTH_PARTICLES) &&
           core_arena_init(&w->scratch, "phys.scratch", (size_t)16 << 30);
}

phys_world *phys_world_create(const phys_world_desc *d) {
    if (!check_desc(d)) {
        return NULL;
    }
    phys_world *w = core_alloc(sizeof *w);
    w->spent = core_alloc(sizeof *w->spent);
    w->jobs = d->jobs;
    w->metrics = d->metrics;
    w->gravity = d->gravity;
    if (d->gravity.x == 0.0f && d->gravity.y == 0.0f && d->gravity.z == 0.0f && !d->zero_gravity) {
        w->gravity = core_v3(0.0f, -9.81f, 0.0f);
    }
    if (d->zero_gravity) {
        w->gravity = core_v3(0, 0, 0);
    }
    for (int i = 0; i < 32; i++) {
        w->rule[i] = UINT32_MAX;
    }
    w->sleep = true;
    w->substeps = d->substeps;
    w->iterations = d->iterations;
    if (!make_storage(w, d->max_bodies ? d->max_bodies : 1u << 20) ||
        !pick_broad(w, d->broad ? d->broad : "auto") ||
        !pick_solver(w, d->solver ? d->solver : solvers[0]->name)) {
        phys_world_destroy(w);
        return NULL;
    }
    return w;
}

void phys_world_destroy(phys_world *w) {
    if (w == NULL) {
        return;
    }
    core_columns_release(&w->bodies.set);
    core_columns_release(&w->shapes.set);
    core_columns_release(&w->balls.set);
    core_columns_release(&w->contacts.set);
    core_columns_release(&w->mesh_pairs.set);
    core_columns_release(&w->joints.set);
    core_free(w->joint_pairs.key);
    core_columns_release(&w->triggers.set);
    core_columns_release(&w->visits.set);
    core_columns_release(&w->fields.set);
    core_columns_release(&w->movers.set);
    core_columns_release(&w->cloths.set);
    core_columns_release(&w->particles.set);
    core_columns_release(&w->holds.set);
    core_arena_release(&w->scratch);
    phys_pairs_release(w);
    phys_hulls_release(w);
    phys_meshes_release(w);
    phys_trees_release(w);
    core_free(w->spent);
    core_free(w);
}

void phys_world_set_gravity(phys_world *w, core_vec3 g) {
    if (phys_finite3(g)) {
        w->gravity = g;
        phys_wake_all(w);
        w->measured = false;
        return;
    }
    core_fail("phys world: gravity (%g, %g, %g) is not finite", (double)g.x, (double)g.y,
              (double)g.z);
}
core_vec3 phys_world_gravity(const phys_world *w) { return w->gravity; }

static bool set_int(const char *name, const char *value, int lo, int hi, int *out) {
    char *end;
    long v = strtol(value, &end, 10);
    if (end == value || *end != '\0' || v < lo || v > hi) {
        return core_fail("phys setting %s: '%s', expected a whole number %d..%d", name, value, lo,
                         hi);
    }
    *out = (int)v;
    return true;
}

bool phys_world_set(phys_world *w, const char *name, const char *value) {
    static const char *const names[] = {"broad",      "cloth",   "friction",    "integrator",
                                        "iterations", "joints",  "restitution", "sleep",
                                        "solver",     "substeps"};
    if (strcmp(name, "friction") == 0 || strcmp(name, "restitution") == 0) {
        bool good =
            phys_set_mixing(name, value, name[0] == 'f' ? &w->mix_friction : &w->mix_restitution);
        phys_remix_contacts(w);
        return good;
    }
    if (strcmp(name, "cloth") == 0) {
        bool iterates = strcmp(value, "iterate") == 0;
        if (!iterates && strcmp(value, "direct") != 0) {
            return core_fail("phys setting cloth: '%s', expected direct or iterate", value);
        }
        w->cloth_iterates = iterates;
        phys_cloths_wake(w);
        return true;
    }
    if (strcmp(name, "joints") == 0) {
        bool iterates = strcmp(value, "iterate") == 0;
        if (!iterates && strcmp(value, "direct") != 0) {
            return core_fail("phys setting joints: '%s', expected direct or iterate", value);
        }
        w->joints_iterate = iterates;
        return true;
    }
    if (strcmp(name, "broad") == 0) {
        return pick_broad(w, value);
    }
    if (strcmp(name, "solver") == 0) {
        return pick_solver(w, value);
    }
    if (strcmp(name, "substeps") == 0) {
        return set_int(name, value, 0, 64, &w->substeps);
    }
    if (strcmp(name, "iterations") == 0) {
        return set_int(name, value, 0, 256, &w->iterations);
    }
    if (strcmp(name, "integrator") == 0) {
        bool exact = strcmp(value, "exact") == 0, fitting = strcmp(value, "auto") == 0;
        const phys_integrator *found = exact ? NULL : phys_integrator_find(fitting ? "rk4" : value);
        if (exact || found != NULL) {
            w->integrator = found;
            w->auto_integrator = fitting;
        }
        return exact || found != NULL;
    }
    if (strcmp(name, "sleep") == 0) {
        bool on = strcmp(value, "on") == 0;
        if (!on && strcmp(value, "off") != 0) {
            return core_fail("phys setting sleep: '%s', expected on or off", value);
        }
        w->sleep = on;
        phys_wake_all(w);
        return true;
    }
    const char *near = core_nearest(name, names, CORE_COUNT_OF(names));
    return core_fail("phys setting '%s' is unknown%s%s", name, near ? ", did you mean " : "",
                     near ? near : "");
}

static bool check_layers(uint32_t a, uint32_t b) {
    return (a < 32 && b < 32) || core_fail("phys layers: %u and %u, expected 0..31", a, b);
}

bool phys_world_set_rule(phys_world *w, uint32_t a, uint32_t b, bool collide) {
    if (!check_layers(a, b)) {
        return false;
    }
    w->pairs_stale = true;
    phys_wake_all(w);
    w->rule[a] = collide ? w->rule[a] | 1u << b : w->rule[a] & ~(1u << b);
    w->rule[b] = collide ? w->rule[b] | 1u << a : w->rule[b] & ~(1u << a);
    return true;
}

bool phys_world_rule(const phys_world *w, uint32_t a, uint32_t b) {
    return check_layers(a, b) && (w->rule[a] >> b & 1u) != 0;
}

#define NAMED_LOST 8u // a structure that explodes would fill the log

// A body that is no longer finite is stopped where it last made sense (its origin is still that of
// the step before) and named; the rest goes on.
static void isolate(phys_bodies *b, uint32_t i, uint32_t found) {
    core_handle h = core_columns_handle(&b->set, i);
    if (found < NAMED_LOST) {
        core_fail("phys body %u:%u is no longer finite: it is frozen and takes no more part",
                  h.index, h.generation);
    }
    b->flags[i] |= PHYS_BODY_LOST;
    b->type[i] = PHYS_STATIC;
    b->im[i] = b->ix[i] = b->iy[i] = b->iz[i] = 0.0f;
    phys_put3(b->vx, b->vy, b->vz, i, core_v3(0, 0, 0));
    phys_put3(b->wx, b->wy, b->wz, i, core_v3(0, 0, 0));
    core_quat q = core_quat_normalize(phys_body_quat(b, i));
    b->qx[i] = q.x;
    b->qy[i] = q.y;
    b->qz[i] = q.z;
    b->qw[i] = q.w;
    phys_body_sync_center(b, i);
}

static void isolate_lost(phys_world *w) {
    phys_bodies *b = &w->bodies;
    uint32_t found = 0;
    for (uint32_t i = 0; i < core_columns_count(&b->set); i++) {
        float sum = b->cx[i] + b->cy[i] + b->cz[i] + b->qx[i] + b->qy[i] + b->qz[i] + b->qw[i] +
                    b->vx[i] + b->vy[i] + b->vz[i] + b->wx[i] + b->wy[i] + b->wz[i];
        if (!phys_finite(sum)) {
            isolate(b, i, found++);
        }
    }
    if (found > NAMED_LOST) {
        core_fail("phys: %u bodies are no longer finite in this step, %u of them named above",
                  found, NAMED_LOST);
    }
}

static void finish_step(phys_world *w, float dt) {
    phys_bodies *b = &w->bodies;
    isolate_lost(w);
    for (uint32_t i = 0; i < core_columns_count(&b->set); i++) {
        core_vec3 f = b->force[i];
        if (b->type[i] == PHYS_DYNAMIC && (f.x != 0.0f || f.y != 0.0f || f.z != 0.0f)) {
            w->work += (double)core_v3_dot(f, phys_get3(b->vx, b->vy, b->vz, i)) * (double)dt;
        }
        if (phys_mobile(b, i) || b->type[i] == PHYS_KINEMATIC) {
            phys_body_sync_origin(b, i);
        }
    }
    phys_clear_forces(w);
    w->edited = false;
    w->time += (double)dt;
}

// Nothing moves and nothing was changed: the step has only its clock and its triggers to do.
static bool all_at_rest(const phys_world *w) {
    if (w->edited || w->pairs_stale || w->rows_stale) {
        return false;
    }
    for (uint32_t i = 0; i < core_columns_count(&w->bodies.set); i++) {
        if (phys_moves(&w->bodies, i)) {
            return false;
        }
    }
    return true;
}

bool phys_world_step(phys_world *w, float dt) {
    if (!(dt > 0.0f && dt <= 1.0f)) {
        return core_fail("phys step: dt is %g s, expected more than 0 and at most 1", (double)dt);
    }
    core_arena_reset(&w->scratch);
    core_stage_begin(w->metrics, CORE_STAGE_PHYS);
    phys_events_begin(w);
    if (all_at_rest(w)) {
        w->islands = 0;
        memset(w->level_islands, 0, sizeof w->level_islands);
        w->time += (double)dt;
        phys_cloths_update(w, dt, false);
        phys_movers_update(w, dt, true);
        phys_events_triggers(w);
        core_stage_end(w->metrics, CORE_STAGE_PHYS);
        return true;
    }
    core_stage_begin(w->metrics, CORE_STAGE_PHYS_BROAD);
    phys_joints_list_pairs(w);
    phys_shapes_update_bounds(w, dt);
    phys_layers_update(w);
    w->broad->find(w);
    phys_pairs_update(w);
    core_stage_end(w->metrics, CORE_STAGE_PHYS_BROAD);
    core_stage_begin(w->metrics, CORE_STAGE_PHYS_NARROW);
    phys_narrow_update(w, dt);
    core_stage_end(w->metrics, CORE_STAGE_PHYS_NARROW);
    core_stage_begin(w->metrics, CORE_STAGE_PHYS_ISLANDS);
    phys_events_contacts(w, dt);
    phys_islands_update(w, dt);
    core_stage_end(w->metrics, CORE_STAGE_PHYS_ISLANDS);
    core_stage_begin(w->metrics, CORE_STAGE_PHYS_SOLVE);
    phys_cloths_update(w, dt, w->shapes_changed);
    w->shapes_changed = false;
    const core_quat *rotations = phys_continuous_begin(w);
    w->solver->step(w, dt);
    core_stage_end(w->metrics, CORE_STAGE_PHYS_SOLVE);
    core_stage_begin(w->metrics, CORE_STAGE_PHYS_CCD);
    phys_continuous_end(w, rotations, dt);
    core_stage_end(w->metrics, CORE_STAGE_PHYS_CCD);
    phys_joints_break(w);
    finish_step(w, dt);
    phys_spent_tell(w->spent, w->metrics);
    phys_movers_update(w, dt, false);
    phys_events_triggers(w);
    core_stage_end(w->metrics, CORE_STAGE_PHYS);
    return true;
}

void phys_world_sets(phys_world *w, core_columns *set[PHYS_SETS]) {
    core_columns *all[PHYS_SETS] = {
        &w->bodies.set,   &w->shapes.set,    &w->balls.set,  &w->contacts.set, &w->joints.set,
        &w->triggers.set, &w->visits.set,    &w->fields.set, &w->movers.set,   &w->mesh_pairs.set,
        &w->cloths.set,   &w->particles.set, &w->holds.set};
    memcpy(set, all, sizeof all);
}

int phys_world_state(const phys_world *w, const core_columns **out, int capacity) {
    core_columns *set[PHYS_SETS];
    phys_world_sets((phys_world *)w, set);
    for (int i = 0; out != NULL && i < capacity && i < PHYS_SETS; i++) {
        out[i] = set[i];
    }
    return PHYS_SETS;
}

size_t phys_world_bytes(const phys_world *w) {
    return sizeof *w + core_columns_bytes(&w->bodies.set) + core_columns_bytes(&w->shapes.set) +
           core_columns_bytes(&w->balls.set) + core_columns_bytes(&w->contacts.set) +
           core_columns_bytes(&w->mesh_pairs.set) + phys_meshes_bytes(w) +
           core_columns_bytes(&w->joints.set) + w->joint_pairs.capacity * sizeof(uint64_t) +
           core_columns_bytes(&w->triggers.set) + core_columns_bytes(&w->visits.set) +
           core_columns_bytes(&w->fields.set) + core_columns_bytes(&w->movers.set) +
           core_columns_bytes(&w->cloths.set) + core_columns_bytes(&w->particles.set) +
           core_columns_bytes(&w->holds.set) +
           (w->events.capacity + w->pending.capacity) * sizeof(phys_event) + w->scratch.committed +
           w->map.capacity * (sizeof(uint64_t) + sizeof(uint32_t)) +
           w->pairs.capacity * sizeof(phys_pair) + w->order_capacity * sizeof(uint32_t) +
           (w->fixed_tree.capacity + w->moving_tree.capacity) *
               (sizeof(uint32_t) + sizeof(phys_box) / 2);
}

static void count_levels(const phys_world *w, core_metrics *m) {
    uint32_t coarse = 0, fine = 0;
    int most = w->substeps, usual = phys_level_substeps(w, PHYS_LEVEL_DEFAULT);
    for (uint32_t level = 0; level < PHYS_LEVELS; level++) {
        int substeps = phys_level_substeps(w, level);
        uint32_t n = w->level_islands[level];
        coarse += substeps < usual ? n : 0;
        fine += substeps > usual ? n : 0;
        most = n != 0 ? CORE_MAX(most, substeps) : most;
    }
    core_metrics_set(m, CORE_COUNT_ISLANDS_COARSE, coarse);
    core_metrics_set(m, CORE_COUNT_ISLANDS_FINE, fine);
    core_metrics_set(m, CORE_COUNT_SUBSTEPS_MAX, most);
}

void phys_world_counts(const phys_world *w, core_metrics *m) {
    uint32_t n = phys_body_count(w), awake = 0;
    for (uint32_t i = 0; i < n; i++) {
        awake += phys_mobile(&w->bodies, i) || w->bodies.type[i] == PHYS_KINEMATIC;
    }
    core_metrics_set(m, CORE_COUNT_BODIES, n);
    core_metrics_set(m, CORE_COUNT_AWAKE, awake);
    core_metrics_set(m, CORE_COUNT_SHAPES, core_columns_count(&w->shapes.set));
    core_metrics_set(m, CORE_COUNT_PAIRS,
                     core_columns_count(&w->balls.set) + core_columns_count(&w->contacts.set));
    core_metrics_set(m, CORE_COUNT_CONTACTS, w->touching);
    core_metrics_set(m, CORE_COUNT_JOINTS, phys_joint_count(w));
    core_metrics_set(m, CORE_COUNT_ISLANDS, w->islands);
    count_levels(w, m);
    core_metrics_set(m, CORE_COUNT_TRIGGERS, core_columns_count(&w->triggers.set));
}

phys_pose_view phys_world_poses(const phys_world *w) {
    const phys_bodies *b = &w->bodies;
    return (phys_pose_view){b->px, b->py, b->pz, b->qx, b->qy, b->qz, b->qw,
                            b->vx, b->vy, b->vz, b->wx, b->wy, b->wz, phys_body_count(w)};
}
