// Body -> transform -> drawn instance.
#include <string.h>

#include "scene/scene_internal.h"

// Interpolation needs the last two steps only where something is drawn.
void scene_keep_previous(scene *s) {
    if (!s->gfx) {
        return;
    }
    scene_entities *e = &s->entity;
    size_t bytes = core_columns_count(&e->set) * sizeof(float);
    if (bytes) {
        memcpy(e->opx, e->wpx, bytes);
        memcpy(e->opy, e->wpy, bytes);
        memcpy(e->opz, e->wpz, bytes);
        memcpy(e->oqx, e->wqx, bytes);
        memcpy(e->oqy, e->wqy, bytes);
        memcpy(e->oqz, e->wqz, bytes);
        memcpy(e->oqw, e->wqw, bytes);
    }
}

// The script may destroy a body and keep its entity: the entity stays where the body was.
static void body_gone(scene *s, uint32_t row) {
    scene_entities *e = &s->entity;
    e->body[row] = CORE_NULL_HANDLE;
    scene_local_from_world(s, row);
    e->changed[row] = s->moves;
}

void scene_pull_bodies(scene *s) {
    if (!s->phys) {
        return;
    }
    scene_entities *e = &s->entity;
    phys_pose_view pose = phys_world_poses(s->phys);
    uint32_t count = core_columns_count(&e->set);
    for (uint32_t row = 0; row < count; row++) {
        if (core_handle_is_null(e->body[row])) {
            continue;
        }
        uint32_t b = phys_body_row(s->phys, e->body[row]);
        if (b == CORE_NO_ROW) {
            body_gone(s, row);
            continue;
        }
        const float now[7] = {pose.px[b], pose.py[b], pose.pz[b], pose.qx[b],
                              pose.qy[b], pose.qz[b], pose.qw[b]};
        const float was[7] = {e->wpx[row], e->wpy[row], e->wpz[row], e->wqx[row],
                              e->wqy[row], e->wqz[row], e->wqw[row]};
        if (memcmp(now, was, sizeof now) == 0) {
            continue; // at rest, and so are its children
        }
        e->changed[row] = s->moves;
        e->wpx[row] = pose.px[b];
        e->wpy[row] = pose.py[b];
        e->wpz[row] = pose.pz[b];
        e->wqx[row] = pose.qx[b];
        e->wqy[row] = pose.qy[b];
        e->wqz[row] = pose.qz[b];
        e->wqw[row] = pose.qw[b];
    }
}

static void draw_pose(const scene_entities *e, uint32_t row, float alpha, core_vec3 *p,
                      core_quat *q) {
    core_vec3 old = {e->opx[row], e->opy[row], e->opz[row]};
    core_vec3 now = {e->wpx[row], e->wpy[row], e->wpz[row]};
    core_quat old_q = {e->oqx[row], e->oqy[row], e->oqz[row], e->oqw[row]};
    core_quat now_q = {e->wqx[row], e->wqy[row], e->wqz[row], e->wqw[row]};
    *p = core_v3_mad(old, core_v3_sub(now, old), alpha);
    bool turned = memcmp(&old_q, &now_q, sizeof now_q) != 0;
    *q = turned ? core_quat_nlerp(old_q, now_q, alpha) : now_q;
}

bool scene_draw_pose(const scene *s, scene_entity e, float alpha, core_vec3 *p, core_quat *q) {
    uint32_t row = scene_row(s, e);
    if (row == CORE_NO_ROW) {
        return false;
    }
    draw_pose(&s->entity, row, alpha, p, q);
    return true;
}

void scene_sync_draw(scene *s, float alpha) {
    if (!s->gfx) {
        return;
    }
    scene_entities *e = &s->entity;
    uint32_t count = core_columns_count(&e->set);
    core_stage_begin(s->metrics, CORE_STAGE_SCENE);
    for (uint32_t row = 0; row < count; row++) {
        if (core_handle_is_null(e->instance[row])) {
            continue;
        }
        core_vec3 p;
        core_quat q;
        draw_pose(e, row, alpha, &p, &q);
        core_vec3 size = {e->wsx[row] * e->dx[row], e->wsy[row] * e->dy[row],
                          e->wsz[row] * e->dz[row]};
        // Most of a world rests: only what changed is handed on.
        scene_drawn want = {p, q, size};
        if (memcmp(&want, &e->drawn[row], sizeof want) != 0) {
            e->drawn[row] = want;
            gfx_instance_set_transform(s->gfx, e->instance[row], p, q, size);
        }
    }
    gfx_world_set_moment(s->gfx, alpha);
    scene_anim_sync(s);
    core_stage_end(s->metrics, CORE_STAGE_SCENE);
}
