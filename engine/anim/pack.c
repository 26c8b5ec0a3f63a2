// Reading and sampling of compressed clips.
#include "anim/pack.h"

#include <string.h>

#define PACK_MAGIC 0x324e4143u // "CAN2"
#define HEAD_BYTES (4 + CORE_NAME_MAX + 6 * 4 + 4)
#define MAX_ROWS   (1u << 20)
#define MAX_BONES  4096u

typedef struct cursor {
    const uint8_t *at, *end;
    bool failed;
} cursor;

static const uint8_t *take(cursor *c, size_t n) {
    if (c->failed || (size_t)(c->end - c->at) < n) {
        c->failed = true;
        return NULL;
    }
    const uint8_t *p = c->at;
    c->at += n;
    return p;
}
static uint32_t take_u16(cursor *c) {
    const uint8_t *p = take(c, 2);
    return p ? (uint32_t)(p[0] | p[1] << 8) : 0;
}
static uint32_t take_u32(cursor *c) {
    uint32_t low = take_u16(c);
    return low | take_u16(c) << 16;
}
static float take_f32(cursor *c) {
    uint32_t bits = take_u32(c);
    float v;
    memcpy(&v, &bits, 4);
    return v;
}
static bool sane(float v) { return v > -1e9f && v < 1e9f; } // false for NaN

// Per track in the file: bone u16; rotations: base, low, step as 16-bit parts; others: 6 f32.
static size_t track_head(uint32_t kind) { return kind == ANIM_PACK_R ? 2 + 3 * 6 : 2 + 24; }

typedef struct group_head {
    uint32_t kind, bytes, tracks, intervals;
} group_head;

static group_head take_group(cursor *c) {
    group_head g;
    const uint8_t *p = take(c, 2);
    g.kind = p ? p[0] : 99;
    g.bytes = p ? p[1] : 0;
    g.tracks = take_u16(c);
    g.intervals = take_u32(c);
    return g;
}

static bool head_ok(const group_head *g, uint32_t bones) {
    return g->kind <= ANIM_PACK_S && (g->bytes == 1 || g->bytes == 2) && g->tracks > 0 &&
           g->tracks <= bones && g->intervals > 0 && g->intervals < MAX_ROWS;
}

static size_t group_body(const group_head *g) {
    return g->tracks * track_head(g->kind) + (size_t)(g->intervals + 1) * 3 * g->tracks * g->bytes;
}

static uint32_t padded(uint32_t tracks) {
    return (tracks + CORE_LANES - 1) / CORE_LANES * CORE_LANES;
}
static size_t aligned(size_t n) { return (n + CORE_ALIGN - 1) & ~(size_t)(CORE_ALIGN - 1); }

// Bytes in memory of all groups, 0 when counts and sizes disagree. Leaves the cursor alone.
static size_t measure(cursor c, const anim_pack *p) {
    size_t total = 0;
    for (uint32_t i = 0; i < p->group_count; i++) {
        group_head g = take_group(&c);
        if (c.failed || !head_ok(&g, p->bones) || !take(&c, group_body(&g))) {
            return 0;
        }
        size_t n = padded(g.tracks);
        total += aligned((size_t)(g.intervals + 1) * 3 * n * g.bytes) + aligned(10 * n * 4) +
                 aligned(g.tracks * 2);
    }
    return c.at == c.end ? total + CORE_ALIGN : 0;
}

static float part(uint32_t v) { return (float)((int32_t)v - 32768) / 32767.0f; } // [-1, 1]

// x, y, z as 16-bit parts, w >= 0 follows.
static void take_rotation(cursor *c, float q[4]) {
    float n = 0;
    for (uint32_t k = 0; k < 3; k++) {
        q[k] = part(take_u16(c));
        n += q[k] * q[k];
    }
    q[3] = core_sqrtf(n < 1 ? 1 - n : 0);
    core_quat unit = core_quat_normalize((core_quat){q[0], q[1], q[2], q[3]});
    memcpy(q, &unit, sizeof unit);
}

