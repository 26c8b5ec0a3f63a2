// What a step has to tell: who came into, is in, and left each trigger, and which contacts began
// and ended. Lists are rebuilt and compared, so that nothing is told twice or forgotten, whatever
// was destroyed in between.
#include "phys/world.h"

CORE_COLUMNS_DEFINE(phys_triggers, PHYS_TRIGGER_COLUMNS)
CORE_COLUMNS_DEFINE(phys_visits, PHYS_VISIT_COLUMNS)

static void reserve(phys_event_list *list) {
    if (list->count == list->capacity) {
        uint32_t grown = list->capacity ? list->capacity * 2 : 64;
        list->event = core_realloc(list->event, list->capacity * sizeof(phys_event),
                                   grown * sizeof(phys_event));
        list->capacity = grown;
    }
}

void phys_event_push(phys_event_list *list, const phys_event *event) {
    reserve(list);
    list->event[list->count++] = *event;
}

void phys_events_begin(phys_world *w) {
    w->events.count = 0;
    for (uint32_t i = 0; i < w->pending.count; i++) {
        phys_event_push(&w->events, &w->pending.event[i]);
    }
    w->pending.count = 0;
}

const phys_event *phys_world_events(const phys_world *w, uint32_t *count) {
    *count = w->events.count;
    return w->events.event;
}

phys_trigger_desc phys_trigger_desc_default(phys_shape_type type) {
    return (phys_trigger_desc){
        .type = type, .rotation = core_quat_identity(), .cookie = PHYS_TRIGGER_COOKIE};
}

bool phys_region_check(const char *what, phys_shape_type type, core_vec3 half, float radius,
                       core_vec3 position) {
    if (!phys_finite3(position) || core_v3_length(position) > PHYS_FAR) {
        return core_fail("phys %s: position (%g, %g, %g) is not finite or too far", what,
                         (double)position.x, (double)position.y, (double)position.z);
    }
    if (type == PHYS_SPHERE) {
        return (radius > 0.0f && radius <= PHYS_FAR) ||
               core_fail("phys %s: radius is %g, expected more than 0 m", what, (double)radius);
    }
    if (type == PHYS_CAPSULE || type == PHYS_CYLINDER) {
        return (radius > 0.0f && radius <= PHYS_FAR && half.y > 0.0f && half.y <= PHYS_FAR) ||
               core_fail("phys %s: radius %g and half height %g, expected more than 0 m", what,
                         (double)radius, (double)half.y);
    }
    if (type != PHYS_BOX) {
        return core_fail("phys %s: shape %d, expected sphere, box, capsule or cylinder", what,
                         (int)type);
    }
    float low = CORE_MIN(half.x, CORE_MIN(half.y, half.z));
    return (low > 0.0f && phys_finite3(half)) ||
           core_fail("phys %s: half extents (%g, %g, %g), expected more than 0 m", what,
                     (double)half.x, (double)half.y, (double)half.z);
}

phys_trigger phys_trigger_create(phys_world *w, const phys_trigger_desc *d) {
    if (d->cookie != PHYS_TRIGGER_COOKIE) {
        core_fail("phys trigger: description was not made by phys_trigger_desc_default");
        return CORE_NULL_HANDLE;
    }
    if (!phys_region_check("trigger", d->type, d->half, d->radius, d->position)) {
        return CORE_NULL_HANDLE;
    }
    phys_triggers *t = &w->triggers;
    reserve(&w->events); // the first visit may come long after warm-up
    core_handle h = core_columns_add(&t->set);
    if (core_handle_is_null(h)) {
        return h;
    }
    uint32_t i = core_columns_count(&t->set) - 1;
    t->type[i] = d->type;
    t->position[i] = d->position;
    t->rotation[i] = core_quat_normalize(d->rotation);
    t->half[i] = d->half;
    t->radius[i] = d->type == PHYS_BOX ? 0.0f : d->radius;
    t->layers[i] = d->layers ? d->layers : UINT32_MAX;
    t->user[i] = d->user;
    return h;
}

