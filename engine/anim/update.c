// The state pass: time, fades, transitions and callbacks, instance by instance in row order. Any
// callback may change the instance, so columns are read again after each.
#include "anim/anim_internal.h"

#include <math.h>

static anim_instance handle_of(const anim_world *w, uint32_t row) {
    return core_columns_handle(&w->instances.set, row);
}
static bool doomed(const anim_world *w, uint32_t row) {
    return (w->instances.flags[row] & ANIM_DOOMED) != 0;
}
static uint32_t player_of(const anim_world *w, uint32_t row) {
    return core_columns_row(&w->players.set, w->instances.player[row]);
}
// NULL for slots that play a clip by itself.
static const anim_state *state_of(const anim_world *w, uint32_t p, const anim_slot *slot) {
    return slot->state < 0 ? NULL : &anim_get_machine(w, w->players.machine[p])->state[slot->state];
}

// The state that holds this one; NULL without.
static const anim_state *outer_of(const anim_world *w, uint32_t p, const anim_state *s) {
    const anim_machine_res *m = anim_get_machine(w, w->players.machine[p]);
    return s->parent < 0 ? NULL : &m->state[s->parent];
}

// Length of one period of a slot's own time.
static float period(const anim_motion *m) {
    return m->loop == ANIM_PING_PONG ? 2 * m->length : m->length;
}

float anim_fade_weight(const anim_world *w, uint32_t p) {
    if (!(w->players.flags[p] & ANIM_FADING)) {
        return 1;
    }
    float s = CORE_CLAMP(w->players.fade_time[p] / w->players.fade_length[p], 0.0f, 1.0f);
    return w->players.flags[p] & ANIM_SMOOTH ? s * s * (3 - 2 * s) : s;
}

static void add_event(anim_world *w, uint32_t row, core_handle clip, const anim_clip_event *e) {
    if (w->event_count == w->event_capacity) {
        uint32_t capacity = w->event_capacity ? w->event_capacity * 2 : 64;
        w->event = core_realloc(w->event, w->event_capacity * sizeof *w->event,
                                capacity * sizeof *w->event);
        w->event_capacity = capacity;
    }
    w->event[w->event_count++] = (anim_event){handle_of(w, row), clip, e->name, e->time};
}

// Events passed while the clip's own time runs from a to b without wrapping: [a, b) forwards, (b,
// a] backwards, with the end of the clip when it is reached.
static void events_between(anim_world *w, uint32_t row, core_handle clip, const anim_clip_res *c,
                           float a, float b) {
    for (uint32_t i = 0; i < c->event_count; i++) {
        const anim_clip_event *e = &c->event[b >= a ? i : c->event_count - 1 - i];
        bool forwards =
            a < b && e->time >= a && (e->time < b || (b == c->duration && e->time == b));
        bool backwards = a > b && e->time <= a && (e->time > b || (b == 0 && e->time == 0));
        if (forwards || backwards) {
            add_event(w, row, clip, e);
        }
    }
}

typedef struct slot_step {
    bool wrapped;   // an end of the clip was passed
    core_vec3 root; // displacement
    float rate;     // clip seconds a second
} slot_step;

// One straight piece of a step in slot time, where the clip's time runs one way.
static void piece(anim_world *w, uint32_t row, const anim_motion *m, float a, float b,
                  slot_step *out) {
    bool mirrored = m->loop == ANIM_PING_PONG && (a + b) * 0.5f > m->length;
    float d = 2 * m->length, ta = mirrored ? d - a : a, tb = mirrored ? d - b : b;
    uint32_t louder = m->clip[1] && m->weight > 0.5f; // whose events are told
    for (uint32_t i = 0; i < 2 && m->clip[i]; i++) {
        const anim_clip_res *c = m->clip[i];
        float from = ta * m->scale[i], to = tb == m->length ? c->duration : tb * m->scale[i];
        if (i == louder) {
            events_between(w, row, m->handle[i], c, from, to);
        }
        if (c->root_motion) {
            core_vec3 moved = anim_root_between(c, from, to);
            out->root = core_v3_mad(out->root, moved, i ? m->weight : 1 - m->weight);
        }
    }
}

// The next place where a straight piece ends.
static float piece_end(const anim_motion *m, float t, bool forwards) {
    float d = m->length;
    if (m->loop == ANIM_PING_PONG) {
        return forwards ? (t < d ? d : 2 * d) : (t > d ? d : 0);
    }
    return forwards ? d : 0;
}

// More whole periods than this in one step keep their phase and tell no events.
#define MAX_PIECES 256

