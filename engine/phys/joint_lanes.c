// Lays joints that trees and chains do not take out in coloured blocks of 16 lanes: no two lanes of
// a colour share a moving body.
#include "phys/joint_solve.h"

#include <string.h>

// First free colour of both bodies; each kind of lanes has colours of its own.
static void color(soft_joints *s, joint_lane_kind kind, uint32_t *lanes) {
    core_arena *arena = &s->world->scratch;
    size_t mark = core_arena_mark(arena);
    uint64_t *used = CORE_ARENA_ARRAY(arena, uint64_t, s->body_count);
    memset(used, 0, s->body_count * sizeof *used);
    for (uint32_t i = 0; i < s->count; i++) {
        joint_work *k = &s->work[i];
        if (k->lanes != kind) {
            continue;
        }
        bool ma = s->body[k->a].mobile, mb = s->body[k->b].mobile;
        uint64_t taken = (ma ? used[k->a] : 0) | (mb ? used[k->b] : 0);
        uint32_t c = taken == UINT64_MAX ? JOINT_COLORS : (uint32_t)__builtin_ctzll(~taken);
        if (c < JOINT_COLORS) {
            used[k->a] |= (uint64_t)1 << c;
            used[k->b] |= (uint64_t)1 << c;
        }
        k->block = c; // the colour, until blocks are known
        k->lane = lanes[c]++;
    }
    core_arena_rewind(arena, mark);
}

// Numbers the blocks and gives each joint its own. Returns how many there are.
static uint32_t place_lanes(soft_joints *s, joint_lane_kind kind) {
    uint32_t lanes[JOINT_COLORS + 1] = {0}, blocks = 0, *first = s->first[kind];
    color(s, kind, lanes);
    for (uint32_t c = 0; c <= JOINT_COLORS; c++) {
        first[c] = blocks;
        blocks += c < JOINT_COLORS ? (lanes[c] + SOFT_LANES - 1) / SOFT_LANES : lanes[c];
    }
    first[JOINT_COLORS + 1] = blocks;
    for (uint32_t i = 0; i < s->count; i++) {
        joint_work *k = &s->work[i];
        if (k->lanes == kind) {
            uint32_t c = k->block, lane = k->lane;
            k->block = first[c] + (c < JOINT_COLORS ? lane / SOFT_LANES : lane);
            k->lane = c < JOINT_COLORS ? lane % SOFT_LANES : 0;
        }
    }
    return blocks;
}

// Every kind of block begins with its head.
static void *make_kind(soft_joints *s, joint_lane_kind kind, size_t size) {
    uint32_t blocks = place_lanes(s, kind);
    uint8_t *data = core_arena_alloc(&s->world->scratch, size * blocks + 1, "joint blocks");
    memset(data, 0, size * blocks);
    for (uint32_t i = 0; i < blocks; i++) {
        joint_head *h = (joint_head *)(data + i * size);
        for (int k = 0; k < SOFT_LANES; k++) {
            h->a[k] = h->b[k] = h->to_a[k] = h->to_b[k] = (int32_t)s->bodies->count;
        }
    }
    for (uint32_t i = 0; i < s->count; i++) {
        const joint_work *k = &s->work[i];
        if (k->lanes == kind) {
            joint_head *h = (joint_head *)(data + k->block * size);
            const joint_body *p = &s->body[k->a], *q = &s->body[k->b];
            int32_t none = (int32_t)s->bodies->count;
            h->a[k->lane] = (int32_t)p->place;
            h->b[k->lane] = (int32_t)q->place;
            h->to_a[k->lane] = p->mobile ? (int32_t)p->place : none;
            h->to_b[k->lane] = q->mobile ? (int32_t)q->place : none;
            h->pose_a[k->lane] = (int32_t)k->a;
            h->pose_b[k->lane] = (int32_t)k->b;
            h->ima[k->lane] = p->im;
            h->imb[k->lane] = q->im;
        }
    }
    return data;
}

static void put_lane(float to[3][SOFT_LANES], uint32_t lane, core_vec3 v) {
    to[0][lane] = v.x;
    to[1][lane] = v.y;
    to[2][lane] = v.z;
}

// Inverse moment of a body whose moments are equal; false when they are not.
static bool round_moment(const soft_joints *s, const joint_body *b, float *out) {
    const phys_bodies *bodies = &s->world->bodies;
    *out = b->mobile ? bodies->ix[b->row] : 0.0f;
    return !b->mobile || ((bodies->flags[b->row] & PHYS_BODY_ISOTROPIC) != 0 &&
                          (bodies->locks[b->row] & PHYS_LOCK_TURN) == 0);
}

