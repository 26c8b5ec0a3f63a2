// Animations of a glTF 2.0 file read from its own JSON and buffers: assimp 5.2.5 gives plain keys
// for STEP and CUBICSPLINE samplers and names nodes by text that need not be unique.
#include "convert.h"

#include <cJSON.h>
#include <stdio.h>
#include <string.h>

typedef struct buffer {
    uint8_t *data;
    size_t size;
} buffer;
// cJSON's arrays are linked lists: these are looked into often.
typedef struct table {
    const cJSON **item;
    uint32_t count;
} table;
typedef struct gltf {
    cv_model *m;
    cJSON *root;
    table accessors, views, nodes;
    buffer *buffer;
    uint32_t buffer_count;
    const struct aiNode **node; // [node_count] the scene's node for each of the file's
    uint32_t node_count;
    const char *lacks; // what this reader cannot do, NULL: nothing
} gltf;

static const cJSON *list(const cJSON *object, const char *key) {
    return cJSON_GetObjectItemCaseSensitive(object, key);
}
static double number(const cJSON *object, const char *key, double fallback) {
    const cJSON *v = list(object, key);
    return cJSON_IsNumber(v) ? v->valuedouble : fallback;
}
static const cJSON *item(const cJSON *root, const char *key, double index) {
    const cJSON *array = list(root, key);
    return index >= 0 && index < cJSON_GetArraySize(array) ? cJSON_GetArrayItem(array, (int)index)
                                                           : NULL;
}
static table table_of(const cJSON *array) {
    table t = {core_alloc(((size_t)cJSON_GetArraySize(array) + 1) * sizeof(void *)), 0};
    const cJSON *v;
    cJSON_ArrayForEach(v, array) { t.item[t.count++] = v; }
    return t;
}
static const cJSON *entry(const table *t, double index) {
    return index >= 0 && index < t->count ? t->item[(uint32_t)index] : NULL;
}
static uint32_t u32_at(const uint8_t *p) {
    return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

// ---- bytes ----

static int base64_value(char c) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const char *p = c ? strchr(digits, c) : NULL;
    return p ? (int)(p - digits) : -1;
}

static buffer base64(const char *text) {
    buffer b = {core_alloc(strlen(text) + 1), 0};
    uint32_t bits = 0, value = 0;
    for (; base64_value(*text) >= 0; text++) {
        value = value << 6 | (uint32_t)base64_value(*text);
        bits += 6;
        if (bits >= 8) {
            bits -= 8;
            b.data[b.size++] = (uint8_t)(value >> bits);
        }
    }
    return b;
}

static buffer external(const gltf *g, const char *uri) {
    char path[1024];
    const char *in = g->m->options->in, *slash = strrchr(in, '/');
    int folder = slash ? (int)(slash - in) + 1 : 0;
    buffer b = {0};
    if (snprintf(path, sizeof path, "%.*s%s", folder, in, uri) < (int)sizeof path) {
        b.data = cv_read_file(path, &b.size);
    }
    return b;
}

static bool read_buffers(gltf *g, const uint8_t *bin, size_t bin_size) {
    const cJSON *buffers = list(g->root, "buffers");
    g->buffer_count = (uint32_t)cJSON_GetArraySize(buffers);
    g->buffer = core_alloc((g->buffer_count + 1) * sizeof *g->buffer);
    for (uint32_t i = 0; i < g->buffer_count; i++) {
        const cJSON *uri = list(cJSON_GetArrayItem(buffers, (int)i), "uri");
        const char *data = cJSON_IsString(uri) ? strstr(uri->valuestring, ";base64,") : NULL;
        if (data) {
            g->buffer[i] = base64(data + 8);
        } else if (cJSON_IsString(uri)) {
            g->buffer[i] = external(g, uri->valuestring);
        } else if (bin) {
            g->buffer[i] = (buffer){core_alloc(bin_size + 1), bin_size};
            memcpy(g->buffer[i].data, bin, bin_size);
        }
        if (!g->buffer[i].data) {
            g->lacks = "one of its buffers cannot be read";
            return false;
        }
    }
    return true;
}

