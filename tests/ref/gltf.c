#include "ref/gltf.h"

#include <cJSON.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct mat {
    double m[16]; // column-major, as in the file
} mat;

struct gltf {
    cJSON *root;
    uint8_t *data[16];
    size_t size[16];
    int nodes;
    double (*trs)[10]; // t, r, s of each node at the asked time
    double (*rest)[10];
    mat *given, *global; // matrix of nodes that have one; model space
    int *has_matrix, *moved;
};

static const cJSON *get(const cJSON *o, const char *key) {
    return o ? cJSON_GetObjectItemCaseSensitive(o, key) : NULL;
}
static int get_int(const cJSON *o, const char *key, int fallback) {
    const cJSON *v = get(o, key);
    return cJSON_IsNumber(v) ? v->valueint : fallback;
}
static const cJSON *at(const gltf *g, const char *list, int i) {
    return i < 0 ? NULL : cJSON_GetArrayItem(get(g->root, list), i);
}

// ---- file ----

static uint8_t *read_all(const char *path, size_t *size) {
    FILE *f = fopen(path, "rb");
    if (!f) {
        return NULL;
    }
    fseek(f, 0, SEEK_END);
    *size = (size_t)ftell(f);
    rewind(f);
    uint8_t *data = malloc(*size + 1);
    data[*size] = 0;
    if (fread(data, 1, *size, f) != *size) {
        free(data);
        data = NULL;
    }
    fclose(f);
    return data;
}

static size_t decode64(const char *in, uint8_t *out) {
    size_t n = 0;
    unsigned held = 0, bits = 0;
    for (; *in && *in != '='; in++) {
        unsigned v = *in >= 'A' && *in <= 'Z'   ? (unsigned)(*in - 'A')
                     : *in >= 'a' && *in <= 'z' ? (unsigned)(*in - 'a') + 26
                     : *in >= '0' && *in <= '9' ? (unsigned)(*in - '0') + 52
                     : *in == '+'               ? 62
                                                : 63;
        held = held << 6 | v;
        bits += 6;
        if (bits >= 8) {
            bits -= 8;
            out[n++] = (uint8_t)(held >> bits);
        }
    }
    return n;
}

static void load_buffer(gltf *g, int i, const char *path, const uint8_t *chunk, size_t chunk_size) {
    const cJSON *uri = get(at(g, "buffers", i), "uri");
    if (!cJSON_IsString(uri)) {
        g->data[i] = malloc(chunk_size + 1);
        memcpy(g->data[i], chunk, chunk_size);
        g->size[i] = chunk_size;
    } else if (strncmp(uri->valuestring, "data:", 5) == 0) {
        const char *text = strchr(uri->valuestring, ',') + 1;
        g->data[i] = malloc(strlen(text) + 1);
        g->size[i] = decode64(text, g->data[i]);
    } else {
        char other[1024];
        const char *slash = strrchr(path, '/');
        snprintf(other, sizeof other, "%.*s/%s", (int)(slash - path), path, uri->valuestring);
        g->data[i] = read_all(other, &g->size[i]);
    }
}

static double value(const uint8_t *p, int type, int normalized) {
    float f;
    uint32_t u;
    switch (type) {
    case 5121:
        return normalized ? p[0] / 255.0 : p[0];
    case 5123:
        return normalized ? (p[0] | p[1] << 8) / 65535.0 : (p[0] | p[1] << 8);
    case 5125:
        memcpy(&u, p, 4);
        return u;
    case 5126:
        memcpy(&f, p, 4);
        return (double)f;
    default:
        abort(); // not in the test models
    }
}

