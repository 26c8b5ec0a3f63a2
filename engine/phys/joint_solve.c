// Joints in a step of the soft solver: collects those of a level, colours the rows that trees do
// not take, and runs the passes.
#include "phys/joint_solve.h"

#include <string.h>

// Sweeps over what is left to iteration. Speeds carry on from substep to substep, so that few do;
// what relaxation leaves over the next substep finds. Rods get one: more substeps (PHYS_LEVEL_NET)
// serve cloth better than more sweeps. Not where substeps are long: one sweep then feeds a swinging
// cloth.
#define SWEEPS_SOLVE 2
#define SWEEPS_RELAX 1
#define ROD_SUBSTEP  0.0022f // s

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
    s->body[i].center = s->body[i].center0;
    s->body[i].q = s->body[i].q0;
    s->jointed[place] = PHYS_JOINTED;
    return i;
}

static void update_body(soft_joints *s, uint32_t i) {
    joint_body *b = &s->body[i];
    const float *m = s->bodies->moved + (size_t)b->place * 8;
    if (b->general) {
        b->center = core_v3_add(b->center0, core_v3(m[0], m[1], m[2]));
        b->q = b->placed ? phys_turned(b->q0, core_v3(m[4], m[5], m[6])) : b->q0;
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
    joint_lane_kind kind;
    uint32_t first;
    soft_pass pass;
    const joint_poses *poses; // NULL: lanes are up to date
} pass_job;
static void run_blocks(void *ctx, uint32_t begin, uint32_t end, uint32_t chunk, uint32_t worker) {
    (void)chunk;
    (void)worker;
    const pass_job *job = ctx;
    const soft_joints *s = job->s;
    uint32_t from = job->first + begin, n = end - begin;
    if (job->kind == JOINT_LANES_BLOCK) {
        CORE_SIMD_SELECT(phys_joint_blocks)(s->block + from, n, s->bodies, job->pass);
    } else if (job->kind == JOINT_LANES_POINT) {
        CORE_SIMD_SELECT(phys_joint_points)
        (s->point + from, n, s->bodies, job->poses, job->pass, s->h);
    } else {
        CORE_SIMD_SELECT(phys_joint_rods)
        (s->rod + from, n, s->bodies, job->poses, job->pass, s->h);
    }
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

static void classify(soft_joints *s) {
    if (!s->world->joints_iterate) {
        joint_tree_choose(s);
    }
    joint_chains_build(s);
    joint_tree_build(s);
    s->general = CORE_ARENA_ARRAY(&s->world->scratch, uint32_t, s->count);
    uint32_t rows = 0;
    for (uint32_t i = 0; i < s->count; i++) {
        joint_work *k = &s->work[i];
        bool hard = !k->direct && !k->chained, lone = hard && k->soft == 0;
        k->lanes = lone && k->type == PHYS_JOINT_BALL       ? JOINT_LANES_POINT
                   : lone && k->type == PHYS_JOINT_DISTANCE ? JOINT_LANES_ROD
                   : k->soft != 0 || hard                   ? JOINT_LANES_BLOCK
                                                            : JOINT_LANES_NONE;
        s->others += !k->chained;
        if (k->lanes == JOINT_LANES_BLOCK || k->direct) {
            s->general[s->general_count++] = i;
            s->body[k->a].general = s->body[k->b].general = true;
            rows += (uint32_t)k->hard + k->soft;
        }
    }
    joint_row *row = CORE_ARENA_ARRAY(&s->world->scratch, joint_row, rows + 1);
    memset(row, 0, rows * sizeof *row);
    for (uint32_t i = 0; i < s->general_count; i++) {
        joint_work *k = &s->work[s->general[i]];
        k->row = row;
        row += k->hard + k->soft;
    }
}

static void make_general(soft_joints *s) {
    each(s, s->general_count, 64, joint_lanes_refresh);
    each(s, s->tree.trees, 1, joint_tree_factor);
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
    for (uint32_t i = 0; i < s->count; i++) {
        joint_work *k = &s->work[i];
        k->upper = (w->joints.flags[k->joint] & PHYS_JOINT_LIMITED) && joint_rows_upper(s, k);
    }
    classify(s);
    joint_lanes_build(s);
    make_general(s);
    for (uint32_t i = 0; i < s->general_count; i++) {
        load_impulses(s, &s->work[s->general[i]]);
    }
    joint_lanes_exchange(s, true);
    s->stale = true;
    run_chains(s, CHAIN_BEGIN);
    return s;
}

// Adds what a joint gave b in this substep: the load is the mean over a step.
static void sum_load(soft_joints *s, uint32_t i) {
    joint_work *k = &s->work[s->general[i]];
    core_vec3 force = {0}, torque = {0};
    for (uint32_t r = 0; r < (uint32_t)k->hard + k->soft; r++) {
        const float *row = k->row[r].j, j = k->row[r].impulse;
        force = core_v3_mad(force, core_v3(row[6], row[7], row[8]), j);
        torque = core_v3_mad(torque, core_v3(row[9], row[10], row[11]), j);
    }
    k->force = core_v3_add(k->force, force);
    k->torque = core_v3_add(k->torque, core_v3_sub(torque, core_v3_cross(k->arm_b, force)));
}

static void run_poses(void *ctx, uint32_t begin, uint32_t end, uint32_t chunk, uint32_t worker) {
    (void)chunk;
    (void)worker;
    soft_joints *s = ctx;
    CORE_SIMD_SELECT(phys_joint_poses)
    (&s->poses, begin * SOFT_LANES, end * SOFT_LANES, s->bodies);
}

static void run_colors(soft_joints *s, soft_pass pass, int sweep) {
    pass_job job = {.s = s, .pass = pass};
    if (s->stale) {
        core_jobs_for(s->world->jobs, s->poses.count / SOFT_LANES, 16, run_poses, s);
        job.poses = &s->poses;
        s->stale = false;
    }
    for (uint32_t c = 0; c <= JOINT_COLORS; c++) {
        for (job.kind = 0; job.kind < JOINT_LANE_KINDS; job.kind++) {
            uint32_t count = s->first[job.kind][c + 1] - s->first[job.kind][c];
            if (count == 0 || (job.kind == JOINT_LANES_ROD && sweep > 0 && s->h < ROD_SUBSTEP)) {
                continue;
            }
            job.first = s->first[job.kind][c];
            core_jobs_for(s->world->jobs, count, c < JOINT_COLORS ? 8 : UINT32_MAX, run_blocks,
                          &job);
        }
    }
}

static void pass_others(soft_joints *s, soft_pass pass) {
    if (!s->alone) {
        each(s, s->body_count, 512, note_start);
    }
    if (pass == SOFT_SOLVE) {
        run_colors(s, SOFT_WARM, 0);
    }
    int sweeps = pass == SOFT_SOLVE ? SWEEPS_SOLVE : SWEEPS_RELAX;
    for (int i = 0; i < sweeps; i++) {
        run_colors(s, pass, i);
    }
    core_jobs_for(s->world->jobs, s->tree.trees, 1, run_trees, &(pass_job){.s = s, .pass = pass});
    if (!s->alone) {
        each(s, s->body_count, 512, note_end);
    }
    if (pass == SOFT_RELAX) {
        joint_lanes_exchange(s, false);
        each(s, s->general_count, 256, sum_load);
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
    if (s->alone && pass == SOFT_RELAX) { // no contact gave anything
        memcpy(s->bodies->mark, s->bodies->velocity, (size_t)s->bodies->count * 8 * sizeof(float));
    }
}

static void turn_pivots(soft_joints *s) {
    phys_joints *j = &s->world->joints;
    for (uint32_t i = 0; i < s->general_count; i++) {
        const joint_work *k = &s->work[s->general[i]];
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
    s->stale = true;
    if (s->general_count != 0) {
        turn_pivots(s);
        each(s, s->body_count, 512, update_body);
        make_general(s);
    }
}

void phys_soft_joints_end(soft_joints *s) {
    phys_joints *j = &s->world->joints;
    joint_chains_end(s);
    joint_lanes_end(s);
    for (uint32_t i = 0; i < s->count; i++) {
        const joint_work *k = &s->work[i];
        phys_joint_impulse *stored = &j->impulse[k->joint];
        for (uint32_t r = 0; k->row != NULL && r < (uint32_t)k->hard + k->soft; r++) {
            bool soft = r >= k->hard;
            *(soft ? &stored->soft[r - k->hard] : &stored->hard[r]) =
                r == k->hard && k->upper ? -k->row[r].impulse : k->row[r].impulse;
        }
        float time = k->chained ? s->elapsed : s->time;
        j->force[k->joint] = core_v3_scale(k->force, 1.0f / time);
        j->torque[k->joint] = core_v3_scale(k->torque, 1.0f / time);
    }
}
