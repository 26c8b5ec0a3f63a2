// Parents and children. Links are handles (rows move on removal); walks are loops over those links
// or over a list of rows sorted by depth, so that a chain of any depth costs no stack.
#include <string.h>

#include "scene/scene_internal.h"

void scene_link(scene *s, uint32_t row, scene_entity parent) {
    scene_entities *e = &s->entity;
    scene_entity self = core_columns_handle(&e->set, row);
    uint32_t above = core_columns_row(&e->set, parent);
    e->parent[row] = parent;
    e->depth[row] = 0;
    e->prev_sibling[row] = CORE_NULL_HANDLE;
    e->next_sibling[row] = CORE_NULL_HANDLE;
    if (above == CORE_NO_ROW) {
        return;
    }
    e->depth[row] = e->depth[above] + 1;
    e->next_sibling[row] = e->first_child[above];
    uint32_t next = core_columns_row(&e->set, e->first_child[above]);
    if (next != CORE_NO_ROW) {
        e->prev_sibling[next] = self;
    }
    e->first_child[above] = self;
    s->order_stale = true;
}

void scene_unlink(scene *s, uint32_t row) {
    scene_entities *e = &s->entity;
    uint32_t above = core_columns_row(&e->set, e->parent[row]);
    uint32_t prev = core_columns_row(&e->set, e->prev_sibling[row]);
    uint32_t next = core_columns_row(&e->set, e->next_sibling[row]);
    if (prev != CORE_NO_ROW) {
        e->next_sibling[prev] = e->next_sibling[row];
    } else if (above != CORE_NO_ROW) {
        e->first_child[above] = e->next_sibling[row];
    }
    if (next != CORE_NO_ROW) {
        e->prev_sibling[next] = e->prev_sibling[row];
    }
    e->parent[row] = CORE_NULL_HANDLE;
    e->prev_sibling[row] = CORE_NULL_HANDLE;
    e->next_sibling[row] = CORE_NULL_HANDLE;
    s->order_stale = true;
}

// Next entity of a depth-first walk below `root`, null when the walk is over.
static scene_entity walk_next(const scene_entities *e, scene_entity root, scene_entity at) {
    uint32_t row = core_columns_row(&e->set, at);
    if (!core_handle_is_null(e->first_child[row])) {
        return e->first_child[row];
    }
    while (!core_handle_equal(at, root)) {
        row = core_columns_row(&e->set, at);
        if (!core_handle_is_null(e->next_sibling[row])) {
            return e->next_sibling[row];
        }
        at = e->parent[row];
    }
    return CORE_NULL_HANDLE;
}

void scene_world_of(scene *s, uint32_t row) {
    scene_entities *e = &s->entity;
    core_vec3 p = {e->px[row], e->py[row], e->pz[row]};
    core_quat q = {e->qx[row], e->qy[row], e->qz[row], e->qw[row]};
    core_vec3 v = {e->sx[row], e->sy[row], e->sz[row]};
    uint32_t above = core_columns_row(&e->set, e->parent[row]);
    if (above != CORE_NO_ROW) {
        core_quat aq = {e->wqx[above], e->wqy[above], e->wqz[above], e->wqw[above]};
        core_vec3 av = {e->wsx[above], e->wsy[above], e->wsz[above]};
        core_vec3 turned = core_quat_rotate(aq, (core_vec3){p.x * av.x, p.y * av.y, p.z * av.z});
        p = core_v3_add((core_vec3){e->wpx[above], e->wpy[above], e->wpz[above]}, turned);
        q = core_quat_normalize(core_quat_mul(aq, q));
        v = (core_vec3){v.x * av.x, v.y * av.y, v.z * av.z};
    }
    e->changed[row] = s->moves;
    e->wpx[row] = p.x;
    e->wpy[row] = p.y;
    e->wpz[row] = p.z;
    e->wqx[row] = q.x;
    e->wqy[row] = q.y;
    e->wqz[row] = q.z;
    e->wqw[row] = q.w;
    e->wsx[row] = v.x;
    e->wsy[row] = v.y;
    e->wsz[row] = v.z;
}

static void reserve_u32(uint32_t **array, uint32_t *capacity, uint32_t need) {
    if (need <= *capacity) {
        return;
    }
    uint32_t grown = CORE_MAX(need, CORE_MAX(64u, *capacity * 2));
    *array = core_realloc(*array, *capacity * sizeof **array, grown * sizeof **array);
    *capacity = grown;
}

// Counting sort of the rows that have a parent by depth; rows of equal depth keep their order.
static void rebuild_order(scene *s) {
    scene_entities *e = &s->entity;
    uint32_t count = core_columns_count(&e->set), children = 0, deepest = 0;
    for (uint32_t row = 0; row < count; row++) {
        children += e->depth[row] > 0;
        deepest = CORE_MAX(deepest, e->depth[row]);
    }
    reserve_u32(&s->order, &s->order_capacity, children);
    reserve_u32(&s->depth_start, &s->depth_capacity, deepest + 2);
    if (children) {
        uint32_t *start = s->depth_start;
        memset(start, 0, (deepest + 2) * sizeof *start);
        for (uint32_t row = 0; row < count; row++) {
            if (e->depth[row]) {
                start[e->depth[row] + 1]++;
            }
        }
        for (uint32_t d = 1; d <= deepest + 1; d++) {
            start[d] += start[d - 1];
        }
        for (uint32_t row = 0; row < count; row++) {
            if (e->depth[row]) {
                s->order[start[e->depth[row]]++] = row;
            }
        }
    }
    s->order_count = children;
    s->order_stale = false;
}