static double *accessor(const gltf *g, int index, int *count, int *width) {
    const cJSON *a = at(g, "accessors", index);
    const cJSON *view = at(g, "bufferViews", get_int(a, "bufferView", -1));
    const char *type = get(a, "type")->valuestring;
    int kind = get_int(a, "componentType", 0);
    int bytes = kind == 5121 ? 1 : kind == 5123 ? 2 : 4;
    *count = get_int(a, "count", 0);
    *width = type[0] == 'S' ? 1 : type[0] == 'M' ? 16 : type[3] - '0';
    int stride = get_int(view, "byteStride", *width * bytes);
    const uint8_t *p = g->data[get_int(view, "buffer", 0)] + get_int(view, "byteOffset", 0) +
                       get_int(a, "byteOffset", 0);
    double *out = malloc((size_t)*count * (size_t)*width * sizeof *out);
    for (int i = 0; i < *count; i++) {
        for (int k = 0; k < *width; k++) {
            out[i * *width + k] = value(p + (size_t)i * (size_t)stride + k * bytes, kind,
                                        cJSON_IsTrue(get(a, "normalized")));
        }
    }
    return out;
}

static void read_numbers(const cJSON *list, double *out) {
    const cJSON *v;
    cJSON_ArrayForEach(v, list) { *out++ = v->valuedouble; }
}

static void read_nodes(gltf *g) {
    g->nodes = cJSON_GetArraySize(get(g->root, "nodes"));
    size_t n = (size_t)g->nodes;
    g->trs = calloc(n, sizeof *g->trs);
    g->rest = calloc(n, sizeof *g->rest);
    g->given = calloc(n, sizeof *g->given);
    g->global = calloc(n, sizeof *g->global);
    g->has_matrix = calloc(n, sizeof *g->has_matrix);
    g->moved = calloc(n, sizeof *g->moved);
    for (int i = 0; i < g->nodes; i++) {
        const cJSON *node = at(g, "nodes", i);
        double *v = g->rest[i];
        v[6] = v[7] = v[8] = v[9] = 1;
        read_numbers(get(node, "translation"), v);
        read_numbers(get(node, "rotation"), v + 3);
        read_numbers(get(node, "scale"), v + 7);
        g->has_matrix[i] = get(node, "matrix") != NULL;
        read_numbers(get(node, "matrix"), g->given[i].m);
    }
}

gltf *gltf_open(const char *path) {
    size_t size = 0;
    uint8_t *file = read_all(path, &size);
    if (!file) {
        return NULL;
    }
    gltf *g = calloc(1, sizeof *g);
    const uint8_t *chunk = NULL;
    size_t chunk_size = 0;
    if (memcmp(file, "glTF", 4) == 0) {
        uint32_t text, bin;
        memcpy(&text, file + 12, 4);
        memcpy(&bin, file + 20 + text, 4);
        g->root = cJSON_ParseWithLength((const char *)file + 20, text);
        chunk = file + 28 + text;
        chunk_size = bin;
    } else {
        g->root = cJSON_Parse((const char *)file);
    }
    int buffers = cJSON_GetArraySize(get(g->root, "buffers"));
    for (int i = 0; i < buffers && i < 16; i++) {
        load_buffer(g, i, path, chunk, chunk_size);
    }
    read_nodes(g);
    free(file);
    return g;
}

void gltf_close(gltf *g) {
    void *const blocks[] = {g->trs, g->rest, g->given, g->global, g->has_matrix, g->moved};
    for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++) {
        free(blocks[i]);
    }
    for (int i = 0; i < 16; i++) {
        free(g->data[i]);
    }
    cJSON_Delete(g->root);
    free(g);
}

// ---- animation ----

int gltf_animation_count(const gltf *g) { return cJSON_GetArraySize(get(g->root, "animations")); }

static void unit(double *q) {
    double n = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (int i = 0; i < 4; i++) {
        q[i] /= n;
    }
}

static void slerp(const double *a, const double *b, double u, double *out) {
    double d = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3], s = d < 0 ? -1 : 1;
    double angle = acos(fmin(1, fabs(d)));
    for (int i = 0; i < 4; i++) {
        out[i] = angle < 1e-7
                     ? a[i] * (1 - u) + b[i] * u * s
                     : (a[i] * sin((1 - u) * angle) + b[i] * s * sin(u * angle)) / sin(angle);
    }
    unit(out);
}

