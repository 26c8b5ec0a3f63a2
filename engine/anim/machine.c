// State machines as shared tables: names are resolved to numbers once, at creation.
#include "anim/anim_internal.h"

#include <math.h>
#include <string.h>

anim_machine_desc anim_machine_desc_default(void) {
    return (anim_machine_desc){.cookie = ANIM_COOKIE};
}

static bool copy_name(char out[CORE_NAME_MAX], const char *name, const char *what) {
    if (!name || !name[0] || strlen(name) >= CORE_NAME_MAX) {
        return core_fail("state machine: a %s needs a name of 1..%d bytes", what,
                         CORE_NAME_MAX - 1);
    }
    memcpy(out, name, strlen(name) + 1);
    return true;
}

static int32_t find_state(const anim_machine_res *m, const char *name) {
    for (uint32_t i = 0; i < m->state_count; i++) {
        if (strcmp(m->state[i].name, name) == 0) {
            return (int32_t)i;
        }
    }
    anim_unknown("no state", name, m->state, sizeof *m->state, m->state_count);
    return -1;
}

// Numbers the event on first use.
static bool event_number(anim_machine_res *m, const char *name, uint32_t *out) {
    for (*out = 0; name && *out < m->event_count; (*out)++) {
        if (strcmp(m->event[*out], name) == 0) {
            return true;
        }
    }
    if (m->event_count == ANIM_MAX_EVENTS) {
        return core_fail("state machine: more than %u event names", ANIM_MAX_EVENTS);
    }
    return copy_name(m->event[m->event_count++], name, "transition on an event");
}

static bool parameter_number(const anim_machine_res *m, const char *name, uint32_t *out) {
    for (*out = 0; name && *out < m->parameter_count; (*out)++) {
        if (strcmp(m->parameter[*out], name) == 0) {
            return true;
        }
    }
    return anim_unknown("no parameter", name ? name : "", m->parameter, CORE_NAME_MAX,
                        m->parameter_count);
}

// Which state holds this one; its entry is the first that does.
static bool add_within(anim_machine_res *m, anim_state *s, const anim_state_desc *d) {
    s->parent = -1;
    if (!d->within) {
        return true;
    }
    s->parent = find_state(m, d->within);
    if (s->parent < 0) {
        return false;
    }
    anim_state *outer = &m->state[s->parent];
    if (!core_handle_is_null(outer->clip)) {
        return core_fail("state machine: state \"%s\" plays a clip, so it cannot hold \"%s\"",
                         outer->name, s->name);
    }
    m->nested = true;
    return true;
}

// Entries of the states that hold others: the first state in each, down to one that plays.
static bool find_entries(anim_machine_res *m) {
    for (uint32_t i = m->state_count; i-- > 0;) {
        anim_state *s = &m->state[i];
        s->entry = core_handle_is_null(s->clip) ? -1 : (int32_t)i;
        for (uint32_t k = i + 1; s->entry < 0 && k < m->state_count; k++) {
            s->entry = m->state[k].parent == (int32_t)i ? m->state[k].entry : -1;
        }
        if (s->entry < 0) {
            return core_fail("state machine: state \"%s\" needs a clip that exists, or states "
                             "within it",
                             s->name);
        }
    }
    return true;
}

static bool add_points(const anim_world *w, anim_machine_res *m, anim_state *s,
                       const anim_state_desc *d) {
    s->first_point = m->point_count;
    for (uint32_t i = 0; i < d->blend_count; i++) {
        const anim_clip_res *c = anim_get_clip(w, d->blend[i].clip);
        const anim_clip_res *first = anim_get_clip(w, d->blend[0].clip);
        if (!c || !first || !core_handle_equal(c->skeleton, first->skeleton)) {
            return core_fail("state machine: state \"%s\": point %u needs a clip of the same "
                             "skeleton as the others",
                             s->name, i + 1);
        }
        if (!isfinite(d->blend[i].value) ||
            (i > 0 && !(d->blend[i].value > d->blend[i - 1].value))) {
            return core_fail("state machine: state \"%s\": point %u at %g; values must grow",
                             s->name, i + 1, d->blend[i].value);
        }
        m->point[m->point_count++] = d->blend[i];
    }
    s->point_count = d->blend_count;
    return d->blend_count == 0 || parameter_number(m, d->blend_parameter, &s->blend_parameter);
}