static float component(const uint8_t *p, int type, bool normalized) {
    float v = 0;
    uint32_t bits = 0;
    switch (type) {
    case 5120:
        v = (float)(int8_t)p[0];
        return normalized ? (v < -127 ? -1 : v / 127) : v;
    case 5121:
        return normalized ? (float)p[0] / 255 : (float)p[0];
    case 5122:
        v = (float)(int16_t)(p[0] | p[1] << 8);
        return normalized ? (v < -32767 ? -1 : v / 32767) : v;
    case 5123:
        v = (float)(p[0] | p[1] << 8);
        return normalized ? v / 65535 : v;
    default:
        bits = u32_at(p);
        memcpy(&v, &bits, 4);
        return v;
    }
}

// All numbers of an accessor; NULL when it leaves its buffer or is of a kind not read here.
static double *read_accessor(gltf *g, double index, uint32_t *count, uint32_t *width) {
    const cJSON *a = entry(&g->accessors, index);
    const cJSON *view = a ? entry(&g->views, number(a, "bufferView", -1)) : NULL;
    const cJSON *type = a ? list(a, "type") : NULL;
    if (!view || !cJSON_IsString(type) || list(a, "sparse")) {
        g->lacks = "an accessor is sparse or has no data";
        return NULL;
    }
    int kind = (int)number(a, "componentType", 0);
    uint32_t bytes = kind == 5120 || kind == 5121 ? 1 : kind == 5122 || kind == 5123 ? 2 : 4;
    uint32_t n = (uint32_t)number(a, "count", 0);
    *width = strcmp(type->valuestring, "SCALAR") == 0 ? 1
             : strcmp(type->valuestring, "VEC3") == 0 ? 3
             : strcmp(type->valuestring, "VEC4") == 0 ? 4
                                                      : 0;
    double b = number(view, "buffer", -1);
    size_t stride = (size_t)number(view, "byteStride", 0), element = (size_t)bytes * *width;
    size_t start = (size_t)(number(view, "byteOffset", 0) + number(a, "byteOffset", 0));
    stride = stride ? stride : element;
    bool known = kind == 5126 || (kind >= 5120 && kind <= 5123);
    if (!known || !*width || n == 0 || b < 0 || b >= g->buffer_count || n > ASSET_MAX_KEYS ||
        start > g->buffer[(int)b].size || stride > 4096 ||
        (n - 1) * stride + element > g->buffer[(int)b].size - start) {
        g->lacks = "an accessor leaves its buffer or has another type";
        return NULL;
    }
    double *out = core_alloc((size_t)n * *width * sizeof *out);
    const uint8_t *p = g->buffer[(int)b].data + start;
    bool normalized = cJSON_IsTrue(list(a, "normalized"));
    for (uint32_t i = 0; i < n; i++) {
        for (uint32_t k = 0; k < *width; k++) {
            out[i * *width + k] = (double)component(p + i * stride + k * bytes, kind, normalized);
        }
    }
    *count = n;
    return out;
}

// ---- nodes: both trees have the same shape ----

static bool pair(gltf *g, double index, const struct aiNode *node, int depth) {
    const cJSON *n = entry(&g->nodes, index);
    const cJSON *children = n ? list(n, "children") : NULL;
    if (!n || depth > 512 || (unsigned)cJSON_GetArraySize(children) != node->mNumChildren ||
        g->node[(int)index]) {
        return false;
    }
    g->node[(int)index] = node;
    for (unsigned i = 0; i < node->mNumChildren; i++) {
        const cJSON *child = cJSON_GetArrayItem(children, (int)i);
        if (!cJSON_IsNumber(child) || !pair(g, child->valuedouble, node->mChildren[i], depth + 1)) {
            return false;
        }
    }
    return true;
}

