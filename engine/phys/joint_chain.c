// Finds the chains among a level's joints and lays them out by slot.
#include "phys/joint_solve.h"

#include <string.h>

typedef struct path_end { // joints of a body that chains are made of
    uint32_t work[2], count;
    bool closed; // something else holds it
} path_end;

static void note_side(const soft_joints *s, path_end *end, uint32_t body, uint32_t work, bool fit) {
    path_end *e = &end[body];
    if (!s->body[body].mobile) {
        return;
    }
    e->closed |= !fit || e->count == 2 || s->world->bodies.locks[s->body[body].row] != 0;
    if (e->count < 2) {
        e->work[e->count++] = work;
    }
}

// Walks from a free end; false when the path is no chain. Writes bodies and joints in order.
static bool walk(const soft_joints *s, const path_end *end, uint32_t from, uint32_t *node,
                 uint32_t *joint, uint32_t *joints) {
    uint32_t body = from, work = JOINT_NONE;
    for (uint32_t n = 0;; n++) {
        const path_end *e = &end[body];
        node[n] = body;
        *joints = n;
        if (!s->body[body].mobile || (n > 0 && e->count == 1)) {
            return !e->closed || !s->body[body].mobile;
        }
        if (e->closed) {
            return false;
        }
        work = e->work[0] == work ? e->work[1] : e->work[0];
        joint[n] = work;
        body = s->work[work].a == body ? s->work[work].b : s->work[work].a;
    }
}

static void put(const joint_chains *c, int column, uint32_t slot, core_vec3 v) {
    for (int k = 0; k < 3; k++) {
        c->data[(size_t)(column + k) * c->slots + slot] = phys_comp(v, k);
    }
}
static core_vec3 get(const joint_chains *c, int column, uint32_t slot) {
    const float *p = c->data + (size_t)column * c->slots + slot;
    return core_v3(p[0], p[c->slots], p[2 * (size_t)c->slots]);
}

static void fill_node(const soft_joints *s, uint32_t slot, uint32_t body) {
    const joint_chains *c = &s->chains;
    const joint_body *b = &s->body[body];
    c->place[slot] = (int32_t)b->place;
    c->to[slot] = b->mobile ? (int32_t)b->place : (int32_t)s->bodies->count;
    put(c, CHAIN_P, slot, b->center0);
    put(c, CHAIN_Q, slot, core_v3(b->q0.x, b->q0.y, b->q0.z));
    c->data[(size_t)(CHAIN_Q + 3) * c->slots + slot] = b->q0.w;
    if (b->mobile) {
        const float *m = s->bodies->inertia + (size_t)b->place * 8;
        c->data[(size_t)CHAIN_IM * c->slots + slot] = b->im;
        put(c, CHAIN_I, slot, core_v3(m[0], m[1], m[2]));
        put(c, CHAIN_I + 3, slot, core_v3(m[4], m[5], m[6]));
    }
}

static void fill_joint(const soft_joints *s, uint32_t slot, uint32_t work, uint32_t body) {
    const phys_joints *j = &s->world->joints;
    const joint_work *k = &s->work[work];
    bool flip = k->b == body;
    s->chains.work[slot] = work;
    put(&s->chains, CHAIN_LA, slot, flip ? j->lb[k->joint] : j->la[k->joint]);
    put(&s->chains, CHAIN_LB, slot, flip ? j->la[k->joint] : j->lb[k->joint]);
}

static uint32_t slots_of(uint32_t joints) { // with a margin for loads of the next node
    return (joints + 1 + SOFT_LANES - 1) / SOFT_LANES * SOFT_LANES + SOFT_LANES;
}