static bool take_track(cursor *c, anim_pack_group *g, uint32_t t, uint32_t bones, float *low,
                       float *step, float *base, uint16_t *bone) {
    bone[t] = (uint16_t)take_u16(c);
    if (g->kind == ANIM_PACK_R) {
        float q[4];
        take_rotation(c, q);
        for (uint32_t k = 0; k < 4; k++) {
            base[k * g->stride + t] = q[k];
        }
        for (uint32_t k = 0; k < 3; k++) {
            low[k * g->stride + t] = part(take_u16(c));
        }
        for (uint32_t k = 0; k < 3; k++) {
            float range = (float)take_u16(c) / 32767.0f;
            step[k * g->stride + t] = range / (g->bytes == 1 ? 255.0f : 65535.0f);
        }
    } else {
        for (uint32_t k = 0; k < 3; k++) {
            low[k * g->stride + t] = take_f32(c);
        }
        for (uint32_t k = 0; k < 3; k++) {
            step[k * g->stride + t] = take_f32(c);
        }
    }
    bool good = !c->failed && bone[t] < bones && (t == 0 || bone[t] > bone[t - 1]);
    for (uint32_t k = 0; k < 3; k++) {
        good = good && sane(low[k * g->stride + t]) && sane(step[k * g->stride + t] * 65535);
    }
    return good;
}

static void take_rows(cursor *c, const anim_pack_group *g, uint8_t *rows) {
    for (size_t r = 0; r < (size_t)(g->intervals + 1) * 3; r++) {
        const uint8_t *p = take(c, (size_t)g->tracks * g->bytes);
        memcpy(rows + r * g->stride * g->bytes, p, (size_t)g->tracks * g->bytes);
    }
}

static bool read_groups(cursor *c, anim_pack *p, uint8_t *memory) {
    memory = (uint8_t *)aligned((size_t)memory);
    for (uint32_t i = 0; i < p->group_count; i++) {
        group_head h = take_group(c);
        anim_pack_group *g = &p->group[i];
        size_t n = padded(h.tracks), rows = (size_t)(h.intervals + 1) * 3 * n * h.bytes;
        float *numbers = (float *)(memory + aligned(rows));
        uint16_t *bone = (uint16_t *)((uint8_t *)numbers + aligned(10 * n * 4));
        *g = (anim_pack_group){h.kind, h.bytes, h.tracks,        (uint32_t)n,     h.intervals,
                               memory, numbers, numbers + 3 * n, numbers + 6 * n, bone};
        for (uint32_t t = 0; t < h.tracks; t++) {
            if (!take_track(c, g, t, p->bones, numbers, numbers + 3 * n, numbers + 6 * n, bone)) {
                return false;
            }
        }
        take_rows(c, g, memory);
        memory = (uint8_t *)bone + aligned(h.tracks * 2);
    }
    return true;
}

static bool read_fixed(cursor *c, anim_pack *p) {
    for (uint32_t i = 0; i < p->fixed_count; i++) {
        anim_pack_fixed *f = &p->fixed[i];
        uint32_t head = take_u16(c); // bone, kind in the upper two bits
        f->bone = head & 0x3fff;
        f->kind = (uint16_t)(head >> 14);
        bool good = f->bone < p->bones && f->kind <= ANIM_PACK_S;
        if (f->kind == ANIM_PACK_R) {
            take_rotation(c, f->value);
        }
        for (uint32_t k = 0; f->kind != ANIM_PACK_R && k < 3; k++) {
            f->value[k] = take_f32(c);
            good = good && sane(f->value[k]);
        }
        if (!good || c->failed) {
            return false;
        }
    }
    return true;
}

static bool read_head(cursor *c, anim_pack *p, const char *path) {
    bool magic = take_u32(c) == PACK_MAGIC;
    const char *name = (const char *)take(c, CORE_NAME_MAX);
    if (!magic || !name) {
        return core_fail("%s: not a compressed clip: expected it to begin with \"CAN2\"", path);
    }
    if (!memchr(name, 0, CORE_NAME_MAX)) {
        return core_fail("%s: clip: its name has no end within %d bytes", path, CORE_NAME_MAX);
    }
    strcpy(p->name, name);
    p->duration = take_f32(c);
    p->bones = take_u32(c);
    p->bound = take_f32(c);
    p->shell = take_f32(c);
    p->error = take_f32(c);
    p->group_count = take_u16(c);
    p->fixed_count = take_u16(c);
    if (c->failed || !(p->duration > 0) || !sane(p->duration) || p->bones == 0 ||
        p->bones > MAX_BONES || !sane(p->bound) || !sane(p->shell) || !sane(p->error) ||
        p->fixed_count > 3 * p->bones || p->group_count > 64) {
        return core_fail("%s: compressed clip: duration %g s, %u bones, %u groups, %u fixed parts "
                         "do not fit together",
                         path, p->duration, p->bones, p->group_count, p->fixed_count);
    }
    return true;
}