static bool pair_nodes(gltf *g) {
    const cJSON *scene = item(g->root, "scenes", number(g->root, "scene", 0));
    const cJSON *roots = scene ? list(scene, "nodes") : NULL;
    int count = cJSON_GetArraySize(roots);
    const struct aiNode *top = g->m->scene->mRootNode;
    g->nodes = table_of(list(g->root, "nodes"));
    g->node_count = g->nodes.count;
    g->node = core_alloc((g->node_count + 1) * sizeof(void *));
    bool good = count > 0;
    if (count == 1) {
        good = pair(g, cJSON_GetArrayItem(roots, 0)->valuedouble, top, 0);
    } else if ((unsigned)count == top->mNumChildren) {
        for (int i = 0; good && i < count; i++) {
            good = pair(g, cJSON_GetArrayItem(roots, i)->valuedouble, top->mChildren[i], 0);
        }
    } else {
        good = false;
    }
    if (!good) {
        g->lacks = "its tree of nodes differs from the imported one";
    }
    return good;
}

// ---- animations ----

static bool read_curve(gltf *g, const cJSON *sampler, uint32_t wanted, cv_curve *out) {
    const cJSON *how = list(sampler, "interpolation");
    const char *name = cJSON_IsString(how) ? how->valuestring : "LINEAR";
    uint32_t width, values, value_width;
    out->mode = strcmp(name, "STEP") == 0          ? CV_STEP
                : strcmp(name, "CUBICSPLINE") == 0 ? CV_CUBIC
                                                   : CV_LINEAR;
    out->time = read_accessor(g, number(sampler, "input", -1), &out->count, &width);
    out->value =
        out->time ? read_accessor(g, number(sampler, "output", -1), &values, &value_width) : NULL;
    out->width = wanted;
    if (!out->value) {
        return false;
    }
    if (width != 1 || value_width != wanted ||
        values != out->count * (out->mode == CV_CUBIC ? 3 : 1)) {
        g->lacks = "a sampler's input and output do not fit";
        return false;
    }
    for (uint32_t k = 1; k < out->count; k++) {
        if (!(out->time[k] > out->time[k - 1])) {
            g->lacks = "the times of a sampler do not grow";
            return false;
        }
    }
    return true;
}

static cv_channel *channel_for(cv_clip *clip, const struct aiNode *node) {
    for (uint32_t i = 0; i < clip->channel_count; i++) {
        if (clip->channel[i].node == node) {
            return &clip->channel[i];
        }
    }
    clip->channel[clip->channel_count].node = node;
    return &clip->channel[clip->channel_count++];
}

static bool read_channel(gltf *g, cv_clip *clip, const table *samplers, const cJSON *channel) {
    static const char *const paths[] = {"translation", "rotation", "scale"};
    const cJSON *target = list(channel, "target");
    const cJSON *path = target ? list(target, "path") : NULL;
    double node = target ? number(target, "node", -1) : -1;
    const cJSON *sampler = entry(samplers, number(channel, "sampler", -1));
    int kind = -1;
    for (int i = 0; cJSON_IsString(path) && i < 3; i++) {
        kind = strcmp(path->valuestring, paths[i]) == 0 ? i : kind;
    }
    if (kind < 0 || node < 0 || node >= g->node_count || !g->node[(int)node]) {
        cv_note_add(g->m, "dropped", "clip \"%s\": a channel of %s", clip->name,
                    cJSON_IsString(path) ? path->valuestring : "no path");
        return true;
    }
    cv_curve *curve = &channel_for(clip, g->node[(int)node])->curve[kind];
    if (!sampler || curve->count) {
        g->lacks = "two channels move one node, or a sampler is missing";
        return false;
    }
    return read_curve(g, sampler, kind == 1 ? 4 : 3, curve);
}

