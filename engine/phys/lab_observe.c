#include "phys/lab_observe.h"
#include "phys/world.h"

static void see(const phys_world *w, phys_observed *o, double value, uint32_t row,
                phys_body other) {
    if (value > o->value) {
        *o = (phys_observed){value, core_columns_handle(&w->bodies.set, row), other, w->time};
    }
}

// Curvature of the fields' potential at a place, the steepest of them: within its core a point
// field is a spring of strength / core^3; beyond, its steepest change is twice strength / r^3.
static double stiffness_at(const phys_world *w, core_vec3 at, uint32_t layer) {
    double steepest = 0;
    for (uint32_t k = 0; k < core_columns_count(&w->fields.set); k++) {
        const phys_field_desc *f = &w->fields.desc[k];
        if (f->type != PHYS_FIELD_POINT || (f->layers >> layer & 1u) == 0) {
            continue;
        }
        double r = (double)core_v3_length(core_v3_sub(at, f->center)), core = (double)f->core;
        double strength = f->strength < 0 ? -(double)f->strength : (double)f->strength;
        double k2 = r <= core ? strength / (core * core * core) : 2 * strength / (r * r * r);
        steepest = CORE_MAX(steepest, k2);
    }
    return steepest;
}

void phys_observe_motion(phys_world *w, phys_observation *o) {
    const phys_bodies *b = &w->bodies;
    bool fields = core_columns_count(&w->fields.set) != 0;
    float fastest = (float)(o->speed.value * o->speed.value);
    float spinning = (float)(o->spin.value * o->spin.value);
    for (uint32_t i = 0; i < core_columns_count(&b->set); i++) {
        float v = b->vx[i] * b->vx[i] + b->vy[i] * b->vy[i] + b->vz[i] * b->vz[i];
        float s = b->wx[i] * b->wx[i] + b->wy[i] * b->wy[i] + b->wz[i] * b->wz[i];
        if (v > fastest) {
            fastest = v;
            see(w, &o->speed, (double)core_sqrtf(v), i, CORE_NULL_HANDLE);
        }
        if (s > spinning && (b->flags[i] & PHYS_BODY_ISOTROPIC) == 0) {
            spinning = s;
            see(w, &o->spin, (double)core_sqrtf(s), i, CORE_NULL_HANDLE);
        }
        if (fields && b->type[i] == PHYS_DYNAMIC) {
            double k = stiffness_at(w, phys_get3(b->cx, b->cy, b->cz, i), b->layer[i]);
            see(w, &o->stiffness, k, i, CORE_NULL_HANDLE);
        }
    }
}

static double thinnest_wall(const phys_world *w) {
    double thin = 0;
    for (uint32_t i = 0; i < core_columns_count(&w->shapes.set); i++) {
        const core_vec3 h = w->shapes.half[i];
        uint32_t row = phys_slot_row(&w->bodies.set, w->shapes.body[i]);
        if (w->shapes.type[i] == PHYS_BOX && w->bodies.type[row] == PHYS_STATIC) {
            double edge = 2.0 * (double)CORE_MIN(h.x, CORE_MIN(h.y, h.z));
            thin = thin > 0 ? CORE_MIN(thin, edge) : edge;
        }
    }
    return thin;
}

typedef struct carrier {  // what a body rests on
    float height;         // against gravity
    uint32_t row, below;  // CORE_NO_ROW: nothing, or a static body
    uint32_t supports, n; // bodies below; bodies of the tower up to this one
} carrier;

