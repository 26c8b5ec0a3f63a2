// Emitters: checks, births, and the store of what was born. Where particles are is in
// gfx_particles.simd.c.
#include "gfx/gfx_particles.h"

#include "core/rng.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

CORE_COLUMNS_DEFINE(gfx_emitters, GFX_EMITTER_COLUMNS)

enum { MAX_EMITTERS = 4096, MAX_CAPACITY = 1 << 20, COLUMNS = 12, NUMBERS = 12 };

static bool finite3(core_vec3 v) { return isfinite(v.x) && isfinite(v.y) && isfinite(v.z); }

gfx_emitter_desc gfx_emitter_desc_default(void) {
    return (gfx_emitter_desc){.rate = 20.0f,
                              .life = {1.0f, 1.0f},
                              .speed = {1.0f, 1.0f},
                              .size = {0.1f},
                              .size_keys = 1,
                              .color = {{1.0f, 1.0f, 1.0f, 1.0f}},
                              .color_keys = 1,
                              .frames = {1, 1},
                              .cookie = GFX_COOKIE};
}

static bool check_range(const char *name, const float *range, float least) {
    return (isfinite(range[0]) && isfinite(range[1]) && range[0] >= least &&
            range[1] >= range[0]) ||
           core_fail("gfx_emitter_create: %s is %g to %g, expected finite numbers from %g on, the "
                     "first not above the second",
                     name, (double)range[0], (double)range[1], (double)least);
}

static bool check(const gfx_emitter_desc *d) {
    if (!d || d->cookie != GFX_COOKIE) {
        return core_fail("gfx_emitter_create: start from gfx_emitter_desc_default()");
    }
    if (!finite3(d->position) || !finite3(d->extent) || !finite3(d->acceleration) ||
        !finite3(d->wind)) {
        return core_fail("gfx_emitter_create: position, extent, acceleration and wind must be "
                         "finite numbers");
    }
    const float numbers[4] = {d->rate, d->drag, d->spread, d->size_vary};
    const char *const names[4] = {"rate", "drag", "spread", "size_vary"};
    for (int i = 0; i < 4; ++i) {
        if (!isfinite(numbers[i]) || numbers[i] < 0.0f) {
            return core_fail("gfx_emitter_create: %s is %g, expected a finite number >= 0",
                             names[i], (double)numbers[i]);
        }
    }
    if (d->size_keys < 1 || d->size_keys > GFX_EMITTER_KEYS || d->color_keys < 1 ||
        d->color_keys > GFX_EMITTER_KEYS || d->frames[0] < 1 || d->frames[1] < 1) {
        return core_fail("gfx_emitter_create: %u sizes, %u colours, %ux%u frames: expected 1 to %d "
                         "of size and colour, at least 1x1 frames",
                         d->size_keys, d->color_keys, d->frames[0], d->frames[1], GFX_EMITTER_KEYS);
    }
    return check_range("life", d->life, 0.001f) && check_range("speed", d->speed, 0.0f) &&
           check_range("spin", d->spin, -1e6f);
}

// Columns of one block, each on a border of 64 bytes as long as capacity is a multiple of 16.
static void make_store(gfx_emitter_store *e, uint32_t capacity) {
    e->capacity = (capacity + CORE_LANES - 1) / CORE_LANES * CORE_LANES;
    e->memory = core_alloc((size_t)e->capacity * COLUMNS * sizeof(float) + CORE_ALIGN);
    uintptr_t start = ((uintptr_t)e->memory + CORE_ALIGN - 1) / CORE_ALIGN * CORE_ALIGN;
    float *at = (float *)start;
    float **const column[] = {&e->px,   &e->py,    &e->pz,    &e->vx,   &e->vy,   &e->vz,
                              &e->life, &e->scale, &e->angle, &e->spin, &e->share};
    for (size_t i = 0; i < CORE_COUNT_OF(column); ++i, at += e->capacity) {
        *column[i] = at;
    }
    e->born = (int32_t *)(void *)at;
}

static gfx_particles *particles_of(gfx_world *world) {
    if (!world->particles) {
        gfx_particles *p = core_alloc(sizeof *p);
        if (!gfx_emitters_init(&p->emitters, "gfx.emitters", MAX_EMITTERS)) {
            core_free(p);
            return NULL;
        }
        world->particles = p;
    }
    return world->particles;
}

void gfx_particles_destroy(gfx_particles *p) {
    if (p) {
        for (uint32_t i = 0; i < core_columns_count(&p->emitters.set); ++i) {
            core_free(p->emitters.store[i].memory);
        }
        core_columns_release(&p->emitters.set);
        gfx_growing_release(&p->scratch);
        core_free(p);
    }
}

gfx_particle_view gfx_particles_scratch(gfx_particles *p, uint32_t capacity) {
    p->scratch.count = 0;
    float *at = gfx_grow(&p->scratch, sizeof *at, (size_t)capacity * 6);
    return (gfx_particle_view){at,
                               at + capacity,
                               at + 2 * capacity,
                               at + 3 * capacity,
                               at + 4 * capacity,
                               (uint32_t *)(void *)(at + 5 * capacity)};
}

