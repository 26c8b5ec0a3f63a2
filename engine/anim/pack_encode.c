// Chooses and writes compressed tracks (see pack.h). Bones are taken parents first; each of their
// components gets the smallest form that keeps every point that hangs on the bone within its share
// of the bound, with the parents already as they will be decoded. The finished file is decoded and
// measured again: the stated error is that of the real sampler.
#include "anim/pack.h"

#include <math.h>
#include <string.h>

#define PACK_MAGIC 0x324e4143u
#define MIN_W      0.25 // of a rotation against its base: 151 degrees off at most
#define OVERSAMPLE 4
#define MAX_TIMES  40000u

typedef struct affine { // rows of 3x4
    double m[12];
} affine;
typedef struct local {
    double v[10]; // t, r (x y z w), s
} local;

typedef struct form { // how a track may be stored
    uint32_t bytes, intervals;
} form;

typedef struct track {
    bool animated, stored; // stored: fixed or animated, else bind pose
    form form;
    double low[3], step[3], base[4], fixed[4];
    uint16_t low16[3], range16[3], base16[3];
    uint16_t *number; // [(intervals + 1) * 3]
} track;

typedef struct encoder {
    const core_skeleton_data *skeleton;
    const core_clip_data *clip;
    double bound, shell, share;
    uint32_t bones, times, rate_intervals, depth;
    double *time;  // [times]
    local *raw;    // [times * bones]
    affine *model; // [times * bones] of the source
    affine *coded; // [times * bones] as decoded so far
    bool *below;   // [bones * bones] below[a * bones + b]: b hangs on a
    uint32_t *level;
    track *track; // [bones * 3]
} encoder;

static const uint32_t first_of[] = {3, 0, 7}, size_of[] = {4, 3, 3};

// ---- the source in double precision ----

static void normalize(double *q) {
    double n = core_sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (int i = 0; i < 4; i++) {
        q[i] /= n;
    }
}

static double dot(const double *a, const double *b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

static local from_key(const core_key *k) {
    local out = {{(double)k->translation.x, (double)k->translation.y, (double)k->translation.z,
                  (double)k->rotation.x, (double)k->rotation.y, (double)k->rotation.z,
                  (double)k->rotation.w, (double)k->scale.x, (double)k->scale.y,
                  (double)k->scale.z}};
    normalize(out.v + 3);
    return out;
}

static local sample_raw(const core_clip_track *t, double time) {
    uint32_t low = 0, high = t->key_count;
    while (high - low > 1) {
        uint32_t middle = (low + high) / 2;
        if ((double)t->key[middle].time <= time) {
            low = middle;
        } else {
            high = middle;
        }
    }
    local a = from_key(&t->key[low]);
    if (low + 1 == t->key_count || time <= (double)t->key[low].time) {
        return a;
    }
    local b = from_key(&t->key[low + 1]), out;
    double t0 = (double)t->key[low].time, u = (time - t0) / ((double)t->key[low + 1].time - t0);
    for (int i = 0; i < 10; i++) {
        out.v[i] = a.v[i] + (b.v[i] - a.v[i]) * u;
    }
    double d = dot(a.v + 3, b.v + 3), sign = d < 0 ? -1 : 1;
    double angle = core_acos(fmin(1, d * sign)), s = core_sin(angle);
    double wa = s > 1e-9 ? core_sin((1 - u) * angle) / s : 1 - u;
    double wb = s > 1e-9 ? core_sin(u * angle) / s : u;
    for (int i = 3; i < 7; i++) {
        out.v[i] = a.v[i] * wa + b.v[i] * wb * sign;
    }
    normalize(out.v + 3);
    return out;
}

static affine compose(const local *p) {
    const double *v = p->v;
    double x = v[3], y = v[4], z = v[5], w = v[6];
    const double r[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                         2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                         2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
    affine out;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            out.m[4 * i + j] = r[3 * i + j] * v[7 + j];
        }
        out.m[4 * i + 3] = v[i];
    }
    return out;
}

static affine multiply(const affine *a, const affine *b) {
    affine out;
    for (int r = 0; r < 3; r++) {
        const double *row = a->m + 4 * r;
        for (int c = 0; c < 4; c++) {
            out.m[4 * r + c] = row[0] * b->m[c] + row[1] * b->m[4 + c] + row[2] * b->m[8 + c] +
                               (c == 3 ? row[3] : 0);
        }
    }
    return out;
}

