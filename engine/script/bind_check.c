// Checks arguments and phases as the declarations say, and words the errors.
#include "script/bind_check.h"

#include "core/nearest.h"
#include "script/internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void check_value(bind_path *path, const bind_arg *arg, int index, unsigned char *out);

// ---- words ----

void bind_push_where(lua_State *L) {
    lua_Debug frame;
    for (int level = 0; lua_getstack(L, level, &frame); level++) {
        lua_getinfo(L, "Sl", &frame);
        if (frame.currentline > 0 && strncmp(frame.source, "=corsac/", 8) != 0) {
            lua_pushfstring(L, "%s:%d: ", frame.short_src, frame.currentline);
            return;
        }
    }
    lua_pushliteral(L, "");
}

void bind_error(lua_State *L, const char *fmt, ...) {
    char text[1024];
    va_list args;
    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    bind_push_where(L);
    lua_pushstring(L, text);
    lua_concat(L, 2);
    lua_error(L);
    __builtin_unreachable();
}

void bind_fail(lua_State *L) { bind_error(L, "%s", core_last_error()); }

void bind_names_add(bind_names *names, const char *name) {
    if (names->count < CORE_COUNT_OF(names->name)) {
        names->name[names->count++] = name;
    }
}

static int compare_names(const void *a, const void *b) {
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

const char *bind_nearest(const char *name, bind_names *names) {
    qsort(names->name, names->count, sizeof names->name[0], compare_names);
    return core_nearest(name, names->name, names->count);
}

static const struct {
    unsigned phase;
    const char *name;
} phase_names[] = {
    {BIND_TOP, "the file's own code"}, {BIND_CONF, "corsac.conf"},   {BIND_LOAD, "corsac.load"},
    {BIND_FIXED, "corsac.fixed"},      {BIND_STEP, "the step"},      {BIND_UPDATE, "corsac.update"},
    {BIND_DRAW, "corsac.draw"},        {BIND_EVENT, "corsac.event"}, {BIND_QUIT, "corsac.quit"}};

const char *bind_phase_name(unsigned phase) {
    for (size_t i = 0; i < CORE_COUNT_OF(phase_names); i++) {
        if (phase_names[i].phase == phase) {
            return phase_names[i].name;
        }
    }
    return "outside every callback";
}

static const char *kind_name(const bind_arg *arg) {
    switch (arg->kind) {
    case BIND_NUMBER:
    case BIND_FLOAT:
        return "a number";
    case BIND_INT:
        return "a whole number";
    case BIND_BOOL:
        return "true or false";
    case BIND_STRING:
        return "a string";
    case BIND_ENUM:
        return "one of";
    case BIND_VEC3:
        return arg->uniform ? "a number or a table {x, y, z}" : "a table {x, y, z}";
    case BIND_QUAT:
        return "a table {x, y, z, w} or {axis = {x, y, z}, angle = radians}";
    case BIND_COLOR:
        return "a table {r, g, b} or {r, g, b, a}";
    case BIND_OBJECT:
        return "an object";
    case BIND_OPTIONS:
        return "a table of options";
    case BIND_LIST:
        return "an array of tables";
    case BIND_NUMBERS:
        return "an array of numbers";
    case BIND_FUNCTION:
        return "a function";
    case BIND_TABLE:
        return "a table";
    case BIND_VALUE:
        return "a value";
    case BIND_REST:
        return "any values";
    }
    return "";
}

void bind_describe(const bind_arg *arg, char *out, size_t size) {
    char values[256] = "", range[64] = "";
    if (arg->kind == BIND_ENUM) {
        size_t n = 0;
        n += (size_t)snprintf(values, sizeof values, " \"");
        for (const char *c = arg->values; *c && n + 8 < sizeof values; c++) {
            if (*c == '|') {
                n += (size_t)snprintf(values + n, sizeof values - n, "\", \"");
            } else {
                values[n++] = *c;
                values[n] = 0;
            }
        }
        snprintf(values + n, sizeof values - n, "\"");
    } else if (arg->kind == BIND_OBJECT) {
        snprintf(values, sizeof values, " of type %s", arg->type->name);
    }
    if (arg->range == BIND_POSITIVE) {
        snprintf(range, sizeof range, ", > 0");
    } else if (arg->range == BIND_NOT_NEGATIVE) {
        snprintf(range, sizeof range, ", >= 0");
    } else if (arg->range == BIND_BETWEEN) {
        snprintf(range, sizeof range, ", %.14g to %.14g", arg->min, arg->max);
    }
    snprintf(out, size, "%s%s%s%s%s", kind_name(arg), values, arg->unit ? " in " : "",
             arg->unit ? arg->unit : "", range);
}

const char *bind_article(const char *noun) { return strchr("AEIOUaeiou", noun[0]) ? "an" : "a"; }

const bind_type *bind_type_at(script *s, lua_State *L, int index) {
    if (lua_type(L, index) != LUA_TUSERDATA || !lua_getmetatable(L, index)) {
        return NULL;
    }
    const void *metatable = lua_topointer(L, -1);
    lua_pop(L, 1);
    for (int i = 0; i < s->type_count; i++) {
        if (s->type[i].metatable == metatable) {
            return s->type[i].type;
        }
    }
    return NULL;
}

// "the string "abc"", "a Body", "nothing": what was given, in a reader's words.
void bind_describe_value(script *s, lua_State *L, int index, char *out, size_t size) {
    switch (lua_type(L, index)) {
    case LUA_TNONE:
    case LUA_TNIL:
        snprintf(out, size, "nothing (nil)");
        break;
    case LUA_TBOOLEAN:
        snprintf(out, size, "%s", lua_toboolean(L, index) ? "true" : "false");
        break;
    case LUA_TNUMBER:
        snprintf(out, size, "the number %.14g", lua_tonumber(L, index));
        break;
    case LUA_TSTRING: {
        const char *text = lua_tostring(L, index);
        snprintf(out, size, "the string \"%.40s%s\"", text, strlen(text) > 40 ? "..." : "");
        break;
    }
    case LUA_TUSERDATA: {
        const bind_type *type = bind_type_at(s, L, index);
        const char *name = type ? type->name : "userdata";
        snprintf(out, size, "%s %s", bind_article(name), name);
        break;
    }
    default:
        snprintf(out, size, "a %s", luaL_typename(L, index));
        break;
    }
}

CORE_NORETURN static void fail_at(bind_path *path, const char *fmt, ...) CORE_PRINTF(2, 3);
static void fail_at(bind_path *path, const char *fmt, ...) {
    char text[768];
    va_list args;
    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    bool field = path->field[0] != 0;
    bind_error(path->L, "%s: argument %d (%s)%s%s: %s", path->owner, path->argument,
               path->argument_name, field ? ", field " : "", path->field, text);
}

CORE_NORETURN static void expected(bind_path *path, const bind_arg *arg, int index) {
    char want[384], got[96];
    bind_describe(arg, want, sizeof want);
    bind_describe_value(path->s, path->L, index, got, sizeof got);
    fail_at(path, "expected %s, got %s", want, got);
}

// ---- checks ----

static double check_number(bind_path *path, const bind_arg *arg, int index) {
    if (lua_type(path->L, index) != LUA_TNUMBER) {
        expected(path, arg, index);
    }
    double v = lua_tonumber(path->L, index);
    bool good =
        isfinite(v) && (arg->range != BIND_POSITIVE || v > 0) &&
        (arg->range != BIND_NOT_NEGATIVE || v >= 0) &&
        (arg->range != BIND_BETWEEN || (v >= arg->min && v <= arg->max)) &&
        (arg->kind != BIND_INT || (v == floor(v) && fabs(v) <= 9007199254740992.0)) &&
        ((arg->kind != BIND_FLOAT && arg->kind != BIND_VEC3) || fabs(v) <= 3.4028234663852886e38);
    if (!good) {
        expected(path, arg, index);
    }
    return v;
}

static int check_enum(bind_path *path, const bind_arg *arg, int index) {
    if (lua_type(path->L, index) != LUA_TSTRING) {
        expected(path, arg, index);
    }
    const char *text = lua_tostring(path->L, index);
    bind_names names = {.count = 0};
    const char *value = arg->values;
    for (int i = 0;; i++) {
        size_t length = strcspn(value, "|");
        if (strlen(text) == length && strncmp(text, value, length) == 0) {
            return i;
        }
        lua_pushlstring(path->L, value, length); // a Lua string of its own for the list
        bind_names_add(&names, lua_tostring(path->L, -1));
        if (value[length] == 0) {
            break;
        }
        value += length + 1;
    }
    char want[384];
    bind_describe(arg, want, sizeof want);
    const char *near = bind_nearest(text, &names);
    if (near) {
        fail_at(path, "\"%.40s\" is unknown; did you mean \"%s\"?", text, near);
    }
    fail_at(path, "\"%.40s\" is unknown; expected %s", text, want);
}

// Numbers [1..count] of the table at index; false when one is missing or no finite number.
static bool read_numbers(lua_State *L, int index, float *out, int count) {
    for (int i = 0; i < count; i++) {
        lua_rawgeti(L, index, i + 1);
        bool good = lua_type(L, -1) == LUA_TNUMBER && isfinite((float)lua_tonumber(L, -1));
        out[i] = (float)lua_tonumber(L, -1);
        lua_pop(L, 1);
        if (!good) {
            return false;
        }
    }
    return true;
}

static void check_vec3(bind_path *path, const bind_arg *arg, int index, core_vec3 *out) {
    lua_State *L = path->L;
    float v[3];
    if (arg->uniform && lua_type(L, index) == LUA_TNUMBER) {
        v[0] = v[1] = v[2] = (float)check_number(path, arg, index);
    } else if (lua_type(L, index) != LUA_TTABLE || lua_objlen(L, index) != 3 ||
               !read_numbers(L, index, v, 3)) {
        if (lua_type(L, index) == LUA_TTABLE) {
            fail_at(path, "expected three finite numbers {x, y, z}");
        }
        expected(path, arg, index);
    }
    for (int i = 0; i < 3; i++) {
        if (arg->range == BIND_POSITIVE && !(v[i] > 0)) {
            fail_at(path, "every number must be > 0, number %d is %.9g", i + 1, (double)v[i]);
        }
    }
    *out = (core_vec3){v[0], v[1], v[2]};
}

static void check_quat(bind_path *path, const bind_arg *arg, int index, core_quat *out) {
    lua_State *L = path->L;
    float v[4];
    if (lua_type(L, index) != LUA_TTABLE) {
        expected(path, arg, index);
    }
    if (lua_objlen(L, index) == 4 && read_numbers(L, index, v, 4)) {
        *out = core_quat_normalize((core_quat){v[0], v[1], v[2], v[3]});
        return;
    }
    lua_getfield(L, index, "axis");
    lua_getfield(L, index, "angle");
    bool good = lua_type(L, -2) == LUA_TTABLE && lua_type(L, -1) == LUA_TNUMBER &&
                read_numbers(L, lua_gettop(L) - 1, v, 3) && isfinite(lua_tonumber(L, -1));
    if (!good) {
        fail_at(path,
                "expected four finite numbers {x, y, z, w} or {axis = {x, y, z}, angle = radians}");
    }
    core_vec3 axis = core_v3_normalize((core_vec3){v[0], v[1], v[2]}, (core_vec3){0, 0, 0});
    if (core_v3_dot(axis, axis) == 0) {
        fail_at(path, "the axis must not be zero");
    }
    *out = core_quat_axis_angle(axis, (float)lua_tonumber(L, -1));
    lua_pop(L, 2);
}

static void check_color(bind_path *path, const bind_arg *arg, int index, float *out) {
    lua_State *L = path->L;
    if (lua_type(L, index) != LUA_TTABLE) {
        expected(path, arg, index);
    }
    int count = (int)lua_objlen(L, index);
    out[3] = 1;
    if ((count != 3 && count != 4) || !read_numbers(L, index, out, count)) {
        fail_at(path, "expected three or four numbers {r, g, b} or {r, g, b, a}");
    }
    for (int i = 0; i < count; i++) {
        if (out[i] < 0) {
            fail_at(path, "colours are >= 0, number %d is %.9g", i + 1, (double)out[i]);
        }
    }
}

// C's strings end at the first zero byte; one inside would cut a name short in silence.
static const char *check_text(bind_path *path, int index) {
    size_t length;
    const char *text = lua_tolstring(path->L, index, &length);
    if (strlen(text) != length) {
        fail_at(path, "the string \"%.40s\" goes on behind a zero byte", text);
    }
    return text;
}

static core_handle check_object(bind_path *path, const bind_arg *arg, int index) {
    if (bind_type_at(path->s, path->L, index) != arg->type) {
        expected(path, arg, index);
    }
    const bind_object *object = lua_touserdata(path->L, index);
    if (!arg->type->alive(path->s, object->handle)) {
        fail_at(path, "this %s was destroyed", arg->type->name);
    }
    return object->handle;
}

// The misspelt or foreign key with the smallest name (so that messages do not depend on table
// order) is reported.
static void check_keys(bind_path *path, const bind_arg *fields, int index) {
    lua_State *L = path->L;
    const char *wrong = NULL;
    lua_pushnil(L);
    while (lua_next(L, index)) {
        lua_pop(L, 1);
        if (lua_type(L, -1) != LUA_TSTRING) {
            fail_at(path, "expected named fields only, found a key that is %s %s",
                    lua_type(L, -1) == LUA_TNUMBER ? "the" : "a", luaL_typename(L, -1));
        }
        const char *key = lua_tostring(L, -1);
        const bind_arg *field = fields;
        while (field->name && strcmp(field->name, key) != 0) {
            field++;
        }
        if (!field->name && (!wrong || strcmp(key, wrong) < 0)) {
            wrong = key;
        }
    }
    if (!wrong) {
        return;
    }
    bind_names names = {.count = 0};
    char known[512] = "";
    size_t n = 0;
    for (const bind_arg *field = fields; field->name; field++) {
        bind_names_add(&names, field->name);
        n += (size_t)snprintf(known + n, sizeof known - n, "%s%s", n ? ", " : "", field->name);
        n = CORE_MIN(n, sizeof known - 1);
    }
    const char *near = bind_nearest(wrong, &names);
    if (near) {
        fail_at(path, "unknown field \"%.40s\"; did you mean \"%s\"?", wrong, near);
    }
    fail_at(path, "unknown field \"%.40s\"; fields are: %s", wrong, known);
}

static void check_options(bind_path *path, const bind_arg *arg, int index, unsigned char *out) {
    lua_State *L = path->L;
    if (lua_type(L, index) != LUA_TTABLE) {
        expected(path, arg, index);
    }
    luaL_checkstack(L, 16, "options nest too deeply");
    luaL_checkstack(L, 24, "too many options");
    check_keys(path, arg->fields, index);
    size_t depth = strlen(path->field);
    for (const bind_arg *field = arg->fields; field->name; field++) {
        snprintf(path->field + depth, sizeof path->field - depth, "%s%s", depth ? "." : "",
                 field->name);
        lua_pushstring(L, field->name);
        lua_rawget(L, index);
        int top = lua_gettop(L);
        check_value(path, field, top, out);
        // Strings live on in the caller's table; what the struct knows by index or pointer stays.
        if (field->kind < BIND_OPTIONS) {
            lua_settop(L, top - 1);
        }
    }
    path->field[depth] = 0;
}

static void check_list(bind_path *path, const bind_arg *arg, int index, bind_list *out) {
    lua_State *L = path->L;
    if (lua_type(L, index) != LUA_TTABLE) {
        expected(path, arg, index);
    }
    out->count = (uint32_t)lua_objlen(L, index);
    out->items = lua_newuserdata(L, out->count * arg->size + 1);
    memset(out->items, 0, out->count * arg->size);
    bind_arg item = *arg;
    item.kind = BIND_OPTIONS;
    size_t depth = strlen(path->field);
    for (uint32_t i = 0; i < out->count; i++) {
        snprintf(path->field + depth, sizeof path->field - depth, "%s%u", depth ? "." : "", i + 1);
        lua_rawgeti(L, index, (int)i + 1);
        int top = lua_gettop(L);
        check_options(path, &item, top, (unsigned char *)out->items + i * arg->size);
        if (lua_gettop(L) == top) { // holds nothing that the struct knows by index
            lua_pop(L, 1);
        }
    }
    path->field[depth] = 0;
}

static void check_numbers(bind_path *path, const bind_arg *arg, int index, bind_numbers *out) {
    lua_State *L = path->L;
    if (lua_type(L, index) != LUA_TTABLE) {
        expected(path, arg, index);
    }
    out->count = (uint32_t)lua_objlen(L, index);
    out->items = lua_newuserdata(L, out->count * sizeof(float) + 1);
    if (!read_numbers(L, index, out->items, (int)out->count)) {
        fail_at(path, "expected finite numbers only");
    }
}

static void set_default(const bind_arg *arg, unsigned char *member) {
    switch (arg->kind) {
    case BIND_NUMBER:
        *(double *)(void *)member = arg->def;
        break;
    case BIND_FLOAT:
        *(float *)(void *)member = (float)arg->def;
        break;
    case BIND_INT:
        *(int64_t *)(void *)member = (int64_t)arg->def;
        break;
    case BIND_BOOL:
        *(bool *)member = arg->def != 0;
        break;
    case BIND_ENUM:
        *(int *)(void *)member = (int)arg->def;
        break;
    case BIND_STRING:
        *(const char **)(void *)member = arg->def_text;
        break;
    case BIND_VEC3:
        *(core_vec3 *)(void *)member = arg->def_vec;
        break;
    case BIND_COLOR:
        memcpy(member, &arg->def_vec, sizeof arg->def_vec);
        ((float *)(void *)member)[3] = 1;
        break;
    default:
        break; // already zero
    }
}

static void check_value(bind_path *path, const bind_arg *arg, int index, unsigned char *out) {
    lua_State *L = path->L;
    unsigned char *member = out + arg->at;
    if (arg->optional && lua_isnoneornil(L, index)) {
        set_default(arg, member);
        return;
    }
    if (arg->given) {
        *(bool *)(out + arg->given) = true;
    }
    switch (arg->kind) {
    case BIND_NUMBER:
        *(double *)(void *)member = check_number(path, arg, index);
        break;
    case BIND_FLOAT:
        *(float *)(void *)member = (float)check_number(path, arg, index);
        break;
    case BIND_INT:
        *(int64_t *)(void *)member = (int64_t)check_number(path, arg, index);
        break;
    case BIND_BOOL:
        if (lua_type(L, index) != LUA_TBOOLEAN) {
            expected(path, arg, index);
        }
        *(bool *)member = lua_toboolean(L, index);
        break;
    case BIND_STRING:
        if (lua_type(L, index) != LUA_TSTRING) {
            expected(path, arg, index);
        }
        *(const char **)(void *)member = check_text(path, index);
        break;
    case BIND_ENUM:
        *(int *)(void *)member = check_enum(path, arg, index);
        break;
    case BIND_VEC3:
        check_vec3(path, arg, index, (core_vec3 *)(void *)member);
        break;
    case BIND_QUAT:
        check_quat(path, arg, index, (core_quat *)(void *)member);
        break;
    case BIND_COLOR:
        check_color(path, arg, index, (float *)(void *)member);
        break;
    case BIND_OBJECT:
        *(core_handle *)(void *)member = check_object(path, arg, index);
        break;
    case BIND_OPTIONS:
        check_options(path, arg, index, member);
        break;
    case BIND_LIST:
        check_list(path, arg, index, (bind_list *)(void *)member);
        break;
    case BIND_NUMBERS:
        check_numbers(path, arg, index, (bind_numbers *)(void *)member);
        break;
    case BIND_FUNCTION:
    case BIND_TABLE:
        if (lua_type(L, index) != (arg->kind == BIND_TABLE ? LUA_TTABLE : LUA_TFUNCTION)) {
            expected(path, arg, index);
        }
        *(int *)(void *)member = index;
        break;
    case BIND_VALUE:
        if (lua_isnoneornil(L, index)) {
            expected(path, arg, index);
        }
        *(int *)(void *)member = index;
        break;
    case BIND_REST:
        *(int *)(void *)member = index;
        break;
    }
}

void bind_check_phase(script *s, lua_State *L, const bind_fn *fn, const char *owner) {
    if (fn->phases & s->phase) {
        return;
    }
    const char *now = bind_phase_name(s->phase);
    if ((fn->phases & BIND_SIM) && (s->phase & (BIND_VIEW | BIND_QUIT))) {
        bind_error(L,
                   "%s changes the simulation, which %s must not do; call it from corsac.fixed "
                   "(or corsac.load)",
                   owner, now);
    }
    if ((fn->phases & BIND_SIM) && (s->phase & (BIND_TOP | BIND_CONF))) {
        bind_error(L,
                   "%s needs the world, which does not exist yet in %s; call it from corsac.load",
                   owner, now);
    }
    char allowed[256];
    size_t n = 0;
    for (size_t i = 0; i < CORE_COUNT_OF(phase_names) && n < sizeof allowed; i++) {
        if (fn->phases & phase_names[i].phase) {
            n += (size_t)snprintf(allowed + n, sizeof allowed - n, "%s%s", n ? ", " : "",
                                  phase_names[i].name);
        }
    }
    bind_error(L, "%s cannot be called from %s; call it from %s", owner, now, allowed);
}

void bind_check_args(bind_path *path, const bind_fn *fn, int first, unsigned char *out) {
    lua_State *L = path->L;
    int index = first, given = lua_gettop(L), declared = 0;
    bool rest = false;
    while (fn->args && fn->args[declared].name) {
        rest = rest || fn->args[declared].kind == BIND_REST;
        declared++;
    }
    if (given < first - 1 + declared - rest) {
        lua_settop(L, first - 1 + declared - rest); // missing ones are nil
    }
    luaL_checkstack(L, 40, "too many arguments");
    for (const bind_arg *arg = fn->args; arg && arg->name; arg++, index++) {
        path->argument = index - first + 1;
        path->argument_name = arg->name;
        check_value(path, arg, index, out);
    }
    if (!rest && given >= index) {
        bind_error(L, "%s: expected %d argument%s, got %d", path->owner, index - first,
                   index - first == 1 ? "" : "s", given - first + 1);
    }
}

void bind_check_table(script *s, lua_State *L, int index, const char *owner, const char *what,
                      const bind_arg *fields, void *out) {
    bind_path path = {.L = L, .s = s, .owner = owner, .argument = 1, .argument_name = what};
    bind_arg options = {.name = what, .kind = BIND_OPTIONS, .fields = fields};
    luaL_checkstack(L, 40, "too many options");
    check_options(&path, &options, index, out);
}
