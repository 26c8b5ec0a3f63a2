// Clips of raw keys: checked and copied at creation, sampled without state.
#include "anim/anim_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

anim_clip_desc anim_clip_desc_default(void) { return (anim_clip_desc){.cookie = ANIM_COOKIE}; }

static bool check_key(const core_clip_data *d, const core_clip_track *t, uint32_t k) {
    const core_key *key = &t->key[k];
    const float *v = &key->time;
    for (size_t i = 0; i < sizeof *key / sizeof(float); i++) {
        if (!isfinite(v[i])) {
            return core_fail("clip %s: bone %u: key %u has a number that is not finite", d->name,
                             t->bone, k);
        }
    }
    core_quat q = key->rotation;
    if (!(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w > 1e-12f)) {
        return core_fail("clip %s: bone %u: key %u has a zero rotation", d->name, t->bone, k);
    }
    if (key->time < 0 || (k > 0 && !(key->time > t->key[k - 1].time))) {
        return core_fail("clip %s: bone %u: key %u at %g s; times must be >= 0 and grow", d->name,
                         t->bone, k, key->time);
    }
    return true;
}

static bool check_tangents(const core_clip_data *d, const core_clip_track *t) {
    if (t->mode > CORE_KEY_CUBIC) {
        return core_fail("clip %s: bone %u: key mode %d is unknown", d->name, t->bone,
                         (int)t->mode);
    }
    size_t numbers = sizeof(core_key) / sizeof(float);
    for (size_t i = 0; t->mode == CORE_KEY_CUBIC && t->tangent && i < 2 * t->key_count * numbers;
         i++) {
        if (!isfinite((&t->tangent[i / numbers].time)[i % numbers])) {
            return core_fail("clip %s: bone %u: tangent %zu has a number that is not finite",
                             d->name, t->bone, i / numbers);
        }
    }
    return true;
}

static bool check_tracks(const core_clip_data *d) {
    for (uint32_t i = 0; i < d->track_count; i++) {
        const core_clip_track *t = &d->track[i];
        if (t->bone >= d->bone_count || (i > 0 && t->bone <= d->track[i - 1].bone) ||
            t->key_count == 0) {
            return core_fail("clip %s: track %u is for bone %u with %u keys; expected ascending "
                             "bones below %u with keys",
                             d->name, i, t->bone, t->key_count, d->bone_count);
        }
        for (uint32_t k = 0; k < t->key_count; k++) {
            if (!check_key(d, t, k)) {
                return false;
            }
        }
        if (!check_tangents(d, t)) {
            return false;
        }
    }
    return true;
}

static bool check_events(const anim_clip_desc *desc, const core_clip_data *d) {
    for (uint32_t i = 0; i < desc->event_count; i++) {
        const anim_clip_event *e = &desc->event[i];
        if (!(e->time >= 0 && e->time <= d->duration) || !memchr(e->name, 0, sizeof e->name)) {
            return core_fail(
                "clip %s: event %u at %g s; expected 0..%g s and a name of at most %zu "
                "bytes",
                d->name, i, e->time, d->duration, sizeof e->name - 1);
        }
    }
    return true;
}

static bool check(const anim_clip_desc *desc, const core_clip_data *d, const anim_skeleton_res *s) {
    if (!memchr(d->name, 0, CORE_NAME_MAX)) {
        return core_fail("clip: its name has no end within %d bytes", CORE_NAME_MAX);
    }
    if (!isfinite(d->duration) || !(d->duration > 0)) {
        return core_fail("clip %s: duration %g s, expected > 0", d->name, d->duration);
    }
    if (d->bone_count != s->bones) {
        return core_fail(
            "clip %s was made for %u bones, the skeleton has %u; convert both from the "
            "same file",
            d->name, d->bone_count, s->bones);
    }
    if (desc->root_motion && desc->root_bone >= s->bones) {
        return core_fail("clip %s: root bone %u, the skeleton has %u", d->name, desc->root_bone,
                         s->bones);
    }
    return check_tracks(d) && check_events(desc, d);
}

