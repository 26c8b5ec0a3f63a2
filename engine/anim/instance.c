// Instances: creation, the caller's controls, and what can be asked of one.
#include "anim/anim_internal.h"

#include <math.h>
#include <string.h>

anim_instance_desc anim_instance_desc_default(void) {
    return (anim_instance_desc){.cookie = ANIM_COOKIE};
}

static bool check_content(const anim_world *w, const anim_instance_desc *d) {
    if (!isfinite(d->time) || !isfinite(d->speed) || d->loop > ANIM_PING_PONG) {
        return core_fail("animation instance: time %g s, speed %g, loop %d", d->time, d->speed,
                         (int)d->loop);
    }
    if (!core_handle_is_null(d->machine)) {
        const anim_machine_res *m = anim_get_machine(w, d->machine);
        return m && (core_handle_equal(m->skeleton, d->skeleton) ||
                     core_fail("animation instance: its machine is for another skeleton"));
    }
    if (!core_handle_is_null(d->clip)) {
        const anim_clip_res *c = anim_get_clip(w, d->clip);
        return c && (core_handle_equal(c->skeleton, d->skeleton) ||
                     core_fail("animation instance: clip %s is for another skeleton", c->name));
    }
    return true;
}

bool anim_take_place(anim_world *w, anim_skeleton_res *s, uint32_t *place) {
    if (s->free_count > 0) {
        *place = s->free_place[--s->free_count];
        return true;
    }
    if (s->bones > w->max_bones - w->bones_placed) {
        return core_fail("animation: more than %u bones at once; raise max_bones", w->max_bones);
    }
    *place = w->bones_placed;
    size_t bytes = (size_t)(w->bones_placed + s->bones) * ANIM_PALETTE_FLOATS * sizeof(float);
    if (!core_commit(w->palette, bytes)) {
        return false;
    }
    w->bones_placed += s->bones;
    w->bones_committed = CORE_MAX(w->bones_committed, w->bones_placed);
    return true;
}

void anim_give_place(anim_skeleton_res *s, uint32_t place) {
    if (s->free_count == s->free_capacity) {
        uint32_t capacity = s->free_capacity ? s->free_capacity * 2 : 16;
        s->free_place = core_realloc(s->free_place, s->free_capacity * sizeof(uint32_t),
                                     capacity * sizeof(uint32_t));
        s->free_capacity = capacity;
    }
    s->free_place[s->free_count++] = place;
}

// A new player of a machine or a clip. Null + core_fail when there is no room.
static core_handle add_player(anim_world *w, anim_machine machine, anim_clip clip, anim_loop loop,
                              float time) {
    core_handle player = core_columns_add(&w->players.set);
    if (core_handle_is_null(player)) {
        return player;
    }
    uint32_t p = core_columns_row(&w->players.set, player);
    anim_slot *now = &w->players.now[p];
    *now = (anim_slot){.state = -1, .clip = clip, .loop = loop, .time = time};
    w->players.machine[p] = machine;
    w->players.from[p].state = -1;
    w->players.weight[p] = 1;
    if (!core_handle_is_null(machine)) {
        anim_machine_res *m = anim_get_machine(w, machine);
        now->state = (int32_t)m->initial;
        now->clip = m->state[m->initial].clip;
        now->loop = m->state[m->initial].loop;
        memcpy(w->players.parameter[p].v, m->start_value, sizeof m->start_value);
        m->users++;
    }
    if (!core_handle_is_null(now->clip)) {
        anim_get_clip(w, now->clip)->users++;
    }
    return player;
}

anim_instance anim_instance_create(anim_world *w, const anim_instance_desc *d) {
    if (!d || d->cookie != ANIM_COOKIE) {
        core_fail("animation instance: the description was not made by "
                  "anim_instance_desc_default()");
        return CORE_NULL_HANDLE;
    }
    anim_skeleton_res *s = anim_get_skeleton(w, d->skeleton);
    uint32_t place = 0;
    if (!s || !check_content(w, d) || !anim_take_place(w, s, &place)) {
        return CORE_NULL_HANDLE;
    }
    core_handle h = core_columns_add(&w->instances.set);
    core_handle player =
        core_handle_is_null(h) ? h : add_player(w, d->machine, d->clip, d->loop, d->time);
    if (core_handle_is_null(player)) {
        anim_give_place(s, place);
        core_columns_remove(&w->instances.set, h, NULL, NULL);
        return CORE_NULL_HANDLE;
    }
    uint32_t row = core_columns_row(&w->instances.set, h);
    w->instances.skeleton[row] = d->skeleton;
    w->instances.player[row] = player;
    w->instances.speed[row] = d->speed == 0 ? 1 : d->speed;
    w->instances.user[row] = d->user;
    w->instances.place[row] = place;
    w->instances.age[row] = h.index; // neighbours take turns
    s->users++;
    w->bones_live += s->bones;
    return h;
}

