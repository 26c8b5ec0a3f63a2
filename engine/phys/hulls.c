// The convex hulls of a world: built once for equal point sets, counted, and shared by shapes.
#include "phys/world.h"

#include "core/hash.h"

uint32_t phys_hull_share(phys_world *w, const phys_shape_desc *s) {
    uint64_t hash = core_hash(s->points, s->point_count * 3 * sizeof(float), s->point_count);
    uint32_t free_entry = w->hull_count;
    for (uint32_t i = 0; i < w->hull_count; i++) {
        if (w->hulls[i].users == 0) {
            free_entry = i;
        } else if (w->hulls[i].hash == hash) {
            w->hulls[i].users++;
            return i + 1;
        }
    }
    phys_geom_hull hull;
    if (!phys_geom_hull_build(&hull, (const core_vec3 *)(const void *)s->points, s->point_count)) {
        return 0;
    }
    if (hull.face_count > PHYS_HULL_FACES) {
        core_fail("phys shape hull: %u faces, expected at most %u", hull.face_count,
                  PHYS_HULL_FACES);
        phys_geom_hull_release(&hull);
        return 0;
    }
    if (free_entry == w->hull_capacity) {
        uint32_t grown = w->hull_capacity ? w->hull_capacity * 2 : 16;
        w->hulls = core_realloc(w->hulls, w->hull_capacity * sizeof(phys_hull_entry),
                                grown * sizeof(phys_hull_entry));
        w->hull_capacity = grown;
    }
    w->hull_count = CORE_MAX(w->hull_count, free_entry + 1);
    w->hulls[free_entry] = (phys_hull_entry){hull, hash, 1};
    return free_entry + 1;
}

void phys_hull_leave(phys_world *w, uint32_t number) {
    if (number != 0 && --w->hulls[number - 1].users == 0) {
        phys_geom_hull_release(&w->hulls[number - 1].hull);
    }
}

void phys_hulls_release(phys_world *w) {
    for (uint32_t i = 0; i < w->hull_count; i++) {
        if (w->hulls[i].users != 0) {
            phys_geom_hull_release(&w->hulls[i].hull);
        }
    }
    core_free(w->hulls);
}
