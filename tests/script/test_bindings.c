// Every binding, called with wrong arguments of every type, unknown fields, too many arguments and
// in every wrong phase: each call must fail with a message that names the function and the place.
#include "script/world.h"

#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static world w;
static int calls;

// A tenth of a second of silence: mono, 16 bits, 8000 Hz.
static void write_sound(void) {
    static const unsigned char head[44] =
        "RIFF\x64\x06\0\0WAVEfmt \x10\0\0\0\1\0\1\0\x40\x1f\0\0\x80\x3e\0\0\2\0\x10\0data\x40\6\0";
    unsigned char file[44 + 1600] = {0};
    memcpy(file, head, sizeof head);
    core_vfs_write(w.vfs, "beep.wav", file, sizeof file);
}

void setUp(void) {
    world_open(&w);
    write_sound();
}
void tearDown(void) { world_close(&w); }

static unsigned any_phase(const bind_fn *fn) {
    unsigned first = fn->phases & -fn->phases;
    return fn->phases & BIND_FIXED ? BIND_FIXED : first;
}

// ---- values ----

// Code that makes a live object. Models and effects need files: their methods are tested as
// those of destroyed ones.
#define SKELETON "corsac.anim.newSkeleton{{name = 'root'}}"
#define CLIP     "corsac.anim.newClip{skeleton = s, duration = 1, keys = {{bone = 'root', time = 0}}}"
static const struct {
    const char *type, *code;
} makers[] = {
    {"Entity", "return corsac.scene.spawn{mesh = 'box', body = {shape = 'sphere'}}"},
    {"Body", "return corsac.phys.newBody{shape = 'sphere'}"},
    {"Light", "return corsac.gfx.newLight{}"},
    {"Skeleton", "return " SKELETON},
    {"Clip", "local s = " SKELETON " return " CLIP},
    {"Machine", "local s = " SKELETON
                " return corsac.anim.newMachine{states = {{name = 'a', clip = " CLIP "}}}"},
    {"Graph", "local g = corsac.nav.newGraph{} g:add(0, 0, 0) g:add(1, 0, 0) return g"},
    {"Path", "local g = corsac.nav.newGraph{} return corsac.nav.newPath(g, {0, 0, 0}, {1, 0, 0})"},
    {"Surface", "return corsac.nav.newSurface{boxes = {{size = {9, 1, 9}}}}"},
    {"Grid", "return corsac.nav.newGrid(4, 4)"},
    {"Flow",
     "return corsac.nav.newFlow(corsac.nav.newSurface{boxes = {{size = {9, 1, 9}}}}, {0, 0.5, 0})"},
    {"Agent", "return corsac.nav.newAgent{position = {0, 0, 0}}"},
    {"Animator", "return corsac.anim.newAnimator(" SKELETON ")"},
    {"Mask", "return corsac.anim.newMask(" SKELETON ", {'root'})"},
    {"Trigger", "return corsac.phys.newTrigger{}"},
    {"Field", "return corsac.phys.newField{}"},
    {"Joint", "local a = corsac.phys.newBody{shape = 'box'} local b ="
              " corsac.phys.newBody{shape = 'box', position = {2, 0, 0}}"
              " return corsac.phys.newJoint{type = 'ball', a = a, b = b}"},
    {"Mover", "return corsac.phys.newMover{}"},
    {"Material", "return corsac.gfx.newMaterial{}"},
    {"Cloth",
     "return corsac.phys.newCloth{columns = 2, rows = 2, across = {1, 0, 0}, down = {0, 0, 1}}"},
    {"View", "return corsac.gfx.newView{}"},
    {"Terrain", "return corsac.gfx.newTerrain{heights = {0, 0, 0, 0}, columns = 2}"},
    {"Emitter", "return corsac.gfx.newEmitter{}"},
    {"Terrain", "return corsac.gfx.newTerrain{heights = {0, 0, 0, 0}, columns = 2}"},
    {"Sound", "return corsac.audio.newSound('beep.wav')"},
    {"Source", "return corsac.audio.newSource{sound = corsac.audio.newSound('beep.wav')}"},
};

static const char *maker_of(const bind_type *type) {
    for (size_t i = 0; i < CORE_COUNT_OF(makers); i++) {
        if (strcmp(makers[i].type, type->name) == 0) {
            return makers[i].code;
        }
    }
    return NULL;
}