static void fill_source(encoder *e) {
    const core_skeleton_data *s = e->skeleton;
    for (uint32_t b = 0; b < e->bones; b++) {
        core_key bind = {0, s->translation[b], s->rotation[b], s->scale[b]};
        local rest = from_key(&bind);
        const core_clip_track *t = NULL;
        for (uint32_t i = 0; i < e->clip->track_count && !t; i++) {
            t = e->clip->track[i].bone == b ? &e->clip->track[i] : NULL;
        }
        for (uint32_t k = 0; k < e->times; k++) {
            local *p = &e->raw[k * e->bones + b];
            *p = t ? sample_raw(t, e->time[k]) : rest;
            affine m = compose(p);
            e->model[k * e->bones + b] =
                s->parent[b] < 0 ? m
                                 : multiply(&e->model[k * e->bones + (uint32_t)s->parent[b]], &m);
        }
        e->level[b] = s->parent[b] < 0 ? 0 : e->level[s->parent[b]] + 1;
        e->depth = e->level[b] > e->depth ? e->level[b] : e->depth;
        for (int32_t a = (int32_t)b; a >= 0; a = s->parent[a]) {
            e->below[(uint32_t)a * e->bones + b] = true;
        }
    }
}

// ---- error ----

// Worst distance, squared, at the joints below `b` and their shells when b's model matrix is
// `coded` instead of its own: D = coded * own^-1 moves each of their points.
static double moved_points(const encoder *e, uint32_t k, uint32_t b, const affine *coded) {
    const affine *own = &e->model[k * e->bones + b];
    const double *m = own->m;
    double c[9], det = 0;
    for (int i = 0; i < 9; i++) {
        int r = i / 3, s = i % 3, r1 = (r + 1) % 3, r2 = (r + 2) % 3, s1 = (s + 1) % 3,
            s2 = (s + 2) % 3;
        c[3 * s + r] = m[4 * r1 + s1] * m[4 * r2 + s2] - m[4 * r1 + s2] * m[4 * r2 + s1];
    }
    det = m[0] * c[0] + m[1] * c[3] + m[2] * c[6];
    if (!(fabs(det) > 1e-30)) {
        return 0; // flattened: nothing below can be told apart
    }
    affine inverse;
    for (int r = 0; r < 3; r++) {
        for (int s = 0; s < 3; s++) {
            inverse.m[4 * r + s] = c[3 * r + s] / det;
        }
        inverse.m[4 * r + 3] =
            -(inverse.m[4 * r] * m[3] + inverse.m[4 * r + 1] * m[7] + inverse.m[4 * r + 2] * m[11]);
    }
    affine d = multiply(coded, &inverse);
    double worst = 0;
    for (uint32_t other = b; other < e->bones; other++) {
        if (!e->below[b * e->bones + other]) {
            continue;
        }
        const double *o = e->model[k * e->bones + other].m;
        for (int point = 0; point < 4; point++) {
            double p[3], sum = 0;
            for (int r = 0; r < 3; r++) {
                p[r] = o[4 * r + 3] + (point ? e->shell * o[4 * r + point - 1] : 0);
            }
            for (int r = 0; r < 3; r++) {
                double q = d.m[4 * r] * p[0] + d.m[4 * r + 1] * p[1] + d.m[4 * r + 2] * p[2] +
                           d.m[4 * r + 3] - p[r];
                sum += q * q;
            }
            worst = fmax(worst, sum);
        }
    }
    return worst;
}

static double row_value(const track *t, uint32_t row, int k) {
    return t->low[k] + t->step[k] * (double)t->number[row * 3 + (uint32_t)k];
}

