// Joints in a step of the soft solver: collects those of a level, colours the rows that trees do
// not take, and runs the passes.
#include "phys/joint_solve.h"

#include <string.h>

#define SWEEPS 4   // over what is left to iteration
#define COLORS 64u // the last is for bodies with more joints than colours, one joint a block

// joint_body of a row of bodies, made at first sight.
static uint32_t body_of(soft_joints *s, uint32_t *known, const uint32_t *index, uint32_t row) {
    const phys_bodies *b = &s->world->bodies;
    if (row == CORE_NO_ROW) {
        return 0;
    }
    if (known[row] != 0) {
        return known[row];
    }
    uint32_t i = known[row] = s->body_count++, place = index[row];
    bool mobile = phys_mobile(b, row);
    s->body[i] = (joint_body){.row = row,
                              .place = place,
                              .mobile = mobile,
                              .placed = place < s->bodies->count,
                              .im = mobile ? b->im[row] : 0.0f,
                              .center0 = phys_get3(b->cx, b->cy, b->cz, row),
                              .q0 = phys_body_quat(b, row)};
    s->jointed[place] = PHYS_JOINTED;
    return i;
}

static void put3(float *out, core_vec3 v) {
    out[0] = v.x;
    out[1] = v.y;
    out[2] = v.z;
}

static void update_body(soft_joints *s, uint32_t i) {
    joint_body *b = &s->body[i];
    if (b->chained) {
        return;
    }
    const float *m = s->bodies->moved + (size_t)b->place * 8;
    b->center = core_v3_add(b->center0, core_v3(m[0], m[1], m[2]));
    b->q = b->placed ? phys_turned(b->q0, core_v3(m[4], m[5], m[6])) : b->q0;
    if (b->placed) {
        float *p = s->poses.pose + (size_t)b->place * 8;
        put3(p, b->center);
        put3(p + 4, core_v3(b->q.x, b->q.y, b->q.z));
        s->poses.real[(size_t)b->place * 8] = b->q.w;
    }
}

static bool on_level(const phys_bodies *b, uint32_t a, uint32_t o, uint32_t level) {
    bool ma = a != CORE_NO_ROW && phys_mobile(b, a), mo = o != CORE_NO_ROW && phys_mobile(b, o);
    return (ma || mo) && b->level[ma ? a : o] == level;
}

static void load_impulses(const soft_joints *s, joint_work *k) {
    const phys_joint_impulse *stored = &s->world->joints.impulse[k->joint];
    for (uint32_t i = 0; i < k->hard; i++) {
        k->row[i].impulse = stored->hard[i];
    }
    for (uint32_t i = 0; i < k->soft; i++) {
        joint_row *r = &k->row[k->hard + i];
        float j = i == 0 && k->upper ? -stored->soft[i] : stored->soft[i];
        r->impulse = CORE_CLAMP(j, r->lo, r->hi);
    }
}

static void collect(soft_joints *s, const uint32_t *index, uint32_t level) {
    phys_world *w = s->world;
    const phys_joints *j = &w->joints;
    core_arena *arena = &w->scratch;
    uint32_t n = core_columns_count(&w->bodies.set), joints = core_columns_count(&j->set);
    s->body = CORE_ARENA_ARRAY(arena, joint_body, CORE_MIN(n, 2 * joints) + 1);
    s->jointed = CORE_ARENA_ARRAY(arena, uint8_t, s->bodies->count + 1);
    s->work = CORE_ARENA_ARRAY(arena, joint_work, joints);
    memset(s->jointed, 0, s->bodies->count + 1);
    size_t floats = ((size_t)s->bodies->count + 1) * 8;
    s->poses.pose = CORE_ARENA_ARRAY(arena, float, floats);
    s->poses.real = CORE_ARENA_ARRAY(arena, float, floats);
    memset(s->poses.pose, 0, floats * sizeof(float));
    memset(s->poses.real, 0, floats * sizeof(float));
    uint32_t *known = CORE_ARENA_ARRAY(arena, uint32_t, n + 1);
    memset(known, 0, (n + 1) * sizeof *known);
    s->body[0] = (joint_body){.row = CORE_NO_ROW,
                              .place = s->bodies->count,
                              .q = core_quat_identity(),
                              .q0 = core_quat_identity()};
    s->body_count = 1;
    for (uint32_t i = 0; i < joints; i++) {
        uint32_t a = phys_joint_body(&w->bodies.set, j->a[i]);
        uint32_t b = phys_joint_body(&w->bodies.set, j->b[i]);
        if (on_level(&w->bodies, a, b, level)) {
            joint_work *k = &s->work[s->count++];
            memset(k, 0, sizeof *k);
            k->joint = i;
            k->type = j->type[i];
            k->a = body_of(s, known, index, a);
            k->b = body_of(s, known, index, b);
            joint_rows_count(j, i, &k->hard, &k->soft);
        }
    }
}

