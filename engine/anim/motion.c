// What a slot plays: its clip, or the two clips of a blend tree that its parameter lies between.
#include "anim/anim_internal.h"

static const anim_clip_res *clip_at(const anim_world *w, core_handle h) {
    return w->clips.item[core_columns_row(&w->clips.set, h)];
}

static anim_motion tree_motion(const anim_world *w, const anim_machine_res *m, const anim_state *s,
                               float value) {
    const anim_blend_point *p = m->point + s->first_point;
    uint32_t i = 0;
    while (i + 1 < s->point_count && p[i + 1].value <= value) {
        i++;
    }
    anim_motion out = {.loop = ANIM_LOOP, .length = 1};
    out.handle[0] = p[i].clip;
    out.clip[0] = clip_at(w, p[i].clip);
    out.scale[0] = out.clip[0]->duration;
    if (i + 1 < s->point_count && value > p[i].value) {
        out.handle[1] = p[i + 1].clip;
        out.clip[1] = clip_at(w, p[i + 1].clip);
        out.scale[1] = out.clip[1]->duration;
        out.weight = (value - p[i].value) / (p[i + 1].value - p[i].value);
    }
    return out;
}

anim_motion anim_slot_motion(const anim_world *w, uint32_t player, const anim_slot *slot) {
    if (slot->state >= 0) {
        const anim_machine_res *m = anim_get_machine(w, w->players.machine[player]);
        const anim_state *s = &m->state[slot->state];
        if (s->point_count) {
            return tree_motion(w, m, s, w->players.parameter[player].v[s->blend_parameter]);
        }
    }
    anim_motion out = {.loop = slot->loop};
    if (!core_handle_is_null(slot->clip)) {
        out.handle[0] = slot->clip;
        out.clip[0] = clip_at(w, slot->clip);
        out.scale[0] = 1;
        out.length = out.clip[0]->duration;
    }
    return out;
}

float anim_motion_time(const anim_motion *m, float t) {
    if (m->loop != ANIM_ONCE) {
        float d = m->loop == ANIM_PING_PONG ? 2 * m->length : m->length;
        if (!(t >= 0 && t <= d)) {
            t = (float)core_fmod(t, d);
            t = t < 0 ? t + d : t;
        }
        t = m->loop == ANIM_PING_PONG && t > m->length ? d - t : t;
    }
    return CORE_CLAMP(t, 0.0f, m->length);
}

float anim_slot_clip_time(const anim_world *w, uint32_t player, const anim_slot *slot) {
    anim_motion m = anim_slot_motion(w, player, slot);
    return m.clip[0] ? anim_motion_time(&m, slot->time) * m.scale[0] : 0;
}