// The track as the sampler will give it.
static void decode_at(const encoder *e, const track *t, uint32_t kind, double time, double *out) {
    if (!t->animated) {
        memcpy(out, t->fixed, size_of[kind] * sizeof *out);
        return;
    }
    double u = time * t->form.intervals / (double)e->clip->duration, v[2][4], d[4];
    uint32_t row = u < t->form.intervals ? (uint32_t)u : t->form.intervals - 1;
    u = fmin(1, u - row);
    for (uint32_t i = 0; i < 2; i++) {
        double rest = 1;
        for (int k = 0; k < 3; k++) {
            v[i][k] = row_value(t, row + i, k);
            rest -= v[i][k] * v[i][k];
        }
        v[i][3] = core_sqrt(fmax(0, rest));
    }
    for (int k = 0; k < 4; k++) {
        d[k] = v[0][k] + (v[1][k] - v[0][k]) * u;
    }
    if (kind != ANIM_PACK_R) {
        memcpy(out, d, 3 * sizeof *out);
        return;
    }
    normalize(d);
    const double *b = t->base;
    out[0] = b[3] * d[0] + b[0] * d[3] + b[1] * d[2] - b[2] * d[1];
    out[1] = b[3] * d[1] + b[1] * d[3] + b[2] * d[0] - b[0] * d[2];
    out[2] = b[3] * d[2] + b[2] * d[3] + b[0] * d[1] - b[1] * d[0];
    out[3] = b[3] * d[3] - b[0] * d[0] - b[1] * d[1] - b[2] * d[2];
}

static local decoded_local(const encoder *e, uint32_t b, uint32_t k, uint32_t upto) {
    local p = e->raw[k * e->bones + b];
    for (uint32_t kind = 0; kind <= upto; kind++) {
        decode_at(e, &e->track[b * 3 + kind], kind, e->time[k], p.v + first_of[kind]);
    }
    return p;
}

static affine decoded_model(const encoder *e, uint32_t b, uint32_t k, uint32_t upto) {
    local p = decoded_local(e, b, k, upto);
    affine m = compose(&p);
    int32_t parent = e->skeleton->parent[b];
    return parent < 0 ? m : multiply(&e->coded[k * e->bones + (uint32_t)parent], &m);
}

static double allowed(const encoder *e, uint32_t b, uint32_t kind) {
    double deeper = (e->level[b] + (kind + 1) / 3.0) / (e->depth + 1.0);
    return e->bound * e->share * (0.3 + 0.7 * deeper);
}

static bool good_enough(const encoder *e, uint32_t b, uint32_t kind) {
    double limit = allowed(e, b, kind);
    for (uint32_t k = 0; k < e->times; k++) {
        affine m = decoded_model(e, b, k, kind);
        if (!(moved_points(e, k, b, &m) <= limit * limit)) {
            return false;
        }
    }
    return true;
}

// ---- one track in one form ----

static local raw_at(const encoder *e, uint32_t b, double time) {
    for (uint32_t i = 0; i < e->clip->track_count; i++) {
        if (e->clip->track[i].bone == b) {
            return sample_raw(&e->clip->track[i], time);
        }
    }
    return e->raw[b];
}

static uint16_t part16(double v) { return (uint16_t)(fmax(-1, fmin(1, v)) * 32767 + 32768.5); }
static double of_part16(uint16_t v) { return (double)(float)((float)(v - 32768) / 32767.0f); }

static void relative(const double *base, const double *q, double *out) { // base^-1 * q, w >= 0
    const double b[4] = {-base[0], -base[1], -base[2], base[3]};
    out[0] = b[3] * q[0] + b[0] * q[3] + b[1] * q[2] - b[2] * q[1];
    out[1] = b[3] * q[1] + b[1] * q[3] + b[2] * q[0] - b[0] * q[2];
    out[2] = b[3] * q[2] + b[2] * q[3] + b[0] * q[1] - b[1] * q[0];
    out[3] = b[3] * q[3] - b[0] * q[0] - b[1] * q[1] - b[2] * q[2];
    for (int i = 0; out[3] < 0 && i < 4; i++) {
        out[i] = i < 3 ? -out[i] : out[i];
    }
    out[3] = fabs(out[3]);
}

// A rotation as its 16-bit x, y, z (w >= 0) will be read back.
static void quantise_rotation(const double *q, uint16_t out16[3], double out[4]) {
    double n = 0, sign = q[3] < 0 ? -1 : 1;
    for (int i = 0; i < 3; i++) {
        out16[i] = part16(q[i] * sign);
        out[i] = of_part16(out16[i]);
        n += out[i] * out[i];
    }
    out[3] = core_sqrt(fmax(0, 1 - n));
    normalize(out);
}