// Specification, appendix C.
static void interpolate(const char *mode, const double *time, const double *v, int keys, int n,
                        double t, double *out) {
    int cubic = strcmp(mode, "CUBICSPLINE") == 0, k = 0, block = cubic ? 3 * n : n;
    while (k + 1 < keys && time[k + 1] <= t) {
        k++;
    }
    const double *p0 = v + k * block + (cubic ? n : 0);
    if (t <= time[0] || k + 1 == keys || strcmp(mode, "STEP") == 0) {
        memcpy(out, p0, (size_t)n * sizeof *out);
        if (n == 4) {
            unit(out);
        }
        return;
    }
    const double *p1 = p0 + block;
    double d = time[k + 1] - time[k], u = (t - time[k]) / d, u2 = u * u, u3 = u2 * u;
    if (!cubic && n == 4) {
        double a[4], b[4];
        memcpy(a, p0, sizeof a);
        memcpy(b, p1, sizeof b);
        unit(a);
        unit(b);
        slerp(a, b, u, out);
        return;
    }
    for (int i = 0; i < n; i++) {
        out[i] = !cubic ? p0[i] + (p1[i] - p0[i]) * u
                        : (2 * u3 - 3 * u2 + 1) * p0[i] + d * (u3 - 2 * u2 + u) * p0[n + i] +
                              (3 * u2 - 2 * u3) * p1[i] + d * (u3 - u2) * p1[i - n];
    }
    if (n == 4) {
        unit(out);
    }
}

static void animate(gltf *g, int animation, double time) {
    memcpy(g->trs, g->rest, (size_t)g->nodes * sizeof *g->trs);
    memset(g->moved, 0, (size_t)g->nodes * sizeof *g->moved);
    const cJSON *a = at(g, "animations", animation), *channel;
    cJSON_ArrayForEach(channel, get(a, "channels")) {
        const cJSON *sampler =
            cJSON_GetArrayItem(get(a, "samplers"), get_int(channel, "sampler", 0));
        const cJSON *target = get(channel, "target"), *mode = get(sampler, "interpolation");
        const char *path = get(target, "path")->valuestring;
        int node = get_int(target, "node", -1), keys, one, values, n;
        if (node < 0 || strcmp(path, "weights") == 0) {
            continue;
        }
        double *times = accessor(g, get_int(sampler, "input", -1), &keys, &one);
        double *v = accessor(g, get_int(sampler, "output", -1), &values, &n);
        int first = path[0] == 't' ? 0 : path[0] == 'r' ? 3 : 7;
        interpolate(mode ? mode->valuestring : "LINEAR", times, v, keys, n, time,
                    g->trs[node] + first);
        g->moved[node] = 1;
        free(times);
        free(v);
    }
}

double gltf_animation_end(gltf *g, int animation) {
    const cJSON *a = at(g, "animations", animation), *sampler;
    double end = 0;
    cJSON_ArrayForEach(sampler, get(a, "samplers")) {
        int keys, one;
        double *times = accessor(g, get_int(sampler, "input", -1), &keys, &one);
        end = fmax(end, times[keys - 1]);
        free(times);
    }
    return end;
}

// ---- positions ----

static mat times_mat(const mat *a, const mat *b) {
    mat out;
    for (int c = 0; c < 4; c++) {
        for (int r = 0; r < 4; r++) {
            double sum = 0;
            for (int k = 0; k < 4; k++) {
                sum += a->m[4 * k + r] * b->m[4 * c + k];
            }
            out.m[4 * c + r] = sum;
        }
    }
    return out;
}

static mat local_of(const gltf *g, int i) {
    if (g->has_matrix[i] && !g->moved[i]) {
        return g->given[i];
    }
    const double *v = g->trs[i], x = v[3], y = v[4], z = v[5], w = v[6];
    const double r[9] = {1 - 2 * (y * y + z * z), 2 * (x * y + w * z),     2 * (x * z - w * y),
                         2 * (x * y - w * z),     1 - 2 * (x * x + z * z), 2 * (y * z + w * x),
                         2 * (x * z + w * y),     2 * (y * z - w * x),     1 - 2 * (x * x + y * y)};
    mat out = {{0}};
    for (int c = 0; c < 3; c++) {
        for (int k = 0; k < 3; k++) {
            out.m[4 * c + k] = r[3 * c + k] * v[7 + c];
        }
        out.m[12 + c] = v[c];
    }
    out.m[15] = 1;
    return out;
}