static bool add_state(anim_world *w, anim_machine_res *m, const anim_state_desc *d) {
    anim_state *s = &m->state[m->state_count];
    if (!copy_name(s->name, d->name, "state")) {
        return false;
    }
    for (uint32_t i = 0; i < m->state_count; i++) {
        if (strcmp(m->state[i].name, s->name) == 0) {
            return core_fail("state machine: two states are called \"%s\"", s->name);
        }
    }
    if (!add_within(m, s, d) || !add_points(w, m, s, d)) {
        return false;
    }
    anim_clip clip = d->blend_count ? d->blend[0].clip : d->clip;
    bool holds = core_handle_is_null(clip);
    anim_clip_res *c = holds ? NULL : anim_get_clip(w, clip);
    if (!c && !holds) {
        return core_fail("state machine: state \"%s\" needs a clip that exists", s->name);
    }
    if (c && !core_handle_is_null(m->skeleton) && !core_handle_equal(c->skeleton, m->skeleton)) {
        return core_fail("state machine: state \"%s\": clip %s is for another skeleton than the "
                         "states before it",
                         s->name, c->name);
    }
    if (d->loop > ANIM_PING_PONG || !isfinite(d->speed)) {
        return core_fail("state machine: state \"%s\": loop %d, speed %g; expected a loop mode and "
                         "a finite speed",
                         s->name, (int)d->loop, d->speed);
    }
    m->skeleton = c ? c->skeleton : m->skeleton;
    s->clip = clip;
    s->loop = d->blend_count ? ANIM_LOOP : d->loop;
    s->speed = d->speed == 0 ? 1 : d->speed;
    s->on_enter = d->on_enter;
    s->on_exit = d->on_exit;
    s->on_tick = d->on_tick;
    s->speed_fn = d->speed_fn;
    s->ctx = d->ctx;
    m->state_count++;
    return true;
}

static bool check_trigger(anim_machine_res *m, anim_transition *t, const anim_transition_desc *d) {
    switch (d->when) {
    case ANIM_WHEN_FINISHED:
        return true;
    case ANIM_WHEN_CONDITION:
        return d->condition ? true
                            : core_fail("state machine: transition to \"%s\": no condition", d->to);
    case ANIM_WHEN_EVENT:
        return event_number(m, d->event, &t->event);
    case ANIM_WHEN_PARAMETER:
        return isfinite(d->value) && d->compare <= ANIM_NOT_EQUAL
                   ? parameter_number(m, d->parameter, &t->parameter)
                   : core_fail("state machine: transition to \"%s\": comparison %d with %g", d->to,
                               (int)d->compare, d->value);
    }
    return core_fail("state machine: transition to \"%s\": unknown kind %d", d->to, (int)d->when);
}

static bool add_transition(anim_machine_res *m, const anim_transition_desc *d) {
    anim_transition *t = &m->transition[m->transition_count];
    t->from = d->from ? find_state(m, d->from) : -1;
    t->to = d->to ? find_state(m, d->to) : -1;
    if ((d->from && t->from < 0) || t->to < 0) {
        return d->to ? false : core_fail("state machine: a transition names no target state");
    }
    if (!isfinite(d->length) || d->length < 0 || d->fade > ANIM_FADE_SMOOTH) {
        return core_fail("state machine: transition to \"%s\": length %g s, expected >= 0", d->to,
                         d->length);
    }
    t->when = d->when;
    t->last = d->when == ANIM_WHEN_FINISHED && t->from >= 0 &&
              core_handle_is_null(m->state[t->from].clip);
    t->condition = d->condition;
    t->ctx = d->ctx;
    t->compare = d->compare;
    t->value = d->value;
    t->length = d->length;
    t->fade = d->fade;
    t->uninterruptible = d->uninterruptible;
    t->sync = d->sync;
    m->transition_count++;
    return check_trigger(m, t, d);
}