// a rests on b when it is higher than it is beside it.
static void rest(phys_world *w, carrier *c, phys_observation *o, uint32_t a, uint32_t b) {
    const phys_bodies *bodies = &w->bodies;
    uint32_t n = core_columns_count(&bodies->set);
    if (a >= n || b >= n) { // removed since the step
        return;
    }
    uint32_t upper = c[a].height > c[b].height ? a : b, lower = upper == a ? b : a;
    if (bodies->type[upper] != PHYS_DYNAMIC) {
        return;
    }
    if (bodies->type[lower] == PHYS_STATIC) {
        c[upper].supports++;
        return;
    }
    core_vec3 d = core_v3_sub(phys_get3(bodies->cx, bodies->cy, bodies->cz, upper),
                              phys_get3(bodies->cx, bodies->cy, bodies->cz, lower));
    float up = c[upper].height - c[lower].height;
    if (up * up * 2.0f < core_v3_dot(d, d)) {
        return;
    }
    c[upper].supports++;
    c[upper].below = lower;
    if (bodies->im[lower] > 0 && bodies->im[upper] > 0) {
        see(w, &o->mass, (double)bodies->im[lower] / (double)bodies->im[upper], upper,
            core_columns_handle(&bodies->set, lower));
    }
}

static void sort_by_height(carrier *c, uint32_t *order, uint32_t *tmp, uint32_t n) {
    for (uint32_t width = 1; width < n; width *= 2) {
        for (uint32_t lo = 0; lo < n; lo += 2 * width) {
            uint32_t mid = CORE_MIN(lo + width, n), hi = CORE_MIN(lo + 2 * width, n);
            uint32_t i = lo, j = mid;
            for (uint32_t k = lo; k < hi; k++) {
                bool left = i < mid && (j >= hi || c[order[i]].height <= c[order[j]].height);
                tmp[k] = left ? order[i++] : order[j++];
            }
        }
        for (uint32_t k = 0; k < n; k++) {
            order[k] = tmp[k];
        }
    }
}

void phys_observe_contacts(phys_world *w, phys_observation *o) {
    const phys_bodies *b = &w->bodies;
    uint32_t n = core_columns_count(&b->set);
    size_t mark = core_arena_mark(&w->scratch);
    carrier *c = CORE_ARENA_ARRAY(&w->scratch, carrier, n + 1);
    uint32_t *order = CORE_ARENA_ARRAY(&w->scratch, uint32_t, n + 1);
    uint32_t *tmp = CORE_ARENA_ARRAY(&w->scratch, uint32_t, n + 1);
    for (uint32_t i = 0; i < n; i++) {
        float height = -core_v3_dot(phys_get3(b->cx, b->cy, b->cz, i), w->gravity);
        c[i] =
            (carrier){height / CORE_MAX(core_v3_length(w->gravity), 1e-6f), i, CORE_NO_ROW, 0, 1};
        order[i] = i;
    }
    for (uint32_t i = 0; i < core_columns_count(&w->balls.set); i++) {
        if (w->balls.touch[i]) {
            rest(w, c, o, w->balls.a[i], w->balls.b[i]);
        }
    }
    for (uint32_t i = 0; i < core_columns_count(&w->contacts.set); i++) {
        if (w->contacts.touch[i]) {
            rest(w, c, o, w->contacts.a[i], w->contacts.b[i]);
        }
    }
    sort_by_height(c, order, tmp, n);
    for (uint32_t k = 0; k < n; k++) {
        carrier *at = &c[order[k]];
        if (at->supports == 1 && at->below != CORE_NO_ROW) {
            at->n = c[at->below].n + 1;
            see(w, &o->stack, at->n, order[k], CORE_NULL_HANDLE);
        }
    }
    o->thickness = thinnest_wall(w);
    core_arena_rewind(&w->scratch, mark);
}

// Balls and boxes; other shapes have no simple mesh.
bool phys_observe_shape(const phys_world *w, uint32_t row, phys_shape_type *type, core_vec3 *half) {
    if (row >= core_columns_count(&w->bodies.set) || w->bodies.shape[row] == 0) {
        return false;
    }
    uint32_t i = phys_slot_row(&w->shapes.set, w->bodies.shape[row]);
    float r = w->shapes.radius[i];
    *type = (phys_shape_type)w->shapes.type[i];
    *half = *type == PHYS_SPHERE ? core_v3(r, r, r) : w->shapes.half[i];
    return *type == PHYS_SPHERE || *type == PHYS_BOX;
}

phys_effort phys_observe_effort(const phys_world *w) {
    return (phys_effort){w->solver->name, w->substeps ? w->substeps : w->solver->substeps,
                         w->iterations ? w->iterations : w->solver->iterations};
}
