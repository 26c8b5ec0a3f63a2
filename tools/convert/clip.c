// Clips: curves of nodes to tracks of bones. Translation, rotation and scale are sampled by their
// own times and joined at the union of them; times are never rescaled.
#include "convert.h"

#include "anim/pack.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- from assimp ----

static cv_curve vector_curve(const struct aiVectorKey *key, unsigned count, double tps) {
    cv_curve c = {count, 3, CV_LINEAR, core_alloc((count + 1) * sizeof(double)),
                  core_alloc((count + 1) * 3 * sizeof(double))};
    for (unsigned k = 0; k < count; k++) {
        c.time[k] = key[k].mTime / tps;
        c.value[3 * k] = (double)key[k].mValue.x;
        c.value[3 * k + 1] = (double)key[k].mValue.y;
        c.value[3 * k + 2] = (double)key[k].mValue.z;
    }
    return c;
}

static cv_curve rotation_curve(const struct aiQuatKey *key, unsigned count, double tps) {
    cv_curve c = {count, 4, CV_LINEAR, core_alloc((count + 1) * sizeof(double)),
                  core_alloc((count + 1) * 4 * sizeof(double))};
    for (unsigned k = 0; k < count; k++) {
        c.time[k] = key[k].mTime / tps;
        c.value[4 * k] = (double)key[k].mValue.x;
        c.value[4 * k + 1] = (double)key[k].mValue.y;
        c.value[4 * k + 2] = (double)key[k].mValue.z;
        c.value[4 * k + 3] = (double)key[k].mValue.w;
    }
    return c;
}

static const struct aiNode *find_node(const struct aiNode *node, const char *name,
                                      uint32_t *found) {
    const struct aiNode *first = NULL;
    if (strcmp(node->mName.data, name) == 0) {
        first = node;
        (*found)++;
    }
    for (unsigned i = 0; i < node->mNumChildren; i++) {
        const struct aiNode *below = find_node(node->mChildren[i], name, found);
        first = first ? first : below;
    }
    return first;
}

static void read_channel(cv_model *m, cv_clip *clip, const struct aiNodeAnim *a, double tps) {
    uint32_t found = 0;
    const struct aiNode *node = find_node(m->scene->mRootNode, a->mNodeName.data, &found);
    if (!node) {
        cv_note_add(m, "dropped", "clip \"%s\": channel for \"%s\": there is no such node",
                    clip->name, a->mNodeName.data);
        return;
    }
    if (found > 1) {
        cv_note_add(m, "warning", "clip \"%s\": %u nodes are called \"%s\": the first one moves",
                    clip->name, found, a->mNodeName.data);
    }
    cv_channel *c = &clip->channel[clip->channel_count++];
    c->node = node;
    c->curve[0] = vector_curve(a->mPositionKeys, a->mNumPositionKeys, tps);
    c->curve[1] = rotation_curve(a->mRotationKeys, a->mNumRotationKeys, tps);
    c->curve[2] = vector_curve(a->mScalingKeys, a->mNumScalingKeys, tps);
}

static void read_assimp(cv_model *m) {
    const struct aiScene *scene = m->scene;
    m->clip = core_alloc((scene->mNumAnimations + 1) * sizeof *m->clip);
    for (unsigned i = 0; i < scene->mNumAnimations; i++) {
        const struct aiAnimation *a = scene->mAnimations[i];
        cv_clip *clip = &m->clip[m->clip_count];
        double tps = a->mTicksPerSecond;
        snprintf(clip->name, sizeof clip->name, "%.127s", a->mName.length ? a->mName.data : "clip");
        if (!(tps > 0)) {
            tps = m->options->ticks_per_second > 0 ? m->options->ticks_per_second : 25;
            cv_note_add(m, "changed",
                        "clip \"%s\": the file gives no ticks per second: %g taken (--fps)",
                        clip->name, tps);
        }
        clip->duration = a->mDuration / tps;
        clip->channel = core_alloc((a->mNumChannels + 1) * sizeof *clip->channel);
        for (unsigned k = 0; k < a->mNumChannels; k++) {
            read_channel(m, clip, a->mChannels[k], tps);
        }
        if (a->mNumMeshChannels || a->mNumMorphMeshChannels) {
            cv_note_add(m, "dropped", "clip \"%s\": %u mesh and morph channels: not supported",
                        clip->name, a->mNumMeshChannels + a->mNumMorphMeshChannels);
        }
        m->clip_count += clip->channel_count > 0;
    }
}

bool cv_clips_read(cv_model *m) {
    if (!cv_gltf_clips(m)) {
        read_assimp(m);
    }
    return true;
}

// ---- sampling ----

