// The reference page and the editor stubs, written from the same tables that check the calls.
#include "script/bind.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct text {
    char *data;
    size_t size, capacity;
} text;

CORE_PRINTF(2, 3) static void add(text *t, const char *fmt, ...) {
    va_list args, again;
    va_start(args, fmt);
    va_copy(again, args);
    size_t need = (size_t)vsnprintf(NULL, 0, fmt, args);
    if (t->size + need + 1 > t->capacity) {
        size_t capacity = (t->size + need + 1) * 2;
        t->data = core_realloc(t->data, t->capacity, capacity);
        t->capacity = capacity;
    }
    vsnprintf(t->data + t->size, need + 1, fmt, again);
    t->size += need;
    va_end(again);
    va_end(args);
}

// ---- parts ----

static void add_phases(text *t, unsigned phases) {
    static const struct {
        unsigned phases;
        const char *text;
    } names[] = {{BIND_ANY, "everywhere"},
                 {BIND_RUNNING, "load and all later callbacks"},
                 {BIND_SIM, "load, fixed and callbacks of the step"}};
    for (size_t i = 0; i < CORE_COUNT_OF(names); i++) {
        if (names[i].phases == phases) {
            add(t, "%s", names[i].text);
            return;
        }
    }
    const char *separator = "";
    for (unsigned phase = 1; phase <= BIND_QUIT; phase <<= 1) {
        if (phases & phase) {
            add(t, "%s%s", separator, bind_phase_name(phase));
            separator = ", ";
        }
    }
}

static void add_default(text *t, const bind_arg *arg) {
    if (!arg->optional) {
        return;
    }
    const core_vec3 *v = &arg->def_vec;
    if (arg->kind == BIND_STRING && arg->def_text) {
        add(t, "\"%s\"", arg->def_text);
    } else if (arg->def_text) {
        add(t, "%s", arg->def_text);
    } else if (arg->kind == BIND_NUMBER || arg->kind == BIND_FLOAT || arg->kind == BIND_INT) {
        add(t, "%.6g", arg->def);
    } else if (arg->kind == BIND_BOOL) {
        add(t, "%s", arg->def != 0 ? "true" : "false");
    } else if (arg->kind == BIND_VEC3 || arg->kind == BIND_COLOR) {
        add(t, "{%.6g, %.6g, %.6g}", (double)v->x, (double)v->y, (double)v->z);
    } else if (arg->kind == BIND_ENUM) {
        const char *value = arg->values;
        for (int i = (int)arg->def; i > 0; i--) {
            value += strcspn(value, "|") + 1;
        }
        add(t, "\"%.*s\"", (int)strcspn(value, "|"), value);
    } else {
        add(t, "none");
    }
}

static void add_row(text *t, const char *prefix, const bind_arg *arg) {
    char kind[384];
    bind_describe(arg, kind, sizeof kind);
    add(t, "| `%s%s` | ", prefix, arg->name);
    for (const char *c = kind; *c; c++) {
        add(t, *c == '|' ? "\\|" : "%c", *c);
    }
    add(t, " | ");
    if (arg->optional) {
        add_default(t, arg);
    } else {
        add(t, "required");
    }
    add(t, " | %s |\n", arg->doc ? arg->doc : "");
}

static void add_rows(text *t, const char *prefix, const bind_arg *args) {
    for (const bind_arg *arg = args; arg && arg->name; arg++) {
        add_row(t, prefix, arg);
        if (arg->fields) {
            char inner[128];
            snprintf(inner, sizeof inner, "%s%s%s.", prefix, arg->name,
                     arg->kind == BIND_LIST ? "[i]" : "");
            add_rows(t, inner, arg->fields);
        }
    }
}

static void add_signature(text *t, const char *owner, const char *join, const bind_fn *fn) {
    for (const bind_return *r = fn->returns; r && r->name; r++) {
        add(t, "%s%s", r == fn->returns ? "" : ", ", r->name);
    }
    add(t, "%s%s%s%s(", fn->returns ? " = " : "", owner, fn->name[0] ? join : "", fn->name);
    for (const bind_arg *arg = fn->args; arg && arg->name; arg++) {
        add(t, "%s%s", arg == fn->args ? "" : ", ", arg->name);
        if (arg->optional) {
            add(t, "?");
        }
    }
    add(t, ")");
}

