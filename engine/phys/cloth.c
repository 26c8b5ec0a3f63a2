// Ropes and cloth: creation, holds and reports. A step of theirs is in cloth_step.c.
#include "phys/world.h"

#include <string.h>

CORE_COLUMNS_DEFINE(phys_cloths, PHYS_CLOTH_COLUMNS)
CORE_COLUMNS_DEFINE(phys_particles, PHYS_PARTICLE_COLUMNS)
CORE_COLUMNS_DEFINE(phys_holds, PHYS_HOLD_COLUMNS)

phys_cloth_desc phys_cloth_desc_default(void) {
    return (phys_cloth_desc){.mass = 1.0f,
                             .radius = 0.01f,
                             .shear = 1e-3f,
                             .friction = 0.5f,
                             .damping = 0.1f,
                             .drag = 1.0f,
                             .gravity_scale = 1.0f,
                             .substeps = 8,
                             .cookie = PHYS_CLOTH_COOKIE};
}

static bool check(const char *what, float value, float lo, float hi, const char *unit) {
    return (value >= lo && value <= hi) ||
           core_fail("phys cloth: %s is %g, expected %g..%g %s", what, (double)value, (double)lo,
                     (double)hi, unit);
}

static bool check_vector(const char *what, core_vec3 v, float far) {
    core_vec3 a = phys_abs3(v);
    return (a.x <= far && a.y <= far && a.z <= far) ||
           core_fail("phys cloth: %s (%g, %g, %g) is not finite or beyond %g", what, (double)v.x,
                     (double)v.y, (double)v.z, (double)far);
}

static bool check_way(const char *what, core_vec3 way, uint32_t count) {
    float length = core_v3_length(way);
    return check_vector(what, way, PHYS_FAR) &&
           (count < 2 || length >= 1e-4f * (float)count ||
            core_fail("phys cloth: %s is %g m for %u particles, expected at least 0.1 mm between "
                      "neighbours",
                      what, (double)length, count));
}

static bool check_desc(const phys_world *w, const phys_cloth_desc *d) {
    if (d->cookie != PHYS_CLOTH_COOKIE) {
        return core_fail("phys cloth: description was not made by phys_cloth_desc_default");
    }
    uint64_t count = (uint64_t)d->columns * d->rows;
    uint32_t room = PHYS_CLOTH_PARTICLES - core_columns_count(&w->particles.set);
    if (count < 2 || count > room) {
        return core_fail("phys cloth: %u columns of %u rows, expected 2..%u particles (room left)",
                         d->columns, d->rows, room);
    }
    if (d->substeps > 64 || d->layer > 31) {
        return core_fail("phys cloth: %u substeps on layer %u, expected at most 64 and 31",
                         d->substeps, d->layer);
    }
    return check_vector("origin", d->origin, PHYS_FAR) &&
           check_way("across", d->across, d->columns) && check_way("down", d->down, d->rows) &&
           check("mass", d->mass, 1e-6f, 1e9f, "kg") &&
           check("radius", d->radius, 1e-4f, 10.0f, "m") &&
           check("stretch", d->stretch, 0.0f, 1e6f, "m/N") &&
           check("shear", d->shear, 0.0f, 1e6f, "m/N") &&
           check("bend", d->bend, 0.0f, 1e9f, "N/m") &&
           check("friction", d->friction, 0.0f, 1e6f, "") &&
           check("damping", d->damping, 0.0f, 1e3f, "1/s") &&
           check("drag", d->drag, 0.0f, 1e3f, "") &&
           check("gravity_scale", d->gravity_scale, -1e3f, 1e3f, "") &&
           check("tear_force", d->tear_force, 0.0f, 1e12f, "N");
}

static void place_particles(phys_world *w, uint32_t first, const phys_cloth_desc *d) {
    phys_particles *p = &w->particles;
    for (uint32_t r = 0; r < d->rows; r++) {
        for (uint32_t c = 0; c < d->columns; c++) {
            float s = d->columns > 1 ? (float)c / (float)(d->columns - 1) : 0.0f;
            float t = d->rows > 1 ? (float)r / (float)(d->rows - 1) : 0.0f;
            core_vec3 at = core_v3_mad(core_v3_mad(d->origin, d->across, s), d->down, t);
            phys_put3(p->x, p->y, p->z, first + r * d->columns + c, at);
        }
    }
}