// Mean rotation as 16-bit x, y, z with w >= 0. False when the track turns too far from it.
static bool choose_base(const encoder *e, uint32_t b, track *t) {
    double sum[4] = {0}, d[4];
    const double *start = e->raw[b].v + 3;
    for (uint32_t k = 0; k < e->times; k++) {
        const double *q = e->raw[k * e->bones + b].v + 3;
        double sign = dot(q, start) < 0 ? -1 : 1;
        for (int i = 0; i < 4; i++) {
            sum[i] += q[i] * sign;
        }
    }
    normalize(sum);
    quantise_rotation(sum, t->base16, t->base);
    for (uint32_t k = 0; k < e->times; k++) {
        relative(t->base, e->raw[k * e->bones + b].v + 3, d);
        if (!(d[3] > MIN_W)) {
            return false;
        }
    }
    return true;
}

static void value_at(const encoder *e, uint32_t b, uint32_t kind, const track *t, uint32_t row,
                     double *out) {
    local p = raw_at(e, b, (double)e->clip->duration * row / t->form.intervals);
    if (kind == ANIM_PACK_R) {
        double d[4];
        relative(t->base, p.v + 3, d);
        memcpy(out, d, 3 * sizeof *out);
    } else {
        memcpy(out, p.v + first_of[kind], 3 * sizeof *out);
    }
}

static void encode_form(const encoder *e, uint32_t b, uint32_t kind, form f, track *t) {
    uint32_t rows = f.intervals + 1;
    double low[3] = {1e30, 1e30, 1e30}, high[3] = {-1e30, -1e30, -1e30}, v[3];
    t->animated = true;
    t->stored = true;
    t->form = f;
    core_free(t->number);
    t->number = core_alloc(rows * 3u * sizeof *t->number);
    for (uint32_t r = 0; r < rows; r++) {
        value_at(e, b, kind, t, r, v);
        for (int k = 0; k < 3; k++) {
            low[k] = fmin(low[k], v[k]);
            high[k] = fmax(high[k], v[k]);
        }
    }
    double top = f.bytes == 1 ? 255 : 65535;
    for (int k = 0; k < 3; k++) {
        if (kind == ANIM_PACK_R) { // round outwards: low down, range up
            t->low16[k] = part16(low[k] - 1.0 / 32767);
            t->low[k] = of_part16(t->low16[k]);
            t->range16[k] = (uint16_t)fmin(65535, ceil((high[k] - t->low[k]) * 32767) + 1);
            t->step[k] = (double)((float)t->range16[k] / 32767.0f) / top;
        } else {
            t->low[k] = (double)(float)low[k];
            t->step[k] = (double)(float)((high[k] - low[k]) / top);
        }
    }
    for (uint32_t r = 0; r < rows; r++) {
        value_at(e, b, kind, t, r, v);
        for (int k = 0; k < 3; k++) {
            double q = t->step[k] > 0 ? (v[k] - t->low[k]) / t->step[k] : 0;
            t->number[r * 3 + (uint32_t)k] = (uint16_t)fmax(0, fmin(top, floor(q + 0.5)));
        }
    }
}

static local bind_pose(const encoder *e, uint32_t b) {
    core_key key = {0, e->skeleton->translation[b], e->skeleton->rotation[b],
                    e->skeleton->scale[b]};
    return from_key(&key);
}

// The component's first value, as it will be stored when it never changes.
static void choose_fixed(const encoder *e, uint32_t b, uint32_t kind, track *t) {
    const double *first = e->raw[b].v + first_of[kind];
    if (kind == ANIM_PACK_R) {
        quantise_rotation(first, t->base16, t->fixed);
        return;
    }
    for (uint32_t k = 0; k < 3; k++) {
        t->fixed[k] = (double)(float)first[k];
    }
}

static uint32_t at_least_one(uint32_t n) { return n ? n : 1; }

