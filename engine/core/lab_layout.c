// Lab kernel "layout": the engine's own shape put to the test. Bodies, lights, bones and nav nodes
// as an array of structures, as a structure of arrays, and as arrays of 16-wide blocks (AoSoA);
// touched in order with few fields, in order with all fields, and in random order. ns per element.
#include <string.h>

#include "core/lab.h"
#include "core/memory.h"
#include "core/rng.h"

#define BLOCK 16

// A record of `fields` floats; an access reads `used` of them and writes one. The field counts are
// those of the report's structures in single precision.
typedef struct record {
    const char *name;
    uint32_t fields; // floats per element
    uint32_t few;    // fields that the common loop touches
} record;

static const record records[] = {
    {"body", 44, 7},     // pose, velocities, mass, inertia, material; integrate: position, velocity
    {"light", 12, 4},    // position, radius, colour, direction, cone; assign: position and radius
    {"bone", 20, 10},    // translation, rotation, scale, parent, flags; sample: the transform
    {"nav_node", 20, 3}, // position, links, costs; nearest: the position
};

typedef struct arrays {
    float *data;
    uint32_t *order;
    uint32_t n, fields, used;
    int layout; // 0 AoS, 1 SoA, 2 AoSoA
    bool random;
} arrays;

static inline size_t place(const arrays *a, uint32_t i, uint32_t f) {
    switch (a->layout) {
    case 0:
        return (size_t)i * a->fields + f;
    case 1:
        return (size_t)f * a->n + i;
    default:
        return ((size_t)(i / BLOCK) * a->fields + f) * BLOCK + i % BLOCK;
    }
}

// In order, element by element where fields lie together, field by field where lanes do: each
// layout by the loop that suits it, each the same arithmetic.
static void in_order_aos(const arrays *a) {
    for (uint32_t i = 0; i < a->n; i++) {
        float *e = a->data + (size_t)i * a->fields, sum = 0;
        for (uint32_t f = 1; f < a->used; f++) {
            sum += e[f];
        }
        e[0] += 0.001f * sum;
    }
}

static void in_order_lanes(const arrays *a, size_t block_stride, size_t field_stride,
                           uint32_t blocks) {
    for (uint32_t b = 0; b < blocks; b++) {
        float *base = a->data + b * block_stride;
        float sum[BLOCK] = {0};
        for (uint32_t f = 1; f < a->used; f++) {
            const float *lane = base + f * field_stride;
            for (int k = 0; k < BLOCK; k++) {
                sum[k] += lane[k];
            }
        }
        for (int k = 0; k < BLOCK; k++) {
            base[k] += 0.001f * sum[k];
        }
    }
}

static void in_random_order(const arrays *a) {
    for (uint32_t k = 0; k < a->n; k++) {
        uint32_t i = a->order[k];
        float sum = 0;
        for (uint32_t f = 1; f < a->used; f++) {
            sum += a->data[place(a, i, f)];
        }
        a->data[place(a, i, 0)] += 0.001f * sum;
    }
}

static void touch(void *ctx) {
    const arrays *a = ctx;
    if (a->random) {
        in_random_order(a);
    } else if (a->layout == 0) {
        in_order_aos(a);
    } else if (a->layout == 1) {
        in_order_lanes(a, BLOCK, a->n, a->n / BLOCK);
    } else {
        in_order_lanes(a, (size_t)BLOCK * a->fields, BLOCK, a->n / BLOCK);
    }
}

static void fill(arrays *a, uint64_t seed) {
    core_rng rng = core_rng_make(seed, CORE_RNG_ENGINE);
    for (uint32_t i = 0; i < a->n; i++) {
        for (uint32_t f = 0; f < a->fields; f++) {
            a->data[place(a, i, f)] = core_rng_float(&rng);
        }
        a->order[i] = i;
    }
    for (uint32_t i = a->n; i > 1; i--) { // Fisher and Yates
        uint32_t j = core_rng_below(&rng, i), swap = a->order[i - 1];
        a->order[i - 1] = a->order[j];
        a->order[j] = swap;
    }
}

static double checksum(const arrays *a) {
    double sum = 0;
    for (uint32_t i = 0; i < a->n; i++) {
        sum += (double)a->data[place(a, i, 0)];
    }
    return sum;
}

static bool run(const core_lab_case *c, core_json *out) {
    static const char *const layouts[] = {"AoS", "SoA", "AoSoA"};
    const char *layout = core_lab_text(c, "method", "SoA");
    const char *name = core_lab_text(c, "record", "body");
    const char *access = core_lab_text(c, "access", "few");
    arrays a = {.layout = -1};
    for (int i = 0; i < 3; i++) {
        a.layout = strcmp(layouts[i], layout) == 0 ? i : a.layout;
    }
    const record *r = NULL;
    for (size_t i = 0; i < CORE_COUNT_OF(records); i++) {
        r = strcmp(records[i].name, name) == 0 ? &records[i] : r;
    }
    double n = core_lab_number(c, "n", 16384);
    if (a.layout < 0 || !r || !(n >= BLOCK && n <= 1 << 22)) {
        return core_fail("lab kernel layout: method AoS, SoA or AoSoA, record body, light, bone or "
                         "nav_node, n 16 to 4194304 expected; got '%s', '%s', %g",
                         layout, name, n);
    }
    a.n = (uint32_t)n / BLOCK * BLOCK;
    a.fields = r->fields;
    a.used = strcmp(access, "all") == 0 ? r->fields : r->few;
    a.random = strcmp(access, "random") == 0;
    size_t bytes = sizeof(float) * a.fields * a.n;
    core_arena arena;
    if (!core_arena_init(&arena, "lab layout", bytes + 4 * (size_t)a.n + 4096)) {
        return false;
    }
    a.data = core_arena_alloc(&arena, bytes, "records");
    a.order = core_arena_alloc(&arena, 4 * (size_t)a.n, "order");
    fill(&a, (uint64_t)core_lab_number(c, "seed", 1));
    touch(&a);
    core_json_number(out, "checksum", checksum(&a)); // one for all layouts: the same arithmetic
    if (core_lab_number(c, "timed", 0) > 0) {
        core_json_number(out, "cost_ns", core_lab_time(touch, &a, 2e7) / a.n);
    }
    core_arena_release(&arena);
    return true;
}

const core_lab_kernel core_lab_layout = {"layout",
                                         "ns per element of AoS, SoA and AoSoA by access pattern",
                                         "method: AoS|SoA|AoSoA; record: body|light|bone|nav_node; "
                                         "access: few|all|random; n, seed, timed",
                                         run};
