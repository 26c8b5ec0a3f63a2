// Force fields: accelerations that depend on where a body is.
#include "phys/world.h"

#define TIMED                                                                                      \
    8 // reading the clock costs as much as a field: a body is timed in one step of so many

CORE_COLUMNS_DEFINE(phys_fields, PHYS_FIELD_COLUMNS)

phys_field_desc phys_field_desc_default(phys_field_type type) {
    return (phys_field_desc){
        .type = type, .core = 0.01f, .rotation = core_quat_identity(), .cookie = PHYS_FIELD_COOKIE};
}

static bool check_desc(const phys_field_desc *d) {
    if (d->cookie != PHYS_FIELD_COOKIE) {
        return core_fail("phys field: description was not made by phys_field_desc_default");
    }
    if ((unsigned)d->type > PHYS_FIELD_WIND) {
        return core_fail("phys field: type %d, expected uniform, point or wind", (int)d->type);
    }
    if (d->type == PHYS_FIELD_UNIFORM && !phys_finite3(d->acceleration)) {
        return core_fail("phys field: acceleration (%g, %g, %g) is not finite",
                         (double)d->acceleration.x, (double)d->acceleration.y,
                         (double)d->acceleration.z);
    }
    if (d->type == PHYS_FIELD_WIND && !phys_finite3(d->velocity)) {
        return core_fail("phys field: velocity (%g, %g, %g) is not finite", (double)d->velocity.x,
                         (double)d->velocity.y, (double)d->velocity.z);
    }
    if (d->type == PHYS_FIELD_POINT &&
        !(phys_finite3(d->center) && phys_finite(d->strength) && d->core > 0.0f)) {
        return core_fail("phys field: point needs a finite centre and strength (%g) and a core "
                         "above 0 m (%g)",
                         (double)d->strength, (double)d->core);
    }
    return !d->bounded || phys_region_check("field", d->shape, d->half, d->radius, d->position);
}

// Member by member into a zeroed row: the padding of a struct that is copied whole is what a
// compiler left there, and rows are hashed.
static void keep(phys_field_desc *out, const phys_field_desc *d) {
    out->type = d->type;
    out->acceleration = d->acceleration;
    out->velocity = d->velocity;
    out->center = d->center;
    out->strength = d->strength;
    out->core = d->core;
    out->bounded = d->bounded;
    out->shape = d->shape;
    out->position = d->position;
    out->half = d->half;
    out->rotation = core_quat_normalize(d->rotation);
    out->radius = d->radius;
    out->layers = d->layers ? d->layers : UINT32_MAX;
}

phys_field phys_field_create(phys_world *w, const phys_field_desc *d) {
    if (!check_desc(d)) {
        return CORE_NULL_HANDLE;
    }
    core_handle h = core_columns_add(&w->fields.set);
    if (!core_handle_is_null(h)) {
        phys_field_desc *out = &w->fields.desc[core_columns_count(&w->fields.set) - 1];
        keep(out, d);
        w->measured = false;
        phys_wake_all(w);
    }
    return h;
}

bool phys_field_destroy(phys_world *w, phys_field h) {
    if (!phys_field_alive(w, h)) {
        return core_fail("phys field: destroy of a stale or null handle (%u:%u)", h.index,
                         h.generation);
    }
    w->measured = false;
    phys_wake_all(w);
    return core_columns_remove(&w->fields.set, h, NULL, NULL);
}

bool phys_field_alive(const phys_world *w, phys_field h) {
    return core_columns_row(&w->fields.set, h) != CORE_NO_ROW;
}

static core_vec3 pull(const phys_field_desc *f, core_vec3 at) {
    if (f->type != PHYS_FIELD_POINT) {
        return f->acceleration;
    }
    core_vec3 d = core_v3_sub(f->center, at);
    float l2 = core_v3_dot(d, d), l = core_sqrtf(l2);
    float cube = l > f->core ? l2 * l : f->core * f->core * f->core;
    return core_v3_scale(d, f->strength / cube);
}

static bool acts(const phys_field_desc *f, core_vec3 at, uint32_t layer) {
    if ((f->layers >> layer & 1u) == 0) {
        return false;
    }
    if (!f->bounded) {
        return true;
    }
    phys_geom g = phys_geom_make(f->shape, f->position, f->rotation, f->half, f->radius);
    return phys_geom_contains(&g, at);
}

// Sum over the fields: of wind or of accelerations.
static core_vec3 sum_fields(const phys_world *w, core_vec3 at, uint32_t layer, bool wind) {
    core_vec3 sum = {0, 0, 0};
    for (uint32_t i = 0; i < core_columns_count(&w->fields.set); i++) {
        const phys_field_desc *f = &w->fields.desc[i];
        if ((f->type == PHYS_FIELD_WIND) == wind && acts(f, at, layer)) {
            sum = core_v3_add(sum, wind ? f->velocity : pull(f, at));
        }
    }
    return sum;
}

core_vec3 phys_field_acceleration(const phys_world *w, core_vec3 at, uint32_t layer) {
    return sum_fields(w, at, layer, false);
}
core_vec3 phys_field_wind(const phys_world *w, core_vec3 at, uint32_t layer) {
    return sum_fields(w, at, layer, true);
}

core_vec3 phys_field_pull(const phys_world *w, core_vec3 at, uint32_t row) {
    if ((row + w->stamp) % TIMED) {
        return phys_field_acceleration(w, at, w->bodies.layer[row]);
    }
    uint64_t begin = phys_spent_begin(w->metrics);
    core_vec3 a = phys_field_acceleration(w, at, w->bodies.layer[row]);
    phys_spent_end(&w->spent->fields, begin, TIMED);
    return a;
}

void phys_world_set_force(phys_world *w, phys_force_fn *force, void *ctx) {
    w->force = force;
    w->force_ctx = ctx;
    w->measured = false;
    phys_wake_all(w);
}

bool phys_pulled(const phys_world *w) {
    return core_columns_count(&w->fields.set) != 0 || w->force != NULL;
}

core_vec3 phys_pull(const phys_world *w, core_vec3 at, core_vec3 velocity, float time,
                    uint32_t row) {
    core_vec3 a = core_v3(0, 0, 0);
    if (core_columns_count(&w->fields.set) != 0) {
        a = phys_field_pull(w, at, row);
    }
    return w->force != NULL ? core_v3_add(a, w->force(w->force_ctx, at, velocity, time)) : a;
}