static int compare_events(const void *a, const void *b) {
    const anim_clip_event *x = a, *y = b;
    if (x->time != y->time) {
        return x->time < y->time ? -1 : 1;
    }
    return strcmp(x->name, y->name);
}

static anim_clip_res *copy_clip(const anim_clip_desc *desc, const core_clip_data *d) {
    size_t keys = 0, tangents = 0;
    for (uint32_t i = 0; i < d->track_count; i++) {
        keys += d->track[i].key_count;
        tangents += d->track[i].mode == CORE_KEY_CUBIC ? 2u * d->track[i].key_count : 0;
    }
    size_t size = sizeof(anim_clip_res) + d->track_count * sizeof(core_clip_track) +
                  (keys + tangents) * sizeof(core_key) + d->bone_count * sizeof(int32_t) +
                  desc->event_count * sizeof(anim_clip_event);
    anim_clip_res *c = core_alloc(size);
    c->track = (core_clip_track *)(c + 1);
    c->key = (core_key *)(c->track + d->track_count);
    c->tangent = c->key + keys;
    c->track_of_bone = (int32_t *)(c->tangent + tangents);
    c->event = (anim_clip_event *)(c->track_of_bone + d->bone_count);
    memcpy(c->name, d->name, CORE_NAME_MAX);
    c->duration = d->duration;
    c->skeleton = desc->skeleton;
    c->bones = d->bone_count;
    c->track_count = d->track_count;
    c->event_count = desc->event_count;
    if (desc->event_count) {
        memcpy(c->event, desc->event, desc->event_count * sizeof *desc->event);
        qsort(c->event, c->event_count, sizeof *c->event, compare_events);
    }
    return c;
}

// Slopes through the neighbours (Catmull and Rom 1974), one-sided at the ends, in units a second.
static void make_tangents(const core_key *key, uint32_t count, core_key *out) {
    for (uint32_t k = 0; k < count; k++) {
        uint32_t a = k > 0 ? k - 1 : k, b = k + 1 < count ? k + 1 : k;
        const float *p = &key[a].time, *q = &key[b].time;
        float *m = &out[2 * k].time, d = q[0] - p[0];
        for (size_t i = 0; i < sizeof *out / sizeof *m; i++) {
            m[i] = d > 0 ? (q[i] - p[i]) / d : 0;
        }
        out[2 * k + 1] = out[2 * k];
    }
}

static core_quat toward(core_quat q, core_quat before) {
    bool far = q.x * before.x + q.y * before.y + q.z * before.z + q.w * before.w < 0;
    return far ? (core_quat){-q.x, -q.y, -q.z, -q.w} : q;
}

static void copy_tracks(anim_clip_res *c, const core_clip_data *d) {
    for (uint32_t b = 0; b < c->bones; b++) {
        c->track_of_bone[b] = -1;
    }
    core_key *key = c->key, *tangent = c->tangent;
    for (uint32_t i = 0; i < d->track_count; i++) {
        core_clip_track *t = &c->track[i];
        *t = d->track[i];
        c->track_of_bone[t->bone] = (int32_t)i;
        bool made = t->mode == CORE_KEY_CUBIC && !t->tangent;
        for (uint32_t k = 0; k < t->key_count; k++) {
            key[k] = t->key[k];
            key[k].rotation = core_quat_normalize(key[k].rotation);
            if (made && k > 0) { // a spline runs through the quaternions as they are written
                key[k].rotation = toward(key[k].rotation, key[k - 1].rotation);
            }
        }
        t->key = key;
        if (made) {
            make_tangents(key, t->key_count, tangent);
        } else if (t->mode == CORE_KEY_CUBIC) {
            memcpy(tangent, t->tangent, 2u * t->key_count * sizeof *tangent);
        }
        t->tangent = t->mode == CORE_KEY_CUBIC ? tangent : NULL;
        tangent += t->mode == CORE_KEY_CUBIC ? 2u * t->key_count : 0;
        key += t->key_count;
    }
}