static void normalize(double *q) {
    double n = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (int i = 0; i < 4; i++) {
        q[i] = n > 0 ? q[i] / n : i == 3;
    }
}

static void slerp(const double *a, const double *b, double u, double *out) {
    double d = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
    double sign = d < 0 ? -1 : 1, angle = acos(fmin(1, d * sign)), s = sin(angle);
    double wa = s > 1e-9 ? sin((1 - u) * angle) / s : 1 - u;
    double wb = s > 1e-9 ? sin(u * angle) / s : u;
    for (int i = 0; i < 4; i++) {
        out[i] = a[i] * wa + b[i] * wb * sign;
    }
    normalize(out);
}

static const double *key_value(const cv_curve *c, uint32_t k) {
    return c->value + (size_t)k * c->width * (c->mode == CV_CUBIC ? 3 : 1) +
           (c->mode == CV_CUBIC ? c->width : 0);
}

// glTF 2.0, appendix C: cubic Hermite spline with tangents scaled by the interval.
static void cubic(const cv_curve *c, uint32_t k, double u, double *out) {
    double d = c->time[k + 1] - c->time[k], u2 = u * u, u3 = u2 * u;
    const double *p0 = key_value(c, k), *p1 = key_value(c, k + 1);
    const double *m0 = p0 + c->width, *m1 = p1 - c->width;
    for (uint32_t i = 0; i < c->width; i++) {
        out[i] = (2 * u3 - 3 * u2 + 1) * p0[i] + d * (u3 - 2 * u2 + u) * m0[i] +
                 (-2 * u3 + 3 * u2) * p1[i] + d * (u3 - u2) * m1[i];
    }
    if (c->width == 4) {
        normalize(out);
    }
}

void cv_curve_sample(const cv_curve *c, double time, double *out) {
    uint32_t k = 0, end = c->count;
    while (end - k > 1) {
        uint32_t middle = (k + end) / 2;
        if (c->time[middle] <= time) {
            k = middle;
        } else {
            end = middle;
        }
    }
    bool held = k + 1 == c->count || time <= c->time[k] || c->mode == CV_STEP;
    const double *a = key_value(c, k);
    if (held) {
        memcpy(out, a, c->width * sizeof(double));
        if (c->width == 4) {
            normalize(out);
        }
        return;
    }
    double u = (time - c->time[k]) / (c->time[k + 1] - c->time[k]);
    if (c->mode == CV_CUBIC) {
        cubic(c, k, u, out);
    } else if (c->width == 4) {
        double p[4], q[4];
        memcpy(p, a, sizeof p);
        memcpy(q, key_value(c, k + 1), sizeof q);
        normalize(p);
        normalize(q);
        slerp(p, q, u, out);
    } else {
        const double *b = key_value(c, k + 1);
        for (uint32_t i = 0; i < 3; i++) {
            out[i] = a[i] + (b[i] - a[i]) * u;
        }
    }
}

static const cv_channel *channel_of(const cv_clip *clip, const struct aiNode *node) {
    for (uint32_t i = 0; i < clip->channel_count; i++) {
        if (clip->channel[i].node == node) {
            return &clip->channel[i];
        }
    }
    return NULL;
}

static cv_trs node_pose(const cv_clip *clip, const struct aiNode *node, double time) {
    cv_mat fixed = cv_from_ai(&node->mTransformation);
    cv_trs p = cv_decompose(&fixed, NULL);
    const cv_channel *c = channel_of(clip, node);
    double *const part[3] = {p.t, p.r, p.s};
    for (int i = 0; c && i < 3; i++) {
        if (c->curve[i].count) {
            cv_curve_sample(&c->curve[i], time, part[i]);
        }
    }
    return p;
}

static bool has_pivots(const struct aiNode *node) {
    return node->mParent && cv_is_helper(node->mParent);
}

static cv_trs bone_pose(const cv_model *m, const cv_clip *clip, const cv_bone *bone, double time) {
    cv_trs p = node_pose(clip, bone->node, time);
    if (has_pivots(bone->node)) {
        cv_mat product = cv_compose(&p);
        for (const struct aiNode *n = bone->node->mParent; n && cv_is_helper(n); n = n->mParent) {
            cv_trs pivot = node_pose(clip, n, time);
            cv_mat local = cv_compose(&pivot);
            product = cv_mul(&local, &product);
        }
        p = cv_decompose(&product, NULL);
    }
    for (int i = 0; bone->parent < 0 && i < 3; i++) {
        p.t[i] *= m->scale;
        p.s[i] *= m->scale;
    }
    return p;
}

// ---- key times ----

typedef struct times {
    double *t;
    uint32_t count, capacity;
} times;

