// Judges the palettes: the same state evaluated in double precision by code of its own (plain
// key search from the front, slerp by angle, 4x4 products), compared at joint origins and at points
// 0.1 m from them along each axis.
#include "anim/anim_internal.h"

#include <math.h>

#define SHELL_M 0.1

typedef struct bone_pose {
    double t[3], q[4], s[3];
} bone_pose;

static void key_pose(const core_key *k, bone_pose *out) {
    const float *t = &k->translation.x, *q = &k->rotation.x, *s = &k->scale.x;
    for (int i = 0; i < 4; i++) {
        out->q[i] = q[i];
        if (i < 3) {
            out->t[i] = t[i];
            out->s[i] = s[i];
        }
    }
}

static void normalize4(double q[4]) {
    double n = core_sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (int i = 0; i < 4; i++) {
        q[i] /= n;
    }
}

static void mix_linear(const bone_pose *a, const bone_pose *b, double u, bone_pose *out) {
    for (int i = 0; i < 3; i++) {
        out->t[i] = a->t[i] + (b->t[i] - a->t[i]) * u;
        out->s[i] = a->s[i] + (b->s[i] - a->s[i]) * u;
    }
}

static double dot4(const double a[4], const double b[4]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

static void mix_slerp(const bone_pose *a, const bone_pose *b, double u, bone_pose *out) {
    double p[4], q[4];
    for (int i = 0; i < 4; i++) {
        p[i] = a->q[i];
        q[i] = b->q[i];
    }
    normalize4(p);
    normalize4(q);
    double d = dot4(p, q), sign = d < 0 ? -1 : 1;
    double angle = core_acos(CORE_MIN(d * sign, 1.0));
    double s = core_sin(angle);
    bool small = s < 1e-9;
    double wa = small ? 1 - u : core_sin((1 - u) * angle) / s;
    double wb = small ? u : core_sin(u * angle) / s;
    for (int i = 0; i < 4; i++) {
        out->q[i] = p[i] * wa + q[i] * wb * sign;
    }
    normalize4(out->q);
}

static void mix_nlerp(const bone_pose *a, const bone_pose *b, double u, bone_pose *out) {
    double sign = dot4(a->q, b->q) < 0 ? -1 : 1;
    double q[4];
    for (int i = 0; i < 4; i++) {
        q[i] = a->q[i] * (1 - u) + b->q[i] * u * sign;
    }
    mix_linear(a, b, u, out);
    normalize4(q);
    for (int i = 0; i < 4; i++) {
        out->q[i] = q[i];
    }
}

static void mix_cubic(const core_clip_track *t, uint32_t k, double time, bone_pose *out) {
    double d = (double)t->key[k + 1].time - t->key[k].time;
    double u = (time - t->key[k].time) / d, v = 1 - u;
    bone_pose p[4];
    key_pose(&t->key[k], &p[0]);
    key_pose(&t->tangent[2 * k + 1], &p[1]);
    key_pose(&t->key[k + 1], &p[2]);
    key_pose(&t->tangent[2 * k + 2], &p[3]);
    const double h[4] = {v * v * (1 + 2 * u), d * u * v * v, u * u * (3 - 2 * u), -d * u * u * v};
    *out = (bone_pose){0};
    for (int i = 0; i < 4; i++) {
        for (int n = 0; n < 4; n++) {
            out->q[n] += h[i] * p[i].q[n];
            if (n < 3) {
                out->t[n] += h[i] * p[i].t[n];
                out->s[n] += h[i] * p[i].s[n];
            }
        }
    }
    normalize4(out->q);
}

static void sample_track(const core_clip_track *t, double time, bone_pose *out) {
    uint32_t k = 0;
    while (k + 1 < t->key_count && (double)t->key[k + 1].time <= time) {
        k++;
    }
    bone_pose a, b;
    key_pose(&t->key[k], &a);
    if (k + 1 == t->key_count || time <= (double)t->key[k].time) {
        *out = a;
        normalize4(out->q);
        return;
    }
    if (t->mode == CORE_KEY_STEP) {
        *out = a;
        normalize4(out->q);
        return;
    }
    key_pose(&t->key[k + 1], &b);
    if (t->mode == CORE_KEY_CUBIC) {
        mix_cubic(t, k, time, out);
        return;
    }
    double t0 = t->key[k].time, t1 = t->key[k + 1].time;
    double u = (time - t0) / (t1 - t0);
    mix_linear(&a, &b, u, out);
    mix_slerp(&a, &b, u, out);
}

// A track of a compressed clip: its own rows, rotations by nlerp between them, as the clip defines.
static void sample_packed_track(const anim_pack_group *g, uint32_t t, double duration, double time,
                                bone_pose *out) {
    double u = time * g->intervals / duration, d[2][4];
    uint32_t row = u < g->intervals ? (uint32_t)u : g->intervals - 1;
    u -= row;
    for (uint32_t r = 0; r < 2; r++) {
        double rest = 1;
        for (uint32_t k = 0; k < 3; k++) {
            size_t i = ((size_t)(row + r) * 3 + k) * g->stride + t;
            uint32_t n = g->bytes == 1 ? g->rows[i] : ((const uint16_t *)(const void *)g->rows)[i];
            d[r][k] = (double)g->low[k * g->stride + t] + (double)g->step[k * g->stride + t] * n;
            rest -= d[r][k] * d[r][k];
        }
        d[r][3] = core_sqrt(rest > 0 ? rest : 0);
    }
    if (g->kind != ANIM_PACK_R) {
        double *to = g->kind == ANIM_PACK_T ? out->t : out->s;
        for (int k = 0; k < 3; k++) {
            to[k] = d[0][k] + (d[1][k] - d[0][k]) * u;
        }
        return;
    }
    bone_pose a = {.q = {d[0][0], d[0][1], d[0][2], d[0][3]}};
    bone_pose b = {.q = {d[1][0], d[1][1], d[1][2], d[1][3]}}, mixed;
    mix_nlerp(&a, &b, u, &mixed);
    const float *base = g->base + t;
    double p[4] = {base[0], base[g->stride], base[2 * g->stride], base[3 * g->stride]};
    const double *q = mixed.q;
    out->q[0] = p[3] * q[0] + p[0] * q[3] + p[1] * q[2] - p[2] * q[1];
    out->q[1] = p[3] * q[1] + p[1] * q[3] + p[2] * q[0] - p[0] * q[2];
    out->q[2] = p[3] * q[2] + p[2] * q[3] + p[0] * q[1] - p[1] * q[0];
    out->q[3] = p[3] * q[3] - p[0] * q[0] - p[1] * q[1] - p[2] * q[2];
    normalize4(out->q);
}

static void sample_packed(const anim_clip_res *c, double time, bone_pose *out) {
    for (uint32_t i = 0; i < c->pack->group_count; i++) {
        const anim_pack_group *g = &c->pack->group[i];
        for (uint32_t t = 0; t < g->tracks; t++) {
            sample_packed_track(g, t, c->duration, time, &out[g->bone[t]]);
        }
    }
}

static void pin_root(const anim_clip_res *c, bone_pose *root) {
    core_vec3 start = anim_root_translation(c, 0);
    double d[3] = {root->t[0] - start.x, root->t[1] - start.y, root->t[2] - start.z};
    bool moves = c->pack ? (c->moved[c->root_bone] & 1u << ANIM_PACK_T) != 0
                         : c->track_of_bone[c->root_bone] >= 0;
    for (int r = 0; moves && r < 3; r++) {
        const float *m = c->root_remove + 3 * r;
        root->t[r] -= m[0] * d[0] + m[1] * d[1] + m[2] * d[2];
    }
}

static void bind_pose(const anim_skeleton_res *s, const float *columns, bone_pose *out) {
    for (uint32_t b = 0; b < s->bones; b++) {
        double *const part[] = {out[b].t, out[b].q, out[b].s};
        const uint32_t first[] = {ANIM_TX, ANIM_RX, ANIM_SX}, size[] = {3, 4, 3};
        for (int k = 0; k < 3; k++) {
            for (uint32_t i = 0; i < size[k]; i++) {
                part[k][i] = columns[(first[k] + i) * s->stride + b];
            }
        }
    }
}

static void sample_clip(const anim_skeleton_res *s, const anim_clip_res *c, double time,
                        bone_pose *out) {
    bind_pose(s, c && c->pack ? c->rest : s->bind, out);
    if (!c) {
        return;
    }
    if (c->pack) {
        sample_packed(c, time, out);
    }
    for (uint32_t i = 0; i < c->track_count; i++) {
        sample_track(&c->track[i], time, &out[c->track[i].bone]);
    }
    if (c->root_motion) {
        pin_root(c, &out[c->root_bone]);
    }
}

static void sample_slot(const anim_world *w, const anim_skeleton_res *s, uint32_t p,
                        const anim_slot *slot, bone_pose *out, core_arena *arena) {
    anim_motion m = anim_slot_motion(w, p, slot);
    double time = m.clip[0] ? (double)anim_motion_time(&m, slot->time) : 0;
    sample_clip(s, m.clip[0], time * (double)m.scale[0], out);
    if (m.clip[1]) {
        bone_pose *second = CORE_ARENA_ARRAY(arena, bone_pose, s->bones);
        sample_clip(s, m.clip[1], time * (double)m.scale[1], second);
        for (uint32_t b = 0; b < s->bones; b++) {
            mix_nlerp(&out[b], &second[b], (double)m.weight, &out[b]);
        }
    }
}

static double fade_weight(const anim_world *w, uint32_t p) {
    double s = (double)w->players.fade_time[p] / w->players.fade_length[p];
    s = CORE_CLAMP(s, 0.0, 1.0);
    return w->players.flags[p] & ANIM_SMOOTH ? s * s * (3 - 2 * s) : s;
}

static void evaluate(anim_world *w, const anim_skeleton_res *s, uint32_t row, bone_pose *out,
                     bone_pose *from, float *columns, core_arena *arena) {
    uint32_t p = core_columns_row(&w->players.set, w->instances.player[row]);
    sample_slot(w, s, p, &w->players.now[p], out, arena);
    if (!(w->players.flags[p] & ANIM_FADING)) {
        return;
    }
    if (core_handle_is_null(w->players.snapshot[p])) {
        sample_slot(w, s, p, &w->players.from[p], from, arena);
    } else {
        anim_snapshot_read(w, w->players.snapshot[p], s, columns);
        bind_pose(s, columns, from);
    }
    double weight = fade_weight(w, p);
    for (uint32_t b = 0; b < s->bones; b++) {
        mix_nlerp(&from[b], &out[b], weight, &out[b]);
    }
}

static void local_matrix(const bone_pose *p, double m[12]) {
    double x = p->q[0], y = p->q[1], z = p->q[2], w = p->q[3];
    const double r[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                         2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                         2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            m[4 * i + j] = r[3 * i + j] * p->s[j];
        }
        m[4 * i + 3] = p->t[i];
    }
}