gfx_emitter gfx_emitter_create(gfx_world *world, const gfx_emitter_desc *desc) {
    if (!check(desc)) {
        return CORE_NULL_HANDLE;
    }
    gfx_particles *p = particles_of(world);
    double want = desc->capacity ? (double)desc->capacity
                                 : (double)desc->rate * (double)desc->life[1] + 1.0 + desc->burst;
    if (want > MAX_CAPACITY) {
        core_fail("gfx_emitter_create: %.0f particles at once, at most %d", want, MAX_CAPACITY);
        return CORE_NULL_HANDLE;
    }
    gfx_emitter emitter = p ? core_columns_add(&p->emitters.set) : CORE_NULL_HANDLE;
    if (core_handle_is_null(emitter)) {
        return emitter;
    }
    gfx_emitter_store *e = &p->emitters.store[core_columns_row(&p->emitters.set, emitter)];
    *e = (gfx_emitter_store){.desc = *desc, .last = INT32_MIN / 2};
    e->desc.rotation = core_quat_normalize(desc->rotation);
    e->was_position = desc->position, e->was_rotation = e->desc.rotation;
    if (desc->image) {
        snprintf(e->image, sizeof e->image, "%s", desc->image);
        e->desc.image = NULL; // that of the caller may go
    }
    make_store(e, (uint32_t)want);
    world->heap_bytes += (size_t)e->capacity * COLUMNS * sizeof(float);
    gfx_emitter_burst(world, emitter, desc->burst);
    return emitter;
}

static gfx_emitter_store *store_of(const gfx_world *world, gfx_emitter emitter, const char *call) {
    gfx_particles *p = world->particles;
    uint32_t row = p ? core_columns_row(&p->emitters.set, emitter) : CORE_NO_ROW;
    if (row == CORE_NO_ROW) {
        core_fail("%s: the handle (index %u, generation %u) is stale or null", call, emitter.index,
                  emitter.generation);
        return NULL;
    }
    return &p->emitters.store[row];
}

bool gfx_emitter_alive(const gfx_world *world, gfx_emitter emitter) {
    const gfx_particles *p = world->particles;
    return p && core_columns_row(&p->emitters.set, emitter) != CORE_NO_ROW;
}

bool gfx_emitter_destroy(gfx_world *world, gfx_emitter emitter) {
    gfx_emitter_store *e = store_of(world, emitter, "gfx_emitter_destroy");
    if (!e) {
        return false;
    }
    world->heap_bytes -= (size_t)e->capacity * COLUMNS * sizeof(float);
    core_free(e->memory);
    return core_columns_remove(&world->particles->emitters.set, emitter, NULL, NULL);
}

// ---- births ----

static float mix(const float range[2], float u) { return range[0] + (range[1] - range[0]) * u; }

// Direction uniform over the cap of half angle `spread` round +Y.
static core_vec3 direction(float spread, float u, float v) {
    float least = core_cosf(CORE_MIN(spread, CORE_PI_F)), sine, cosine;
    float y = 1.0f - u * (1.0f - least), r = core_sqrtf(CORE_MAX(1.0f - y * y, 0.0f));
    core_sincosf(2.0f * CORE_PI_F * v, &sine, &cosine);
    return core_v3(r * cosine, y, r * sine);
}

// Uniform in the emitter's shape, in its own frame.
static core_vec3 place(const gfx_emitter_desc *d, const float u[3]) {
    core_vec3 at = {2.0f * u[0] - 1.0f, 2.0f * u[1] - 1.0f, 2.0f * u[2] - 1.0f};
    if (d->shape == GFX_EMIT_POINT) {
        return core_v3(0.0f, 0.0f, 0.0f);
    }
    if (d->shape == GFX_EMIT_SPHERE) {
        // The cube root makes it uniform in the ball.
        float r = core_powf(u[2], 1.0f / 3.0f);
        at = core_v3_scale(direction(CORE_PI_F, u[0], u[1]), r);
    }
    return core_v3(at.x * d->extent.x, at.y * d->extent.y, at.z * d->extent.z);
}

// One particle, born at `share` of the step.
static void give_birth(gfx_emitter_store *e, int32_t step, float share) {
    const gfx_emitter_desc *d = &e->desc;
    float u[NUMBERS];
    for (uint64_t i = 0; i < NUMBERS; ++i) {
        uint64_t bits = core_rng_at(d->seed, CORE_RNG_VIEW, e->number * NUMBERS + i);
        u[i] = (float)(bits >> 40) * 0x1p-24f;
    }
    e->number++;
    uint32_t i = e->next;
    e->next = i + 1 == e->capacity ? 0 : i + 1;
    e->used = CORE_MAX(e->used, i + 1);
    core_quat turn = e->moved ? core_quat_nlerp(e->was_rotation, d->rotation, share) : d->rotation;
    core_vec3 from = core_v3_mad(e->was_position, core_v3_sub(d->position, e->was_position), share);
    core_vec3 at = core_v3_add(from, core_quat_rotate(turn, place(d, u)));
    core_vec3 v = core_quat_rotate(turn, direction(d->spread, u[3], u[4]));
    v = core_v3_scale(v, mix(d->speed, u[5]));
    e->px[i] = at.x, e->py[i] = at.y, e->pz[i] = at.z;
    e->vx[i] = v.x, e->vy[i] = v.y, e->vz[i] = v.z;
    e->life[i] = mix(d->life, u[6]);
    e->scale[i] = 1.0f + d->size_vary * (2.0f * u[7] - 1.0f);
    e->angle[i] = d->spin[0] != 0.0f || d->spin[1] != 0.0f ? 2.0f * CORE_PI_F * u[8] : 0.0f;
    e->spin[i] = mix(d->spin, u[9]);
    e->share[i] = share;
    e->born[i] = step;
    e->last = step;
}