static void advance_time(anim_world *w, uint32_t row, anim_slot *slot, const anim_motion *m,
                         float delta, slot_step *out) {
    float p = period(m), t = slot->time;
    if (m->loop == ANIM_ONCE) {
        float end = CORE_CLAMP(t + delta, 0.0f, m->length);
        piece(w, row, m, CORE_CLAMP(t, 0.0f, m->length), end, out);
        out->wrapped = t + delta >= m->length || (delta < 0 && t + delta <= 0);
        slot->time = end;
        return;
    }
    if (!(t >= 0 && t <= p)) {
        t = (float)core_fmod(t, p);
        t = t < 0 ? t + p : t;
    }
    bool forwards = delta >= 0;
    for (int i = 0; delta != 0 && i < MAX_PIECES; i++) {
        if (forwards ? t >= p : t <= 0) {
            t = forwards ? 0 : p;
        }
        float end = piece_end(m, t, forwards), next = t + delta;
        if (forwards ? next < end : next > end) {
            piece(w, row, m, t, next, out);
            t = next;
            delta = 0;
        } else {
            piece(w, row, m, t, end, out);
            delta -= end - t;
            t = end;
            out->wrapped = out->wrapped || t >= p || t <= 0;
        }
    }
    if (delta != 0) {
        t = (float)core_fmod((double)t + delta, p);
        t = t < 0 ? t + p : t;
    }
    slot->time = t;
}

// Slot time a second at speed 1: a blend tree's phase runs by its blended duration.
static float base_rate(const anim_motion *m, const anim_state *s) {
    if (!s || !s->point_count) {
        return 1;
    }
    float d = m->scale[0] + (m->clip[1] ? (m->scale[1] - m->scale[0]) * m->weight : 0);
    return 1 / d;
}

static slot_step advance(anim_world *w, uint32_t row, uint32_t p, bool leaving, float dt) {
    anim_slot *slot = leaving ? &w->players.from[p] : &w->players.now[p];
    slot_step out = {0};
    anim_motion m = anim_slot_motion(w, p, slot);
    if (!m.clip[0]) {
        return out;
    }
    const anim_state *s = state_of(w, p, slot);
    float rate = w->instances.speed[row] * base_rate(&m, s);
    for (; s; s = outer_of(w, p, s)) {
        rate *= s->speed;
        if (s->speed_fn) {
            float phase = anim_motion_time(&m, slot->time) / m.length;
            float factor = s->speed_fn(s->ctx, w, handle_of(w, row), phase);
            rate *= isfinite(factor) ? factor : 1;
        }
    }
    out.rate = rate;
    if (!doomed(w, row)) {
        advance_time(w, row, slot, &m, dt * rate, &out);
    }
    return out;
}

static void call(anim_world *w, uint32_t row, anim_state_fn *fn, void *ctx) {
    if (fn && !doomed(w, row)) {
        fn(ctx, w, handle_of(w, row));
    }
}

// onExit of a state and of those around it that do not hold `now`, from the inside out. Callbacks
// may destroy the instance or give it another machine's place, so the machine is looked up each
// time.
static void leave_states(anim_world *w, uint32_t row, uint32_t p, int32_t left, int32_t now) {
    bool itself = true;
    while (left >= 0 && !doomed(w, row)) {
        const anim_machine_res *m = anim_get_machine(w, w->players.machine[p]);
        if (!itself && anim_state_in(m, now, left)) {
            return;
        }
        const anim_state *s = &m->state[left];
        left = s->parent;
        itself = false;
        call(w, row, s->on_exit, s->ctx);
    }
}

// onEnter from the outside in, but for states that held `before`.
static void enter_states(anim_world *w, uint32_t row, uint32_t p, int32_t before, int32_t now) {
    int32_t path[ANIM_MAX_STATES];
    uint32_t depth = 0;
    const anim_machine_res *m = anim_get_machine(w, w->players.machine[p]);
    for (int32_t s = now; s >= 0 && (s == now || !anim_state_in(m, before, s));
         s = m->state[s].parent) {
        path[depth++] = s;
    }
    while (depth > 0 && !doomed(w, row) && w->players.now[p].state == now) {
        const anim_state *s = &m->state[path[--depth]];
        call(w, row, s->on_enter, s->ctx);
    }
}

static void set_slot(anim_world *w, anim_slot *slot, anim_slot value) {
    if (!core_handle_is_null(value.clip)) {
        anim_get_clip(w, value.clip)->users++;
    }
    if (!core_handle_is_null(slot->clip)) {
        anim_get_clip(w, slot->clip)->users--;
    }
    *slot = value;
}

static void exit_from(anim_world *w, uint32_t row, uint32_t p) {
    int32_t left = w->players.from[p].state, now = w->players.now[p].state;
    set_slot(w, &w->players.from[p], (anim_slot){.state = -1});
    anim_snapshot_drop(w, w->players.snapshot[p]);
    w->players.snapshot[p] = CORE_NULL_HANDLE;
    w->players.flags[p] = 0;
    leave_states(w, row, p, left, now);
}

