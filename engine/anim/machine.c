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
    if (!add_points(w, m, s, d)) {
        return false;
    }
    anim_clip clip = d->blend_count ? d->blend[0].clip : d->clip;
    anim_clip_res *c = anim_get_clip(w, clip);
    if (!c) {
        return core_fail("state machine: state \"%s\" needs a clip that exists", s->name);
    }
    if (m->state_count > 0 && !core_handle_equal(c->skeleton, m->skeleton)) {
        return core_fail("state machine: state \"%s\": clip %s is for another skeleton than state "
                         "\"%s\"",
                         s->name, c->name, m->state[0].name);
    }
    if (d->loop > ANIM_PING_PONG || !isfinite(d->speed)) {
        return core_fail("state machine: state \"%s\": loop %d, speed %g; expected a loop mode and "
                         "a finite speed",
                         s->name, (int)d->loop, d->speed);
    }
    m->skeleton = c->skeleton;
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
    for (uint32_t i = 0; i < d->state_count; i++) {
        if (!add_state(w, m, &d->state[i])) {
            return false;
        }
    }
    for (uint32_t i = 0; i < d->transition_count; i++) {
        if (!add_transition(m, &d->transition[i])) {
            return false;
        }
    }
    int32_t initial = d->initial ? find_state(m, d->initial) : 0;
    m->initial = (uint32_t)initial;
    return initial >= 0;
}

static void count_users(anim_world *w, const anim_machine_res *m, int by) {
    for (uint32_t i = 0; i < m->state_count; i++) {
        anim_get_clip(w, m->state[i].clip)->users += (uint32_t)by;
    }
    for (uint32_t i = 0; i < m->point_count; i++) {
        anim_get_clip(w, m->point[i].clip)->users += (uint32_t)by;
    }
}

anim_machine anim_machine_create(anim_world *w, const anim_machine_desc *d) {
    if (!d || d->cookie != ANIM_COOKIE || d->state_count == 0 || d->state_count > ANIM_MAX_STATES ||
        d->parameter_count > ANIM_MAX_PARAMETERS || d->transition_count > 65536) {
        core_fail("state machine: expected a description made by anim_machine_desc_default() with "
                  "1..%u states and at most %u parameters",
                  ANIM_MAX_STATES, ANIM_MAX_PARAMETERS);
        return CORE_NULL_HANDLE;
    }
    size_t points = 0;
    for (uint32_t i = 0; i < d->state_count; i++) {
        points += d->state[i].blend_count;
    }
    anim_machine_res *m = core_alloc(sizeof *m + d->state_count * sizeof(anim_state) +
                                     d->transition_count * sizeof(anim_transition) +
                                     points * sizeof(anim_blend_point));
    m->state = (anim_state *)(m + 1);
    m->transition = (anim_transition *)(m->state + d->state_count);
    m->point = (anim_blend_point *)(m->transition + d->transition_count);
    core_handle h = fill(w, m, d) ? anim_resource_add(&w->machines, m) : CORE_NULL_HANDLE;
    if (core_handle_is_null(h)) {
        core_free(m);
        return h;
    }
    count_users(w, m, 1);
    return h;
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