static bool add_all(anim_world *w, anim_machine_res *m, const anim_machine_desc *d) {
    for (uint32_t i = 0; i < d->state_count; i++) {
        if (!add_state(w, m, &d->state[i])) {
            return false;
        }
    }
    if (!find_entries(m)) {
        return false;
    }
    for (uint32_t i = 0; i < d->transition_count; i++) {
        if (!add_transition(m, &d->transition[i])) {
            return false;
        }
    }
    return true;
}

static bool fill(anim_world *w, anim_machine_res *m, const anim_machine_desc *d) {
    for (uint32_t i = 0; i < d->parameter_count; i++) {
        if (!copy_name(m->parameter[i], d->parameter[i].name, "parameter")) {
            return false;
        }
        if (!isfinite(d->parameter[i].value)) {
            return core_fail("state machine: parameter \"%s\" starts at %g", m->parameter[i],
                             d->parameter[i].value);
        }
        m->start_value[i] = d->parameter[i].value;
        m->parameter_count++;
    }
    if (!add_all(w, m, d)) {
        return false;
    }
    int32_t initial = d->initial ? find_state(m, d->initial) : 0;
    m->initial = initial < 0 ? 0 : (uint32_t)m->state[initial].entry;
    return initial >= 0;
}

static void count_users(anim_world *w, const anim_machine_res *m, int by) {
    for (uint32_t i = 0; i < m->state_count; i++) {
        if (m->state[i].entry == (int32_t)i) {
            anim_get_clip(w, m->state[i].clip)->users += (uint32_t)by;
        }
    }
    for (uint32_t i = 0; i < m->point_count; i++) {
        anim_get_clip(w, m->point[i].clip)->users += (uint32_t)by;
    }
}

static bool check_counts(const anim_machine_desc *d, size_t states, size_t transitions) {
    return (d && d->cookie == ANIM_COOKIE && states > 0 && states <= ANIM_MAX_STATES &&
            d->parameter_count <= ANIM_MAX_PARAMETERS && transitions <= 65536) ||
           core_fail("state machine: expected a description made by anim_machine_desc_default() "
                     "with 1..%u states, at most %u parameters and 65536 transitions",
                     ANIM_MAX_STATES, ANIM_MAX_PARAMETERS);
}

// Room for what `base` has (NULL: nothing) and `d` adds, in one block; holds a copy of base.
static anim_machine_res *make_room(const anim_machine_res *base, const anim_machine_desc *d) {
    static const anim_machine_res empty;
    base = base ? base : &empty;
    size_t states = base->state_count + d->state_count;
    size_t transitions = base->transition_count + d->transition_count;
    size_t points = base->point_count;
    for (uint32_t i = 0; i < d->state_count; i++) {
        points += d->state[i].blend_count;
    }
    anim_machine_res *m =
        core_alloc(sizeof *m + states * sizeof(anim_state) + transitions * sizeof(anim_transition) +
                   points * sizeof(anim_blend_point));
    *m = *base;
    m->state = (anim_state *)(m + 1);
    m->transition = (anim_transition *)(m->state + states);
    m->point = (anim_blend_point *)(m->transition + transitions);
    if (base != &empty) {
        memcpy(m->state, base->state, base->state_count * sizeof(anim_state));
        memcpy(m->transition, base->transition, base->transition_count * sizeof(anim_transition));
        memcpy(m->point, base->point, base->point_count * sizeof(anim_blend_point));
    }
    return m;
}

anim_machine anim_machine_create(anim_world *w, const anim_machine_desc *d) {
    if (!check_counts(d, d ? d->state_count : 0, d ? d->transition_count : 0)) {
        return CORE_NULL_HANDLE;
    }
    anim_machine_res *m = make_room(NULL, d);
    core_handle h = fill(w, m, d) ? anim_resource_add(&w->machines, m) : CORE_NULL_HANDLE;
    if (core_handle_is_null(h)) {
        core_free(m);
        return h;
    }
    count_users(w, m, 1);
    return h;
}