// Smallest form within the bone's share.
static bool choose_form(encoder *e, uint32_t b, uint32_t kind) {
    track *t = &e->track[b * 3 + kind];
    local bind = bind_pose(e, b);
    memcpy(t->fixed, bind.v + first_of[kind], size_of[kind] * sizeof *t->fixed);
    t->stored = false;
    if (good_enough(e, b, kind)) {
        return true;
    }
    choose_fixed(e, b, kind, t);
    t->stored = true;
    if (good_enough(e, b, kind)) {
        return true;
    }
    if (kind == ANIM_PACK_R && !choose_base(e, b, t)) {
        return core_fail_quiet(
            "clip %s: bone %s turns more than 150 degrees from its mean: keep the raw "
            "clip",
            e->clip->name, e->skeleton->name[b]);
    }
    uint32_t n = e->rate_intervals;
    const form forms[] = {{1, at_least_one(n / 8)},
                          {1, at_least_one(n / 4)},
                          {2, at_least_one(n / 8)},
                          {1, at_least_one(n / 2)},
                          {2, at_least_one(n / 4)},
                          {1, n},
                          {2, at_least_one(n / 2)},
                          {2, n},
                          {2, 2 * n},
                          {2, 4 * n}};
    for (size_t i = 0; i < CORE_COUNT_OF(forms); i++) {
        encode_form(e, b, kind, forms[i], t);
        if (good_enough(e, b, kind)) {
            return true;
        }
    }
    return core_fail_quiet("clip %s: bone %s cannot be kept within %g m", e->clip->name,
                           e->skeleton->name[b], e->bound);
}

// ---- writing ----

typedef struct sink {
    uint8_t *data;
    size_t size, capacity;
} sink;

static void put(sink *s, const void *p, size_t n) {
    if (s->size + n > s->capacity) {
        size_t capacity = (s->capacity + n) * 2;
        s->data = core_realloc(s->data, s->capacity, capacity);
        s->capacity = capacity;
    }
    memcpy(s->data + s->size, p, n);
    s->size += n;
}
static void put_u16(sink *s, uint32_t v) { put(s, (uint8_t[]){(uint8_t)v, (uint8_t)(v >> 8)}, 2); }
static void put_u32(sink *s, uint32_t v) {
    put_u16(s, v);
    put_u16(s, v >> 16);
}
static void put_f32(sink *s, float v) {
    uint32_t bits;
    memcpy(&bits, &v, 4);
    put_u32(s, bits);
}

static bool same_form(const track *a, form f) {
    return a->animated && a->form.bytes == f.bytes && a->form.intervals == f.intervals;
}

static void put_track(sink *s, const track *t, uint32_t kind, uint32_t bone) {
    put_u16(s, bone);
    for (int k = 0; kind == ANIM_PACK_R && k < 3; k++) {
        put_u16(s, t->base16[k]);
    }
    for (int k = 0; k < 3; k++) {
        if (kind == ANIM_PACK_R) {
            put_u16(s, t->low16[k]);
        } else {
            put_f32(s, (float)t->low[k]);
        }
    }
    for (int k = 0; k < 3; k++) {
        if (kind == ANIM_PACK_R) {
            put_u16(s, t->range16[k]);
        } else {
            put_f32(s, (float)t->step[k]);
        }
    }
}

// All tracks of the kind that share the form of bone `first`.
static void put_group(sink *s, const encoder *e, uint32_t kind, uint32_t first) {
    form f = e->track[first * 3 + kind].form;
    uint32_t tracks = 0;
    for (uint32_t b = first; b < e->bones; b++) {
        tracks += same_form(&e->track[b * 3 + kind], f);
    }
    put(s, (uint8_t[]){(uint8_t)kind, (uint8_t)f.bytes}, 2);
    put_u16(s, tracks);
    put_u32(s, f.intervals);
    for (uint32_t b = first; b < e->bones; b++) {
        if (same_form(&e->track[b * 3 + kind], f)) {
            put_track(s, &e->track[b * 3 + kind], kind, b);
        }
    }
    for (uint32_t i = 0; i < (f.intervals + 1) * 3; i++) {
        for (uint32_t b = first; b < e->bones; b++) {
            const track *t = &e->track[b * 3 + kind];
            if (same_form(t, f)) {
                uint16_t v = t->number[i];
                put(s, (uint8_t[]){(uint8_t)v, (uint8_t)(v >> 8)}, f.bytes);
            }
        }
    }
}

static bool is_first_of_form(const encoder *e, uint32_t kind, uint32_t b) {
    const track *t = &e->track[b * 3 + kind];
    for (uint32_t a = 0; t->animated && a < b; a++) {
        if (same_form(&e->track[a * 3 + kind], t->form)) {
            return false;
        }
    }
    return t->animated;
}

