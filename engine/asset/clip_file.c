// .canim "CAN1": raw keys in the layout of the report's fig. 13, little-endian, rotation x y z w.
#include "asset/asset.h"
#include "asset/bytes.h"

#include <string.h>

#define CLIP_MAGIC 0x314e4143u // "CAN1"
#define HEAD_BYTES 144
#define KEY_BYTES  44

static bool read_head(asset_reader *r, core_clip_data *c) {
    if (asset_read_u32(r) != CLIP_MAGIC) {
        return core_fail("%s: not a raw clip: expected it to begin with \"CAN1\"", r->path);
    }
    bool named = asset_read_name(r, c->name);
    c->duration = asset_read_f32(r);
    c->bone_count = asset_read_u32(r);
    c->track_count = asset_read_u32(r);
    if (r->failed) {
        return core_fail("%s: clip: cut off inside the header of %d bytes", r->path, HEAD_BYTES);
    }
    if (!named) {
        return core_fail("%s: clip: its name has no end within %d bytes", r->path, CORE_NAME_MAX);
    }
    if (!asset_check_finite(r->path, "duration", &c->duration, 1)) {
        return false;
    }
    if (!(c->duration > 0)) {
        return core_fail("%s: clip: duration %g s, expected > 0", r->path, c->duration);
    }
    if (c->bone_count == 0 || c->bone_count > ASSET_MAX_BONES || c->track_count > c->bone_count) {
        return core_fail("%s: clip: %u animated of %u bones; expected at most %u bones", r->path,
                         c->track_count, c->bone_count, ASSET_MAX_BONES);
    }
    return true;
}

// Walks the tracks without keeping anything: the sum of keys, or 0 when counts and size disagree.
static size_t count_keys(asset_reader r, const core_clip_data *c) {
    size_t keys = 0;
    for (uint32_t t = 0; t < c->track_count; t++) {
        uint32_t bone = asset_read_u32(&r), count = asset_read_u32(&r);
        if (r.failed || count == 0 || count > asset_reader_left(&r) / KEY_BYTES ||
            count > ASSET_MAX_KEYS - keys) {
            core_fail("%s: clip: track %u (bone %u) has %u keys in the %zu bytes left; expected "
                      "1 or more keys of %d bytes",
                      r.path, t, bone, count, asset_reader_left(&r), KEY_BYTES);
            return SIZE_MAX;
        }
        asset_read_bytes(&r, (size_t)count * KEY_BYTES);
        keys += count;
    }
    if (asset_reader_left(&r) != 0) {
        core_fail("%s: clip: %zu bytes after the last track, expected none", r.path,
                  asset_reader_left(&r));
        return SIZE_MAX;
    }
    return keys;
}

static bool check_keys(const core_clip_track *t, const char *path) {
    for (uint32_t k = 0; k < t->key_count; k++) {
        const core_key *key = &t->key[k];
        if (!asset_check_finite(path, "time", &key->time, 1) ||
            !asset_check_finite(path, "translation", &key->translation.x, 3) ||
            !asset_check_finite(path, "rotation", &key->rotation.x, 4) ||
            !asset_check_finite(path, "scale", &key->scale.x, 3) ||
            !asset_check_rotation(path, "key", k, key->rotation)) {
            return false;
        }
        if (key->time < 0 || (k > 0 && !(key->time > t->key[k - 1].time))) {
            return core_fail("%s: clip: bone %u: key %u at %g s; expected times >= 0 that grow",
                             path, t->bone, k, key->time);
        }
    }
    return true;
}

static bool check_tracks(const core_clip_data *c, const char *path) {
    for (uint32_t t = 0; t < c->track_count; t++) {
        const core_clip_track *track = &c->track[t];
        if (track->bone >= c->bone_count || (t > 0 && track->bone <= c->track[t - 1].bone)) {
            return core_fail("%s: clip: track %u is for bone %u; expected ascending bones below %u",
                             path, t, track->bone, c->bone_count);
        }
        if (!check_keys(track, path)) {
            return false;
        }
    }
    return true;
}

static void read_tracks(asset_reader *r, core_clip_data *c, core_clip_track *track, core_key *key) {
    for (uint32_t t = 0; t < c->track_count; t++) {
        uint32_t bone = asset_read_u32(r), count = asset_read_u32(r);
        track[t] = (core_clip_track){.bone = bone, .key_count = count, .key = key};
        for (uint32_t k = 0; k < count; k++, key++) {
            key->time = asset_read_f32(r);
            asset_read_f32s(r, &key->translation.x, 3);
            asset_read_f32s(r, &key->rotation.x, 4);
            asset_read_f32s(r, &key->scale.x, 3);
        }
    }
}

core_clip_data *asset_clip_decode(const void *bytes, size_t size, const char *path) {
    asset_reader r = asset_reader_make(bytes, size, path);
    core_clip_data head = {0};
    if (!read_head(&r, &head)) {
        return NULL;
    }
    size_t keys = count_keys(r, &head);
    if (keys == SIZE_MAX) {
        return NULL;
    }
    asset_block block = asset_block_make(asset_round(sizeof(core_clip_data)) +
                                         asset_round(head.track_count * sizeof(core_clip_track)) +
                                         asset_round(keys * sizeof(core_key)));
    core_clip_data *c = asset_block_take(&block, sizeof *c);
    core_clip_track *track = asset_block_take(&block, head.track_count * sizeof *track);
    core_key *key = asset_block_take(&block, keys * sizeof *key);
    *c = head;
    c->track = track;
    read_tracks(&r, c, track, key);
    if (!check_tracks(c, r.path)) {
        core_free(c);
        return NULL;
    }
    return c;
}

static void *decode_any(const void *bytes, size_t size, const char *path) {
    return asset_clip_decode(bytes, size, path);
}

core_clip_data *asset_clip_load(core_vfs *vfs, const char *path) {
    return asset_load(vfs, path, decode_any);
}

static void write_key(asset_writer *w, const core_key *k) {
    const float f[11] = {k->time,       k->translation.x, k->translation.y, k->translation.z,
                         k->rotation.x, k->rotation.y,    k->rotation.z,    k->rotation.w,
                         k->scale.x,    k->scale.y,       k->scale.z};
    for (int i = 0; i < 11; i++) {
        asset_write_f32(w, f[i]);
    }
}

void *asset_clip_encode(const core_clip_data *c, size_t *size) {
    if (!(c->duration > 0) || c->bone_count == 0 || c->bone_count > ASSET_MAX_BONES) {
        core_fail("clip to write (%s): duration %g s for %u bones; expected > 0 and 1..%u", c->name,
                  c->duration, c->bone_count, ASSET_MAX_BONES);
        return NULL;
    }
    if (!check_tracks(c, "clip to write")) {
        return NULL;
    }
    asset_writer w = {0};
    asset_write_u32(&w, CLIP_MAGIC);
    asset_write_name(&w, c->name);
    asset_write_f32(&w, c->duration);
    asset_write_u32(&w, c->bone_count);
    asset_write_u32(&w, c->track_count);
    for (uint32_t t = 0; t < c->track_count; t++) {
        asset_write_u32(&w, c->track[t].bone);
        asset_write_u32(&w, c->track[t].key_count);
        for (uint32_t k = 0; k < c->track[t].key_count; k++) {
            write_key(&w, &c->track[t].key[k]);
        }
    }
    *size = w.size;
    return w.data;
}