static uint32_t live_trigger(const phys_world *w, phys_trigger h, const char *what) {
    uint32_t row = core_columns_row(&w->triggers.set, h);
    if (row == CORE_NO_ROW) {
        core_fail("phys trigger: %s of a stale or null handle (%u:%u)", what, h.index,
                  h.generation);
    }
    return row;
}

bool phys_trigger_destroy(phys_world *w, phys_trigger h) {
    return live_trigger(w, h, "destroy") != CORE_NO_ROW &&
           core_columns_remove(&w->triggers.set, h, NULL, NULL);
}

bool phys_trigger_alive(const phys_world *w, phys_trigger h) {
    return core_columns_row(&w->triggers.set, h) != CORE_NO_ROW;
}

bool phys_trigger_set_position(phys_world *w, phys_trigger h, core_vec3 p) {
    uint32_t i = live_trigger(w, h, "set position");
    if (i == CORE_NO_ROW || !phys_region_check("trigger", PHYS_SPHERE, p, 1.0f, p)) {
        return false;
    }
    w->triggers.position[i] = p;
    return true;
}

bool phys_trigger_set_rotation(phys_world *w, phys_trigger h, core_quat q) {
    uint32_t i = live_trigger(w, h, "set rotation");
    if (i == CORE_NO_ROW) {
        return false;
    }
    w->triggers.rotation[i] = core_quat_normalize(q);
    return true;
}

uint64_t phys_trigger_user(const phys_world *w, phys_trigger h) {
    uint32_t i = live_trigger(w, h, "user");
    return i == CORE_NO_ROW ? 0 : w->triggers.user[i];
}

typedef struct visit {
    core_handle trigger, body;
} visit;

static int visit_order(const visit *a, const visit *b) {
    uint64_t ka = (uint64_t)a->trigger.index << 32 | a->body.index;
    uint64_t kb = (uint64_t)b->trigger.index << 32 | b->body.index;
    return ka < kb ? -1 : ka > kb;
}

static bool visit_same(const visit *a, const visit *b) {
    return core_handle_equal(a->trigger, b->trigger) && core_handle_equal(a->body, b->body);
}

static bool overlaps(const phys_geom *region, const phys_geom *shape) {
    phys_manifold m = {0};
    phys_collide(region, shape, 0.0f, &m);
    return m.count != 0;
}

static bool body_inside(const phys_world *w, const phys_geom *region, const core_aabb *box,
                        uint32_t row) {
    const phys_shapes *s = &w->shapes;
    for (uint32_t slot = w->bodies.shape[row]; slot != 0;) {
        uint32_t i = phys_slot_row(&s->set, slot);
        phys_geom g = phys_shape_geom(w, i);
        core_aabb b = phys_geom_bounds(&g);
        bool apart = b.min.x > box->max.x || b.max.x < box->min.x || b.min.y > box->max.y ||
                     b.max.y < box->min.y || b.min.z > box->max.z || b.max.z < box->min.z;
        if (!apart && overlaps(region, &g)) {
            return true;
        }
        slot = s->next[i];
    }
    return false;
}

// Everyone inside now, sorted: triggers by slot; bodies come by row, so each run is sorted after.
static uint32_t find_visits(const phys_world *w, visit *out, uint32_t room) {
    const phys_triggers *t = &w->triggers;
    const phys_bodies *b = &w->bodies;
    uint32_t n = 0;
    for (uint32_t k = 0; k < core_columns_count(&t->set); k++) {
        phys_geom region = phys_geom_make((phys_shape_type)t->type[k], t->position[k],
                                          t->rotation[k], t->half[k], t->radius[k]);
        core_aabb box = phys_geom_bounds(&region);
        for (uint32_t i = 0; i < core_columns_count(&b->set) && n < room; i++) {
            bool seen = b->type[i] != PHYS_STATIC && (t->layers[k] >> b->layer[i] & 1u) != 0;
            if (!seen || !body_inside(w, &region, &box, i)) {
                continue;
            }
            visit v = {core_columns_handle(&t->set, k), core_columns_handle(&b->set, i)};
            uint32_t at = n++;
            for (; at > 0 && visit_order(&out[at - 1], &v) > 0; at--) {
                out[at] = out[at - 1];
            }
            out[at] = v;
        }
    }
    return n;
}