static sink write_file(const encoder *e, float error) {
    sink s = {0};
    uint32_t groups = 0, fixed = 0;
    for (uint32_t i = 0; i < e->bones * 3; i++) {
        groups += is_first_of_form(e, i % 3, i / 3);
        fixed += e->track[i].stored && !e->track[i].animated;
    }
    char name[CORE_NAME_MAX] = {0};
    memcpy(name, e->clip->name, strnlen(e->clip->name, CORE_NAME_MAX - 1));
    put_u32(&s, PACK_MAGIC);
    put(&s, name, sizeof name);
    put_f32(&s, e->clip->duration);
    put_u32(&s, e->bones);
    put_f32(&s, (float)e->bound);
    put_f32(&s, (float)e->shell);
    put_f32(&s, error);
    put_u16(&s, groups);
    put_u16(&s, fixed);
    for (uint32_t i = 0; i < e->bones * 3; i++) {
        const track *t = &e->track[i];
        if (t->stored && !t->animated) {
            put_u16(&s, i / 3 | i % 3 << 14);
            for (uint32_t k = 0; k < 3; k++) {
                if (i % 3 == ANIM_PACK_R) {
                    put_u16(&s, t->base16[k]);
                } else {
                    put_f32(&s, (float)t->fixed[k]);
                }
            }
        }
    }
    for (uint32_t kind = 0; kind < 3; kind++) {
        for (uint32_t b = 0; b < e->bones; b++) {
            if (is_first_of_form(e, kind, b)) {
                put_group(&s, e, kind, b);
            }
        }
    }
    return s;
}

// ---- the finished file, measured ----

static double measure(const encoder *e, const sink *s) {
    anim_pack *p = anim_pack_decode(s->data, s->size, e->clip->name);
    if (!p) {
        return INFINITY;
    }
    float *columns = core_alloc(10u * e->bones * sizeof *columns);
    affine *model = core_alloc(e->bones * sizeof *model);
    double worst = 0;
    for (uint32_t k = 0; k < e->times; k++) {
        for (uint32_t b = 0; b < e->bones; b++) {
            local rest = bind_pose(e, b);
            for (uint32_t i = 0; i < 10; i++) {
                columns[i * e->bones + b] = (float)rest.v[i];
            }
        }
        anim_pack_sample(p, (float)e->time[k], e->bones, columns);
        for (uint32_t b = 0; b < e->bones; b++) {
            local l;
            for (uint32_t i = 0; i < 10; i++) {
                l.v[i] = (double)columns[i * e->bones + b];
            }
            affine m = compose(&l);
            int32_t parent = e->skeleton->parent[b];
            model[b] = parent < 0 ? m : multiply(&model[parent], &m);
            const affine *own = &e->model[k * e->bones + b];
            for (int point = 0; point < 4; point++) {
                double sum = 0;
                for (int r = 0; r < 3; r++) {
                    double d = model[b].m[4 * r + 3] - own->m[4 * r + 3];
                    if (point) {
                        d += e->shell * (model[b].m[4 * r + point - 1] - own->m[4 * r + point - 1]);
                    }
                    sum += d * d;
                }
                worst = fmax(worst, sum);
            }
        }
    }
    core_free(columns);
    core_free(model);
    core_free(p);
    return core_sqrt(worst);
}

static bool on_grid(const core_clip_data *clip, double rate) {
    for (uint32_t i = 0; i < clip->track_count; i++) {
        for (uint32_t k = 0; k < clip->track[i].key_count; k++) {
            double at = (double)clip->track[i].key[k].time * rate;
            if (fabs(at - floor(at + 0.5)) > 2e-3) {
                return false;
            }
        }
    }
    return fabs((double)clip->duration * rate - floor((double)clip->duration * rate + 0.5)) < 2e-3;
}

