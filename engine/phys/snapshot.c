// A world's whole state in one block of memory: for rollback and saved games.
#include "phys/world.h"

#include <string.h>

#define SNAPSHOT_MAGIC 0x32536870u // "phS2"

typedef struct header {
    uint32_t magic, sets;
    uint64_t bytes;
    core_vec3 gravity;
    uint32_t rule[32];
    double time;
} header;

size_t phys_world_save_size(phys_world *w) {
    core_columns *set[PHYS_SETS];
    const int n = PHYS_SETS;
    phys_world_sets(w, set);
    size_t bytes = sizeof(header);
    for (int i = 0; i < n; i++) {
        bytes += sizeof(uint64_t) + (core_columns_save_size(set[i]) + 7) / 8 * 8;
    }
    return bytes;
}

void phys_world_save(phys_world *w, void *out) {
    core_columns *set[PHYS_SETS];
    const int n = PHYS_SETS;
    phys_world_sets(w, set);
    header h = {SNAPSHOT_MAGIC, (uint32_t)n, phys_world_save_size(w), w->gravity, {0}, w->time};
    memcpy(h.rule, w->rule, sizeof h.rule);
    memset(out, 0, (size_t)h.bytes);
    uint8_t *at = out;
    memcpy(at, &h, sizeof h);
    at += sizeof h;
    for (int i = 0; i < n; i++) {
        uint64_t size = core_columns_save_size(set[i]);
        memcpy(at, &size, sizeof size);
        core_columns_save(set[i], at + sizeof size);
        at += sizeof size + (size + 7) / 8 * 8;
    }
}

// Checks the frame before anything is changed; each set then checks its own part.
bool phys_world_restore(phys_world *w, const void *data, size_t size) {
    core_columns *set[PHYS_SETS];
    const int n = PHYS_SETS;
    phys_world_sets(w, set);
    header h;
    if (size < sizeof h) {
        return core_fail("phys restore: %zu bytes are no snapshot", size);
    }
    memcpy(&h, data, sizeof h);
    if (h.magic != SNAPSHOT_MAGIC || h.sets != (uint32_t)n || h.bytes != size) {
        return core_fail("phys restore: not a snapshot of this version (%zu bytes)", size);
    }
    const uint8_t *at = (const uint8_t *)data + sizeof h, *end = (const uint8_t *)data + size;
    for (int i = 0; i < n; i++) {
        uint64_t part;
        if ((size_t)(end - at) < sizeof part) {
            return core_fail("phys restore: the snapshot is cut short");
        }
        memcpy(&part, at, sizeof part);
        if (part > (size_t)(end - at) - sizeof part ||
            !core_columns_restore(set[i], at + sizeof part, (size_t)part)) {
            return core_fail("phys restore: part %d (%s) does not fit", i, set[i]->name);
        }
        at += sizeof part + (part + 7) / 8 * 8;
    }
    w->gravity = h.gravity;
    w->time = h.time;
    memcpy(w->rule, h.rule, sizeof h.rule);
    phys_world_restored(w);
    return true;
}

void phys_world_restored(phys_world *w) {
    phys_pairs_rebuild_map(w);
    phys_static_forget(w);
    w->trees_stale = w->rows_stale = w->edited = w->joint_pairs.stale = true;
    w->measured = false;
    w->order_count = 0;
    w->events.count = w->pending.count = 0;
    for (uint32_t i = 0; i < core_columns_count(&w->bodies.set); i++) {
        w->bodies.seen[i] = phys_get3(w->bodies.cx, w->bodies.cy, w->bodies.cz, i);
    }
}