static void add_function(text *t, const char *owner, const char *join, const bind_fn *fn) {
    add(t, "#### %s%s%s\n\n```lua\n", owner, fn->name[0] ? join : "", fn->name);
    add_signature(t, owner, join, fn);
    add(t, "\n```\n\n%s Callable from: ", fn->doc);
    add_phases(t, fn->phases);
    add(t, ".%s\n\n", fn->mod_only ? " Only in mods." : fn->mod ? " Open to mods." : "");
    if (fn->args) {
        add(t, "| argument | expects | default | meaning |\n|---|---|---|---|\n");
        add_rows(t, "", fn->args);
        add(t, "\n");
    }
    for (const bind_return *r = fn->returns; r && r->name; r++) {
        if (r->unit) {
            add(t, "%s`%s` in %s", r == fn->returns ? "Returns " : ", ", r->name, r->unit);
        } else {
            add(t, "%s`%s`", r == fn->returns ? "Returns " : ", ", r->name);
        }
    }
    add(t, fn->returns ? ".\n\n" : "");
}

// Further functions of the module before, declared in a file of their own.
static bool continues(const bind_room *room, const bind_module *m) {
    return m > room->modules && strcmp(m[-1].path, m->path) == 0;
}

char *bind_docs_markdown(void) {
    text t = {0};
    add(&t, "# Lua API\n\nWritten by `make docs` from the tables that check the calls "
            "(`engine/script/bind_*.c`). Units are SI, angles radians. Arguments marked `?` may be "
            "left out. What a function may not be called from is an error that says so.\n\n");
    for (int r = 0; bind_rooms[r]; r++) {
        for (const bind_module *m = bind_rooms[r]->modules; m->path; m++) {
            if (!continues(bind_rooms[r], m)) {
                add(&t, "## %s\n\n%s\n\n", m->path, m->doc);
            }
            for (const bind_fn *fn = m->functions; fn->name; fn++) {
                add_function(&t, m->path, ".", fn);
            }
        }
        for (int i = 0; bind_rooms[r]->types && bind_rooms[r]->types[i]; i++) {
            const bind_type *type = bind_rooms[r]->types[i];
            add(&t,
                "## %s\n\n%s Objects are equal when they are the same thing and can be keys of "
                "tables.\n\n",
                type->name, type->doc);
            for (const bind_fn *fn = type->methods; fn->name; fn++) {
                add_function(&t, type->name, ":", fn);
            }
        }
    }
    t.size--; // one newline at the end of the file
    t.data[t.size] = 0;
    return t.data;
}

// ---- stubs ----

static void add_stub_type(text *t, const char *class_name, const bind_arg *arg) {
    switch (arg->kind) {
    case BIND_NUMBER:
    case BIND_FLOAT:
        add(t, "number");
        break;
    case BIND_INT:
        add(t, "integer");
        break;
    case BIND_BOOL:
        add(t, "boolean");
        break;
    case BIND_STRING:
        add(t, "string");
        break;
    case BIND_ENUM:
        for (const char *v = arg->values; *v; v += strcspn(v, "|")) {
            v += *v == '|';
            add(t, "%s\"%.*s\"", v == arg->values ? "" : "|", (int)strcspn(v, "|"), v);
        }
        break;
    case BIND_VEC3:
        add(t, arg->uniform ? "number|number[]" : "number[]");
        break;
    case BIND_QUAT:
        add(t, "number[]|corsac.AxisAngle");
        break;
    case BIND_COLOR:
    case BIND_NUMBERS:
        add(t, "number[]");
        break;
    case BIND_OBJECT:
        add(t, "corsac.%s", arg->type->name);
        break;
    case BIND_OPTIONS:
        add(t, "%s.%s", class_name, arg->name);
        break;
    case BIND_LIST:
        add(t, "%s.%s[]", class_name, arg->name);
        break;
    case BIND_FUNCTION:
        add(t, "function");
        break;
    case BIND_TABLE:
        add(t, "table");
        break;
    case BIND_VALUE:
    case BIND_REST:
        add(t, "any");
        break;
    }
}