static void add_time(times *l, double t) {
    if (l->count == l->capacity) {
        uint32_t capacity = l->capacity ? l->capacity * 2 : 64;
        l->t = core_realloc(l->t, l->capacity * sizeof *l->t, capacity * sizeof *l->t);
        l->capacity = capacity;
    }
    l->t[l->count++] = t > 0 ? t : 0;
}

// Splits a cubic interval until the chord's middle is within 1e-5 of the spline.
static void split_cubic(times *l, const cv_curve *c, double a, double b, int depth) {
    double pa[4], pb[4], pm[4], worst = 0, middle = (a + b) / 2;
    cv_curve_sample(c, a, pa);
    cv_curve_sample(c, b, pb);
    cv_curve_sample(c, middle, pm);
    double sign = 1;
    if (c->width == 4 && pa[0] * pb[0] + pa[1] * pb[1] + pa[2] * pb[2] + pa[3] * pb[3] < 0) {
        sign = -1;
    }
    for (uint32_t i = 0; i < c->width; i++) {
        worst = fmax(worst, fabs(pm[i] - (pa[i] + pb[i] * sign) / 2));
    }
    if (depth < 3 || (worst > 1e-5 && depth < 9)) { // an S shape crosses its chord in the middle
        split_cubic(l, c, a, middle, depth + 1);
        add_time(l, middle);
        split_cubic(l, c, middle, b, depth + 1);
    }
}

static void curve_times(times *l, const cv_curve *c) {
    for (uint32_t k = 0; k < c->count; k++) {
        add_time(l, c->time[k]);
        if (c->mode == CV_STEP && k > 0 && c->time[k] > 0) {
            add_time(l, nextafterf((float)c->time[k], 0)); // holds until just before
        }
        if (c->mode == CV_CUBIC && k + 1 < c->count) {
            split_cubic(l, c, c->time[k], c->time[k + 1], 0);
        }
    }
}

