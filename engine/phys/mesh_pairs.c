// Shapes near meshes: each such pair owns rows among the contacts, one for each direction in which
// the surface is touched, so that solvers, islands and events see contacts as they know them.
#include "phys/mesh_internal.h"

CORE_COLUMNS_DEFINE(phys_mesh_pairs, PHYS_MESH_PAIR_COLUMNS)

#define GRAIN       32u
#define SAME_FACE   0.8f // cosine: a row goes on with a part of about its direction
#define SPARE_REACH 0.01f

uint32_t phys_mesh_pair_add(phys_world *w, uint32_t sa, uint32_t sb, bool ball) {
    phys_mesh_pairs *p = &w->mesh_pairs;
    core_handle h = core_columns_add(&p->set);
    uint32_t i = core_columns_count(&p->set) - 1;
    p->sa[i] = sa;
    p->sb[i] = sb;
    p->ball[i] = ball;
    p->a[i] = w->shapes.row[phys_slot_row(&w->shapes.set, sa)];
    p->b[i] = w->shapes.row[phys_slot_row(&w->shapes.set, sb)];
    p->stamp[i] = w->stamp;
    return h.index;
}

void phys_mesh_pair_remove(phys_world *w, uint32_t row) {
    phys_mesh_pairs *p = &w->mesh_pairs;
    core_columns *set = p->ball[row] ? &w->balls.set : &w->contacts.set;
    for (uint32_t k = 0; k < p->count[row]; k++) {
        uint32_t part = phys_slot_row(set, p->rows[row].slot[k]);
        core_columns_remove(set, core_columns_handle(set, part), NULL, NULL);
    }
    core_columns_remove(&p->set, core_columns_handle(&p->set, row), NULL, NULL);
}

static uint32_t part_row(const phys_world *w, uint32_t i, uint32_t k) {
    const phys_mesh_pairs *p = &w->mesh_pairs;
    return phys_slot_row(p->ball[i] ? &w->balls.set : &w->contacts.set, p->rows[i].slot[k]);
}

static void own_more(phys_world *w, uint32_t i) {
    phys_mesh_pairs *p = &w->mesh_pairs;
    while (p->count[i] < p->wanted[i]) {
        uint32_t slot = p->ball[i] ? phys_ball_row_add(w, p->sa[i], p->sb[i])
                                   : phys_contact_row_add(w, p->sa[i], p->sb[i]);
        p->rows[i].slot[p->count[i]++] = slot;
    }
}

static core_vec3 part_normal(const phys_world *w, uint32_t i, uint32_t row) {
    return w->mesh_pairs.ball[i] ? phys_get3(w->balls.nx, w->balls.ny, w->balls.nz, row)
                                 : w->contacts.manifold[row].normal;
}

static bool part_used(const phys_world *w, uint32_t i, uint32_t row) {
    return w->mesh_pairs.ball[i] ? w->balls.separation[row] < PHYS_APART
                                 : w->contacts.manifold[row].count != 0;
}

static void clear_part(phys_world *w, uint32_t i, uint32_t row) {
    phys_balls *c = &w->balls;
    if (w->mesh_pairs.ball[i]) {
        c->separation[row] = PHYS_APART;
        c->jn[row] = c->jx[row] = c->jy[row] = c->jz[row] = 0.0f;
        c->rx[row] = c->ry[row] = c->rz[row] = 0.0f;
    } else {
        w->contacts.manifold[row] = (phys_manifold){0};
    }
}

// The surface's own material, where it has one, mixes with the shape's.
static void put_material(phys_world *w, uint32_t i, uint32_t row, const phys_mesh *mesh,
                         uint8_t area) {
    uint32_t sa = phys_slot_row(&w->shapes.set, w->mesh_pairs.sa[i]);
    if ((mesh->area == NULL && mesh->height == NULL) || area >= mesh->material_count) {
        return;
    }
    phys_material m =
        phys_mix_materials(w, phys_shape_material(&w->shapes, sa), mesh->material[area]);
    if (w->mesh_pairs.ball[i]) {
        w->balls.friction[row] = m.friction;
        w->balls.restitution[row] = m.restitution;
        w->balls.rolling[row] = m.rolling;
    } else {
        w->contacts.friction[row] = m.friction;
        w->contacts.restitution[row] = m.restitution;
    }
}

static void put_part(phys_world *w, uint32_t i, uint32_t row, const phys_manifold *m,
                     const phys_pair_view *v) {
    if (w->mesh_pairs.ball[i]) {
        phys_put3(w->balls.nx, w->balls.ny, w->balls.nz, row, m->normal);
        w->balls.separation[row] = m->point[0].separation;
        return;
    }
    phys_manifold out = *m;
    const phys_bodies *b = &w->bodies;
    uint32_t ra = w->mesh_pairs.a[i], rb = w->mesh_pairs.b[i];
    core_vec3 ca = phys_get3(b->cx, b->cy, b->cz, ra), cb = phys_get3(b->cx, b->cy, b->cz, rb);
    out.qa = v->qa;
    out.qb = v->qb;
    out.offset = v->offset;
    out.apart = out.twist = 0.0f;
    out.friction = core_v3(0, 0, 0);
    for (uint32_t k = 0; k < out.count; k++) {
        out.point[k].ra = core_v3_sub(out.point[k].ra, ca);
        out.point[k].rb = core_v3_sub(out.point[k].rb, cb);
        out.point[k].base = out.point[k].separation;
    }
    for (uint32_t k = out.count; k < 4; k++) {
        out.point[k] = (phys_point){0};
    }
    phys_manifold_carry(&w->contacts.manifold[row], &out);
    w->contacts.manifold[row] = out;
}