// One class per table of options, inner ones first.
static void add_stub_options(text *t, const char *class_name, const bind_arg *args) {
    for (const bind_arg *arg = args; arg && arg->name; arg++) {
        if (!arg->fields) {
            continue;
        }
        char inner[160];
        snprintf(inner, sizeof inner, "%s.%s", class_name, arg->name);
        add_stub_options(t, inner, arg->fields);
        add(t, "---@class %s\n", inner);
        for (const bind_arg *f = arg->fields; f->name; f++) {
            add(t, "---@field %s%s ", f->name, f->optional ? "?" : "");
            add_stub_type(t, inner, f);
            const char *doc = f->doc && f->doc[0] ? f->doc : NULL;
            add(t, "%s%s%s%s\n", doc || f->unit ? " " : "", doc ? doc : "",
                doc && f->unit ? ", " : "", f->unit ? f->unit : "");
        }
        add(t, "\n");
    }
}

static void add_stub(text *t, const char *owner, const char *join, const bind_fn *fn) {
    char class_name[160];
    snprintf(class_name, sizeof class_name, "%s.%s", owner, fn->name);
    add_stub_options(t, class_name, fn->args);
    add(t, "---%s\n", fn->doc);
    for (const bind_arg *arg = fn->args; arg && arg->name; arg++) {
        add(t, "---@param %s%s ", arg->name, arg->optional ? "?" : "");
        add_stub_type(t, class_name, arg);
        add(t, "%s%s\n", arg->doc && arg->doc[0] ? " " : "", arg->doc ? arg->doc : "");
    }
    for (const bind_return *r = fn->returns; r && r->name; r++) {
        add(t, "---@return %s %s\n", r->type, r->name);
    }
    add(t, "function %s%s%s(", owner, join, fn->name);
    for (const bind_arg *arg = fn->args; arg && arg->name; arg++) {
        add(t, "%s%s", arg == fn->args ? "" : ", ", arg->name);
    }
    add(t, ") end\n\n");
}

static void add_stub_module(text *t, const bind_module *m) {
    bool root = strcmp(m->path, "corsac") == 0;
    const bind_fn *fn = m->functions;
    add(t, "---%s\n", m->doc);
    for (; fn->name && fn->name[0]; fn++) {
    }
    if (root) {
        add(t, "---@class corsac\n---@field load? fun(args: string[])\n"
               "---@field fixed? fun(dt: number)\n---@field update? fun(dt: number)\n"
               "---@field draw? fun()\n---@field event? fun(name: string, ...)\n"
               "---@field quit? fun()\n---@field conf? fun(t: table)\n"
               "---@field reload? fun(state: table)\n");
    } else if (fn->name) { // callable: overload of the module itself
        add(t, "---@class %s\n---@overload fun(", m->path);
        for (const bind_arg *arg = fn->args; arg && arg->name; arg++) {
            add(t, "%s%s: ", arg == fn->args ? "" : ", ", arg->name);
            add_stub_type(t, m->path, arg);
        }
        add(t, ")\n");
    }
    add(t, "%s = {}\n\n", m->path);
}

char *bind_docs_stubs(void) {
    text t = {0};
    add(&t,
        "---@meta\n-- Types for the Lua language server, written by `make docs`.\n\n"
        "---@class corsac.AxisAngle\n---@field axis number[]\n---@field angle number radians\n\n"
        "---@class corsac.Columns\n---@field n integer\n"
        "---@field row fun(body: corsac.Body): integer\n"
        "---@field handle fun(row: integer): corsac.Body\n"
        "---@field touch fun(row: integer)\n---@field [string] number[]\n\n");
    for (int r = 0; bind_rooms[r]; r++) {
        for (int i = 0; bind_rooms[r]->types && bind_rooms[r]->types[i]; i++) {
            const bind_type *type = bind_rooms[r]->types[i];
            add(&t, "---%s\n---@class corsac.%s\nlocal %s = {}\n\n", type->doc, type->name,
                type->name);
            for (const bind_fn *fn = type->methods; fn->name; fn++) {
                add_stub(&t, type->name, ":", fn);
            }
        }
    }
    for (int r = 0; bind_rooms[r]; r++) {
        for (const bind_module *m = bind_rooms[r]->modules; m->path; m++) {
            if (!continues(bind_rooms[r], m)) {
                add_stub_module(&t, m);
            }
            for (const bind_fn *fn = m->functions; fn->name; fn++) {
                if (fn->name[0]) {
                    add_stub(&t, m->path, ".", fn);
                }
            }
        }
    }
    t.size--;
    t.data[t.size] = 0;
    return t.data;
}
