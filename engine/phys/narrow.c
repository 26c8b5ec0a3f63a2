// Narrow phase: refreshes the manifold of every near pair and carries impulses over by feature.
#include "phys/world.h"

#include "core/simd.h"

#define NARROW_GRAIN 256u

float phys_shape_extent(const phys_shapes *s, uint32_t i) {
    float e = core_v3_length(s->half[i]) + s->radius[i];
    return (e > 0.0f ? e : PHYS_FAR) + core_v3_length(s->position[i]);
}

// Half of the smallest width; a ball counts as thin, since it is cheap to sweep.
static float thin_of(const phys_shapes *s, uint32_t i) {
    core_vec3 h = s->half[i];
    bool flat = s->type[i] == PHYS_BOX || s->type[i] == PHYS_HULL;
    return flat                        ? CORE_MIN(h.x, CORE_MIN(h.y, h.z))
           : s->type[i] == PHYS_SPHERE ? 0.0f
                                       : s->radius[i];
}

phys_moving phys_shape_moving(const phys_world *w, uint32_t shape, uint32_t row) {
    const phys_bodies *b = &w->bodies;
    bool moves = phys_moves(b, row);
    phys_moving m = {.geom = phys_shape_geom(w, shape),
                     .center = phys_get3(b->cx, b->cy, b->cz, row),
                     .extent = moves ? phys_shape_extent(&w->shapes, shape) : 0.0f};
    if (moves) {
        m.v = phys_get3(b->vx, b->vy, b->vz, row);
        m.w = phys_get3(b->wx, b->wy, b->wz, row);
    }
    return m;
}

// Contact of a pair that may meet late in the step: point and normal are those of the moment they
// meet, the gap is what has to close until then. No points: they pass each other.
static void sweep_pair(const phys_moving *a, const phys_moving *b, float dt, phys_manifold *m) {
    float t;
    m->count = 0;
    m->apart = 0.0f;
    if (!phys_sweep(a, b, dt, &t)) {
        return;
    }
    phys_geom ga = phys_moving_at(a, t), gb = phys_moving_at(b, t);
    m->normal = core_v3(0, 0, 0);
    phys_collide(&ga, &gb, PHYS_MARGIN, m);
    phys_swept_points(a, b, t, m);
}

static bool touches(const phys_manifold *m) {
    for (uint32_t k = 0; k < m->count; k++) {
        if (m->point[k].separation < PHYS_NEAR) {
            return true;
        }
    }
    return false;
}

// Slow pairs: what is within the margin. Fast ones: what touches, else what the sweep finds.
static void search_pair(const phys_world *w, uint32_t sa, uint32_t sb, uint32_t ra, uint32_t rb,
                        float dt, phys_manifold *m) {
    phys_moving a = phys_shape_moving(w, sa, ra), b = phys_shape_moving(w, sb, rb);
    float turn = core_v3_length(a.w) * a.extent + core_v3_length(b.w) * b.extent;
    float way = (core_v3_length(core_v3_sub(a.v, b.v)) + turn) * dt;
    float thin = CORE_MIN(thin_of(&w->shapes, sa), thin_of(&w->shapes, sb));
    bool fast = way > CORE_MAX(PHYS_FAST, 0.5f * thin);
    phys_collide(&a.geom, &b.geom, PHYS_MARGIN + (fast ? 0.0f : way), m);
    if (fast && !touches(m)) {
        if (m->apart > PHYS_MARGIN + way) {
            return;
        }
        uint64_t begin = phys_spent_begin(w->metrics);
        sweep_pair(&a, &b, dt, m);
        phys_spent_end(&w->spent->ccd, begin, 1);
    }
}

// Ball on something that does not move: one at a time.
static void refresh_fixed_ball(phys_world *w, uint32_t i, float dt) {
    phys_balls *c = &w->balls;
    phys_manifold m = {0};
    search_pair(w, phys_slot_row(&w->shapes.set, c->sa[i]), phys_slot_row(&w->shapes.set, c->sb[i]),
                c->a[i], c->b[i], dt, &m);
    if (m.count == 0) {
        c->separation[i] = PHYS_APART;
        c->jn[i] = c->jx[i] = c->jy[i] = c->jz[i] = 0.0f;
        c->rx[i] = c->ry[i] = c->rz[i] = 0.0f;
        return;
    }
    phys_put3(c->nx, c->ny, c->nz, i, m.normal);
    c->separation[i] = m.point[0].separation;
}

static bool on_mesh(const phys_world *w, uint32_t shape_slot) {
    return w->shapes.type[phys_slot_row(&w->shapes.set, shape_slot)] == PHYS_MESH;
}