// First free colour of both bodies; blocks of rows and of points have colours of their own.
static void color(soft_joints *s, bool points, uint32_t *lanes) {
    core_arena *arena = &s->world->scratch;
    size_t mark = core_arena_mark(arena);
    uint64_t *used = CORE_ARENA_ARRAY(arena, uint64_t, s->body_count);
    memset(used, 0, s->body_count * sizeof *used);
    for (uint32_t i = 0; i < s->count; i++) {
        joint_work *k = &s->work[i];
        if (!(points ? k->pointed : k->blocked)) {
            continue;
        }
        bool ma = s->body[k->a].mobile, mb = s->body[k->b].mobile;
        uint64_t taken = (ma ? used[k->a] : 0) | (mb ? used[k->b] : 0);
        uint32_t c = taken == UINT64_MAX ? COLORS : (uint32_t)__builtin_ctzll(~taken);
        if (c < COLORS) {
            used[k->a] |= (uint64_t)1 << c;
            used[k->b] |= (uint64_t)1 << c;
        }
        k->block = c; // the colour, until blocks are known
        k->lane = lanes[c]++;
    }
    core_arena_rewind(arena, mark);
}

// Numbers the blocks and gives each joint its own. Returns the first block of each colour.
static uint32_t *place_lanes(soft_joints *s, bool points) {
    uint32_t lanes[COLORS + 1] = {0}, blocks = 0;
    color(s, points, lanes);
    uint32_t *first = CORE_ARENA_ARRAY(&s->world->scratch, uint32_t, COLORS + 2);
    for (uint32_t c = 0; c <= COLORS; c++) {
        first[c] = blocks;
        blocks += c < COLORS ? (lanes[c] + SOFT_LANES - 1) / SOFT_LANES : lanes[c];
    }
    first[COLORS + 1] = blocks;
    for (uint32_t i = 0; i < s->count; i++) {
        joint_work *k = &s->work[i];
        if (points ? k->pointed : k->blocked) {
            uint32_t c = k->block, lane = k->lane;
            k->block = first[c] + (c < COLORS ? lane / SOFT_LANES : lane);
            k->lane = c < COLORS ? lane % SOFT_LANES : 0;
        }
    }
    return first;
}

// The heads of both kinds of blocks are alike: a, b, to_a, to_b.
static void clear_blocks(const soft_joints *s, void *blocks, uint32_t count, size_t size) {
    memset(blocks, 0, count * size);
    for (uint32_t i = 0; i < count; i++) {
        int32_t *index = (int32_t *)((uint8_t *)blocks + i * size);
        for (int k = 0; k < 4 * SOFT_LANES; k++) {
            index[k] = (int32_t)s->bodies->count;
        }
    }
}

static void place_bodies(const soft_joints *s, const joint_work *k, int32_t *index, float *ima,
                         float *imb) {
    const joint_body *p = &s->body[k->a], *q = &s->body[k->b];
    int32_t none = (int32_t)s->bodies->count;
    index[k->lane] = (int32_t)p->place;
    index[SOFT_LANES + k->lane] = (int32_t)q->place;
    index[2 * SOFT_LANES + k->lane] = p->mobile ? (int32_t)p->place : none;
    index[3 * SOFT_LANES + k->lane] = q->mobile ? (int32_t)q->place : none;
    ima[k->lane] = p->im;
    imb[k->lane] = q->im;
}

// An arm, or the place in the world when the body has no pose in lanes.
static core_vec3 lane_anchor(const soft_joints *s, uint32_t body, core_vec3 local) {
    const joint_body *b = &s->body[body];
    return b->placed ? local : core_v3_add(b->center0, phys_rotate(b->q0, local));
}