static int compare_times(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

// The file keeps floats: times that become equal there are one key.
static void sort_times(times *l) {
    uint32_t n = 0;
    if (l->count) {
        qsort(l->t, l->count, sizeof *l->t, compare_times);
    }
    for (uint32_t i = 0; i < l->count; i++) {
        if (n == 0 || (float)l->t[i] > (float)l->t[n - 1]) {
            l->t[n++] = l->t[i];
        }
    }
    l->count = n;
}

// Between the keys of a chain of pivots the product is no slerp: keys at least 60 a second.
static void fill_times(times *l) {
    uint32_t keys = l->count;
    for (uint32_t i = 0; i + 1 < keys; i++) {
        double gap = l->t[i + 1] - l->t[i];
        for (int k = 1, n = (int)ceil(gap * 60 - 1e-6); k < n; k++) {
            add_time(l, l->t[i] + gap * k / n);
        }
    }
    sort_times(l);
}

static times bone_times(const cv_clip *clip, const cv_bone *bone) {
    times l = {0};
    const cv_channel *c = channel_of(clip, bone->node);
    for (int i = 0; c && i < 3; i++) {
        curve_times(&l, &c->curve[i]);
    }
    uint32_t moved_pivots = 0;
    for (const struct aiNode *n = bone->node->mParent; n && cv_is_helper(n); n = n->mParent) {
        c = channel_of(clip, n);
        for (int i = 0; c && i < 3; i++) {
            curve_times(&l, &c->curve[i]);
            moved_pivots += c->curve[i].count > 1;
        }
    }
    sort_times(&l);
    if (moved_pivots) {
        fill_times(&l);
    }
    return l;
}

// ---- tracks ----

static core_key key_of(const cv_trs *p, double time) {
    return (core_key){(float)time,
                      {(float)p->t[0], (float)p->t[1], (float)p->t[2]},
                      {(float)p->r[0], (float)p->r[1], (float)p->r[2], (float)p->r[3]},
                      {(float)p->s[0], (float)p->s[1], (float)p->s[2]}};
}

static bool same_pose(const core_key *a, const core_key *b) {
    core_quat n = {-b->rotation.x, -b->rotation.y, -b->rotation.z, -b->rotation.w};
    return memcmp(&a->translation, &b->translation, sizeof a->translation) == 0 &&
           memcmp(&a->scale, &b->scale, sizeof a->scale) == 0 &&
           (memcmp(&a->rotation, &b->rotation, sizeof n) == 0 ||
            memcmp(&a->rotation, &n, sizeof n) == 0);
}

// Keys of one bone; count 0 when it stays in its bind pose all the time.
static core_key *bone_keys(const cv_model *m, const cv_clip *clip, const cv_bone *bone,
                           uint32_t *count) {
    *count = 0;
    if (!bone->node) {
        return NULL;
    }
    times l = bone_times(clip, bone);
    core_key *key = core_alloc((l.count + 1) * sizeof *key);
    bool constant = true;
    for (uint32_t k = 0; k < l.count; k++) {
        cv_trs p = bone_pose(m, clip, bone, l.t[k]);
        key[k] = key_of(&p, l.t[k]);
        constant = constant && same_pose(&key[0], &key[k]);
    }
    core_key bind = key_of(&bone->local, 0);
    *count = l.count == 0 ? 0 : constant ? !same_pose(&key[0], &bind) : l.count;
    if (constant) {
        key[0].time = 0;
    }
    core_free(l.t);
    return key;
}

static bool clip_taken(const void *ctx, const char *name) {
    const cv_model *m = ctx;
    for (uint32_t i = 0; i < m->out.clip_count; i++) {
        if (strcmp(m->out.clip[i].name, name) == 0) {
            return true;
        }
    }
    return false;
}

static void end_of_clip(cv_model *m, const cv_clip *clip, core_clip_data *data) {
    float last = 0;
    for (uint32_t i = 0; i < data->track_count; i++) {
        last = fmaxf(last, data->track[i].key[data->track[i].key_count - 1].time);
    }
    if (!(data->duration > 0)) {
        data->duration = last > 0 ? last : 1.0f / 30;
        cv_note_add(m, "changed", "clip \"%s\": its length was %g s: now %g s", clip->name,
                    clip->duration, (double)data->duration);
    } else if (last > data->duration) {
        cv_note_add(m, "changed", "clip \"%s\": keys run to %g s beyond its %g s: now as long",
                    clip->name, (double)last, (double)data->duration);
        data->duration = last;
    } else if (last < data->duration * 0.999f && last > 0) {
        cv_note_add(m, "warning",
                    "clip \"%s\": last key at %g s of %g s: the pose holds from there", clip->name,
                    (double)last, (double)data->duration);
    }
}

// Compressed where that was asked for and the bound can be kept, else raw.
static void *encode(cv_model *m, const core_clip_data *data, size_t *size) {
    void *bytes = NULL;
    if (m->options->compress > 0) {
        core_skeleton_data *skeleton = cv_skeleton_data(m);
        bytes = anim_pack_encode(skeleton, data, (float)m->options->compress, 0.1f, 0, size);
        core_free(skeleton);
        anim_pack *pack = bytes ? anim_pack_decode(bytes, *size, data->name) : NULL;
        if (pack) {
            cv_note_add(m, "changed",
                        "clip \"%s\": compressed to %zu bytes, %.0f a bone and second, at most "
                        "%.3g mm off",
                        data->name, *size, (double)*size / m->bone_count / (double)data->duration,
                        (double)pack->error * 1000);
        } else {
            cv_note_add(m, "warning", "%s: kept raw", core_last_error());
        }
        core_free(pack);
    }
    return bytes ? bytes : asset_clip_encode(data, size);
}

static bool write_clip(cv_model *m, const cv_clip *clip) {
    core_clip_track *track = core_alloc((m->bone_count + 1) * sizeof *track);
    core_clip_data data = {
        .duration = (float)clip->duration, .bone_count = m->bone_count, .track = track};
    core_key **owned = core_alloc((m->bone_count + 1) * sizeof *owned);
    for (uint32_t b = 0; b < m->bone_count; b++) {
        uint32_t count;
        owned[b] = bone_keys(m, clip, &m->bone[b], &count);
        if (count) {
            track[data.track_count++] =
                (core_clip_track){.bone = b, .key_count = count, .key = owned[b]};
        }
    }
    end_of_clip(m, clip, &data);
    asset_model_clip *out = &m->out.clip[m->out.clip_count];
    cv_clean_name(clip->name, data.name, sizeof data.name);
    cv_unique_name(data.name, sizeof data.name, clip_taken, m);
    memcpy(out->name, data.name, sizeof out->name);
    snprintf(out->path, sizeof out->path, "%.40s_%.80s.canim", m->name, data.name);
    size_t size = 0;
    void *bytes = encode(m, &data, &size);
    bool good = bytes ? cv_write(m, out->path, bytes, size) : cv_fail(m, "%s", core_last_error());
    m->out.clip_count++;
    for (uint32_t b = 0; b < m->bone_count; b++) {
        core_free(owned[b]);
    }
    core_free(owned);
    core_free(track);
    core_free(bytes);
    return good;
}

bool cv_clips_write(cv_model *m) {
    m->out.clip = core_alloc((m->clip_count + 1) * sizeof *m->out.clip);
    for (uint32_t i = 0; i < m->clip_count; i++) {
        cv_progress(m, "clips", i, m->clip_count);
        if (!write_clip(m, &m->clip[i])) {
            return false;
        }
    }
    return true;
}