static void narrow_balls(void *ctx, uint32_t begin, uint32_t end, uint32_t chunk, uint32_t worker) {
    (void)chunk;
    (void)worker;
    phys_world *w = ((void **)ctx)[0];
    const float *dt = ((void **)ctx)[1];
    CORE_SIMD_SELECT(phys_narrow_balls)(w, begin, end, *dt);
    for (uint32_t i = begin; i < end; i++) {
        if (w->balls.fixed[i] && phys_mobile(&w->bodies, w->balls.a[i]) &&
            !on_mesh(w, w->balls.sb[i])) {
            refresh_fixed_ball(w, i, *dt);
        }
    }
}

// By feature first; a point whose feature is new takes over from the nearest one left.
void phys_manifold_carry(const phys_manifold *old, phys_manifold *m) {
    bool used[4] = {false}, done[4] = {false};
    if (m->count != 0) {
        m->friction = old->friction;
        m->twist = old->twist;
    }
    for (uint32_t k = 0; k < m->count; k++) {
        for (uint32_t o = 0; o < old->count && !done[k]; o++) {
            if (!used[o] && old->point[o].feature == m->point[k].feature) {
                m->point[k].normal_impulse = old->point[o].normal_impulse;
                used[o] = done[k] = true;
            }
        }
    }
    for (uint32_t k = 0; k < m->count; k++) {
        uint32_t best = 4;
        float least = 4.0f * PHYS_MARGIN * PHYS_MARGIN;
        for (uint32_t o = 0; o < old->count && !done[k]; o++) {
            core_vec3 d = core_v3_sub(old->point[o].ra, m->point[k].ra);
            if (!used[o] && core_v3_dot(d, d) < least) {
                least = core_v3_dot(d, d);
                best = o;
            }
        }
        if (best < 4) {
            m->point[k].normal_impulse = old->point[best].normal_impulse;
            used[best] = true;
        }
    }
}

static float quat_dot(core_quat a, core_quat b) {
    return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
}

phys_pair_view phys_view_pair(const phys_world *w, uint32_t sa, uint32_t sb, uint32_t ra,
                              uint32_t rb) {
    const phys_bodies *b = &w->bodies;
    phys_pair_view v = {.qa = phys_body_quat(b, ra), .qb = phys_body_quat(b, rb)};
    v.dc = core_v3_sub(phys_get3(b->cx, b->cy, b->cz, rb), phys_get3(b->cx, b->cy, b->cz, ra));
    float ea = phys_shape_extent(&w->shapes, sa), eb = phys_shape_extent(&w->shapes, sb);
    v.extent = CORE_MIN(ea, eb);
    v.offset =
        eb > ea ? phys_unrotate(v.qb, core_v3_scale(v.dc, -1.0f)) : phys_unrotate(v.qa, v.dc);
    return v;
}

// Bound on how far any point moved, seen from the other body, since the last search.
float phys_moved_since(const phys_pair_view *old, const phys_pair_view *v) {
    core_quat before = phys_quat_mul(phys_conj(old->qa), old->qb);
    core_quat turn = phys_quat_mul(phys_conj(before), phys_quat_mul(phys_conj(v->qa), v->qb));
    float angle = 2.0f * core_v3_length(core_v3(turn.x, turn.y, turn.z));
    return core_v3_length(core_v3_sub(v->offset, old->offset)) + angle * v->extent;
}

// Keeps what is known of a pair that hardly moved: one that was apart stays so; of one in touch,
// anchors and normal stay and only the gaps are renewed (contact recycling, after Catto, Box3D
// 2026). Besides saving the search, frozen arms keep a loaded stack from swaying: its lever arms do
// not follow every tremor. False: the pair must be searched.
bool phys_manifold_recycle(phys_manifold *m, const phys_pair_view *v, float reach) {
    phys_pair_view old = {.qa = m->qa, .qb = m->qb, .offset = m->offset};
    if (m->count == 0) {
        return m->apart > 0.0f && phys_moved_since(&old, v) + reach < m->apart;
    }
    float ca = quat_dot(v->qa, m->qa), cb = quat_dot(v->qb, m->qb);
    if (core_absf(ca) < PHYS_KEEP_COSINE || core_absf(cb) < PHYS_KEEP_COSINE ||
        phys_moved_since(&old, v) > PHYS_KEEP_DISTANCE) {
        return false;
    }
    core_quat ta = phys_quat_mul(v->qa, phys_conj(m->qa));
    core_quat tb = phys_quat_mul(v->qb, phys_conj(m->qb));
    for (uint32_t k = 0; k < m->count; k++) {
        phys_point *p = &m->point[k];
        core_vec3 arm = core_v3_sub(phys_rotate(tb, p->rb), phys_rotate(ta, p->ra));
        p->separation = p->base + core_v3_dot(core_v3_add(v->dc, arm), m->normal);
    }
    return true;
}