// Pushes a live object, kept from call to call while it lives.
static void push_sample(const bind_type *type) {
    lua_State *L = w.L;
    lua_getfield(L, LUA_REGISTRYINDEX, type->name);
    core_handle h = bind_object_handle(w.script, L, -1, type);
    if (!core_handle_is_null(h) && type->alive(w.script, h)) {
        return;
    }
    lua_pop(L, 1);
    unsigned before = w.script->phase;
    w.script->phase = BIND_FIXED;
    TEST_ASSERT_NOT_NULL_MESSAGE(maker_of(type), type->name); // a new class needs a line in makers
    TEST_ASSERT_EQUAL_INT(0, luaL_loadstring(L, maker_of(type)));
    int rc = lua_pcall(L, 0, 1, 0);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, rc, lua_tostring(L, -1));
    w.script->phase = before;
    lua_pushvalue(L, -1);
    lua_setfield(L, LUA_REGISTRYINDEX, type->name);
}

static void push_right(const bind_arg *arg);

static void push_fields(const bind_arg *fields) {
    lua_newtable(w.L);
    for (const bind_arg *f = fields; f->name; f++) {
        if (!f->optional) {
            push_right(f);
            lua_setfield(w.L, -2, f->name);
        }
    }
}

static void push_right(const bind_arg *arg) {
    lua_State *L = w.L;
    switch (arg->kind) {
    case BIND_NUMBER:
    case BIND_FLOAT:
    case BIND_INT:
        lua_pushnumber(L, arg->range == BIND_BETWEEN ? arg->max : 1);
        break;
    case BIND_BOOL:
        lua_pushboolean(L, 1);
        break;
    case BIND_STRING:
        lua_pushliteral(L, "accuracy.nan");
        break;
    case BIND_ENUM:
        lua_pushlstring(L, arg->values, strcspn(arg->values, "|"));
        break;
    case BIND_OBJECT:
        push_sample(arg->type);
        break;
    case BIND_OPTIONS:
        push_fields(arg->fields);
        break;
    case BIND_FUNCTION:
        luaL_loadstring(L, "");
        break;
    case BIND_VEC3:
    case BIND_QUAT:
    case BIND_COLOR:
        lua_newtable(L);
        for (int i = 1; i <= (arg->kind == BIND_QUAT ? 4 : 3); i++) {
            lua_pushnumber(L, 1);
            lua_rawseti(L, -2, i);
        }
        break;
    default:
        lua_newtable(L);
        break;
    }
}

enum {
    WRONG_NIL,
    WRONG_BOOL,
    WRONG_NUMBER,
    WRONG_NAN,
    WRONG_INF,
    WRONG_FRACTION,
    WRONG_STRING,
    WRONG_TABLE,
    WRONG_FUNCTION,
    WRONG_OBJECT,
    WRONG_THREAD,
    WRONG_NEGATIVE,
    WRONG_HUGE,
    WRONG_COUNT
};

static void push_wrong(int kind, const bind_arg *arg) {
    lua_State *L = w.L;
    switch (kind) {
    case WRONG_NIL:
        lua_pushnil(L);
        break;
    case WRONG_BOOL:
        lua_pushboolean(L, 0);
        break;
    case WRONG_NUMBER:
        lua_pushnumber(L, 1);
        break;
    case WRONG_NAN:
        lua_pushnumber(L, NAN);
        break;
    case WRONG_INF:
        lua_pushnumber(L, INFINITY);
        break;
    case WRONG_FRACTION:
        lua_pushnumber(L, 1.5);
        break;
    case WRONG_STRING:
        lua_pushliteral(L, "?");
        break;
    case WRONG_TABLE:
        lua_newtable(L);
        luaL_loadstring(L, "");
        lua_rawseti(L, -2, 1);
        break;
    case WRONG_FUNCTION:
        luaL_loadstring(L, "");
        break;
    case WRONG_OBJECT: {
        bool entity = arg->kind == BIND_OBJECT && strcmp(arg->type->name, "Entity") == 0;
        push_sample(entity ? w.script->type[1].type : w.script->type[0].type);
        break;
    }
    case WRONG_THREAD:
        lua_newthread(L);
        break;
    case WRONG_NEGATIVE:
        lua_pushnumber(L, -1);
        break;
    default:
        lua_pushnumber(L, 1e300);
        break;
    }
}

