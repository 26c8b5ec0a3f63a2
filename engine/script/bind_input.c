// corsac.input: keys, buttons, axes, actions; what a bot sends.
#include "script/internal.h"

typedef struct name_args {
    const char *name;
} name_args;

CORE_NORETURN static void no_key(lua_State *L, const char *owner, const char *name) {
    bind_error(L,
               "%s: no key, button, axis or action \"%s\"; actions are declared in corsac.conf "
               "(t.actions = {jump = \"space\"})",
               owner, name);
}

static int is_down(script *s, lua_State *L, void *args) {
    const char *name = ((name_args *)args)->name;
    bool known = false;
    bool down = s->host.input_down ? s->host.input_down(s->host.ctx, name, &known) : false;
    if (!known) {
        no_key(L, "corsac.input.isDown", name);
    }
    lua_pushboolean(L, down);
    return 1;
}

static int get_axis(script *s, lua_State *L, void *args) {
    const char *name = ((name_args *)args)->name;
    bool known = false;
    float value = s->host.input_axis ? s->host.input_axis(s->host.ctx, name, &known) : 0.0f;
    if (!known) {
        no_key(L, "corsac.input.getAxis", name);
    }
    lua_pushnumber(L, (double)value);
    return 1;
}

// ---- bindings ----

typedef struct bind_args {
    const char *action, *keys;
} bind_args;
static int bind_action(script *s, lua_State *L, void *args) {
    const bind_args *a = args;
    if (s->host.bind && !s->host.bind(s->host.ctx, a->action, a->keys)) {
        bind_fail(L);
    }
    return 0;
}

static int get_binding(script *s, lua_State *L, void *args) {
    char keys[256] = "";
    if (s->host.binding &&
        s->host.binding(s->host.ctx, ((name_args *)args)->name, keys, sizeof keys)) {
        lua_pushstring(L, keys);
    } else {
        lua_pushnil(L);
    }
    return 1;
}

#define CURSORS "normal|hidden|locked"
typedef struct cursor_args {
    int mode;
} cursor_args;
static int set_cursor(script *s, lua_State *L, void *args) {
    (void)L;
    if (s->host.cursor) {
        s->host.cursor(s->host.ctx, ((cursor_args *)args)->mode);
    }
    return 0;
}

// ---- bots ----

static int press(script *s, lua_State *L, void *args) {
    const char *name = ((name_args *)args)->name;
    if (s->host.send_key && !s->host.send_key(s->host.ctx, name, true)) {
        no_key(L, "corsac.input.press", name);
    }
    return 0;
}

static int release(script *s, lua_State *L, void *args) {
    const char *name = ((name_args *)args)->name;
    if (s->host.send_key && !s->host.send_key(s->host.ctx, name, false)) {
        no_key(L, "corsac.input.release", name);
    }
    return 0;
}

typedef struct axis_args {
    const char *name;
    double value;
} axis_args;
static int set_axis(script *s, lua_State *L, void *args) {
    const axis_args *a = args;
    if (s->host.send_axis && !s->host.send_axis(s->host.ctx, a->name, (float)a->value)) {
        no_key(L, "corsac.input.setAxis", a->name);
    }
    return 0;
}

typedef struct move_args {
    double x, y;
} move_args;
static int move(script *s, lua_State *L, void *args) {
    const move_args *a = args;
    (void)L;
    if (s->host.send_move) {
        s->host.send_move(s->host.ctx, (float)a->x, (float)a->y);
    }
    return 0;
}

static int type(script *s, lua_State *L, void *args) {
    if (s->host.send_text && !s->host.send_text(s->host.ctx, ((name_args *)args)->name)) {
        bind_error(L, "corsac.input.type: the text is not UTF-8");
    }
    return 0;
}

// ---- declarations ----

#define KEY_ARG(what) BIND_ARGS({"name", BIND_STRING, BIND_AT(name_args, name), what})
#define BOT_DOC       " As if a person did it: heard in the next step, recorded, ignored in a replay."

static const bind_fn functions[] = {
    {"isDown", "Whether a key, button or action is held at this step.",
     KEY_ARG("\"space\", \"a\", \"mouse1\", \"pad_a\", an action"),
     BIND_RETURNS({"down", "boolean", NULL}), sizeof(name_args), BIND_RUNNING, .run = is_down},
    {"getAxis",
     "Value of an axis at this step: an action -1 to 1, a stick without its dead zone, the "
     "pointer and the wheel.",
     KEY_ARG("an action, \"pad_leftx\", \"mouse_x\", \"mouse_y\" (pixels), \"move_x\", \"move_y\", "
             "\"scroll_x\", \"scroll_y\""),
     BIND_RETURNS({"value", "number", NULL}), sizeof(name_args), BIND_RUNNING, .run = get_axis},
    {"bind", "Binds an action to other keys, in place of those of corsac.conf.",
     BIND_ARGS({"action", BIND_STRING, BIND_AT(bind_args, action), "a new name makes an action"},
               {"keys", BIND_STRING, BIND_AT(bind_args, keys),
                "separated by commas; - before one pulls the axis down: \"-a,d,pad_leftx\""}),
     NULL, sizeof(bind_args), BIND_SIM | BIND_EVENT, .run = bind_action},
    {"getBinding", "The keys of an action as bind takes them, nil for unknown actions.",
     KEY_ARG("an action"), BIND_RETURNS({"keys", "string?", NULL}), sizeof(name_args), BIND_RUNNING,
     .run = get_binding},
    {"setCursor",
     "How the pointer shows in a window; locked: hidden and held, for turning a camera.",
     BIND_ARGS({"mode", BIND_ENUM, BIND_AT(cursor_args, mode), "", .values = CURSORS}), NULL,
     sizeof(cursor_args), BIND_RUNNING, .run = set_cursor},
    {"press", "Presses a key or button." BOT_DOC, KEY_ARG("of a key or button"), NULL,
     sizeof(name_args), BIND_SIM, .run = press},
    {"release", "Releases a key or button." BOT_DOC, KEY_ARG("of a key or button"), NULL,
     sizeof(name_args), BIND_SIM, .run = release},
    {"setAxis", "Moves a stick or trigger of the gamepad." BOT_DOC,
     BIND_ARGS({"name", BIND_STRING, BIND_AT(axis_args, name), "\"pad_leftx\", \"pad_rt\""},
               {"value", BIND_NUMBER, BIND_AT(axis_args, value), "stick -1 to 1, trigger 0 to 1",
                NULL, BIND_BETWEEN, .min = -1, .max = 1}),
     NULL, sizeof(axis_args), BIND_SIM, .run = set_axis},
    {"move", "Moves the pointer." BOT_DOC,
     BIND_ARGS({"x", BIND_NUMBER, BIND_AT(move_args, x), "", "pixels"},
               {"y", BIND_NUMBER, BIND_AT(move_args, y), "", "pixels"}),
     NULL, sizeof(move_args), BIND_SIM, .run = move},
    {"type", "Types a text." BOT_DOC, KEY_ARG("UTF-8"), NULL, sizeof(name_args), BIND_SIM,
     .run = type},
    {0}};

static const bind_module modules[] = {
    {"corsac.input", "Keys, buttons, axes and actions, sampled once per step.", functions}, {0}};

const bind_room bind_input_room = {"input", modules, NULL};