static void refresh_contact(phys_world *w, uint32_t i, float dt) {
    phys_contacts *c = &w->contacts;
    const phys_bodies *b = &w->bodies;
    uint32_t sa = phys_slot_row(&w->shapes.set, c->sa[i]);
    uint32_t sb = phys_slot_row(&w->shapes.set, c->sb[i]);
    uint32_t ra = c->a[i], rb = c->b[i];
    if ((!phys_moves(b, ra) && !phys_moves(b, rb)) || w->shapes.type[sb] == PHYS_MESH) {
        return;
    }
    core_vec3 dv =
        core_v3_sub(phys_get3(b->vx, b->vy, b->vz, ra), phys_get3(b->vx, b->vy, b->vz, rb));
    float spin = core_v3_length(phys_get3(b->wx, b->wy, b->wz, ra)) +
                 core_v3_length(phys_get3(b->wx, b->wy, b->wz, rb));
    phys_pair_view v = phys_view_pair(w, sa, sb, ra, rb);
    phys_manifold *old = &c->manifold[i];
    if (phys_manifold_recycle(old, &v, PHYS_MARGIN + (core_v3_length(dv) + spin * v.extent) * dt)) {
        return;
    }
    phys_manifold m = {.normal = old->normal, .qa = v.qa, .qb = v.qb, .offset = v.offset};
    search_pair(w, sa, sb, ra, rb, dt, &m);
    core_vec3 ca = phys_get3(b->cx, b->cy, b->cz, ra), cb = phys_get3(b->cx, b->cy, b->cz, rb);
    for (uint32_t k = 0; k < m.count; k++) {
        m.point[k].ra = core_v3_sub(m.point[k].ra, ca);
        m.point[k].rb = core_v3_sub(m.point[k].rb, cb);
        m.point[k].base = m.point[k].separation;
    }
    for (uint32_t k = m.count; k < 4; k++) {
        m.point[k] = (phys_point){0};
    }
    phys_manifold_carry(old, &m);
    *old = m;
}

static void narrow_contacts(void *ctx, uint32_t begin, uint32_t end, uint32_t chunk,
                            uint32_t worker) {
    (void)chunk;
    (void)worker;
    const float *dt = ((void **)ctx)[1];
    for (uint32_t i = begin; i < end; i++) {
        refresh_contact(((void **)ctx)[0], i, *dt);
    }
}

// Contacts know their bodies' rows; removals move rows.
static void refresh_rows(phys_world *w) {
    const phys_shapes *s = &w->shapes;
    for (uint32_t i = 0; i < core_columns_count(&w->balls.set); i++) {
        w->balls.a[i] = s->row[phys_slot_row(&s->set, w->balls.sa[i])];
        w->balls.b[i] = s->row[phys_slot_row(&s->set, w->balls.sb[i])];
    }
    for (uint32_t i = 0; i < core_columns_count(&w->contacts.set); i++) {
        w->contacts.a[i] = s->row[phys_slot_row(&s->set, w->contacts.sa[i])];
        w->contacts.b[i] = s->row[phys_slot_row(&s->set, w->contacts.sb[i])];
    }
    for (uint32_t i = 0; i < core_columns_count(&w->mesh_pairs.set); i++) {
        w->mesh_pairs.a[i] = s->row[phys_slot_row(&s->set, w->mesh_pairs.sa[i])];
        w->mesh_pairs.b[i] = s->row[phys_slot_row(&s->set, w->mesh_pairs.sb[i])];
    }
    w->rows_stale = false;
}

void phys_narrow_update(phys_world *w, float dt) {
    if (w->rows_stale) {
        refresh_rows(w);
    }
    void *ctx[2] = {w, &dt};
    uint32_t balls = core_columns_count(&w->balls.set);
    uint32_t contacts = core_columns_count(&w->contacts.set);
    core_jobs_for(w->jobs, balls, NARROW_GRAIN, narrow_balls, ctx);
    core_jobs_for(w->jobs, contacts, NARROW_GRAIN, narrow_contacts, ctx);
    phys_mesh_pairs_narrow(w, dt);
    balls = core_columns_count(&w->balls.set);
    contacts = core_columns_count(&w->contacts.set);
    w->touching = 0;
    uint32_t n = core_columns_count(&w->bodies.set);
    for (uint32_t i = 0; i < n; i++) {
        w->bodies.touching[i] = 0;
    }
    for (uint32_t i = 0; i < balls; i++) {
        if (w->balls.separation[i] < PHYS_APART) {
            w->touching++;
            w->bodies.touching[w->balls.a[i]]++;
            w->bodies.touching[w->balls.b[i]]++;
        }
    }
    for (uint32_t i = 0; i < contacts; i++) {
        if (w->contacts.manifold[i].count != 0) {
            w->touching++;
            w->bodies.touching[w->contacts.a[i]]++;
            w->bodies.touching[w->contacts.b[i]]++;
        }
    }
}