static void make_points(soft_joints *s) {
    const phys_joints *j = &s->world->joints;
    s->first_point = place_lanes(s, true);
    uint32_t blocks = s->first_point[COLORS + 1];
    s->point = CORE_ARENA_ARRAY(&s->world->scratch, joint_points, blocks + 1);
    clear_blocks(s, s->point, blocks, sizeof *s->point);
    for (uint32_t i = 0; i < s->count; i++) {
        const joint_work *k = &s->work[i];
        if (k->pointed) {
            joint_points *p = &s->point[k->block];
            place_bodies(s, k, p->a, p->ima, p->imb);
            core_vec3 la = lane_anchor(s, k->a, j->la[k->joint]);
            core_vec3 lb = lane_anchor(s, k->b, j->lb[k->joint]);
            for (int n = 0; n < 3; n++) {
                p->la[n][k->lane] = phys_comp(la, n);
                p->lb[n][k->lane] = phys_comp(lb, n);
                p->impulse[n][k->lane] = j->impulse[k->joint].hard[n];
            }
        }
    }
}

static void make_blocks(soft_joints *s) {
    s->first = place_lanes(s, false);
    uint32_t blocks = s->first[COLORS + 1];
    s->block = CORE_ARENA_ARRAY(&s->world->scratch, joint_block, blocks + 1);
    clear_blocks(s, s->block, blocks, sizeof *s->block);
    for (uint32_t i = 0; i < s->count; i++) {
        const joint_work *k = &s->work[i];
        if (k->blocked) {
            joint_block *b = &s->block[k->block];
            place_bodies(s, k, b->a, b->ima, b->imb);
            b->hard_count = CORE_MAX(b->hard_count, k->direct ? 0u : k->hard);
            b->soft_count = CORE_MAX(b->soft_count, (uint32_t)k->soft);
        }
    }
}