static void multiply(const double a[12], const double b[12], double out[12]) {
    double r[12];
    for (int i = 0; i < 12; i++) {
        int row = i / 4 * 4, column = i % 4;
        r[i] = a[row] * b[column] + a[row + 1] * b[4 + column] + a[row + 2] * b[8 + column] +
               (column == 3 ? a[row + 3] : 0);
    }
    for (int i = 0; i < 12; i++) {
        out[i] = r[i];
    }
}

// Distance between what two model matrices do to the joint and its shell points.
static double matrix_distance(const double a[12], const double b[12]) {
    double worst = 0;
    for (int point = 0; point < 4; point++) {
        double sum = 0;
        for (int r = 0; r < 3; r++) {
            double d = a[4 * r + 3] - b[4 * r + 3];
            d += point ? SHELL_M * (a[4 * r + point - 1] - b[4 * r + point - 1]) : 0;
            sum += d * d;
        }
        double distance = core_sqrt(sum);
        worst = distance > worst || distance != distance ? distance : worst;
    }
    return worst;
}

static double instance_error(anim_world *w, uint32_t row, core_arena *arena) {
    const anim_skeleton_res *s = anim_get_skeleton(w, w->instances.skeleton[row]);
    bone_pose *pose = CORE_ARENA_ARRAY(arena, bone_pose, s->bones);
    bone_pose *from = CORE_ARENA_ARRAY(arena, bone_pose, s->bones);
    double *model = CORE_ARENA_ARRAY(arena, double, 12u * s->bones);
    evaluate(w, s, row, pose, from, anim_scratch_pose(arena, s), arena);
    double worst = 0;
    for (uint32_t b = 0; b < s->bones; b++) {
        double local[12];
        local_matrix(&pose[b], local);
        double *m = model + 12 * b;
        for (int i = 0; i < 12; i++) {
            m[i] = local[i];
        }
        if (s->parent[b] >= 0) {
            multiply(model + 12 * (uint32_t)s->parent[b], local, m);
        }
        core_mat4 shown;
        double rows[12];
        if (!anim_palette_bone(w, row, b, &shown)) {
            continue; // a singular inverse bind cannot be undone
        }
        for (int i = 0; i < 12; i++) {
            rows[i] = shown.m[i % 4 * 4 + i / 4];
        }
        double d = matrix_distance(m, rows);
        worst = d > worst || d != d ? d : worst;
    }
    return worst;
}

double anim_world_error_max(anim_world *w, uint32_t sample) {
    uint32_t count = core_columns_count(&w->instances.set), looked = 0;
    // A fixed stride spreads the sample over all rows.
    uint32_t stride = sample && count > sample ? count / sample : 1;
    core_arena *arena = anim_scratch(w, 0);
    double worst = 0;
    for (uint32_t row = 0; row < count && (!sample || looked < sample); row += stride) {
        if (!w->instances.posed[row] || w->instances.layered[row] || w->instances.goal_count[row] ||
            w->instances.external_weight[row] > 0 || (w->instances.flags[row] & ANIM_HIDDEN)) {
            continue;
        }
        size_t mark = core_arena_mark(arena);
        double d = instance_error(w, row, arena);
        core_arena_rewind(arena, mark);
        worst = d > worst || d != d ? d : worst;
        looked++;
    }
    return worst;
}
