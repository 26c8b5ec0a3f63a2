// A world in a saved scene: its columns through a stream, and a check of everything in them that
// points elsewhere, because a file may say anything.
#include "phys/world.h"

static bool live_slot(const core_columns *set, uint32_t slot) {
    const core_pool *p = &set->pool;
    return slot - 1 < p->slots && p->row[slot - 1] < p->count &&
           p->slot_of_row[p->row[slot - 1]] == slot - 1;
}

static bool live(const core_columns *set, core_handle h) {
    return core_handle_is_null(h) || core_columns_row(set, h) != CORE_NO_ROW;
}

// Every shape hangs on exactly one body's list, and lists end.
static bool check_shapes(const phys_world *w, core_stream *s) {
    const phys_bodies *b = &w->bodies;
    const phys_shapes *sh = &w->shapes;
    uint32_t shapes = core_columns_count(&sh->set), seen = 0;
    for (uint32_t i = 0; i < core_columns_count(&b->set); i++) {
        if (b->type[i] > PHYS_KINEMATIC || b->layer[i] > 31) {
            return core_stream_fail(s, "phys.bodies", "row %u: type %u, layer %u", i, b->type[i],
                                    b->layer[i]);
        }
        for (uint32_t slot = b->shape[i]; slot != 0; seen++) {
            if (seen == shapes || !live_slot(&sh->set, slot)) {
                return core_stream_fail(s, "phys.bodies.shape", "row %u: no shape in slot %u", i,
                                        slot);
            }
            uint32_t row = phys_slot_row(&sh->set, slot);
            if (sh->body[row] != phys_row_slot(&b->set, i)) {
                return core_stream_fail(s, "phys.shapes.body", "row %u is of another body", row);
            }
            slot = sh->next[row];
        }
    }
    return seen == shapes ||
           core_stream_fail(s, "phys.shapes", "%u of %u hang on no body", shapes - seen, shapes);
}

static bool pair_stands(const phys_world *w, uint32_t sa, uint32_t sb) {
    return live_slot(&w->shapes.set, sa) && live_slot(&w->shapes.set, sb);
}

static bool check_contacts(const phys_world *w, core_stream *s) {
    for (uint32_t i = 0; i < core_columns_count(&w->balls.set); i++) {
        if (!pair_stands(w, w->balls.sa[i], w->balls.sb[i])) {
            return core_stream_fail(s, "phys.balls", "row %u joins shapes that are not", i);
        }
    }
    for (uint32_t i = 0; i < core_columns_count(&w->contacts.set); i++) {
        if (!pair_stands(w, w->contacts.sa[i], w->contacts.sb[i]) ||
            w->contacts.manifold[i].count > 4) {
            return core_stream_fail(s, "phys.contacts", "row %u joins shapes that are not", i);
        }
    }
    const phys_mesh_pairs *m = &w->mesh_pairs;
    for (uint32_t i = 0; i < core_columns_count(&m->set); i++) {
        bool good = pair_stands(w, m->sa[i], m->sb[i]) && m->count[i] <= PHYS_MESH_PARTS &&
                    m->used[i] <= m->count[i];
        for (uint32_t k = 0; good && k < m->count[i]; k++) {
            good = live_slot(m->ball[i] ? &w->balls.set : &w->contacts.set, m->rows[i].slot[k]);
        }
        if (!good) {
            return core_stream_fail(s, "phys.mesh_pairs", "row %u joins shapes that are not", i);
        }
    }
    return true;
}

static bool check_rest(const phys_world *w, core_stream *s) {
    const phys_joints *j = &w->joints;
    for (uint32_t i = 0; i < core_columns_count(&j->set); i++) {
        bool a = j->a[i] == 0 || live_slot(&w->bodies.set, j->a[i]);
        bool b = j->b[i] == 0 || live_slot(&w->bodies.set, j->b[i]);
        if (!a || !b || j->type[i] > PHYS_JOINT_PULLEY) {
            return core_stream_fail(s, "phys.joints", "row %u joins bodies that are not", i);
        }
    }
    for (uint32_t i = 0; i < core_columns_count(&w->triggers.set); i++) {
        if (w->triggers.type[i] != PHYS_SPHERE && w->triggers.type[i] != PHYS_BOX) {
            return core_stream_fail(s, "phys.triggers.type", "row %u: %u", i, w->triggers.type[i]);
        }
    }
    for (uint32_t i = 0; i < core_columns_count(&w->visits.set); i++) {
        if (core_columns_row(&w->triggers.set, w->visits.trigger[i]) == CORE_NO_ROW) {
            return core_stream_fail(s, "phys.visits", "row %u is in no trigger", i);
        }
    }
    for (uint32_t i = 0; i < core_columns_count(&w->fields.set); i++) {
        const phys_field_desc *d = &w->fields.desc[i];
        if ((unsigned)d->type > PHYS_FIELD_POINT ||
            (d->bounded && d->shape != PHYS_SPHERE && d->shape != PHYS_BOX)) {
            return core_stream_fail(s, "phys.fields.desc", "row %u: type %d", i, (int)d->type);
        }
    }
    for (uint32_t i = 0; i < core_columns_count(&w->movers.set); i++) {
        if (!live(&w->bodies.set, w->movers.body[i])) {
            return core_stream_fail(s, "phys.movers.body", "row %u stands on no body", i);
        }
    }
    return true;
}