// Columns of what a compressed clip does not move, and which bones' parts it does.
static void prepare_pack(const anim_skeleton_res *s, anim_clip_res *c, anim_pack *pack) {
    c->pack = pack;
    c->rest = core_alloc(ANIM_COMPONENTS * s->stride * sizeof *c->rest);
    c->moved = core_alloc(s->bones);
    memcpy(c->rest, s->bind, ANIM_COMPONENTS * s->stride * sizeof *c->rest);
    anim_pack_sample(pack, 0, s->stride, c->rest);
    for (uint32_t i = 0; i < pack->group_count; i++) {
        for (uint32_t t = 0; t < pack->group[i].tracks; t++) {
            c->moved[pack->group[i].bone[t]] |= (uint8_t)(1u << pack->group[i].kind);
        }
    }
}

static void free_clip(anim_clip_res *c) {
    core_free(c->pack);
    core_free(c->rest);
    core_free(c->moved);
    core_free(c);
}

// The skeleton's own data again, as the encoder takes it.
static void *pack_for(const anim_skeleton_res *s, const core_clip_data *d, float bound,
                      size_t *size) {
    core_vec3 *t = core_alloc(s->bones * 2u * sizeof *t), *k = t + s->bones;
    core_quat *r = core_alloc(s->bones * sizeof *r);
    anim_columns_to_pose(s->bind, s->bones, s->stride, (anim_pose){t, r, k});
    core_skeleton_data data = {.bone_count = s->bones,
                               .name = (const char(*)[CORE_NAME_MAX])s->name,
                               .parent = s->parent,
                               .translation = t,
                               .rotation = r,
                               .scale = k};
    void *bytes = anim_pack_encode(&data, d, bound, ANIM_SHELL_M, 0, size);
    core_free(t);
    core_free(r);
    return bytes;
}

static anim_pack *open_pack(const anim_clip_desc *desc) {
    return desc->packed ? anim_pack_decode(desc->packed, desc->packed_size, "compressed clip")
                        : NULL;
}

static anim_clip_res *make_clip(const anim_world *w, const anim_clip_desc *desc,
                                const anim_skeleton_res *s) {
    anim_pack *pack = open_pack(desc);
    if (desc->packed && !pack) {
        return NULL;
    }
    core_clip_data head = {0};
    if (pack) { // a clip without tracks of its own
        memcpy(head.name, pack->name, CORE_NAME_MAX);
        head.duration = pack->duration;
        head.bone_count = pack->bones;
    }
    const core_clip_data *d = pack ? &head : desc->data;
    if (!check(desc, d, s)) {
        core_free(pack);
        return NULL;
    }
    bool compress = !pack && w->pack_bound > 0;
    if (compress) {
        size_t size = 0;
        void *bytes = pack_for(s, d, w->pack_bound, &size);
        pack = bytes ? anim_pack_decode(bytes, size, d->name) : NULL;
        core_free(bytes);
        memcpy(head.name, d->name, CORE_NAME_MAX);
        head.duration = d->duration;
        head.bone_count = d->bone_count;
        d = pack ? &head : d; // what cannot be kept within the bound stays raw
    }
    anim_clip_res *c = copy_clip(desc, d);
    copy_tracks(c, d);
    if (pack) {
        prepare_pack(s, c, pack);
    }
    return c;
}

anim_clip anim_clip_create(anim_world *w, const anim_clip_desc *desc) {
    if (!desc || desc->cookie != ANIM_COOKIE || (desc->data != NULL) == (desc->packed != NULL)) {
        core_fail("anim_clip_create: expected a description made by anim_clip_desc_default() with "
                  "either data or packed bytes");
        return CORE_NULL_HANDLE;
    }
    anim_skeleton_res *s = anim_get_skeleton(w, desc->skeleton);
    anim_clip_res *c = s ? make_clip(w, desc, s) : NULL;
    if (!c) {
        return CORE_NULL_HANDLE;
    }
    if (desc->root_motion) {
        c->root_motion = true;
        c->root_bone = desc->root_bone;
        anim_root_prepare(s, c, desc->root_vertical);
    }
    core_handle h = anim_resource_add(&w->clips, c);
    if (core_handle_is_null(h)) {
        free_clip(c);
        return h;
    }
    s->users++;
    return h;
}

