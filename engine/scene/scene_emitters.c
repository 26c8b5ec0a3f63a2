// Emitters of particles that follow entities.
#include "scene/scene_internal.h"

bool scene_set_emitter(scene *s, scene_entity e, gfx_emitter emitter) {
    if (scene_row(s, e) == CORE_NO_ROW) {
        return false;
    }
    uint64_t bits = (uint64_t)e.generation << 32 | e.index;
    if (!s->gfx || !gfx_emitter_set_user(s->gfx, emitter, bits)) {
        return core_fail("scene_set_emitter: the emitter's handle is stale or null");
    }
    return true;
}

// What an entity has lit goes on glowing when the entity is gone, and gets no more.
static void follow(scene *s, gfx_emitter emitter) {
    uint64_t bits = gfx_emitter_user(s->gfx, emitter);
    scene_entity e = {(uint32_t)bits, (uint32_t)(bits >> 32)};
    core_vec3 p;
    core_quat q;
    if (bits == 0) {
        return;
    }
    if (scene_alive(s, e) && scene_position(s, e, &p) && scene_rotation(s, e, &q)) {
        gfx_emitter_set_pose(s->gfx, emitter, p, q);
    } else {
        gfx_emitter_set_rate(s->gfx, emitter, 0.0f);
        gfx_emitter_set_user(s->gfx, emitter, 0);
    }
}

void scene_emitters_step(scene *s) {
    uint32_t count = s->gfx ? gfx_emitters_count(s->gfx) : 0;
    if (count == 0) {
        return;
    }
    core_stage_begin(s->metrics, CORE_STAGE_SCENE);
    for (uint32_t i = 0; i < count; i++) {
        follow(s, gfx_emitter_at(s->gfx, i));
    }
    gfx_world_step(s->gfx, s->dt);
    core_stage_end(s->metrics, CORE_STAGE_SCENE);
}
