// Tags, and finding entities by tags, components and place.
#include <math.h>
#include <string.h>

#include "scene/scene_internal.h"

#define QUERY_COOKIE 0x5ce7e003u

int scene_tag(scene *s, const char *name) {
    for (uint32_t i = 0; i < s->tag_count; i++) {
        if (strcmp(s->tag[i], name) == 0) {
            return (int)i;
        }
    }
    if (!name[0] || strlen(name) >= SCENE_TAG_NAME || s->tag_count == SCENE_MAX_TAGS) {
        core_fail("tag '%.40s': at most %d tags, with names of 1 to %d bytes", name, SCENE_MAX_TAGS,
                  SCENE_TAG_NAME - 1);
        return -1;
    }
    if (!s->tag) {
        s->tag = core_alloc(sizeof *s->tag * SCENE_MAX_TAGS);
    }
    strcpy(s->tag[s->tag_count], name);
    return (int)s->tag_count++;
}

bool scene_set_tag(scene *s, scene_entity e, const char *name, bool on) {
    uint32_t row = scene_row(s, e);
    int tag = row == CORE_NO_ROW ? -1 : scene_tag(s, name);
    if (tag < 0) {
        return false;
    }
    uint64_t bit = (uint64_t)1 << tag;
    s->entity.tags[row] = on ? s->entity.tags[row] | bit : s->entity.tags[row] & ~bit;
    return true;
}

bool scene_has_tag(const scene *s, scene_entity e, const char *name) {
    uint32_t row = core_columns_row(&s->entity.set, e);
    for (uint32_t i = 0; row != CORE_NO_ROW && i < s->tag_count; i++) {
        if (strcmp(s->tag[i], name) == 0) {
            return (s->entity.tags[row] >> i & 1) != 0;
        }
    }
    return false;
}

scene_query scene_query_default(void) {
    return (scene_query){.min = {-INFINITY, -INFINITY, -INFINITY},
                         .max = {INFINITY, INFINITY, INFINITY},
                         .radius = INFINITY,
                         .cookie = QUERY_COOKIE};
}

static uint32_t components(const scene_entities *e, uint32_t row) {
    return (core_handle_is_null(e->body[row]) ? 0 : SCENE_HAS_BODY) |
           (core_handle_is_null(e->instance[row]) ? 0 : SCENE_HAS_MESH) |
           (core_handle_is_null(e->anim[row]) ? 0 : SCENE_HAS_ANIM) |
           (core_handle_is_null(e->agent[row]) ? 0 : SCENE_HAS_AGENT) |
           (core_handle_is_null(e->source[row]) ? 0 : SCENE_HAS_SOUND);
}

static bool matches(const scene *s, const scene_query *q, uint32_t row) {
    const scene_entities *e = &s->entity;
    if ((e->tags[row] & q->tags) != q->tags || (e->tags[row] & q->without) ||
        (components(e, row) & q->has) != q->has) {
        return false;
    }
    core_vec3 p = {e->wpx[row], e->wpy[row], e->wpz[row]};
    core_vec3 d = core_v3_sub(p, q->center);
    return p.x >= q->min.x && p.y >= q->min.y && p.z >= q->min.z && p.x <= q->max.x &&
           p.y <= q->max.y && p.z <= q->max.z && core_v3_dot(d, d) <= q->radius * q->radius;
}

uint32_t scene_find_all(const scene *s, const scene_query *q, scene_entity *out,
                        uint32_t capacity) {
    uint32_t found = 0;
    if (!q || q->cookie != QUERY_COOKIE) {
        core_fail("scene: query was not made by scene_query_default()");
        return 0;
    }
    for (uint32_t row = 0; row < core_columns_count(&s->entity.set); row++) {
        if (matches(s, q, row)) {
            if (found < capacity) {
                out[found] = core_columns_handle(&s->entity.set, row);
            }
            found++;
        }
    }
    return found;
}