static void release_clip(anim_world *w, core_handle clip) {
    if (!core_handle_is_null(clip)) {
        anim_get_clip(w, clip)->users--;
    }
}

void anim_player_remove(anim_world *w, core_handle player) {
    uint32_t p = core_columns_row(&w->players.set, player);
    if (p == CORE_NO_ROW) {
        return;
    }
    release_clip(w, w->players.now[p].clip);
    release_clip(w, w->players.from[p].clip);
    anim_snapshot_drop(w, w->players.snapshot[p]);
    if (!core_handle_is_null(w->players.machine[p])) {
        anim_get_machine(w, w->players.machine[p])->users--;
    }
    if (!core_handle_is_null(w->players.mask[p])) {
        anim_get_mask(w, w->players.mask[p])->users--;
    }
    core_columns_remove(&w->players.set, player, NULL, NULL);
}

void anim_instance_remove(anim_world *w, uint32_t row) {
    anim_skeleton_res *s = anim_get_skeleton(w, w->instances.skeleton[row]);
    anim_player_remove(w, w->instances.player[row]);
    for (uint32_t i = 0; i < ANIM_MAX_LAYERS; i++) {
        anim_player_remove(w, w->instances.layer[row].player[i]);
    }
    anim_snapshot_drop(w, w->instances.external[row]);
    anim_give_place(s, w->instances.place[row]);
    s->users--;
    w->bones_live -= s->bones;
    core_columns_remove(&w->instances.set, core_columns_handle(&w->instances.set, row), NULL, NULL);
}

bool anim_instance_destroy(anim_world *w, anim_instance h) {
    uint32_t row = anim_get_instance(w, h);
    if (row == CORE_NO_ROW) {
        return false;
    }
    if (w->updating) {
        w->instances.flags[row] |= ANIM_DOOMED;
    } else {
        anim_instance_remove(w, row);
    }
    return true;
}

bool anim_instance_alive(const anim_world *w, anim_instance h) {
    uint32_t row = core_columns_row(&w->instances.set, h);
    return row != CORE_NO_ROW && !(w->instances.flags[row] & ANIM_DOOMED);
}

uint64_t anim_instance_user(const anim_world *w, anim_instance h) {
    uint32_t row = anim_get_instance(w, h);
    return row == CORE_NO_ROW ? 0 : w->instances.user[row];
}

bool anim_instance_set_user(anim_world *w, anim_instance h, uint64_t user) {
    uint32_t row = anim_get_instance(w, h);
    if (row == CORE_NO_ROW) {
        return false;
    }
    w->instances.user[row] = user;
    return true;
}

anim_skeleton anim_instance_skeleton(const anim_world *w, anim_instance h) {
    uint32_t row = anim_get_instance(w, h);
    return row == CORE_NO_ROW ? CORE_NULL_HANDLE : w->instances.skeleton[row];
}

uint32_t anim_instance_bone_count(const anim_world *w, anim_instance h) {
    uint32_t row = anim_get_instance(w, h);
    return row == CORE_NO_ROW ? 0 : anim_get_skeleton(w, w->instances.skeleton[row])->bones;
}

// Row of the instance's player; CORE_NO_ROW + core_fail for stale instances.
static uint32_t player_row(const anim_world *w, anim_instance h, uint32_t *row) {
    *row = anim_get_instance(w, h);
    return *row == CORE_NO_ROW ? CORE_NO_ROW
                               : core_columns_row(&w->players.set, w->instances.player[*row]);
}

static bool check_fade(float length, anim_fade fade) {
    return (isfinite(length) && length >= 0 && fade <= ANIM_FADE_SMOOTH) ||
           core_fail("animation: a fade of %g s; expected >= 0, linear or smooth", length);
}