void scene_world_of_children(scene *s) {
    if (s->order_stale) {
        rebuild_order(s);
    }
    scene_entities *e = &s->entity;
    s->moved_count = 0;
    for (uint32_t i = 0; i < s->order_count; i++) {
        uint32_t row = s->order[i];
        if (!core_handle_is_null(e->body[row])) {
            continue;
        }
        uint32_t above = core_columns_row(&e->set, e->parent[row]);
        bool moved =
            e->changed[row] == s->moves || (above != CORE_NO_ROW && e->changed[above] == s->moves);
        if (moved) {
            scene_world_of(s, row);
            s->moved_count++;
        }
    }
    s->moves++;
}

uint32_t scene_moved(const scene *s) { return s->moved_count; }

void scene_interpolation_reset(scene *s, uint32_t row) {
    scene_entities *e = &s->entity;
    e->opx[row] = e->wpx[row];
    e->opy[row] = e->wpy[row];
    e->opz[row] = e->wpz[row];
    e->oqx[row] = e->wqx[row];
    e->oqy[row] = e->wqy[row];
    e->oqz[row] = e->wqz[row];
    e->oqw[row] = e->wqw[row];
}

void scene_subtree_moved(scene *s, scene_entity root) {
    scene_entities *e = &s->entity;
    scene_interpolation_reset(s, core_columns_row(&e->set, root));
    e->changed[core_columns_row(&e->set, root)] = s->moves;
    for (scene_entity at = walk_next(e, root, root); !core_handle_is_null(at);
         at = walk_next(e, root, at)) {
        uint32_t row = core_columns_row(&e->set, at);
        if (core_handle_is_null(e->body[row])) {
            scene_world_of(s, row);
            scene_interpolation_reset(s, row);
        }
    }
}

static bool is_below(const scene *s, scene_entity at, scene_entity root) {
    const scene_entities *e = &s->entity;
    for (; !core_handle_is_null(at); at = e->parent[core_columns_row(&e->set, at)]) {
        if (core_handle_equal(at, root)) {
            return true;
        }
    }
    return false;
}

// Local transform that gives the present world transform under the present parent. A scale of zero
// on the way up has no inverse; that axis then keeps its local value.
void scene_local_from_world(scene *s, uint32_t row) {
    scene_entities *e = &s->entity;
    uint32_t above = core_columns_row(&e->set, e->parent[row]);
    core_vec3 p = {e->wpx[row], e->wpy[row], e->wpz[row]};
    core_quat q = {e->wqx[row], e->wqy[row], e->wqz[row], e->wqw[row]};
    core_vec3 v = {e->wsx[row], e->wsy[row], e->wsz[row]};
    if (above != CORE_NO_ROW) {
        core_quat aq = {e->wqx[above], e->wqy[above], e->wqz[above], e->wqw[above]};
        core_vec3 av = {e->wsx[above], e->wsy[above], e->wsz[above]};
        p = core_v3_sub(p, (core_vec3){e->wpx[above], e->wpy[above], e->wpz[above]});
        p = core_quat_unrotate(aq, p);
        q = core_quat_mul(core_quat_conjugate(aq), q);
        p = (core_vec3){av.x != 0.0f ? p.x / av.x : e->px[row],
                        av.y != 0.0f ? p.y / av.y : e->py[row],
                        av.z != 0.0f ? p.z / av.z : e->pz[row]};
        v = (core_vec3){av.x != 0.0f ? v.x / av.x : e->sx[row],
                        av.y != 0.0f ? v.y / av.y : e->sy[row],
                        av.z != 0.0f ? v.z / av.z : e->sz[row]};
    }
    e->px[row] = p.x;
    e->py[row] = p.y;
    e->pz[row] = p.z;
    e->qx[row] = q.x;
    e->qy[row] = q.y;
    e->qz[row] = q.z;
    e->qw[row] = q.w;
    e->sx[row] = v.x;
    e->sy[row] = v.y;
    e->sz[row] = v.z;
}

bool scene_set_parent(scene *s, scene_entity child, scene_entity parent) {
    uint32_t row = scene_row(s, child);
    if (row == CORE_NO_ROW) {
        return false;
    }
    if (!core_handle_is_null(parent)) {
        if (scene_row(s, parent) == CORE_NO_ROW) {
            return false;
        }
        if (is_below(s, parent, child)) {
            return core_fail("scene: entity '%s' cannot be a child of its own descendant '%s'",
                             scene_entity_name(s, child), scene_entity_name(s, parent));
        }
    }
    scene_entities *e = &s->entity;
    scene_unlink(s, row);
    scene_link(s, row, parent);
    scene_local_from_world(s, row);
    e->changed[row] = s->moves;
    for (scene_entity at = walk_next(e, child, child); !core_handle_is_null(at);
         at = walk_next(e, child, at)) {
        uint32_t below = core_columns_row(&e->set, at);
        e->depth[below] = e->depth[core_columns_row(&e->set, e->parent[below])] + 1;
    }
    return true;
}