phys_cloth phys_cloth_create(phys_world *w, const phys_cloth_desc *d) {
    if (!check_desc(w, d)) {
        return CORE_NULL_HANDLE;
    }
    core_handle h = core_columns_add(&w->cloths.set);
    if (core_handle_is_null(h)) {
        return h;
    }
    uint32_t count = d->columns * d->rows, first = core_columns_count(&w->particles.set);
    for (uint32_t i = 0; i < count; i++) {
        core_columns_add(&w->particles.set); // room was checked
    }
    place_particles(w, first, d);
    phys_cloths *c = &w->cloths;
    uint32_t i = core_columns_count(&c->set) - 1;
    c->columns[i] = d->columns;
    c->rows[i] = d->rows;
    c->first[i] = first;
    c->rest_across[i] = core_v3_length(d->across) / (float)CORE_MAX(d->columns - 1, 1u);
    c->rest_down[i] = core_v3_length(d->down) / (float)CORE_MAX(d->rows - 1, 1u);
    c->mass[i] = d->mass / (float)count;
    c->radius[i] = d->radius;
    c->stretch[i] = d->stretch;
    c->shear[i] = d->shear;
    c->bend[i] = d->bend;
    c->friction[i] = d->friction;
    c->damping[i] = d->damping;
    c->drag[i] = d->drag;
    c->gravity_scale[i] = d->gravity_scale;
    c->tear_force[i] = d->tear_force;
    c->substeps[i] = d->substeps ? d->substeps : 8;
    c->layer[i] = d->layer;
    c->user[i] = d->user;
    return h;
}

static uint32_t live_row(const phys_world *w, phys_cloth cloth, const char *what) {
    uint32_t row = core_columns_row(&w->cloths.set, cloth);
    if (row == CORE_NO_ROW) {
        core_fail("phys cloth: %s of a stale or null handle (%u:%u)", what, cloth.index,
                  cloth.generation);
    }
    return row;
}

static void drop_holds(phys_world *w, uint32_t cloth_slot, uint32_t index, bool all) {
    phys_holds *h = &w->holds;
    for (uint32_t k = core_columns_count(&h->set); k-- > 0;) {
        if (h->cloth[k] == cloth_slot && (all || h->index[k] == index)) {
            core_columns_remove(&h->set, core_columns_handle(&h->set, k), NULL, NULL);
        }
    }
}

// Particles behind close up: their order stays, only the last rows go.
static void remove_particles(phys_world *w, uint32_t first, uint32_t count) {
    core_columns *set = &w->particles.set;
    uint32_t n = core_columns_count(set);
    for (uint32_t k = 0; k < set->column_count; k++) {
        uint8_t *data = set->data[k];
        size_t size = set->column[k].size;
        memmove(data + first * size, data + (first + count) * size, (n - first - count) * size);
    }
    for (uint32_t i = 0; i < count; i++) {
        core_columns_remove(set, core_columns_handle(set, n - 1 - i), NULL, NULL);
    }
    phys_cloths *c = &w->cloths;
    for (uint32_t i = 0; i < core_columns_count(&c->set); i++) {
        c->first[i] -= c->first[i] > first ? count : 0;
    }
}

bool phys_cloth_destroy(phys_world *w, phys_cloth cloth) {
    uint32_t i = live_row(w, cloth, "destroy");
    if (i == CORE_NO_ROW) {
        return false;
    }
    drop_holds(w, cloth.index, 0, true);
    remove_particles(w, w->cloths.first[i], w->cloths.columns[i] * w->cloths.rows[i]);
    return core_columns_remove(&w->cloths.set, cloth, NULL, NULL);
}

bool phys_cloth_alive(const phys_world *w, phys_cloth cloth) {
    return core_columns_row(&w->cloths.set, cloth) != CORE_NO_ROW;
}

uint32_t phys_cloth_count(const phys_world *w) { return core_columns_count(&w->cloths.set); }

uint64_t phys_cloth_user(const phys_world *w, phys_cloth cloth) {
    uint32_t i = live_row(w, cloth, "user");
    return i == CORE_NO_ROW ? 0 : w->cloths.user[i];
}

// Row of a cloth that has this particle.
static uint32_t particle_of(const phys_world *w, phys_cloth cloth, uint32_t column, uint32_t row,
                            const char *what, uint32_t *index) {
    uint32_t i = live_row(w, cloth, what);
    const phys_cloths *c = &w->cloths;
    if (i != CORE_NO_ROW && (column >= c->columns[i] || row >= c->rows[i])) {
        core_fail("phys cloth: %s of particle (%u, %u), expected columns 0..%u and rows 0..%u",
                  what, column, row, c->columns[i] - 1, c->rows[i] - 1);
        return CORE_NO_ROW;
    }
    *index = i == CORE_NO_ROW ? 0 : row * c->columns[i] + column;
    return i;
}

static void wake(phys_cloths *c, uint32_t i) {
    c->asleep[i] = 0;
    c->still[i] = 0.0f;
}