bool anim_instance_play(anim_world *w, anim_instance h, anim_clip clip, anim_loop loop,
                        float length, anim_fade fade) {
    uint32_t row, p = player_row(w, h, &row);
    const anim_clip_res *c = p == CORE_NO_ROW ? NULL : anim_get_clip(w, clip);
    if (!c || !check_fade(length, fade)) {
        return false;
    }
    if (!core_handle_equal(c->skeleton, w->instances.skeleton[row])) {
        return core_fail("clip %s is for another skeleton than the instance's", c->name);
    }
    anim_player_start(w, row, p, (anim_slot){.clip = clip, .state = -1, .loop = loop}, length, fade,
                      false);
    return true;
}

static anim_machine_res *machine_of(const anim_world *w, uint32_t p) {
    if (core_handle_is_null(w->players.machine[p])) {
        core_fail("this animation instance has no state machine");
        return NULL;
    }
    return anim_get_machine(w, w->players.machine[p]);
}

bool anim_instance_go(anim_world *w, anim_instance h, const char *state, float length,
                      anim_fade fade) {
    uint32_t row, p = player_row(w, h, &row);
    const anim_machine_res *m = p == CORE_NO_ROW ? NULL : machine_of(w, p);
    if (!m || !check_fade(length, fade)) {
        return false;
    }
    for (uint32_t i = 0; i < m->state_count; i++) {
        if (strcmp(m->state[i].name, state) == 0) {
            int32_t entry = m->state[i].entry;
            anim_slot to = {
                .clip = m->state[entry].clip, .state = entry, .loop = m->state[entry].loop};
            anim_player_start(w, row, p, to, length, fade, false);
            return true;
        }
    }
    return anim_unknown("no state", state, m->state, sizeof *m->state, m->state_count);
}

bool anim_instance_set_time(anim_world *w, anim_instance h, float time) {
    uint32_t row, p = player_row(w, h, &row);
    if (p == CORE_NO_ROW) {
        return false;
    }
    if (!isfinite(time)) {
        return core_fail("animation: time %g s", time);
    }
    w->players.now[p].time = time;
    return true;
}

float anim_instance_time(const anim_world *w, anim_instance h) {
    uint32_t row, p = player_row(w, h, &row);
    if (p == CORE_NO_ROW || core_handle_is_null(w->players.now[p].clip)) {
        return 0;
    }
    return anim_slot_clip_time(w, p, &w->players.now[p]);
}

bool anim_instance_set_speed(anim_world *w, anim_instance h, float speed) {
    uint32_t row = anim_get_instance(w, h);
    if (row == CORE_NO_ROW) {
        return false;
    }
    if (!isfinite(speed)) {
        return core_fail("animation: speed %g", speed);
    }
    w->instances.speed[row] = speed;
    return true;
}

bool anim_instance_finished(const anim_world *w, anim_instance h) {
    uint32_t row, p = player_row(w, h, &row);
    if (p == CORE_NO_ROW || core_handle_is_null(w->players.now[p].clip)) {
        return false;
    }
    anim_motion m = anim_slot_motion(w, p, &w->players.now[p]);
    return w->players.now[p].time >= m.length;
}

// Row of the i-th player, 0 the base; CORE_NO_ROW when there is none.
static uint32_t nth_player(const anim_world *w, uint32_t row, uint32_t i) {
    core_handle h = i == 0 ? w->instances.player[row] : w->instances.layer[row].player[i - 1];
    return core_columns_row(&w->players.set, h);
}

static bool find_parameter(const anim_world *w, uint32_t row, uint32_t layer, const char *name,
                           uint32_t *p, uint32_t *number) {
    *p = nth_player(w, row, layer);
    if (*p == CORE_NO_ROW || core_handle_is_null(w->players.machine[*p])) {
        return false;
    }
    const anim_machine_res *m = anim_get_machine(w, w->players.machine[*p]);
    for (uint32_t i = 0; i < m->parameter_count; i++) {
        if (strcmp(m->parameter[i], name) == 0) {
            *number = i;
            return true;
        }
    }
    return false;
}

static bool no_parameter(const anim_world *w, uint32_t row, const char *name) {
    const anim_machine_res *m = machine_of(w, nth_player(w, row, 0));
    return m && anim_unknown("no parameter", name, m->parameter, CORE_NAME_MAX, m->parameter_count);
}

