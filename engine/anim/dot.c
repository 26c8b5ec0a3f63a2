// A machine as Graphviz text.
#include "anim/anim_internal.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

typedef struct text {
    char *data;
    size_t length, capacity;
} text;

static void add(text *t, const char *fmt, ...) CORE_PRINTF(2, 3);
static void add(text *t, const char *fmt, ...) {
    char line[512];
    va_list args;
    va_start(args, fmt);
    vsnprintf(line, sizeof line, fmt, args);
    va_end(args);
    size_t n = strlen(line);
    if (t->length + n + 1 > t->capacity) {
        size_t capacity = (t->capacity + n + 1) * 2;
        t->data = core_realloc(t->data, t->capacity, capacity);
        t->capacity = capacity;
    }
    memcpy(t->data + t->length, line, n + 1);
    t->length += n;
}

static void add_quoted(text *t, const char *name) {
    add(t, "\"");
    for (; *name; name++) {
        add(t, *name == '"' || *name == '\\' ? "\\%c" : "%c", *name);
    }
    add(t, "\"");
}

static void label(text *t, const anim_machine_res *m, const anim_transition *tr) {
    static const char *const compare[] = {">", "<", ">=", "<=", "==", "!="};
    switch (tr->when) {
    case ANIM_WHEN_FINISHED:
        add(t, "finished");
        break;
    case ANIM_WHEN_CONDITION:
        add(t, "condition");
        break;
    case ANIM_WHEN_EVENT:
        add(t, "on %s", m->event[tr->event]);
        break;
    case ANIM_WHEN_PARAMETER:
        add(t, "%s %s %g", m->parameter[tr->parameter], compare[tr->compare], tr->value);
        break;
    }
    add(t, "\\n%g s%s", tr->length, tr->fade == ANIM_FADE_SMOOTH ? " smooth" : "");
}

// A state as a box, or as a frame around those it holds.
static void add_state(text *t, const anim_machine_res *m, int32_t i, const char *now) {
    const anim_state *s = &m->state[i];
    if (s->entry == i) {
        add(t, "  ");
        add_quoted(t, s->name);
        add(t, " [%s%s];\n", i == (int32_t)m->initial ? "peripheries=2" : "peripheries=1",
            strcmp(s->name, now) == 0 ? ", style=filled" : "");
        return;
    }
    add(t, "  subgraph cluster_%d {\n  label=", i);
    add_quoted(t, s->name);
    add(t, ";\n");
    for (int32_t k = i + 1; k < (int32_t)m->state_count; k++) {
        if (m->state[k].parent == i) {
            add_state(t, m, k, now);
        }
    }
    add(t, "  }\n");
}

static void add_transition(text *t, const anim_machine_res *m, uint32_t i) {
    const anim_transition *tr = &m->transition[i];
    int32_t from = tr->from < 0 ? -1 : m->state[tr->from].entry, to = m->state[tr->to].entry;
    add(t, "  ");
    add_quoted(t, from < 0 ? "*" : m->state[from].name);
    add(t, " -> ");
    add_quoted(t, m->state[to].name);
    add(t, " [");
    if (from >= 0 && from != tr->from) {
        add(t, "ltail=cluster_%d, ", tr->from);
    }
    if (to != tr->to) {
        add(t, "lhead=cluster_%d, ", tr->to);
    }
    add(t, "label=\"%u: ", i + 1);
    label(t, m, tr);
    add(t, "\"];\n");
}

char *anim_machine_dot(const anim_world *w, anim_machine h, anim_instance instance) {
    const anim_machine_res *m = anim_get_machine(w, h);
    if (!m) {
        return NULL;
    }
    const char *now = core_handle_is_null(instance) ? "" : anim_instance_state(w, instance);
    text t = {0};
    add(&t, "digraph machine {\n  compound=true;\n  node [shape=box];\n");
    for (int32_t i = 0; i < (int32_t)m->state_count; i++) {
        if (m->state[i].parent < 0) {
            add_state(&t, m, i, now);
        }
    }
    for (uint32_t i = 0; i < m->transition_count; i++) {
        add_transition(&t, m, i);
    }
    add(&t, "}\n");
    return t.data;
}