static void make_points(soft_joints *s) {
    const phys_joints *j = &s->world->joints;
    s->point = make_kind(s, JOINT_LANES_POINT, sizeof *s->point);
    for (uint32_t i = 0; i < s->first[JOINT_LANES_POINT][JOINT_COLORS + 1]; i++) {
        s->point[i].round = true;
    }
    for (uint32_t i = 0; i < s->count; i++) {
        const joint_work *k = &s->work[i];
        if (k->lanes == JOINT_LANES_POINT) {
            joint_points *p = &s->point[k->block];
            const float *was = j->impulse[k->joint].hard;
            p->round &= round_moment(s, &s->body[k->a], &p->ia[k->lane]);
            p->round &= round_moment(s, &s->body[k->b], &p->ib[k->lane]);
            put_lane(p->la, k->lane, j->la[k->joint]);
            put_lane(p->lb, k->lane, j->lb[k->joint]);
            put_lane(p->impulse, k->lane, core_v3(was[0], was[1], was[2]));
        }
    }
}

static bool has_length(core_vec3 v) { return v.x != 0.0f || v.y != 0.0f || v.z != 0.0f; }

static void make_rods(soft_joints *s) {
    const phys_joints *j = &s->world->joints;
    s->rod = make_kind(s, JOINT_LANES_ROD, sizeof *s->rod);
    for (uint32_t i = 0; i < s->count; i++) {
        const joint_work *k = &s->work[i];
        if (k->lanes == JOINT_LANES_ROD) {
            joint_rods *r = &s->rod[k->block];
            put_lane(r->la, k->lane, j->la[k->joint]);
            put_lane(r->lb, k->lane, j->lb[k->joint]);
            r->rest[k->lane] = j->rest[k->joint];
            r->impulse[k->lane] = j->impulse[k->joint].hard[0];
            r->arms |= has_length(j->la[k->joint]) || has_length(j->lb[k->joint]);
        }
    }
}

static void make_blocks(soft_joints *s) {
    s->block = make_kind(s, JOINT_LANES_BLOCK, sizeof *s->block);
    for (uint32_t i = 0; i < s->count; i++) {
        const joint_work *k = &s->work[i];
        if (k->lanes == JOINT_LANES_BLOCK) {
            joint_block *b = &s->block[k->block];
            b->hard_count = CORE_MAX(b->hard_count, k->direct ? 0u : k->hard);
            b->soft_count = CORE_MAX(b->soft_count, (uint32_t)k->soft);
        }
    }
}

static void put3(float *out, core_vec3 v) {
    out[0] = v.x;
    out[1] = v.y;
    out[2] = v.z;
}

static void make_poses(soft_joints *s) {
    core_arena *arena = &s->world->scratch;
    joint_poses *p = &s->poses;
    uint32_t rows = (s->body_count + SOFT_LANES - 1) / SOFT_LANES * SOFT_LANES;
    size_t floats = (size_t)rows * 8;
    p->start = CORE_ARENA_ARRAY(arena, float, floats);
    p->start_real = CORE_ARENA_ARRAY(arena, float, floats);
    p->pose = CORE_ARENA_ARRAY(arena, float, floats);
    p->real = CORE_ARENA_ARRAY(arena, float, floats);
    p->place = CORE_ARENA_ARRAY(arena, int32_t, rows);
    memset(p->start, 0, floats * sizeof(float));
    memset(p->start_real, 0, floats * sizeof(float));
    memset(p->pose, 0, floats * sizeof(float));
    memset(p->real, 0, floats * sizeof(float));
    for (uint32_t i = 0; i < rows; i++) {
        const joint_body *b = &s->body[i];
        bool some = i < s->body_count;
        p->place[i] = (int32_t)(some ? b->place : s->bodies->count);
        if (some) {
            put3(p->start + (size_t)i * 8, b->center0);
            put3(p->start + (size_t)i * 8 + 4, core_v3(b->q0.x, b->q0.y, b->q0.z));
            p->start_real[(size_t)i * 8] = b->q0.w;
        }
    }
    p->count = rows;
}

void joint_lanes_build(soft_joints *s) {
    make_points(s);
    make_rods(s);
    make_blocks(s);
    uint32_t points = s->first[JOINT_LANES_POINT][JOINT_COLORS + 1];
    if (points + s->first[JOINT_LANES_ROD][JOINT_COLORS + 1] != 0) {
        make_poses(s);
    }
}

static core_vec3 turn_of(const soft_joints *s, uint32_t body, const float *t) {
    if (!s->body[body].mobile) {
        return core_v3(0, 0, 0);
    }
    const float *m = s->bodies->inertia + (size_t)s->body[body].place * 8;
    return core_v3(m[0] * t[0] + m[4] * t[1] + m[5] * t[2], m[4] * t[0] + m[1] * t[1] + m[6] * t[2],
                   m[5] * t[0] + m[6] * t[1] + m[2] * t[2]);
}