static core_handle freeze(anim_world *w, uint32_t row, uint32_t p) {
    const anim_skeleton_res *s = anim_get_skeleton(w, w->instances.skeleton[row]);
    core_arena *arena = anim_scratch(w, 0);
    size_t mark = core_arena_mark(arena);
    float *pose = anim_scratch_pose(arena, s);
    anim_evaluate_player(w, s, p, arena, pose);
    core_handle h = anim_snapshot_take(w, s, pose);
    core_arena_rewind(arena, mark);
    return h;
}

void anim_player_start(anim_world *w, uint32_t row, uint32_t p, anim_slot to, float length,
                       anim_fade fade, bool locked) {
    bool interrupts = (w->players.flags[p] & ANIM_FADING) != 0;
    int32_t before = w->players.now[p].state;
    core_handle snapshot = CORE_NULL_HANDLE;
    if (interrupts) {
        snapshot = length > 0 ? freeze(w, row, p) : CORE_NULL_HANDLE;
        exit_from(w, row, p);
    }
    set_slot(w, &w->players.from[p], w->players.now[p]);
    set_slot(w, &w->players.now[p], to);
    w->players.snapshot[p] = snapshot;
    w->players.fade_time[p] = 0;
    w->players.fade_length[p] = length;
    w->players.flags[p] = ANIM_FADING | (fade == ANIM_FADE_SMOOTH ? (uint32_t)ANIM_SMOOTH : 0u) |
                          (locked ? (uint32_t)ANIM_LOCKED : 0u);
    if (!(length > 0)) {
        exit_from(w, row, p);
    }
    if (to.state >= 0) {
        enter_states(w, row, p, before, to.state);
    }
}

static bool compare(float a, anim_compare how, float b) {
    switch (how) {
    case ANIM_GREATER:
        return a > b;
    case ANIM_LESS:
        return a < b;
    case ANIM_GREATER_EQUAL:
        return a >= b;
    case ANIM_LESS_EQUAL:
        return a <= b;
    case ANIM_EQUAL:
        return a == b;
    case ANIM_NOT_EQUAL:
        return a != b;
    }
    return false;
}

static bool nearly_finished(const anim_world *w, uint32_t p, const slot_step *step, float length) {
    const anim_slot *now = &w->players.now[p];
    anim_motion m = anim_slot_motion(w, p, now);
    float end = period(&m);
    float ahead = step->rate * length;
    bool reaches = step->rate < 0 ? now->time + ahead <= 0 : now->time + ahead >= end;
    return step->wrapped || reaches;
}

static bool matches(anim_world *w, uint32_t row, uint32_t p, const anim_transition *t,
                    const slot_step *step) {
    switch (t->when) {
    case ANIM_WHEN_FINISHED:
        return nearly_finished(w, p, step, t->length);
    case ANIM_WHEN_CONDITION:
        return t->condition(t->ctx, w, handle_of(w, row));
    case ANIM_WHEN_EVENT:
        return (w->players.events[p] >> t->event & 1u) != 0;
    case ANIM_WHEN_PARAMETER:
        return compare(w->players.parameter[p].v[t->parameter], t->compare, t->value);
    }
    return false;
}

// Where the target starts: at its beginning (its end when it plays backwards), or at the phase of
// the state left.
static float start_time(const anim_world *w, uint32_t p, const anim_slot *to, const anim_state *s,
                        bool sync) {
    anim_motion target = anim_slot_motion(w, p, to);
    anim_motion source = anim_slot_motion(w, p, &w->players.now[p]);
    if (!sync || !source.clip[0]) {
        return s->speed < 0 ? period(&target) : 0;
    }
    return w->players.now[p].time / period(&source) * period(&target);
}

static void follow(anim_world *w, uint32_t row, uint32_t p, const anim_transition *t) {
    const anim_machine_res *m = anim_get_machine(w, w->players.machine[p]);
    int32_t entry = m->state[t->to].entry;
    const anim_state *to = &m->state[entry];
    anim_slot slot = {.clip = to->clip, .state = entry, .loop = to->loop};
    slot.time = start_time(w, p, &slot, to, t->sync);
    anim_player_start(w, row, p, slot, t->length, t->fade, t->uninterruptible);
}

// Whether a state holds the one that plays and something within it goes on when that has finished.
static bool goes_on(const anim_machine_res *m, const anim_transition *t, int32_t state) {
    for (uint32_t i = 0; i < m->transition_count; i++) {
        const anim_transition *u = &m->transition[i];
        if (u->when == ANIM_WHEN_FINISHED && u->from != t->from && u->from >= 0 &&
            anim_state_in(m, u->from, t->from) && anim_transition_leaves(m, u, state)) {
            return true;
        }
    }
    return false;
}