static void place(gltf *g, int node, const mat *above) {
    mat local = local_of(g, node);
    g->global[node] = above ? times_mat(above, &local) : local;
    const cJSON *child;
    cJSON_ArrayForEach(child, get(at(g, "nodes", node), "children")) {
        place(g, child->valueint, &g->global[node]);
    }
}

static void add_point(const mat *m, const double *p, double weight, double *out) {
    for (int r = 0; r < 3; r++) {
        out[r] +=
            weight * (m->m[r] * p[0] + m->m[4 + r] * p[1] + m->m[8 + r] * p[2] + m->m[12 + r]);
    }
}

static void skinned(const gltf *g, const cJSON *skin, const double *bind, const double *joint,
                    const double *weight, const double *p, double *out) {
    double sum = weight[0] + weight[1] + weight[2] + weight[3];
    for (int k = 0; k < 4; k++) {
        if (weight[k] > 0) {
            int j = (int)joint[k];
            mat inverse;
            memcpy(inverse.m, bind + 16 * j, sizeof inverse.m);
            const cJSON *node = cJSON_GetArrayItem(get(skin, "joints"), j);
            mat m = times_mat(&g->global[node->valueint], &inverse);
            add_point(&m, p, weight[k] / sum, out);
        }
    }
}

static size_t primitive(const gltf *g, int node, const cJSON *prim, double *out) {
    const cJSON *attributes = get(prim, "attributes");
    const cJSON *skin = at(g, "skins", get_int(at(g, "nodes", node), "skin", -1));
    int vertices, width, corners, n;
    if (get_int(prim, "mode", 4) != 4) {
        return 0;
    }
    double *p = accessor(g, get_int(attributes, "POSITION", -1), &vertices, &width), *index = NULL;
    double *joint = NULL, *weight = NULL, *bind = NULL, *all = NULL;
    corners = vertices;
    if (get(prim, "indices")) {
        index = accessor(g, get_int(prim, "indices", -1), &corners, &width);
    }
    if (skin && out) {
        joint = accessor(g, get_int(attributes, "JOINTS_0", -1), &n, &width);
        weight = accessor(g, get_int(attributes, "WEIGHTS_0", -1), &n, &width);
        bind = accessor(g, get_int(skin, "inverseBindMatrices", -1), &n, &width);
    }
    if (out) {
        all = calloc((size_t)vertices, 3 * sizeof *all);
        for (int i = 0; i < vertices; i++) {
            if (skin) {
                skinned(g, skin, bind, joint + 4 * i, weight + 4 * i, p + 3 * i, all + 3 * i);
            } else {
                add_point(&g->global[node], p + 3 * i, 1, all + 3 * i);
            }
        }
        for (int i = 0; i < corners; i++) {
            memcpy(out + 3 * i, all + 3 * (index ? (int)index[i] : i), 3 * sizeof *out);
        }
    }
    free(p);
    free(index);
    free(joint);
    free(weight);
    free(bind);
    free(all);
    return (size_t)corners;
}

static size_t walk(const gltf *g, int node, double *out) {
    size_t n = 0;
    const cJSON *mesh = at(g, "meshes", get_int(at(g, "nodes", node), "mesh", -1)), *part;
    cJSON_ArrayForEach(part, get(mesh, "primitives")) {
        n += primitive(g, node, part, out ? out + 3 * n : NULL);
    }
    cJSON_ArrayForEach(part, get(at(g, "nodes", node), "children")) {
        n += walk(g, part->valueint, out ? out + 3 * n : NULL);
    }
    return n;
}

size_t gltf_corners(gltf *g, int animation, double time, double *out) {
    const cJSON *scene = at(g, "scenes", get_int(g->root, "scene", 0)), *node;
    size_t n = 0;
    animate(g, animation, time);
    cJSON_ArrayForEach(node, get(scene, "nodes")) {
        place(g, node->valueint, NULL);
        n += walk(g, node->valueint, out ? out + 3 * n : NULL);
    }
    return n;
}