static float product(const float *row, float ima, const float *ia, float imb, const float *ib) {
    return ima * (row[0] * row[0] + row[1] * row[1] + row[2] * row[2]) +
           imb * (row[6] * row[6] + row[7] * row[7] + row[8] * row[8]) +
           (row[3] * ia[0] + row[4] * ia[1] + row[5] * ia[2]) +
           (row[9] * ib[0] + row[10] * ib[1] + row[11] * ib[2]);
}

// A row and what its unit impulse does.
static void fill_lane(const soft_joints *s, const joint_work *k, const joint_row *r,
                      joint_lanes *out) {
    uint32_t l = k->lane;
    core_vec3 ia = turn_of(s, k->a, r->j + 3), ib = turn_of(s, k->b, r->j + 9);
    for (int i = 0; i < 12; i++) {
        out->j[i][l] = r->j[i];
    }
    for (int i = 0; i < 3; i++) {
        out->ia[i][l] = phys_comp(ia, i);
        out->ib[i][l] = phys_comp(ib, i);
    }
    float mass = product(r->j, s->body[k->a].im, &ia.x, s->body[k->b].im, &ib.x) + r->gamma;
    out->mass[l] = mass > 0.0f ? 1.0f / mass : 0.0f;
    out->bias[l] = r->bias;
    out->relax[l] = r->relax;
    out->gamma[l] = r->gamma;
    out->lo[l] = r->lo;
    out->hi[l] = r->hi;
}

static void fill_inverse(const soft_joints *s, const joint_work *k, joint_block *b) {
    double m[6][6];
    uint32_t l = k->lane;
    for (uint32_t r = 0; r < k->hard; r++) {
        const joint_lanes *p = &b->hard[r];
        for (uint32_t c = 0; c <= r; c++) {
            const float *j = k->row[c].j, *o = k->row[r].j;
            float ima = s->body[k->a].im, imb = s->body[k->b].im;
            m[r][c] = (double)(ima * (j[0] * o[0] + j[1] * o[1] + j[2] * o[2])) +
                      (double)(imb * (j[6] * o[6] + j[7] * o[7] + j[8] * o[8]));
            for (int i = 0; i < 3; i++) {
                m[r][c] += (double)(j[3 + i] * p->ia[i][l]) + (double)(j[9 + i] * p->ib[i][l]);
            }
            m[c][r] = m[r][c];
        }
    }
    for (uint32_t r = 0; r < k->hard; r++) {
        m[r][r] *= 1.0 + 1e-6;
    }
    joint_invert(m, k->hard);
    for (uint32_t r = 0; r < k->hard; r++) {
        for (uint32_t c = 0; c < k->hard; c++) {
            b->inverse[r][c][l] = (float)m[r][c];
        }
    }
}

void joint_lanes_refresh(soft_joints *s, uint32_t i) {
    joint_work *k = &s->work[s->general[i]];
    joint_rows_make(s, k);
    if (k->lanes != JOINT_LANES_BLOCK) {
        return;
    }
    joint_block *b = &s->block[k->block];
    for (uint32_t r = 0; r < k->soft; r++) {
        fill_lane(s, k, &k->row[k->hard + r], &b->soft[r]);
    }
    if (!k->direct) {
        for (uint32_t r = 0; r < k->hard; r++) {
            fill_lane(s, k, &k->row[r], &b->hard[r]);
        }
        fill_inverse(s, k, b);
    }
}

void joint_lanes_exchange(soft_joints *s, bool to_lanes) {
    for (uint32_t i = 0; i < s->general_count; i++) {
        joint_work *k = &s->work[s->general[i]];
        uint32_t first = k->direct ? k->hard : 0, rows = (uint32_t)k->hard + k->soft;
        for (uint32_t r = first; k->lanes == JOINT_LANES_BLOCK && r < rows; r++) {
            joint_block *b = &s->block[k->block];
            joint_lanes *lanes = r < k->hard ? &b->hard[r] : &b->soft[r - k->hard];
            float *lane = &lanes->impulse[k->lane];
            *(to_lanes ? lane : &k->row[r].impulse) = to_lanes ? k->row[r].impulse : *lane;
        }
    }
}

static core_vec3 lane3(float from[3][SOFT_LANES], uint32_t lane) {
    return core_v3(from[0][lane], from[1][lane], from[2][lane]);
}

// Loads and impulses of the joints that have no rows.
void joint_lanes_end(soft_joints *s) {
    for (uint32_t i = 0; i < s->count; i++) {
        joint_work *k = &s->work[i];
        float *stored = s->world->joints.impulse[k->joint].hard;
        if (k->lanes == JOINT_LANES_POINT) {
            joint_points *p = &s->point[k->block];
            k->force = lane3(p->load, k->lane);
            put3(stored, lane3(p->impulse, k->lane));
        } else if (k->lanes == JOINT_LANES_ROD) {
            joint_rods *r = &s->rod[k->block];
            k->force = lane3(r->load, k->lane);
            stored[0] = r->impulse[k->lane];
        }
    }
}