static bool fits(int wrong, const bind_arg *arg) {
    bool number = arg->kind == BIND_NUMBER || arg->kind == BIND_FLOAT || arg->kind == BIND_INT;
    if (wrong == WRONG_NIL) {
        return arg->optional || arg->kind == BIND_REST;
    }
    switch (arg->kind) {
    case BIND_VALUE:
        return true;
    case BIND_REST:
        return true;
    case BIND_BOOL:
        return wrong == WRONG_BOOL;
    case BIND_STRING:
        return wrong == WRONG_STRING;
    case BIND_FUNCTION:
        return wrong == WRONG_FUNCTION;
    case BIND_TABLE:
        return wrong == WRONG_TABLE;
    case BIND_VEC3:
        return arg->uniform && (wrong == WRONG_NUMBER || wrong == WRONG_FRACTION ||
                                (wrong == WRONG_NEGATIVE && arg->range != BIND_POSITIVE));
    default:
        break;
    }
    if (!number) {
        return false;
    }
    bool between = arg->range == BIND_BETWEEN;
    switch (wrong) {
    case WRONG_NUMBER:
        return !between || (arg->min <= 1 && arg->max >= 1);
    case WRONG_FRACTION:
        return arg->kind != BIND_INT && (!between || (arg->min <= 1.5 && arg->max >= 1.5));
    case WRONG_NEGATIVE:
        return arg->range == BIND_ANY_NUMBER || (between && arg->min <= -1);
    case WRONG_HUGE:
        return arg->kind == BIND_NUMBER && !between;
    default:
        return false;
    }
}

// ---- calls ----

typedef struct target {
    const bind_fn *fn;
    const bind_type *type; // methods
    const char *module;
    char owner[96];
} target;

static void push_function(const target *t) {
    lua_State *L = w.L;
    if (t->type) {
        push_sample(t->type);
        lua_getfield(L, -1, t->fn->name);
        lua_insert(L, -2);
        return;
    }
    char code[160];
    snprintf(code, sizeof code, t->fn->name[0] ? "return %s.%s" : "return %s", t->module,
             t->fn->name);
    luaL_loadstring(L, code);
    lua_call(L, 0, 1);
}

// Calls with the arguments above `base` and wants an error whose text has each of the two parts.
static void must_fail(const target *t, int base, unsigned phase, const char *part) {
    char note[512];
    unsigned before = w.script->phase;
    w.script->phase = phase;
    int rc = lua_pcall(w.L, lua_gettop(w.L) - base - 1, 0, 0);
    w.script->phase = before;
    calls++;
    snprintf(note, sizeof note, "%s should have failed with \"%s\"", t->owner, part);
    TEST_ASSERT_TRUE_MESSAGE(rc != 0, note);
    const char *text = lua_tostring(w.L, -1);
    snprintf(note, sizeof note, "\"%.300s\" should name %s and \"%s\"", text, t->owner, part);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(text, t->owner), note);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(text, part), note);
    lua_settop(w.L, base);
}

static void check_fields(const target *t, int position, const bind_arg *options) {
    lua_State *L = w.L;
    for (const bind_arg *f = options->fields; f->name; f++) {
        for (int wrong = 0; wrong < WRONG_COUNT; wrong++) {
            if (fits(wrong, f)) {
                continue;
            }
            int base = lua_gettop(L);
            push_function(t);
            for (int i = 0; i < position; i++) {
                push_right(&t->fn->args[i]);
            }
            push_fields(options->fields);
            push_wrong(wrong, f);
            lua_setfield(L, -2, f->name);
            char part[96];
            snprintf(part, sizeof part,
                     wrong == WRONG_TABLE && f->kind == BIND_OPTIONS ? "named fields" : "field %s",
                     f->name);
            must_fail(t, base, any_phase(t->fn), part);
        }
    }
    int base = lua_gettop(L);
    push_function(t);
    for (int i = 0; i < position; i++) {
        push_right(&t->fn->args[i]);
    }
    push_fields(options->fields);
    lua_pushboolean(L, 1);
    lua_setfield(L, -2, "zzz");
    must_fail(t, base, any_phase(t->fn), "unknown field \"zzz\"");
}