static void step_emitter(gfx_emitter_store *e, int32_t step, float dt) {
    float due = e->desc.rate * dt, first = 1.0f - e->owed;
    uint32_t births = due > 0.0f && e->owed + due >= 1.0f ? (uint32_t)(e->owed + due) : 0;
    for (uint32_t i = 0; i < births; ++i) {
        give_birth(e, step, CORE_MIN((first + (float)i) / due, 1.0f));
    }
    e->owed = CORE_MAX(e->owed + due - (float)births, 0.0f);
    e->was_position = e->desc.position, e->was_rotation = e->desc.rotation;
    e->moved = false;
}

void gfx_world_step(gfx_world *world, float dt) {
    gfx_particles *p = world->particles;
    if (!p) {
        return;
    }
    p->dt = dt;
    p->part = 0.0f;
    for (uint32_t i = 0; i < core_columns_count(&p->emitters.set); ++i) {
        step_emitter(&p->emitters.store[i], p->step, dt);
    }
    p->step++;
}

void gfx_world_set_moment(gfx_world *world, float alpha) {
    if (world->particles) {
        world->particles->part = alpha - 1.0f; // alpha 1: the end of the last step
    }
}

// ---- changes ----

bool gfx_emitter_burst(gfx_world *world, gfx_emitter emitter, uint32_t count) {
    gfx_emitter_store *e = store_of(world, emitter, "gfx_emitter_burst");
    for (uint32_t i = 0; e && i < CORE_MIN(count, e->capacity); ++i) {
        give_birth(e, world->particles->step, 0.0f);
    }
    return e != NULL;
}

bool gfx_emitter_set_pose(gfx_world *world, gfx_emitter emitter, core_vec3 position,
                          core_quat rotation) {
    gfx_emitter_store *e = store_of(world, emitter, "gfx_emitter_set_pose");
    if (!e) {
        return false;
    }
    if (!finite3(position)) {
        return core_fail("gfx_emitter_set_pose: the position must be finite numbers");
    }
    e->desc.position = position;
    e->desc.rotation = core_quat_normalize(rotation);
    e->moved = true;
    return true;
}

bool gfx_emitter_set_rate(gfx_world *world, gfx_emitter emitter, float rate) {
    gfx_emitter_store *e = store_of(world, emitter, "gfx_emitter_set_rate");
    if (!e) {
        return false;
    }
    if (!isfinite(rate) || rate < 0.0f) {
        return core_fail("gfx_emitter_set_rate: %g a second, expected a finite number >= 0",
                         (double)rate);
    }
    e->desc.rate = rate;
    return true;
}

bool gfx_emitter_set_user(gfx_world *world, gfx_emitter emitter, uint64_t user) {
    gfx_emitter_store *e = store_of(world, emitter, "gfx_emitter_set_user");
    return e ? (e->user = user, true) : false;
}

uint64_t gfx_emitter_user(const gfx_world *world, gfx_emitter emitter) {
    const gfx_emitter_store *e = store_of(world, emitter, "gfx_emitter_user");
    return e ? e->user : 0;
}

uint32_t gfx_emitters_count(const gfx_world *world) {
    return world->particles ? core_columns_count(&world->particles->emitters.set) : 0;
}

gfx_emitter gfx_emitter_at(const gfx_world *world, uint32_t row) {
    return row < gfx_emitters_count(world)
               ? core_columns_handle(&world->particles->emitters.set, row)
               : CORE_NULL_HANDLE;
}

uint32_t gfx_emitter_particles(gfx_world *world, gfx_emitter emitter, core_vec3 *out,
                               uint32_t capacity) {
    const gfx_emitter_store *e = store_of(world, emitter, "gfx_emitter_particles");
    if (!e) {
        return 0;
    }
    gfx_particles *p = world->particles;
    gfx_particle_view v = gfx_particles_scratch(p, e->capacity);
    uint32_t n = CORE_SIMD_SELECT(gfx_particles_at)(e, p->step, p->part, p->dt, &v);
    for (uint32_t i = 0; out && i < CORE_MIN(n, capacity); ++i) {
        out[i] = core_v3(v.x[i], v.y[i], v.z[i]);
    }
    return n;
}