static void make_columns(soft_joints *s, const uint32_t *node, const uint32_t *joint) {
    core_arena *arena = &s->world->scratch;
    joint_chains *c = &s->chains;
    size_t floats = (size_t)c->slots * CHAIN_COLUMNS;
    c->data = CORE_ARENA_ARRAY(arena, float, floats);
    memset(c->data, 0, floats * sizeof(float));
    c->place = CORE_ARENA_ARRAY(arena, int32_t, c->slots);
    c->to = CORE_ARENA_ARRAY(arena, int32_t, c->slots);
    c->work = CORE_ARENA_ARRAY(arena, uint32_t, c->slots);
    s->rotation = CORE_ARENA_ARRAY(arena, core_quat, s->bodies->count + 1);
    c->factor = CORE_ARENA_ARRAY(arena, joint_factor, c->slots);
    for (uint32_t i = 0; i < c->slots; i++) {
        c->place[i] = c->to[i] = (int32_t)s->bodies->count;
    }
    for (uint32_t k = 0; k < c->count; k++) {
        uint32_t first = c->chain[k].first, joints = c->chain[k].joints;
        for (uint32_t i = 0; i <= joints; i++) {
            fill_node(s, first + i, *node);
            if (i < joints) {
                fill_joint(s, first + i, *joint++, *node);
            }
            node++;
        }
    }
}

void joint_chains_build(soft_joints *s) {
    core_arena *arena = &s->world->scratch;
    joint_chains *c = &s->chains;
    c->chain = CORE_ARENA_ARRAY(arena, joint_chain, s->count + 1);
    path_end *end = CORE_ARENA_ARRAY(arena, path_end, s->body_count);
    uint32_t *node = CORE_ARENA_ARRAY(arena, uint32_t, 2 * (size_t)s->count + 1);
    uint32_t *joint = CORE_ARENA_ARRAY(arena, uint32_t, s->count + 1);
    memset(end, 0, s->body_count * sizeof *end);
    for (uint32_t i = 0; i < s->count; i++) {
        const joint_work *k = &s->work[i];
        bool fit = k->direct && k->type == PHYS_JOINT_BALL && k->soft == 0;
        note_side(s, end, k->a, i, fit);
        note_side(s, end, k->b, i, fit);
    }
    uint32_t nodes = 0, joints = 0, count;
    c->slots = SOFT_LANES; // loads of the node before the first
    for (uint32_t i = 1; i < s->body_count; i++) {
        bool free_end = s->body[i].mobile && end[i].count == 1 && !s->body[i].chained;
        if (!free_end || !walk(s, end, i, node + nodes, joint + joints, &count)) {
            continue;
        }
        c->chain[c->count++] = (joint_chain){c->slots, count};
        c->slots += slots_of(count);
        for (uint32_t k = 0; k <= count; k++) {
            s->body[node[nodes + k]].chained |= s->body[node[nodes + k]].mobile;
        }
        for (uint32_t k = 0; k < count; k++) {
            s->work[joint[joints + k]].chained = true;
            s->work[joint[joints + k]].direct = false;
        }
        nodes += count + 1;
        joints += count;
    }
    if (c->count != 0) {
        make_columns(s, node, joint);
    }
}

// Rotations for the end of the step, loads for the joints.
void joint_chains_end(soft_joints *s) {
    joint_chains *c = &s->chains;
    for (uint32_t k = 0; k < c->count; k++) {
        for (uint32_t i = 0; i <= c->chain[k].joints; i++) {
            uint32_t slot = c->chain[k].first + i;
            core_vec3 q = get(c, CHAIN_Q, slot), load = get(c, CHAIN_LOAD, slot);
            float real = c->data[(size_t)(CHAIN_Q + 3) * c->slots + slot];
            s->rotation[c->to[slot]] = (core_quat){q.x, q.y, q.z, real};
            s->jointed[c->to[slot]] = PHYS_CHAINED;
            if (i == c->chain[k].joints) {
                continue;
            }
            joint_work *w = &s->work[c->work[slot]];
            bool flip = s->body[w->b].place != (uint32_t)c->place[slot + 1];
            w->force = core_v3_scale(load, flip ? -1.0f : 1.0f);
            for (int n = 0; n < 3; n++) {
                s->world->joints.impulse[w->joint].hard[n] =
                    phys_comp(w->force, n) * s->h / s->elapsed;
            }
        }
    }
}