// Cloths lie in the particles one after another, in the order of creation; holds name a particle.
static bool check_cloth(const phys_world *w, core_stream *s) {
    const phys_cloths *c = &w->cloths;
    uint64_t particles = core_columns_count(&w->particles.set);
    for (uint32_t i = 0; i < core_columns_count(&c->set); i++) {
        if (c->columns[i] < 1 || c->rows[i] < 1 || c->layer[i] > 31 || c->substeps[i] > 64 ||
            c->first[i] + (uint64_t)c->columns[i] * c->rows[i] > particles) {
            return core_stream_fail(s, "phys.cloths", "row %u: %u x %u of %u particles", i,
                                    c->columns[i], c->rows[i], (uint32_t)particles);
        }
    }
    for (uint32_t i = 0; i < core_columns_count(&w->holds.set); i++) {
        uint32_t slot = w->holds.cloth[i];
        uint32_t row = live_slot(&c->set, slot) ? phys_slot_row(&c->set, slot) : CORE_NO_ROW;
        if (row == CORE_NO_ROW || w->holds.index[i] >= (uint64_t)c->columns[row] * c->rows[row] ||
            !live(&w->bodies.set, w->holds.body[i])) {
            return core_stream_fail(s, "phys.holds", "row %u holds what is not", i);
        }
    }
    return true;
}

// Hulls and meshes are made by the scene, not saved: shapes may name those that the scene has.
static bool check_geometry(phys_world *w, core_stream *s) {
    for (uint32_t i = 0; i < core_columns_count(&w->shapes.set); i++) {
        uint32_t type = w->shapes.type[i], n = w->shapes.hull[i];
        bool good = type == PHYS_HULL   ? n - 1 < w->hull_count && w->hulls[n - 1].users != 0
                    : type == PHYS_MESH ? phys_mesh_stands(w, n)
                                        : type < PHYS_MESH;
        if (!good) {
            return core_stream_fail(s, "phys.shapes.hull",
                                    "row %u: the scene has no geometry %u of its kind; load a save "
                                    "into the scene that wrote it",
                                    i, n);
        }
    }
    return true;
}

// Which points each hull was made from: another scene's hulls would be other shapes.
static bool same_hulls(phys_world *w, core_stream *s) {
    uint32_t count = w->hull_count;
    bool good = core_stream_count(s, "hulls", &count, 1u << 20);
    for (uint32_t i = 0; good && i < count; i++) {
        uint64_t mine = i < w->hull_count && w->hulls[i].users ? w->hulls[i].hash : 0, saved = mine;
        good = core_stream_u64(s, "hull", &saved) &&
               (saved == 0 || saved == mine ||
                core_stream_fail(s, "phys hulls", "the scene's hull %u is another", i));
    }
    return good;
}

static void recount_hulls(phys_world *w) {
    for (uint32_t i = 0; i < w->hull_count; i++) {
        w->hulls[i].users = w->hulls[i].users != 0; // kept alive, so that an undone load finds it
    }
    for (uint32_t i = 0; i < core_columns_count(&w->shapes.set); i++) {
        if (w->shapes.type[i] == PHYS_HULL) {
            w->hulls[w->shapes.hull[i] - 1].users++;
        }
    }
}

bool phys_world_stream(phys_world *w, core_stream *s) {
    core_columns *set[PHYS_SETS];
    phys_world_sets(w, set);
    bool good = core_stream_open(s, "phys") &&
                core_stream_list(s, "gravity", 'f', &w->gravity, sizeof w->gravity) &&
                core_stream_list(s, "rules", 'u', w->rule, sizeof w->rule) &&
                core_stream_list(s, "time", 'd', &w->time, sizeof w->time) && same_hulls(w, s);
    for (int i = 0; good && i < PHYS_SETS; i++) {
        good = core_stream_columns(s, set[i]);
    }
    good = good && core_stream_close(s);
    if (good && !s->writing) {
        good = check_shapes(w, s) && check_contacts(w, s) && check_rest(w, s) &&
               check_cloth(w, s) && check_geometry(w, s);
        if (good) {
            recount_hulls(w);
            phys_meshes_recount(w);
            phys_world_restored(w);
        }
    }
    return good;
}