static void tell(phys_world *w, phys_event_kind kind, const visit *v) {
    phys_event_push(&w->events, &(phys_event){.kind = kind, .trigger = v->trigger, .a = v->body});
}

static void store_visits(phys_visits *s, const visit *now, uint32_t n) {
    while (core_columns_count(&s->set) > n) {
        uint32_t last = core_columns_count(&s->set) - 1;
        core_columns_remove(&s->set, core_columns_handle(&s->set, last), NULL, NULL);
    }
    while (core_columns_count(&s->set) < n) {
        core_columns_add(&s->set);
    }
    for (uint32_t i = 0; i < n; i++) {
        s->trigger[i] = now[i].trigger;
        s->body[i] = now[i].body;
    }
}

void phys_events_triggers(phys_world *w) {
    phys_visits *s = &w->visits;
    uint32_t old_count = core_columns_count(&s->set);
    if (core_columns_count(&w->triggers.set) == 0 && old_count == 0) {
        return;
    }
    size_t mark = core_arena_mark(&w->scratch);
    uint64_t most =
        (uint64_t)core_columns_count(&w->triggers.set) * core_columns_count(&w->bodies.set);
    uint32_t room = (uint32_t)CORE_MIN(most, (uint64_t)s->set.pool.capacity);
    visit *now = CORE_ARENA_ARRAY(&w->scratch, visit, room + 1);
    uint32_t n = find_visits(w, now, room);
    uint32_t i = 0, j = 0;
    while (i < old_count || j < n) {
        visit old = i < old_count ? (visit){s->trigger[i], s->body[i]} : (visit){0};
        int order = i >= old_count ? 1 : j >= n ? -1 : visit_order(&old, &now[j]);
        if (order == 0 && visit_same(&old, &now[j])) {
            tell(w, PHYS_TRIGGER_STAY, &now[j++]);
            i++;
        } else if (order <= 0) { // gone, or its slot has a new owner that enters next
            tell(w, PHYS_TRIGGER_EXIT, &old);
            i++;
        } else {
            tell(w, PHYS_TRIGGER_ENTER, &now[j++]);
        }
    }
    store_visits(s, now, n);
    core_arena_rewind(&w->scratch, mark);
}

static core_handle slot_handle(const core_columns *set, uint32_t slot) {
    return core_columns_handle(set, phys_slot_row(set, slot));
}

static bool wants_events(const phys_world *w, uint32_t sa, uint32_t sb) {
    uint32_t a = phys_slot_row(&w->bodies.set, w->shapes.body[phys_slot_row(&w->shapes.set, sa)]);
    uint32_t b = phys_slot_row(&w->bodies.set, w->shapes.body[phys_slot_row(&w->shapes.set, sb)]);
    return ((w->bodies.flags[a] | w->bodies.flags[b]) & PHYS_BODY_EVENTS) != 0;
}

static phys_event contact_event(const phys_world *w, phys_event_kind kind, uint32_t sa,
                                uint32_t sb) {
    uint32_t ba = w->shapes.body[phys_slot_row(&w->shapes.set, sa)];
    uint32_t bb = w->shapes.body[phys_slot_row(&w->shapes.set, sb)];
    return (phys_event){
        .kind = kind, .a = slot_handle(&w->bodies.set, ba), .b = slot_handle(&w->bodies.set, bb)};
}

void phys_events_contact_end(phys_world *w, phys_event_list *list, uint32_t sa, uint32_t sb) {
    if (wants_events(w, sa, sb)) {
        phys_event e = contact_event(w, PHYS_CONTACT_END, sa, sb);
        phys_event_push(list, &e);
    }
}

