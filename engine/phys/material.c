// How the materials of two shapes become that of their contact, and changes of either.
#include "phys/mesh_internal.h"

#include <string.h>

enum { MIX_DEFAULT, MIX_PRODUCT, MIX_GEOMETRIC, MIX_AVERAGE, MIX_LEAST, MIX_MOST };

bool phys_set_mixing(const char *name, const char *value, uint8_t *out) {
    static const char *const rules[] = {"default", "product", "geometric",
                                        "average", "least",   "most"};
    for (uint32_t i = 0; i < CORE_COUNT_OF(rules); i++) {
        if (strcmp(value, rules[i]) == 0) {
            *out = (uint8_t)i;
            return true;
        }
    }
    return core_fail("phys setting %s: '%s' is unknown, expected default, product, geometric, "
                     "average, least or most",
                     name, value);
}

static float mix(uint8_t rule, float a, float b) {
    switch (rule) {
    case MIX_PRODUCT:
        return a * b;
    case MIX_GEOMETRIC:
        return core_sqrtf(a * b);
    case MIX_AVERAGE:
        return 0.5f * (a + b);
    case MIX_LEAST:
        return CORE_MIN(a, b);
    default:
        return CORE_MAX(a, b);
    }
}

phys_material phys_shape_material(const phys_shapes *s, uint32_t i) {
    return (phys_material){s->friction[i], s->restitution[i], s->rolling[i]};
}

phys_material phys_mix_materials(const phys_world *w, phys_material a, phys_material b) {
    uint8_t friction = w->mix_friction ? w->mix_friction : MIX_GEOMETRIC;
    return (phys_material){mix(friction, a.friction, b.friction),
                           mix(w->mix_restitution, a.restitution, b.restitution),
                           CORE_MAX(a.rolling, b.rolling)};
}

static phys_material mixed(const phys_world *w, uint32_t sa, uint32_t sb) {
    const phys_shapes *s = &w->shapes;
    return phys_mix_materials(w, phys_shape_material(s, phys_slot_row(&s->set, sa)),
                              phys_shape_material(s, phys_slot_row(&s->set, sb)));
}

void phys_remix_contacts(phys_world *w) {
    for (uint32_t i = 0; i < core_columns_count(&w->balls.set); i++) {
        phys_material m = mixed(w, w->balls.sa[i], w->balls.sb[i]);
        w->balls.friction[i] = m.friction;
        w->balls.restitution[i] = m.restitution;
        w->balls.rolling[i] = m.rolling;
    }
    for (uint32_t i = 0; i < core_columns_count(&w->contacts.set); i++) {
        phys_material m = mixed(w, w->contacts.sa[i], w->contacts.sb[i]);
        w->contacts.friction[i] = m.friction;
        w->contacts.restitution[i] = m.restitution;
    }
    for (uint32_t i = 0; i < core_columns_count(&w->mesh_pairs.set); i++) {
        w->mesh_pairs.used[i] = 0; // looked at anew: surfaces may have materials of their own
    }
}