void *anim_clip_pack(const core_skeleton_data *skeleton, const core_clip_data *clip, float bound,
                     float shell, size_t *size) {
    return anim_pack_encode(skeleton, clip, bound, shell, 0, size);
}

bool anim_clip_packed(const anim_world *w, anim_clip h, float *error, size_t *bytes) {
    const anim_clip_res *c = anim_get_clip(w, h);
    if (!c || !c->pack) {
        return false;
    }
    *error = c->pack->error;
    *bytes = c->pack->file_bytes;
    return true;
}

void anim_clip_free(void *clip) { free_clip(clip); }

bool anim_clip_destroy(anim_world *w, anim_clip h) {
    anim_clip_res *c = anim_get_clip(w, h);
    if (!c) {
        return false;
    }
    if (c->users) {
        return core_fail("clip %s: %u states and instances still use it; destroy them first",
                         c->name, c->users);
    }
    anim_get_skeleton(w, c->skeleton)->users--;
    free_clip(c);
    return core_columns_remove(&w->clips.set, h, NULL, NULL);
}

const char *anim_clip_name(const anim_world *w, anim_clip h) {
    const anim_clip_res *c = anim_get_clip(w, h);
    return c ? c->name : "";
}

float anim_clip_duration(const anim_world *w, anim_clip h) {
    const anim_clip_res *c = anim_get_clip(w, h);
    return c ? c->duration : 0;
}

anim_clip anim_clip_find(const anim_world *w, anim_skeleton skeleton, const char *name) {
    for (uint32_t row = 0; row < core_columns_count(&w->clips.set); row++) {
        const anim_clip_res *c = w->clips.item[row];
        if (core_handle_equal(c->skeleton, skeleton) && strcmp(c->name, name) == 0) {
            return core_columns_handle(&w->clips.set, row);
        }
    }
    return CORE_NULL_HANDLE;
}

const core_key *anim_clip_keys(const anim_world *w, anim_clip h, uint32_t bone, uint32_t *count) {
    const anim_clip_res *c = anim_get_clip(w, h);
    *count = 0;
    if (!c || bone >= c->bones || c->track_of_bone[bone] < 0) {
        return NULL;
    }
    const core_clip_track *t = &c->track[c->track_of_bone[bone]];
    *count = t->key_count;
    return t->key;
}

// sin(u angle) / sin(angle) as a series in cos(angle) - 1: eight terms are exact to float up to
// half a radian between keys (Eberly, "A fast and accurate algorithm for computing SLERP", 2011).
static float slerp_weight(float u, float minus) {
    static const float a[] = {1.0f / 3,  1.0f / 10, 1.0f / 21,  1.0f / 36,
                              1.0f / 55, 1.0f / 78, 1.0f / 105, 1.0f / 136};
    static const float b[] = {1.0f / 3,  2.0f / 5,  3.0f / 7,  4.0f / 9,
                              5.0f / 11, 6.0f / 13, 7.0f / 15, 8.0f / 17};
    float square = u * u, sum = 1;
    for (int i = 7; i >= 0; i--) {
        sum = 1 + (a[i] * square - b[i]) * minus * sum;
    }
    return u * sum;
}

// Unit quaternions in, so near that nothing needs normalising; others by the full formula.
static core_quat slerp_keys(core_quat p, core_quat q, float u) {
    float dot = p.x * q.x + p.y * q.y + p.z * q.z + p.w * q.w, side = dot < 0 ? -1.0f : 1.0f;
    float minus = dot * side - 1;
    if (!(minus > -0.125f && minus < 1e-5f)) {
        return core_quat_slerp(p, q, u);
    }
    float wp = slerp_weight(1 - u, minus), wq = slerp_weight(u, minus) * side;
    return (core_quat){p.x * wp + q.x * wq, p.y * wp + q.y * wq, p.z * wp + q.z * wq,
                       p.w * wp + q.w * wq};
}

core_key anim_key_interpolate(const core_key *a, const core_key *b, float alpha) {
    core_key out;
    float left = 1 - alpha; // both ends are exact: a * 1 + b * 0
    out.time = a->time * left + b->time * alpha;
    out.translation = core_v3_mad(core_v3_scale(a->translation, left), b->translation, alpha);
    out.scale = core_v3_mad(core_v3_scale(a->scale, left), b->scale, alpha);
    out.rotation = slerp_keys(a->rotation, b->rotation, alpha);
    return out;
}