anim_pack *anim_pack_decode(const void *bytes, size_t size, const char *path) {
    const uint8_t *start = bytes;
    cursor c = {start, start + size, false};
    anim_pack head = {.file_bytes = size};
    const char *name = path ? path : "(memory)";
    if (!read_head(&c, &head, name)) {
        return NULL;
    }
    size_t tables = aligned(sizeof head) + aligned(head.group_count * sizeof(anim_pack_group)) +
                    aligned(head.fixed_count * sizeof(anim_pack_fixed));
    anim_pack_fixed *fixed = core_alloc((head.fixed_count + 1) * sizeof *fixed);
    head.fixed = fixed;
    bool good = read_fixed(&c, &head);
    size_t memory = good ? measure(c, &head) : 0;
    if (memory == 0) {
        core_free(fixed);
        core_fail("%s: compressed clip: its groups do not fill the file, or name bones beyond %u",
                  name, head.bones);
        return NULL;
    }
    uint8_t *block = core_alloc(tables + memory + CORE_ALIGN);
    anim_pack *p = (anim_pack *)block;
    *p = head;
    p->group = (anim_pack_group *)(block + aligned(sizeof head));
    p->fixed = (anim_pack_fixed *)(block + aligned(sizeof head) +
                                   aligned(head.group_count * sizeof(anim_pack_group)));
    memcpy(p->fixed, fixed, head.fixed_count * sizeof *fixed);
    core_free(fixed);
    if (!read_groups(&c, p, block + tables)) {
        core_free(block);
        core_fail(
            "%s: compressed clip: a track has a bone beyond %u, out of order, or a range that "
            "is not finite",
            name, head.bones);
        return NULL;
    }
    return p;
}

// ---- sampling ----

static float number_at(const anim_pack_group *g, uint32_t row, uint32_t component, uint32_t track) {
    size_t i = ((size_t)row * 3 + component) * g->stride + track;
    return g->bytes == 1 ? (float)g->rows[i] : (float)((const uint16_t *)(const void *)g->rows)[i];
}

static float number_w(const float v[3]) {
    float rest = 1 - ((v[0] * v[0] + v[1] * v[1]) + v[2] * v[2]);
    return core_sqrtf(rest > 0 ? rest : 0);
}

void anim_pack_sample_track(const anim_pack_group *g, uint32_t track, uint32_t row, float fraction,
                            float out[4]) {
    float a[4], b[4];
    for (uint32_t k = 0; k < 3; k++) {
        float low = g->low[k * g->stride + track], step = g->step[k * g->stride + track];
        a[k] = low + number_at(g, row, k, track) * step;
        b[k] = low + number_at(g, row + 1, k, track) * step;
        out[k] = a[k] + (b[k] - a[k]) * fraction;
    }
    if (g->kind != ANIM_PACK_R) {
        return;
    }
    a[3] = number_w(a);
    b[3] = number_w(b);
    float x = out[0], y = out[1], z = out[2], w = a[3] + (b[3] - a[3]) * fraction;
    float rest = 1 - ((x * x + y * y) + (z * z + w * w));
    float series = ANIM_PACK_SERIES_3 + rest * ANIM_PACK_SERIES_4;
    series = ANIM_PACK_SERIES_2 + rest * series;
    series = ANIM_PACK_SERIES_1 + rest * series;
    float scale = 1 + rest * series;
    x *= scale;
    y *= scale;
    z *= scale;
    w *= scale;
    const float *base = g->base + track;
    float bx = base[0], by = base[g->stride], bz = base[2 * g->stride], bw = base[3 * g->stride];
    out[0] = (bw * x + bx * w) + (by * z - bz * y);
    out[1] = (bw * y + by * w) + (bz * x - bx * z);
    out[2] = (bw * z + bz * w) + (bx * y - by * x);
    out[3] = (bw * w - bx * x) - (by * y + bz * z);
}

void anim_pack_sample(const anim_pack *p, float time, uint32_t stride, float *out) {
    static const uint32_t first[] = {3, 0, 7}, size[] = {4, 3, 3}; // columns of R, T, S
    for (uint32_t i = 0; i < p->fixed_count; i++) {
        const anim_pack_fixed *f = &p->fixed[i];
        for (uint32_t k = 0; k < size[f->kind]; k++) {
            out[(first[f->kind] + k) * stride + f->bone] = f->value[k];
        }
    }
    for (uint32_t i = 0; i < p->group_count; i++) {
        const anim_pack_group *g = &p->group[i];
        float fraction, v[4];
        uint32_t row = anim_pack_row(g, p->duration, time, &fraction);
        for (uint32_t t = 0; t < g->tracks; t++) {
            anim_pack_sample_track(g, t, row, fraction, v);
            for (uint32_t k = 0; k < size[g->kind]; k++) {
                out[(first[g->kind] + k) * stride + g->bone[t]] = v[k];
            }
        }
    }
}