static core_vec3 turn_by(const soft_joints *s, uint32_t body, const float *t) {
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
    core_vec3 ia = turn_by(s, k->a, r->j + 3), ib = turn_by(s, k->b, r->j + 9);
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

static void refresh(soft_joints *s, uint32_t i) {
    joint_work *k = &s->work[i];
    if (k->pointed || k->chained) {
        return;
    }
    joint_rows_make(s, k);
    if (!k->blocked) {
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

typedef struct run_job {
    soft_joints *s;
    void (*fn)(soft_joints *s, uint32_t i);
} run_job;
static void run_each(void *ctx, uint32_t begin, uint32_t end, uint32_t chunk, uint32_t worker) {
    (void)chunk;
    (void)worker;
    const run_job *job = ctx;
    for (uint32_t i = begin; i < end; i++) {
        job->fn(job->s, i);
    }
}
static void each(soft_joints *s, uint32_t count, uint32_t grain,
                 void (*fn)(soft_joints *, uint32_t)) {
    core_jobs_for(s->world->jobs, count, grain, run_each, &(run_job){s, fn});
}

typedef struct pass_job {
    soft_joints *s;
    uint32_t first;
    soft_pass pass;
    bool prepare;
} pass_job;
static void run_blocks(void *ctx, uint32_t begin, uint32_t end, uint32_t chunk, uint32_t worker) {
    (void)chunk;
    (void)worker;
    const pass_job *job = ctx;
    CORE_SIMD_SELECT(phys_joint_blocks)
    (job->s->block + job->first + begin, end - begin, job->s->bodies, job->pass);
}
static void run_points(void *ctx, uint32_t begin, uint32_t end, uint32_t chunk, uint32_t worker) {
    (void)chunk;
    (void)worker;
    const pass_job *job = ctx;
    const soft_joints *s = job->s;
    CORE_SIMD_SELECT(phys_joint_points)
    (s->point + job->first + begin, end - begin, s->bodies, job->prepare ? &s->poses : NULL,
     job->pass, 1.0f / s->h);
}
static void prepare_points(soft_joints *s) {
    core_jobs_for(s->world->jobs, s->first_point[COLORS + 1], 8, run_points,
                  &(pass_job){.s = s, .prepare = true});
}
static void run_trees(void *ctx, uint32_t begin, uint32_t end, uint32_t chunk, uint32_t worker) {
    (void)chunk;
    (void)worker;
    const pass_job *job = ctx;
    for (uint32_t i = begin; i < end; i++) {
        joint_tree_solve(job->s, i, job->pass == SOFT_SOLVE);
    }
}

typedef struct chain_job {
    soft_joints *s;
    chain_pass pass;
} chain_job;
static void run_chain(void *ctx, uint32_t begin, uint32_t end, uint32_t chunk, uint32_t worker) {
    (void)chunk;
    (void)worker;
    const chain_job *job = ctx;
    soft_joints *s = job->s;
    for (uint32_t i = begin; i < end; i++) {
        CORE_SIMD_SELECT(phys_joint_chain)(&s->chains, i, s->bodies, job->pass, s->h);
    }
}
static void run_chains(soft_joints *s, chain_pass pass) {
    core_jobs_for(s->world->jobs, s->chains.count, 1, run_chain, &(chain_job){s, pass});
}

// What joints give is no part of the solver's common warm start, which would give it in the old
// direction again: a swinging body would gain energy.
static void note_start(soft_joints *s, uint32_t i) {
    size_t at = (size_t)s->body[i].place * 8;
    memcpy(s->body[i].before, s->bodies->velocity + at, sizeof s->body[i].before);
}
static void note_end(soft_joints *s, uint32_t i) {
    size_t at = (size_t)s->body[i].place * 8;
    for (size_t k = 0; s->body[i].mobile && k < 8; k++) {
        s->bodies->mark[at + k] += s->bodies->velocity[at + k] - s->body[i].before[k];
    }
}

// What lies in lanes, to or from the rows.
static void move_impulses(soft_joints *s, bool to_lanes) {
    for (uint32_t i = 0; i < s->count; i++) {
        joint_work *k = &s->work[i];
        for (uint32_t r = k->direct ? k->hard : 0; k->blocked && r < (uint32_t)k->hard + k->soft;
             r++) {
            joint_block *b = &s->block[k->block];
            joint_lanes *lanes = r < k->hard ? &b->hard[r] : &b->soft[r - k->hard];
            float *lane = &lanes->impulse[k->lane];
            *(to_lanes ? lane : &k->row[r].impulse) = to_lanes ? k->row[r].impulse : *lane;
        }
    }
}

soft_joints *phys_soft_joints_begin(phys_world *w, soft_bodies *bodies, const uint32_t *index,
                                    uint32_t level, float h, bool alone) {
    if (core_columns_count(&w->joints.set) == 0) {
        return NULL;
    }
    soft_joints *s = CORE_ARENA_ARRAY(&w->scratch, soft_joints, 1);
    *s = (soft_joints){.world = w, .bodies = bodies, .h = h, .alone = alone};
    collect(s, index, level);
    if (s->count == 0) {
        return NULL;
    }
    each(s, s->body_count, 512, update_body);
    for (uint32_t i = 0; i < s->count; i++) {
        joint_work *k = &s->work[i];
        k->upper = (w->joints.flags[k->joint] & PHYS_JOINT_LIMITED) && joint_rows_upper(s, k);
    }
    joint_tree_choose(s);
    joint_chains_build(s);
    joint_tree_build(s);
    for (uint32_t i = 0; i < s->count; i++) {
        joint_work *k = &s->work[i];
        bool hard = !k->direct && !k->chained;
        k->pointed = k->type == PHYS_JOINT_BALL && k->soft == 0 && hard;
        k->blocked = !k->pointed && (k->soft != 0 || hard);
        s->others += !k->chained;
    }
    make_points(s);
    make_blocks(s);
    each(s, s->count, 64, refresh);
    prepare_points(s);
    each(s, s->tree.trees, 1, joint_tree_factor);
    for (uint32_t i = 0; i < s->count; i++) {
        load_impulses(s, &s->work[i]);
    }
    move_impulses(s, true);
    run_chains(s, CHAIN_BEGIN);
    return s;
}

// Adds what a joint gave b in this substep: the load is the mean over a step.
static void sum_load(soft_joints *s, uint32_t i) {
    joint_work *k = &s->work[i];
    core_vec3 force = {0}, torque = {0};
    if (k->chained) {
        return;
    }
    if (k->pointed) { // no torque about the anchor
        const joint_points *p = &s->point[k->block];
        force = core_v3(p->impulse[0][k->lane], p->impulse[1][k->lane], p->impulse[2][k->lane]);
        k->row[0].impulse = force.x;
        k->row[1].impulse = force.y;
        k->row[2].impulse = force.z;
        k->force = core_v3_add(k->force, force);
        return;
    }
    for (uint32_t r = 0; r < (uint32_t)k->hard + k->soft; r++) {
        const float *row = k->row[r].j, j = k->row[r].impulse;
        force = core_v3_mad(force, core_v3(row[6], row[7], row[8]), j);
        torque = core_v3_mad(torque, core_v3(row[9], row[10], row[11]), j);
    }
    k->force = core_v3_add(k->force, force);
    k->torque = core_v3_add(k->torque, core_v3_sub(torque, core_v3_cross(k->arm_b, force)));
}

static void run_colors(soft_joints *s, soft_pass pass) {
    pass_job job = {.s = s, .pass = pass};
    for (uint32_t c = 0; c <= COLORS; c++) {
        uint32_t count = s->first[c + 1] - s->first[c];
        job.first = s->first[c];
        core_jobs_for(s->world->jobs, count, c < COLORS ? 4 : UINT32_MAX, run_blocks, &job);
        count = s->first_point[c + 1] - s->first_point[c];
        job.first = s->first_point[c];
        core_jobs_for(s->world->jobs, count, c < COLORS ? 8 : UINT32_MAX, run_points, &job);
    }
}

static void pass_others(soft_joints *s, soft_pass pass) {
    each(s, s->body_count, 512, note_start);
    if (pass == SOFT_SOLVE) {
        run_colors(s, SOFT_WARM);
    }
    for (int i = 0; i < SWEEPS; i++) {
        run_colors(s, pass);
    }
    core_jobs_for(s->world->jobs, s->tree.trees, 1, run_trees, &(pass_job){.s = s, .pass = pass});
    each(s, s->body_count, 512, note_end);
    if (pass == SOFT_RELAX) {
        move_impulses(s, false);
        each(s, s->count, 256, sum_load);
        s->time += s->h;
    }
}

// Chains are exact: where nothing comes between, the next substep's solution does for the
// relaxation too.
void phys_soft_joints_pass(soft_joints *s, soft_pass pass, bool last) {
    if (s->others != 0) {
        pass_others(s, pass);
    }
    if (pass == SOFT_SOLVE || last || !s->alone) {
        run_chains(s, pass == SOFT_SOLVE ? CHAIN_SOLVE : CHAIN_RELAX);
    }
}

static void turn_pivots(soft_joints *s) {
    phys_joints *j = &s->world->joints;
    for (uint32_t i = 0; i < s->count; i++) {
        const joint_work *k = &s->work[i];
        if (k->type == PHYS_JOINT_PIVOT) {
            const float *v = s->bodies->velocity, *row = k->row[0].j;
            const float *a = v + (size_t)s->body[k->a].place * 8 + 4;
            const float *b = v + (size_t)s->body[k->b].place * 8 + 4;
            j->phase[k->joint] += s->h * (row[3] * a[0] + row[4] * a[1] + row[5] * a[2] +
                                          row[9] * b[0] + row[10] * b[1] + row[11] * b[2]);
        }
    }
}

// After the bodies moved: rows of the new pose, for the relaxation and the next substep.
void phys_soft_joints_move(soft_joints *s, bool last) {
    run_chains(s, last ? CHAIN_LAST : CHAIN_MOVE);
    s->elapsed += s->h;
    if (s->others == 0) {
        return;
    }
    turn_pivots(s);
    each(s, s->body_count, 512, update_body);
    each(s, s->count, 64, refresh);
    prepare_points(s);
    each(s, s->tree.trees, 1, joint_tree_factor);
}

void phys_soft_joints_end(soft_joints *s) {
    phys_joints *j = &s->world->joints;
    joint_chains_end(s);
    for (uint32_t i = 0; i < s->count; i++) {
        const joint_work *k = &s->work[i];
        phys_joint_impulse *stored = &j->impulse[k->joint];
        for (uint32_t r = 0; r < (uint32_t)k->hard + k->soft; r++) {
            bool soft = r >= k->hard;
            *(soft ? &stored->soft[r - k->hard] : &stored->hard[r]) =
                r == k->hard && k->upper ? -k->row[r].impulse : k->row[r].impulse;
        }
        float time = k->chained ? s->elapsed : s->time;
        j->force[k->joint] = core_v3_scale(k->force, 1.0f / time);
        j->torque[k->joint] = core_v3_scale(k->torque, 1.0f / time);
    }
}