// Cubic Hermite spline of all components; rotations are normalised after.
static core_key cubic_key(const core_clip_track *t, uint32_t k, float u) {
    float d = t->key[k + 1].time - t->key[k].time, u2 = u * u, u3 = u2 * u;
    float h00 = 2 * u3 - 3 * u2 + 1, h10 = d * (u3 - 2 * u2 + u), h01 = 3 * u2 - 2 * u3;
    float h11 = d * (u3 - u2);
    const float *p0 = &t->key[k].time, *p1 = &t->key[k + 1].time;
    const float *m0 = &t->tangent[2 * k + 1].time, *m1 = &t->tangent[2 * k + 2].time;
    core_key out;
    float *o = &out.time;
    for (size_t i = 0; i < sizeof out / sizeof *o; i++) {
        o[i] = (h00 * p0[i] + h10 * m0[i]) + (h01 * p1[i] + h11 * m1[i]);
    }
    out.rotation = core_quat_normalize(out.rotation);
    return out;
}

core_key anim_track_sample(const core_clip_track *t, float time) {
    const core_key *key = t->key;
    uint32_t low = 0, high = t->key_count - 1;
    if (!(time > key[0].time)) {
        return key[0];
    }
    if (time >= key[high].time) {
        return key[high];
    }
    while (high - low > 1) {
        uint32_t middle = (low + high) / 2;
        if (key[middle].time <= time) {
            low = middle;
        } else {
            high = middle;
        }
    }
    float alpha = (time - key[low].time) / (key[high].time - key[low].time);
    switch (t->mode) {
    case CORE_KEY_STEP:
        return key[low];
    case CORE_KEY_CUBIC:
        return cubic_key(t, low, alpha);
    case CORE_KEY_LINEAR:
        break;
    }
    return anim_key_interpolate(&key[low], &key[high], alpha);
}

void anim_clip_sample_columns(const anim_skeleton_res *s, const anim_clip_res *c, float time,
                              float *out) {
    memcpy(out, c->pack ? c->rest : s->bind, ANIM_COMPONENTS * s->stride * sizeof(float));
    if (c->pack) {
        anim_pack_sample(c->pack, CORE_CLAMP(time, 0.0f, c->duration), s->stride, out);
    }
    for (uint32_t i = 0; i < c->track_count; i++) {
        core_key k = anim_track_sample(&c->track[i], time);
        float *v = out + c->track[i].bone;
        const uint32_t n = s->stride;
        v[ANIM_TX * n] = k.translation.x;
        v[ANIM_TY * n] = k.translation.y;
        v[ANIM_TZ * n] = k.translation.z;
        v[ANIM_RX * n] = k.rotation.x;
        v[ANIM_RY * n] = k.rotation.y;
        v[ANIM_RZ * n] = k.rotation.z;
        v[ANIM_RW * n] = k.rotation.w;
        v[ANIM_SX * n] = k.scale.x;
        v[ANIM_SY * n] = k.scale.y;
        v[ANIM_SZ * n] = k.scale.z;
    }
    if (c->root_motion) {
        float *x = out + ANIM_TX * s->stride + c->root_bone;
        anim_root_pin(c, x, x + s->stride, x + 2 * s->stride);
    }
}

bool anim_clip_sample(const anim_world *w, anim_clip h, float time, anim_pose out) {
    const anim_clip_res *c = anim_get_clip(w, h);
    if (!c) {
        return false;
    }
    const anim_skeleton_res *s = anim_get_skeleton(w, c->skeleton);
    core_arena *arena = anim_scratch((anim_world *)w, 0);
    size_t mark = core_arena_mark(arena);
    float *columns = anim_scratch_pose(arena, s);
    anim_clip_sample_columns(s, c, isfinite(time) ? time : 0, columns);
    anim_columns_to_pose(columns, s->bones, s->stride, out);
    core_arena_rewind(arena, mark);
    return true;
}