static float closing_speed(const phys_world *w, uint32_t a, uint32_t b, core_vec3 normal) {
    const phys_bodies *p = &w->bodies;
    core_vec3 dv =
        core_v3_sub(phys_get3(p->vx, p->vy, p->vz, a), phys_get3(p->vx, p->vy, p->vz, b));
    return CORE_MAX(core_v3_dot(dv, normal), 0.0f);
}

#define HIT_SPEED 1.0f // m/s

static void contact_change(phys_world *w, bool touch, uint8_t *was, uint32_t sa, uint32_t sb,
                           core_vec3 normal, float speed) {
    bool before = *was != 0, hit = touch && before && speed > HIT_SPEED;
    if (touch == before && !hit) {
        return;
    }
    *was = touch;
    if (!touch) {
        phys_events_contact_end(w, &w->events, sa, sb);
    } else if (wants_events(w, sa, sb)) {
        phys_event e = contact_event(w, hit ? PHYS_CONTACT_HIT : PHYS_CONTACT_BEGIN, sa, sb);
        e.normal = normal;
        e.speed = speed;
        phys_event_push(&w->events, &e);
    }
}

static float least_gap(const phys_manifold *m) {
    float least = 1e30f;
    for (uint32_t k = 0; k < m->count; k++) {
        least = CORE_MIN(least, m->point[k].separation);
    }
    return least;
}

static bool on_mesh(const phys_world *w, uint32_t shape_slot) {
    return w->shapes.type[phys_slot_row(&w->shapes.set, shape_slot)] == PHYS_MESH;
}

// A mesh is one thing to touch, in however many places: it tells of the first, with the greatest
// speed of approach.
static void mesh_contact(phys_world *w, uint32_t i, float dt) {
    phys_mesh_pairs *p = &w->mesh_pairs;
    bool touch = false;
    float most = -1.0f;
    core_vec3 normal = core_v3(0, 0, 0);
    for (uint32_t k = 0; k < p->count[i]; k++) {
        uint32_t slot = p->rows[i].slot[k];
        uint32_t row = phys_slot_row(p->ball[i] ? &w->balls.set : &w->contacts.set, slot);
        core_vec3 n = p->ball[i] ? phys_get3(w->balls.nx, w->balls.ny, w->balls.nz, row)
                                 : w->contacts.manifold[row].normal;
        float gap = p->ball[i] ? w->balls.separation[row] : least_gap(&w->contacts.manifold[row]);
        float speed = closing_speed(w, p->a[i], p->b[i], n);
        if (gap <= PHYS_TOUCH + speed * dt && speed > most) {
            touch = true;
            most = speed;
            normal = n;
        }
    }
    contact_change(w, touch, &p->touch[i], p->sa[i], p->sb[i], normal, most);
}

// Touching: the gap is closed, or closes within this step. Told before the solver changes
// velocities, so that the speed is that of the approach.
void phys_events_contacts(phys_world *w, float dt) {
    phys_balls *c = &w->balls;
    for (uint32_t i = 0; i < core_columns_count(&c->set); i++) {
        if (on_mesh(w, c->sb[i])) {
            continue;
        }
        core_vec3 n = phys_get3(c->nx, c->ny, c->nz, i);
        float speed = closing_speed(w, c->a[i], c->b[i], n);
        contact_change(w, c->separation[i] <= PHYS_TOUCH + speed * dt, &c->touch[i], c->sa[i],
                       c->sb[i], n, speed);
    }
    phys_contacts *m = &w->contacts;
    for (uint32_t i = 0; i < core_columns_count(&m->set); i++) {
        if (on_mesh(w, m->sb[i])) {
            continue;
        }
        float least = least_gap(&m->manifold[i]);
        float speed = closing_speed(w, m->a[i], m->b[i], m->manifold[i].normal);
        contact_change(w, least <= PHYS_TOUCH + speed * dt, &m->touch[i], m->sa[i], m->sb[i],
                       m->manifold[i].normal, speed);
    }
    for (uint32_t i = 0; i < core_columns_count(&w->mesh_pairs.set); i++) {
        mesh_contact(w, i, dt);
    }
}