// The rate whose ticks all keys fall on, else that of the densest track.
static double source_rate(const core_clip_data *clip) {
    static const double common[] = {10, 12, 15, 20, 24, 25, 30, 48, 50, 60, 100, 120};
    double rate = 1;
    for (size_t i = 0; i < CORE_COUNT_OF(common); i++) {
        if (on_grid(clip, common[i])) {
            return common[i];
        }
    }
    for (uint32_t i = 0; i < clip->track_count; i++) {
        const core_clip_track *t = &clip->track[i];
        double span = (double)t->key[t->key_count - 1].time - (double)t->key[0].time;
        if (t->key_count > 1 && span > 0) {
            rate = fmax(rate, (t->key_count - 1) / span);
        }
    }
    return fmin(rate, 240);
}

static void *allocate(encoder *e, double rate) {
    e->rate_intervals = (uint32_t)fmax(1, floor((double)e->clip->duration * rate + 0.5));
    e->times = e->rate_intervals * OVERSAMPLE + 1;
    e->times = e->times < MAX_TIMES ? e->times : MAX_TIMES;
    size_t n = (size_t)e->times * e->bones;
    e->time = core_alloc(e->times * sizeof *e->time);
    e->raw = core_alloc(n * sizeof *e->raw);
    e->model = core_alloc(n * sizeof *e->model);
    e->coded = core_alloc(n * sizeof *e->coded);
    e->below = core_alloc((size_t)e->bones * e->bones);
    e->level = core_alloc(e->bones * sizeof *e->level);
    e->track = core_alloc(e->bones * 3u * sizeof *e->track);
    for (uint32_t k = 0; k < e->times; k++) {
        e->time[k] = (double)(float)((double)e->clip->duration * k / (e->times - 1));
    }
    return e->track;
}

static void release(encoder *e) {
    for (uint32_t i = 0; e->track && i < e->bones * 3; i++) {
        core_free(e->track[i].number);
    }
    void *const blocks[] = {e->time, e->raw, e->model, e->coded, e->below, e->level, e->track};
    for (size_t i = 0; i < CORE_COUNT_OF(blocks); i++) {
        core_free(blocks[i]);
    }
}

static bool choose_all(encoder *e) {
    for (uint32_t b = 0; b < e->bones; b++) {
        for (uint32_t kind = 0; kind < 3; kind++) {
            e->track[b * 3 + kind].animated = false;
            if (!choose_form(e, b, kind)) {
                return false;
            }
        }
        for (uint32_t k = 0; k < e->times; k++) {
            e->coded[k * e->bones + b] = decoded_model(e, b, k, 2);
        }
    }
    return true;
}

void *anim_pack_encode(const core_skeleton_data *skeleton, const core_clip_data *clip, float bound,
                       float shell, float rate, size_t *size) {
    if (!(bound > 0) || !(shell >= 0) || !(rate >= 0) || skeleton->bone_count != clip->bone_count) {
        core_fail("clip %s: cannot compress to %g m with shell %g m, rate %g; bones %u and %u",
                  clip->name, bound, shell, rate, clip->bone_count, skeleton->bone_count);
        return NULL;
    }
    for (uint32_t i = 0; i < clip->track_count; i++) {
        if (clip->track[i].mode != CORE_KEY_LINEAR) {
            core_fail_quiet("clip %s: only linear keys can be compressed; bone %u has others",
                            clip->name, clip->track[i].bone);
            return NULL;
        }
    }
    encoder e = {.skeleton = skeleton,
                 .clip = clip,
                 .bound = (double)bound,
                 .shell = (double)shell,
                 .share = 1,
                 .bones = skeleton->bone_count};
    allocate(&e, rate > 0 ? (double)rate : source_rate(clip));
    fill_source(&e);
    sink best = {0};
    bool chosen = true;
    for (int attempt = 0; attempt < 8; attempt++) {
        chosen = choose_all(&e); // says why not
        if (!chosen) {
            break;
        }
        sink s = write_file(&e, 0);
        double error = measure(&e, &s);
        core_free(s.data);
        if (error <= (double)bound && (!best.data || s.size < best.size)) {
            core_free(best.data);
            best = write_file(&e, (float)(error * (1 + 1e-6)));
        }
        if (error > 0.9 * (double)bound && error <= (double)bound) {
            break;
        }
        e.share *= 0.95 * (double)bound / fmax(error, 0.2 * (double)bound);
    }
    if (!best.data && chosen) {
        core_fail_quiet("clip %s: cannot be kept within %g m", clip->name, bound);
    }
    release(&e);
    *size = best.size;
    return best.data;
}