bool anim_instance_set_parameter(anim_world *w, anim_instance h, const char *name, float value) {
    uint32_t row = anim_get_instance(w, h), p, number, found = 0;
    if (row == CORE_NO_ROW) {
        return false;
    }
    if (!isfinite(value)) {
        return core_fail("state machine: parameter \"%s\" set to %g", name, value);
    }
    for (uint32_t i = 0; i <= ANIM_MAX_LAYERS; i++) {
        if (find_parameter(w, row, i, name, &p, &number)) {
            w->players.parameter[p].v[number] = value;
            found++;
        }
    }
    return found > 0 || no_parameter(w, row, name);
}

bool anim_instance_parameter(const anim_world *w, anim_instance h, const char *name, float *out) {
    uint32_t row = anim_get_instance(w, h), p, number;
    for (uint32_t i = 0; row != CORE_NO_ROW && i <= ANIM_MAX_LAYERS; i++) {
        if (find_parameter(w, row, i, name, &p, &number)) {
            *out = w->players.parameter[p].v[number];
            return true;
        }
    }
    return row != CORE_NO_ROW && no_parameter(w, row, name);
}

bool anim_instance_send(anim_world *w, anim_instance h, const char *event) {
    uint32_t row = anim_get_instance(w, h), found = 0;
    for (uint32_t i = 0; row != CORE_NO_ROW && i <= ANIM_MAX_LAYERS; i++) {
        uint32_t p = nth_player(w, row, i);
        bool has = p != CORE_NO_ROW && !core_handle_is_null(w->players.machine[p]);
        const anim_machine_res *m = has ? anim_get_machine(w, w->players.machine[p]) : NULL;
        for (uint32_t e = 0; m && e < m->event_count; e++) {
            if (strcmp(m->event[e], event) == 0) {
                w->players.events[p] |= 1u << e;
                found++;
            }
        }
    }
    if (row == CORE_NO_ROW || found) {
        return found > 0;
    }
    const anim_machine_res *m = machine_of(w, nth_player(w, row, 0));
    return m &&
           anim_unknown("no transition listens to", event, m->event, CORE_NAME_MAX, m->event_count);
}

// ---- layers ----

anim_layer_desc anim_layer_desc_default(void) { return (anim_layer_desc){.cookie = ANIM_COOKIE}; }

static bool check_layer(const anim_world *w, uint32_t row, uint32_t layer,
                        const anim_layer_desc *d) {
    if (layer < 1 || layer > ANIM_MAX_LAYERS || d->cookie != ANIM_COOKIE || w->updating) {
        return core_fail("animation layer %u: expected 1..%u, a description made by "
                         "anim_layer_desc_default(), and no call from a callback",
                         layer, ANIM_MAX_LAYERS);
    }
    if (!(d->weight >= 0 && d->weight <= 1)) {
        return core_fail("animation layer %u: weight %g, expected 0..1", layer, d->weight);
    }
    anim_instance_desc content = {.skeleton = w->instances.skeleton[row],
                                  .machine = d->machine,
                                  .clip = d->clip,
                                  .loop = d->loop};
    if (!check_content(w, &content)) {
        return false;
    }
    const anim_mask_res *m = core_handle_is_null(d->mask) ? NULL : anim_get_mask(w, d->mask);
    return core_handle_is_null(d->mask) ||
           (m && (core_handle_equal(m->skeleton, content.skeleton) ||
                  core_fail("animation layer %u: its mask is for another skeleton", layer)));
}

bool anim_instance_set_layer(anim_world *w, anim_instance h, uint32_t layer,
                             const anim_layer_desc *d) {
    uint32_t row = anim_get_instance(w, h);
    if (row == CORE_NO_ROW || !check_layer(w, row, layer, d)) {
        return false;
    }
    core_handle *slot = &w->instances.layer[row].player[layer - 1];
    w->instances.layered[row] -= !core_handle_is_null(*slot);
    anim_player_remove(w, *slot);
    *slot = CORE_NULL_HANDLE;
    if (core_handle_is_null(d->machine) && core_handle_is_null(d->clip)) {
        return true;
    }
    *slot = add_player(w, d->machine, d->clip, d->loop, 0);
    if (core_handle_is_null(*slot)) {
        return false;
    }
    uint32_t p = core_columns_row(&w->players.set, *slot);
    w->players.weight[p] = d->weight == 0 ? 1 : d->weight;
    w->players.mode[p] = d->additive ? ANIM_ADDITIVE : 0;
    w->players.mask[p] = d->mask;
    if (!core_handle_is_null(d->mask)) {
        anim_get_mask(w, d->mask)->users++;
    }
    w->instances.layered[row]++;
    return true;
}