static bool read_clip(gltf *g, const cJSON *animation, cv_clip *clip, int number_of) {
    const cJSON *name = list(animation, "name"), *channels = list(animation, "channels"), *c;
    snprintf(clip->name, sizeof clip->name, "%s",
             cJSON_IsString(name) && name->valuestring[0] ? name->valuestring : "");
    if (!clip->name[0]) {
        snprintf(clip->name, sizeof clip->name, "animation_%d", number_of);
    }
    clip->channel = core_alloc(((size_t)cJSON_GetArraySize(channels) + 1) * sizeof *clip->channel);
    table samplers = table_of(list(animation, "samplers"));
    bool good = true;
    cJSON_ArrayForEach(c, channels) { good = good && read_channel(g, clip, &samplers, c); }
    core_free(samplers.item);
    if (!good) {
        return false;
    }
    uint32_t modes[3] = {0};
    for (uint32_t i = 0; i < clip->channel_count; i++) {
        for (int k = 0; k < 3; k++) {
            const cv_curve *curve = &clip->channel[i].curve[k];
            if (curve->count) {
                double last = curve->time[curve->count - 1];
                clip->duration = last > clip->duration ? last : clip->duration;
                modes[curve->mode]++;
            }
        }
    }
    if (modes[CV_STEP] || modes[CV_CUBIC]) {
        cv_note_add(g->m, "changed",
                    "clip \"%s\": %u STEP and %u CUBICSPLINE samplers became linear keys within "
                    "1e-5",
                    clip->name, modes[CV_STEP], modes[CV_CUBIC]);
    }
    return true;
}

static bool read_clips(gltf *g) {
    const cJSON *animations = list(g->root, "animations"), *a;
    cv_model *m = g->m;
    m->clip = core_alloc(((size_t)cJSON_GetArraySize(animations) + 1) * sizeof *m->clip);
    int count = 0;
    cJSON_ArrayForEach(a, animations) {
        if (!read_clip(g, a, &m->clip[m->clip_count], count++)) {
            return false;
        }
        m->clip_count += m->clip[m->clip_count].channel_count > 0;
    }
    return true;
}

static bool open_gltf(gltf *g, const uint8_t *data, size_t size) {
    const uint8_t *bin = NULL;
    size_t bin_size = 0;
    if (size >= 20 && memcmp(data, "glTF", 4) == 0) {
        size_t text = u32_at(data + 12);
        if (text > size - 20) {
            return false;
        }
        g->root = cJSON_ParseWithLength((const char *)data + 20, text);
        if (size - 20 - text >= 8) {
            bin_size = u32_at(data + 20 + text);
            bin = data + 28 + text;
            bin_size = bin_size > size - 28 - text ? size - 28 - text : bin_size;
        }
    } else {
        g->root = cJSON_ParseWithLength((const char *)data, size);
    }
    const cJSON *asset = g->root ? list(g->root, "asset") : NULL;
    if (!asset || !list(asset, "version")) {
        return false;
    }
    g->accessors = table_of(list(g->root, "accessors"));
    g->views = table_of(list(g->root, "bufferViews"));
    return read_buffers(g, bin, bin_size) && pair_nodes(g);
}

bool cv_gltf_clips(cv_model *m) {
    const char *dot = strrchr(m->options->in, '.');
    if (!dot || (strcmp(dot, ".gltf") != 0 && strcmp(dot, ".glb") != 0)) {
        return false;
    }
    gltf g = {.m = m};
    size_t size = 0;
    uint8_t *data = cv_read_file(m->options->in, &size);
    bool good = data && open_gltf(&g, data, size) && read_clips(&g);
    if (!good) {
        m->clip_count = 0;
        cv_note_add(m, "warning", "interpolation modes are lost: %s",
                    g.lacks ? g.lacks : "its JSON cannot be read");
    }
    for (uint32_t i = 0; i < g.buffer_count; i++) {
        core_free(g.buffer[i].data);
    }
    core_free(g.buffer);
    core_free(g.node);
    core_free(g.accessors.item);
    core_free(g.views.item);
    core_free(g.nodes.item);
    cJSON_Delete(g.root);
    core_free(data);
    return good;
}
