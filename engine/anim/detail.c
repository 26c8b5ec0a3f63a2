// Level of detail: a palette may be as far behind as nobody can see. How fast the palette moves is
// measured where it moves most, at the joints farthest from the root.
#include "anim/anim_internal.h"

#include <math.h>

#define LONGEST 16     // steps between two poses of what is seen
#define MEMORY  240.0f // steps after which a former motion no longer counts

bool anim_instance_set_tolerance(anim_world *w, anim_instance h, float tolerance) {
    uint32_t row = anim_get_instance(w, h);
    if (row == CORE_NO_ROW) {
        return false;
    }
    if (!(tolerance >= 0)) {
        return core_fail("anim_instance_set_tolerance: %g m, expected >= 0", tolerance);
    }
    w->instances.tolerance[row] = tolerance;
    return true;
}

uint32_t anim_world_posed(const anim_world *w) {
    uint32_t count = 0;
    for (uint32_t row = 0; row < core_columns_count(&w->instances.set); row++) {
        count += w->pose_count > 0 && w->instances.posed_at[row] == w->pose_count;
    }
    return count;
}

float anim_instance_radius(const anim_world *w, anim_instance h) {
    uint32_t row = core_columns_row(&w->instances.set, h);
    if (row == CORE_NO_ROW) {
        return 0;
    }
    const anim_skeleton_res *s = anim_get_skeleton(w, w->instances.skeleton[row]);
    return core_v3_length(s->probe_place[0]);
}

float anim_instance_behind(const anim_world *w, anim_instance h) {
    uint32_t row = core_columns_row(&w->instances.set, h);
    return row == CORE_NO_ROW || !w->instances.posed[row]
               ? 0
               : (float)(w->pose_count - w->instances.posed_at[row]) * w->instances.motion[row];
}

bool anim_detail_skips(const anim_world *w, uint32_t row) {
    float tolerance = w->instances.tolerance[row];
    if (!(tolerance > 0) || !w->instances.posed[row] || w->instances.read[row]) {
        return false;
    }
    uint32_t behind = w->pose_count - w->instances.posed_at[row];
    uint32_t p = core_columns_row(&w->players.set, w->instances.player[row]);
    bool fades = p != CORE_NO_ROW && (w->players.flags[p] & ANIM_FADING);
    bool unseen = isinf(tolerance);
    return unseen ||
           (!fades && behind < LONGEST && (float)behind * w->instances.motion[row] <= tolerance);
}

// Where a point of the bind pose that moves with a bone is now.
static core_vec3 moved_by(const float *palette, uint32_t bone, core_vec3 p) {
    const float *m = palette + 12 * bone;
    return core_v3(m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3],
                   m[4] * p.x + m[5] * p.y + m[6] * p.z + m[7],
                   m[8] * p.x + m[9] * p.y + m[10] * p.z + m[11]);
}

static void measure(anim_world *w, uint32_t row) {
    const anim_skeleton_res *s = anim_get_skeleton(w, w->instances.skeleton[row]);
    const float *palette = anim_palette_of(w, row);
    anim_probe *probe = &w->instances.probe[row];
    float moved = 0;
    for (uint32_t i = 0; i < s->probe_count; i++) {
        core_vec3 now = moved_by(palette, s->probe[i], s->probe_place[i]);
        moved = CORE_MAX(moved, core_v3_length(core_v3_sub(now, probe->at[i])));
        probe->at[i] = now;
    }
    uint32_t steps = w->pose_count - probe->measured;
    bool known = probe->measured > 0 && steps <= LONGEST;
    float bent = steps > 1 ? 1.5f : 1.0f; // between two poses the way was no straight line
    float motion = known ? bent * moved / (float)steps : INFINITY;
    float before = w->instances.motion[row];
    float kept = isinf(before) ? 0 : before * (1 - CORE_MIN((float)steps / MEMORY, 1.0f));
    w->instances.motion[row] = CORE_MAX(motion, kept);
    probe->measured = w->pose_count;
}

void anim_detail_measure(anim_world *w) {
    for (uint32_t row = 0; row < core_columns_count(&w->instances.set); row++) {
        if (w->instances.tolerance[row] > 0 && w->instances.posed_at[row] == w->pose_count) {
            measure(w, row);
        }
    }
}

// Where the bone's joint stands in the bind pose; the origin when its matrix has no inverse.
static core_vec3 bind_place(const anim_skeleton_res *s, uint32_t bone) {
    core_mat4 inverse = core_mat4_identity(), bind = core_mat4_identity();
    for (uint32_t i = 0; i < 12; i++) {
        inverse.m[i % 4 * 4 + i / 4] = s->inverse_bind[12 * bone + i];
    }
    return core_mat4_inverse(&inverse, &bind) ? core_v3(bind.m[12], bind.m[13], bind.m[14])
                                              : core_v3(0, 0, 0);
}

void anim_detail_choose_probes(anim_skeleton_res *s) {
    core_vec3 root = bind_place(s, 0);
    while (s->probe_count < CORE_MIN(s->bones, (uint32_t)ANIM_PROBES)) {
        uint32_t best = 0;
        float farthest = -1;
        for (uint32_t b = 0; b < s->bones; b++) {
            float far = core_v3_length(core_v3_sub(bind_place(s, b), root));
            bool taken = false;
            for (uint32_t i = 0; i < s->probe_count; i++) {
                taken = taken || s->probe[i] == b;
            }
            if (!taken && far > farthest) {
                best = b;
                farthest = far;
            }
        }
        // The skin reaches beyond the joint: about as far again as the joint is from its parent.
        core_vec3 tip = bind_place(s, best);
        core_vec3 from = s->parent[best] < 0 ? tip : bind_place(s, (uint32_t)s->parent[best]);
        s->probe_place[s->probe_count] = core_v3_add(tip, core_v3_sub(tip, from));
        s->probe[s->probe_count++] = best;
    }
}