bool phys_cloth_hold(phys_world *w, phys_cloth cloth, uint32_t column, uint32_t row, phys_body body,
                     core_vec3 at) {
    uint32_t index, i = particle_of(w, cloth, column, row, "hold", &index);
    if (i == CORE_NO_ROW || !check_vector("place of a hold", at, PHYS_FAR)) {
        return false;
    }
    uint32_t b = phys_body_row(w, body);
    if (!core_handle_is_null(body) && b == CORE_NO_ROW) {
        return core_fail("phys cloth: hold by a stale body (%u:%u)", body.index, body.generation);
    }
    drop_holds(w, cloth.index, index, false);
    if (core_handle_is_null(core_columns_add(&w->holds.set))) {
        return false;
    }
    uint32_t k = core_columns_count(&w->holds.set) - 1;
    w->holds.cloth[k] = cloth.index;
    w->holds.index[k] = index;
    w->holds.body[k] = body;
    w->holds.place[k] = at;
    if (b != CORE_NO_ROW) {
        const phys_particles *p = &w->particles;
        const phys_bodies *all = &w->bodies;
        core_vec3 here = phys_get3(p->x, p->y, p->z, w->cloths.first[i] + index);
        core_vec3 arm = core_v3_sub(here, phys_get3(all->px, all->py, all->pz, b));
        w->holds.place[k] = phys_unrotate(phys_body_quat(all, b), arm);
    }
    wake(&w->cloths, i);
    return true;
}

bool phys_cloth_release(phys_world *w, phys_cloth cloth, uint32_t column, uint32_t row) {
    uint32_t index, i = particle_of(w, cloth, column, row, "release", &index);
    if (i == CORE_NO_ROW) {
        return false;
    }
    drop_holds(w, cloth.index, index, false);
    wake(&w->cloths, i);
    return true;
}

bool phys_cloth_push(phys_world *w, phys_cloth cloth, uint32_t column, uint32_t row,
                     core_vec3 impulse) {
    uint32_t index, i = particle_of(w, cloth, column, row, "push", &index);
    if (i == CORE_NO_ROW || !check_vector("impulse", impulse, 1e9f)) {
        return false;
    }
    phys_particles *p = &w->particles;
    uint32_t k = w->cloths.first[i] + index;
    core_vec3 v = phys_get3(p->vx, p->vy, p->vz, k);
    phys_put3(p->vx, p->vy, p->vz, k, core_v3_mad(v, impulse, 1.0f / w->cloths.mass[i]));
    wake(&w->cloths, i);
    return true;
}

void phys_cloths_wake(phys_world *w) {
    for (uint32_t i = 0; i < core_columns_count(&w->cloths.set); i++) {
        wake(&w->cloths, i);
    }
}

bool phys_cloth_read(const phys_world *w, phys_cloth cloth, phys_cloth_view *out) {
    uint32_t i = live_row(w, cloth, "read");
    *out = (phys_cloth_view){0};
    if (i == CORE_NO_ROW) {
        return false;
    }
    const phys_cloths *c = &w->cloths;
    const phys_particles *p = &w->particles;
    uint32_t k = c->first[i];
    *out = (phys_cloth_view){.columns = c->columns[i],
                             .rows = c->rows[i],
                             .count = c->columns[i] * c->rows[i],
                             .x = p->x + k,
                             .y = p->y + k,
                             .z = p->z + k,
                             .vx = p->vx + k,
                             .vy = p->vy + k,
                             .vz = p->vz + k,
                             .torn = p->torn + k,
                             .torn_count = c->torn_count[i],
                             .asleep = c->asleep[i] != 0};
    return true;
}

static double edge_error(const phys_cloth_view *v, uint32_t a, uint32_t b, float rest) {
    double x = (double)v->x[b] - (double)v->x[a], y = (double)v->y[b] - (double)v->y[a];
    double z = (double)v->z[b] - (double)v->z[a];
    double e = core_sqrt(x * x + y * y + z * z) / (double)rest - 1.0;
    return e < 0 ? -e : e;
}

bool phys_cloth_stretch(const phys_world *w, phys_cloth cloth, double *mean, double *most) {
    phys_cloth_view v;
    *mean = *most = 0;
    if (!phys_cloth_read(w, cloth, &v)) {
        return false;
    }
    uint32_t i = core_columns_row(&w->cloths.set, cloth), edges = 0;
    for (uint32_t r = 0; r < v.rows; r++) {
        for (uint32_t c = 0; c < v.columns; c++) {
            uint32_t k = r * v.columns + c;
            bool across = c + 1 < v.columns && !(v.torn[k] & PHYS_CLOTH_TORN_ACROSS);
            bool down = r + 1 < v.rows && !(v.torn[k] & PHYS_CLOTH_TORN_DOWN);
            double a = across ? edge_error(&v, k, k + 1, w->cloths.rest_across[i]) : 0;
            double b = down ? edge_error(&v, k, k + v.columns, w->cloths.rest_down[i]) : 0;
            edges += (uint32_t)across + (uint32_t)down;
            *mean += a + b;
            *most = CORE_MAX(*most, CORE_MAX(a, b));
        }
    }
    *mean /= edges ? (double)edges : 1.0;
    return true;
}