// Every part goes to the row that had about its direction, else to a free one. The order of parts
// and rows is fixed, and so is the outcome.
static void hand_out(phys_world *w, uint32_t i, phys_parts *parts, const phys_geom *mesh,
                     const phys_pair_view *v) {
    phys_mesh_pairs *p = &w->mesh_pairs;
    uint32_t to[PHYS_PARTS], taken = 0;
    for (uint32_t k = 0; k < parts->count; k++) {
        phys_manifold_place(&parts->m[k], mesh);
        to[k] = PHYS_PARTS;
        float most = SAME_FACE;
        for (uint32_t r = 0; r < p->count[i]; r++) {
            uint32_t row = part_row(w, i, r);
            float d = core_v3_dot(part_normal(w, i, row), parts->m[k].normal);
            if ((taken >> r & 1u) == 0 && part_used(w, i, row) && d > most) {
                most = d;
                to[k] = r;
            }
        }
        taken |= to[k] < PHYS_PARTS ? 1u << to[k] : 0u;
    }
    for (uint32_t r = 0; r < p->count[i]; r++) {
        if ((taken >> r & 1u) == 0) {
            clear_part(w, i, part_row(w, i, r));
        }
    }
    for (uint32_t k = 0; k < parts->count; k++) {
        for (uint32_t r = 0; r < p->count[i] && to[k] == PHYS_PARTS; r++) {
            to[k] = (taken >> r & 1u) == 0 ? r : PHYS_PARTS;
        }
        if (to[k] < PHYS_PARTS) {
            uint32_t row = part_row(w, i, to[k]);
            taken |= 1u << to[k];
            put_part(w, i, row, &parts->m[k], v);
            put_material(w, i, row, mesh->mesh, parts->area[k]);
        }
    }
    p->used[i] = (uint8_t)parts->count;
}

// A pair in touch that hardly moved, and looks no farther than it did, keeps its points.
static bool keep_points(phys_world *w, uint32_t i, const phys_pair_view *v, float reach) {
    phys_mesh_pairs *p = &w->mesh_pairs;
    phys_pair_view old = {.qa = p->qa[i], .qb = p->qb[i], .offset = p->offset[i]};
    if (p->ball[i] || p->used[i] == 0 || reach > p->searched[i] + SPARE_REACH ||
        phys_moved_since(&old, v) > PHYS_KEEP_DISTANCE) {
        return false;
    }
    bool all = true;
    for (uint32_t k = 0; k < p->count[i]; k++) {
        phys_manifold *m = &w->contacts.manifold[part_row(w, i, k)];
        all = (m->count == 0 || phys_manifold_recycle(m, v, reach)) && all;
    }
    return all;
}

static void refresh(phys_world *w, uint32_t i, float dt) {
    phys_mesh_pairs *p = &w->mesh_pairs;
    p->wanted[i] = 0;
    if (!phys_moves(&w->bodies, p->a[i])) {
        return;
    }
    uint32_t sa = phys_slot_row(&w->shapes.set, p->sa[i]);
    uint32_t sb = phys_slot_row(&w->shapes.set, p->sb[i]);
    phys_moving shape = phys_shape_moving(w, sa, p->a[i]);
    phys_pair_view v = phys_view_pair(w, sa, sb, p->a[i], p->b[i]);
    float turn = p->ball[i] ? 0.0f : core_v3_length(shape.w) * shape.extent;
    float way = (core_v3_length(shape.v) + turn) * dt;
    bool fast = way > PHYS_FAST;
    float reach = PHYS_MARGIN + way;
    if (keep_points(w, i, &v, reach)) {
        return;
    }
    phys_geom mesh = phys_shape_geom(w, sb);
    phys_moving local = phys_moving_seen_from(&shape, &mesh);
    phys_parts parts;
    phys_mesh_contacts(mesh.mesh, &local, fast ? PHYS_MARGIN : reach, fast, dt, &parts);
    p->qa[i] = v.qa;
    p->qb[i] = v.qb;
    p->offset[i] = v.offset;
    p->searched[i] = fast ? PHYS_MARGIN : reach;
    p->wanted[i] = (uint8_t)parts.count;
    if (parts.count <= p->count[i]) {
        hand_out(w, i, &parts, &mesh, &v);
    } else {
        p->used[i] = 0; // looked at again when it has the rows
    }
}

static void refresh_chunk(void *ctx, uint32_t begin, uint32_t end, uint32_t chunk,
                          uint32_t worker) {
    (void)chunk;
    (void)worker;
    const float *dt = ((void **)ctx)[1];
    for (uint32_t i = begin; i < end; i++) {
        refresh(((void **)ctx)[0], i, *dt);
    }
}

void phys_mesh_pairs_narrow(phys_world *w, float dt) {
    phys_mesh_pairs *p = &w->mesh_pairs;
    uint32_t n = core_columns_count(&p->set);
    void *ctx[2] = {w, &dt};
    core_jobs_for(w->jobs, n, GRAIN, refresh_chunk, ctx);
    for (uint32_t i = 0; i < n; i++) {
        if (p->wanted[i] > p->count[i]) {
            own_more(w, i);
            refresh(w, i, dt);
        }
    }
}