static void follow_transitions(anim_world *w, uint32_t row, uint32_t p, const slot_step *step) {
    int32_t state = w->players.now[p].state;
    if (state < 0 || (w->players.flags[p] & ANIM_LOCKED)) {
        return;
    }
    const anim_machine_res *m = anim_get_machine(w, w->players.machine[p]);
    for (int last = 0; last <= m->nested; last++) {
        for (uint32_t i = 0; i < m->transition_count; i++) {
            const anim_transition *t = &m->transition[i];
            if (t->last != last || !anim_transition_leaves(m, t, state) ||
                (last && goes_on(m, t, state)) || !matches(w, row, p, t, step)) {
                continue;
            }
            if (!doomed(w, row) && w->players.now[p].state == state) {
                follow(w, row, p, t); // else a condition changed the instance itself
            }
            return;
        }
    }
}

static void tick(anim_world *w, uint32_t row, uint32_t p, float dt) {
    const anim_machine_res *m = anim_get_machine(w, w->players.machine[p]);
    int32_t path[ANIM_MAX_STATES];
    uint32_t depth = 0;
    for (int32_t s = w->players.now[p].state; s >= 0; s = m->state[s].parent) {
        path[depth++] = s;
    }
    int32_t state = w->players.now[p].state;
    while (depth > 0 && !doomed(w, row) && w->players.now[p].state == state) {
        const anim_state *s = &m->state[path[--depth]];
        if (s->on_tick) {
            s->on_tick(s->ctx, w, handle_of(w, row), dt);
        }
    }
}

static void add_root(anim_world *w, uint32_t row, core_vec3 d, float weight) {
    w->instances.root_x[row] += d.x * weight;
    w->instances.root_y[row] += d.y * weight;
    w->instances.root_z[row] += d.z * weight;
}

static void advance_fade(anim_world *w, uint32_t row, uint32_t p, float dt) {
    w->players.fade_time[p] += dt;
    if (w->players.fade_time[p] >= w->players.fade_length[p]) {
        exit_from(w, row, p);
    }
}

static void update_player(anim_world *w, uint32_t row, uint32_t p, float dt) {
    bool fading = (w->players.flags[p] & ANIM_FADING) != 0, base = p == player_of(w, row);
    slot_step step = advance(w, row, p, false, dt), left = {0};
    float weight = 1;
    if (fading && !doomed(w, row)) {
        if (core_handle_is_null(w->players.snapshot[p])) {
            left = advance(w, row, p, true, dt);
        }
        advance_fade(w, row, p, dt);
        weight = anim_fade_weight(w, p);
    }
    if (base) { // layers do not move the root
        add_root(w, row, left.root, 1 - weight);
        add_root(w, row, step.root, weight);
    }
    if (!doomed(w, row)) {
        follow_transitions(w, row, p, &step);
    }
    w->players.events[p] = 0;
    if (w->players.now[p].state >= 0) {
        tick(w, row, p, dt);
    }
}

static void update_instance(anim_world *w, uint32_t row, float dt) {
    w->instances.root_x[row] = w->instances.root_y[row] = w->instances.root_z[row] = 0;
    update_player(w, row, player_of(w, row), dt);
    for (uint32_t i = 0; w->instances.layered[row] && i < ANIM_MAX_LAYERS; i++) {
        uint32_t p = core_columns_row(&w->players.set, w->instances.layer[row].player[i]);
        if (p != CORE_NO_ROW && !doomed(w, row)) {
            update_player(w, row, p, dt);
        }
    }
}

static void remove_doomed(anim_world *w) {
    for (uint32_t row = core_columns_count(&w->instances.set); row > 0; row--) {
        if (doomed(w, row - 1)) {
            anim_instance_remove(w, row - 1);
        }
    }
}

bool anim_world_update(anim_world *w, float dt) {
    if (!isfinite(dt) || dt < 0) {
        return core_fail("anim_world_update: dt is %g s; expected >= 0", dt);
    }
    if (w->updating) {
        return core_fail("anim_world_update: called from one of its own callbacks");
    }
    core_stage_begin(w->metrics, CORE_STAGE_ANIM);
    w->updating = true;
    w->event_count = 0;
    uint32_t count = core_columns_count(&w->instances.set);
    for (uint32_t row = 0; row < count; row++) {
        if (!doomed(w, row)) {
            update_instance(w, row, dt);
        }
    }
    w->updating = false;
    remove_doomed(w);
    core_stage_end(w->metrics, CORE_STAGE_ANIM);
    return true;
}

uint32_t anim_world_events(const anim_world *w, const anim_event **out) {
    *out = w->event;
    return w->event_count;
}