bool anim_instance_set_layer_weight(anim_world *w, anim_instance h, uint32_t layer, float weight) {
    uint32_t row = anim_get_instance(w, h);
    uint32_t p = row == CORE_NO_ROW || layer < 1 || layer > ANIM_MAX_LAYERS
                     ? CORE_NO_ROW
                     : nth_player(w, row, layer);
    if (p == CORE_NO_ROW || !(weight >= 0 && weight <= 1)) {
        return core_fail("animation layer %u: it is not set, or weight %g is not in 0..1", layer,
                         weight);
    }
    w->players.weight[p] = weight;
    return true;
}

const char *anim_instance_state(const anim_world *w, anim_instance h) {
    uint32_t row, p = player_row(w, h, &row);
    if (p == CORE_NO_ROW || w->players.now[p].state < 0) {
        return "";
    }
    return anim_get_machine(w, w->players.machine[p])->state[w->players.now[p].state].name;
}

anim_machine anim_instance_machine(const anim_world *w, anim_instance h) {
    uint32_t row, p = player_row(w, h, &row);
    return p == CORE_NO_ROW ? CORE_NULL_HANDLE : w->players.machine[p];
}

bool anim_instance_in(const anim_world *w, anim_instance h, const char *state) {
    uint32_t row, p = player_row(w, h, &row);
    const anim_machine_res *m = p == CORE_NO_ROW ? NULL : machine_of(w, p);
    for (uint32_t i = 0; m && i < m->state_count; i++) {
        if (strcmp(m->state[i].name, state) == 0) {
            return anim_state_in(m, w->players.now[p].state, (int32_t)i);
        }
    }
    return m && anim_unknown("no state", state, m->state, sizeof *m->state, m->state_count);
}

float anim_instance_fade(const anim_world *w, anim_instance h, const char **from) {
    uint32_t row, p = player_row(w, h, &row);
    if (from) {
        *from = "";
    }
    if (p == CORE_NO_ROW || !(w->players.flags[p] & ANIM_FADING)) {
        return 1;
    }
    if (from && w->players.from[p].state >= 0) {
        *from = anim_get_machine(w, w->players.machine[p])->state[w->players.from[p].state].name;
    }
    return w->players.fade_time[p] / w->players.fade_length[p];
}

uint32_t anim_instance_transitions(const anim_world *w, anim_instance h, const char **to,
                                   uint32_t capacity) {
    uint32_t row, p = player_row(w, h, &row), n = 0;
    if (p == CORE_NO_ROW || w->players.now[p].state < 0) {
        return 0;
    }
    const anim_machine_res *m = anim_get_machine(w, w->players.machine[p]);
    int32_t state = w->players.now[p].state;
    for (uint32_t i = 0; i < m->transition_count; i++) {
        const anim_transition *t = &m->transition[i];
        if (anim_transition_leaves(m, t, state)) {
            if (n < capacity) {
                to[n] = m->state[t->to].name;
            }
            n++;
        }
    }
    return n;
}

bool anim_instance_set_visible(anim_world *w, anim_instance h, bool visible) {
    uint32_t row = anim_get_instance(w, h);
    if (row == CORE_NO_ROW) {
        return false;
    }
    uint32_t flags = w->instances.flags[row] & ~(uint32_t)ANIM_HIDDEN;
    w->instances.flags[row] = flags | (visible ? 0u : (uint32_t)ANIM_HIDDEN);
    return true;
}

bool anim_instance_set_rate(anim_world *w, anim_instance h, uint32_t every) {
    uint32_t row = anim_get_instance(w, h);
    if (row == CORE_NO_ROW) {
        return false;
    }
    if (every < 1 || every > 64) {
        return core_fail("anim_instance_set_rate: every %u poses; expected 1..64", every);
    }
    w->instances.rate[row] = every;
    return true;
}

bool anim_instance_root_motion(const anim_world *w, anim_instance h, core_vec3 *out) {
    uint32_t row = anim_get_instance(w, h);
    if (row == CORE_NO_ROW) {
        return false;
    }
    *out = core_v3(w->instances.root_x[row], w->instances.root_y[row], w->instances.root_z[row]);
    return true;
}

uint32_t anim_instance_count(const anim_world *w) { return core_columns_count(&w->instances.set); }

anim_instance anim_instance_at(const anim_world *w, uint32_t row) {
    return row < core_columns_count(&w->instances.set) ? core_columns_handle(&w->instances.set, row)
                                                       : CORE_NULL_HANDLE;
}