static void replace(anim_world *w, anim_machine h, anim_machine_res *old, anim_machine_res *m) {
    count_users(w, m, 1);
    count_users(w, old, -1);
    w->machines.item[core_columns_row(&w->machines.set, h)] = m;
    core_free(old);
}

bool anim_machine_extend(anim_world *w, anim_machine h, const anim_machine_desc *d) {
    anim_machine_res *old = anim_get_machine(w, h);
    if (!old || !d || d->parameter_count > 0 || d->initial) {
        return core_fail(old ? "state machine: what is added has states and transitions only"
                             : "state machine: there is none to extend");
    }
    if (!check_counts(d, old->state_count + (size_t)d->state_count,
                      old->transition_count + (size_t)d->transition_count)) {
        return false;
    }
    anim_machine_res *m = make_room(old, d);
    if (!add_all(w, m, d)) {
        core_free(m);
        return false;
    }
    replace(w, h, old, m);
    return true;
}

void anim_machine_size(const anim_world *w, anim_machine h, uint32_t *states,
                       uint32_t *transitions) {
    const anim_machine_res *m = anim_get_machine(w, h);
    *states = m ? m->state_count : 0;
    *transitions = m ? m->transition_count : 0;
}

bool anim_machine_trim(anim_world *w, anim_machine h, uint32_t states, uint32_t transitions) {
    anim_machine_res *old = anim_get_machine(w, h);
    if (!old || states == 0 || states > old->state_count || transitions > old->transition_count) {
        return core_fail("state machine: there are no %u states and %u transitions to keep", states,
                         transitions);
    }
    for (uint32_t p = 0; p < core_columns_count(&w->players.set); p++) {
        bool uses = core_handle_equal(w->players.machine[p], h);
        if (uses && (w->players.now[p].state >= (int32_t)states ||
                     w->players.from[p].state >= (int32_t)states)) {
            return core_fail(
                "state machine: state \"%s\" plays; it cannot be taken away",
                old->state[CORE_MAX(w->players.now[p].state, w->players.from[p].state)].name);
        }
    }
    anim_machine_res *m = make_room(old, &(anim_machine_desc){0});
    m->state_count = states;
    m->transition_count = transitions;
    m->point_count = m->event_count = 0;
    for (uint32_t i = 0; i < states; i++) {
        m->point_count += m->state[i].point_count;
    }
    for (uint32_t i = 0; i < transitions; i++) {
        if (m->transition[i].when == ANIM_WHEN_EVENT) {
            m->event_count = CORE_MAX(m->event_count, m->transition[i].event + 1);
        }
        if (m->transition[i].to >= (int32_t)states || m->transition[i].from >= (int32_t)states) {
            core_free(m);
            return core_fail("state machine: transition %u leads to a state that would go", i);
        }
    }
    replace(w, h, old, m);
    return true;
}

static const char *name_of(const anim_machine_res *m, int32_t state) {
    return state < 0 ? "" : m->state[state].name;
}

bool anim_machine_state_at(const anim_world *w, anim_machine h, uint32_t i, const char **name,
                           const char **within) {
    const anim_machine_res *m = anim_get_machine(w, h);
    if (!m || i >= m->state_count) {
        return false;
    }
    *name = m->state[i].name;
    *within = name_of(m, m->state[i].parent);
    return true;
}

bool anim_machine_transition_at(const anim_world *w, anim_machine h, uint32_t i, const char **from,
                                const char **to) {
    const anim_machine_res *m = anim_get_machine(w, h);
    if (!m || i >= m->transition_count) {
        return false;
    }
    *from = name_of(m, m->transition[i].from);
    *to = name_of(m, m->transition[i].to);
    return true;
}

bool anim_machine_destroy(anim_world *w, anim_machine h) {
    anim_machine_res *m = anim_get_machine(w, h);
    if (!m) {
        return false;
    }
    if (m->users) {
        return core_fail("state machine: %u instances still use it; destroy them first", m->users);
    }
    count_users(w, m, -1);
    core_free(m);
    return core_columns_remove(&w->machines.set, h, NULL, NULL);
}