static void check_target(const target *t) {
    lua_State *L = w.L;
    int count = 0;
    bool rest = false;
    for (const bind_arg *arg = t->fn->args; arg && arg->name; arg++, count++) {
        rest = rest || arg->kind == BIND_REST;
        for (int wrong = 0; wrong < WRONG_COUNT; wrong++) {
            if (fits(wrong, arg)) {
                continue;
            }
            int base = lua_gettop(L);
            push_function(t);
            for (int i = 0; i < count; i++) {
                push_right(&t->fn->args[i]);
            }
            push_wrong(wrong, arg);
            char part[64];
            snprintf(part, sizeof part, "argument %d (%s)", count + 1, arg->name);
            must_fail(t, base, any_phase(t->fn), part);
        }
        if (arg->fields && arg->kind == BIND_OPTIONS) {
            check_fields(t, count, arg);
        }
    }
    int base = lua_gettop(L);
    if (!rest) {
        push_function(t);
        for (int i = 0; i < count; i++) {
            push_right(&t->fn->args[i]);
        }
        lua_pushboolean(L, 1);
        must_fail(t, base, any_phase(t->fn), "expected");
    }
    for (unsigned phase = 1; phase <= BIND_QUIT; phase <<= 1) {
        if (t->fn->phases & phase) {
            continue;
        }
        push_function(t);
        for (int i = 0; i < count; i++) {
            push_right(&t->fn->args[i]);
        }
        must_fail(t, base, phase, bind_phase_name(phase));
    }
}

// A handle that was never given out.
static void check_stale(const target *t) {
    bool light = strcmp(t->type->name, "Light") == 0; // its room checks, in words of its own
    if (light || strcmp(t->fn->name, "isDestroyed") == 0) {
        return;
    }
    int base = lua_gettop(w.L);
    bind_push(w.script, w.L, t->type, (core_handle){60000, 9});
    lua_getfield(w.L, -1, t->fn->name);
    lua_insert(w.L, -2);
    must_fail(t, base, any_phase(t->fn), "was destroyed");
}

static void test_every_function_refuses_what_it_does_not_take(void) {
    int functions = 0;
    for (int r = 0; bind_rooms[r]; r++) {
        for (const bind_module *m = bind_rooms[r]->modules; m->path; m++) {
            for (const bind_fn *fn = m->functions; fn->name; fn++, functions++) {
                if (fn->mod_only) {
                    continue; // test_guard.c calls those
                }
                target t = {.fn = fn, .module = m->path};
                snprintf(t.owner, sizeof t.owner, fn->name[0] ? "%s.%s" : "%s", m->path, fn->name);
                check_target(&t);
            }
        }
        for (int i = 0; bind_rooms[r]->types && bind_rooms[r]->types[i]; i++) {
            const bind_type *type = bind_rooms[r]->types[i];
            for (const bind_fn *fn = type->methods; fn->name; fn++, functions++) {
                target t = {.fn = fn, .type = type};
                snprintf(t.owner, sizeof t.owner, "%s:%s", type->name, fn->name);
                check_stale(&t);
                if (strcmp(type->name, "Model") != 0 && strcmp(type->name, "Effect") != 0) {
                    check_target(&t);
                }
            }
        }
    }
    TEST_ASSERT_GREATER_THAN_INT(40, functions);
    TEST_ASSERT_GREATER_THAN_INT(40 * functions / 4, calls);
}

static void test_every_function_has_a_line_of_text_and_named_arguments(void) {
    for (int r = 0; bind_rooms[r]; r++) {
        for (const bind_module *m = bind_rooms[r]->modules; m->path; m++) {
            for (const bind_fn *fn = m->functions; fn->name; fn++) {
                TEST_ASSERT_TRUE_MESSAGE(fn->doc[strlen(fn->doc) - 1] == '.', fn->name);
                TEST_ASSERT_TRUE_MESSAGE(fn->phases != 0, fn->name);
                TEST_ASSERT_TRUE_MESSAGE(fn->args || fn->size == 0, fn->name);
            }
        }
    }
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_every_function_refuses_what_it_does_not_take);
    RUN_TEST(test_every_function_has_a_line_of_text_and_named_arguments);
    return UNITY_END();
}
