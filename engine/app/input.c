#include "app/input.h"

#include <stdio.h>
#include <string.h>

#include "core/json.h"
#include "core/log.h"
#include "core/nearest.h"

// GLFW's codes, by number: this room knows no window library.
typedef struct key_name {
    const char *name;
    int16_t code;
} key_name;
static const key_name keys[] = {
    {"space", 32},      {"apostrophe", 39},  {"comma", 44},       {"minus", 45},
    {"period", 46},     {"slash", 47},       {"semicolon", 59},   {"equal", 61},
    {"lbracket", 91},   {"backslash", 92},   {"rbracket", 93},    {"grave", 96},
    {"escape", 256},    {"enter", 257},      {"tab", 258},        {"backspace", 259},
    {"insert", 260},    {"delete", 261},     {"right", 262},      {"left", 263},
    {"down", 264},      {"up", 265},         {"pageup", 266},     {"pagedown", 267},
    {"home", 268},      {"end", 269},        {"capslock", 280},   {"scrolllock", 281},
    {"numlock", 282},   {"print", 283},      {"pause", 284},      {"f1", 290},
    {"f2", 291},        {"f3", 292},         {"f4", 293},         {"f5", 294},
    {"f6", 295},        {"f7", 296},         {"f8", 297},         {"f9", 298},
    {"f10", 299},       {"f11", 300},        {"f12", 301},        {"kp0", 320},
    {"kp1", 321},       {"kp2", 322},        {"kp3", 323},        {"kp4", 324},
    {"kp5", 325},       {"kp6", 326},        {"kp7", 327},        {"kp8", 328},
    {"kp9", 329},       {"kpdecimal", 330},  {"kpdivide", 331},   {"kpmultiply", 332},
    {"kpminus", 333},   {"kpplus", 334},     {"kpenter", 335},    {"lshift", 340},
    {"lctrl", 341},     {"lalt", 342},       {"lsuper", 343},     {"rshift", 344},
    {"rctrl", 345},     {"ralt", 346},       {"rsuper", 347},     {"menu", 348},
    {"mouse1", 512},    {"mouse2", 513},     {"mouse3", 514},     {"mouse4", 515},
    {"mouse5", 516},    {"mouse6", 517},     {"mouse7", 518},     {"mouse8", 519},
    {"pad_a", 520},     {"pad_b", 521},      {"pad_x", 522},      {"pad_y", 523},
    {"pad_lb", 524},    {"pad_rb", 525},     {"pad_back", 526},   {"pad_start", 527},
    {"pad_guide", 528}, {"pad_lthumb", 529}, {"pad_rthumb", 530}, {"pad_up", 531},
    {"pad_right", 532}, {"pad_down", 533},   {"pad_left", 534},   {"pad_leftx", 540},
    {"pad_lefty", 541}, {"pad_rightx", 542}, {"pad_righty", 543}, {"pad_lt", 544},
    {"pad_rt", 545},
};

const char *app_key_name(int code, char buffer[8]) {
    if ((code >= 'A' && code <= 'Z') || (code >= '0' && code <= '9')) {
        buffer[0] = (char)(code >= 'A' ? code - 'A' + 'a' : code);
        buffer[1] = 0;
        return buffer;
    }
    for (size_t i = 0; i < CORE_COUNT_OF(keys); i++) {
        if (keys[i].code == code) {
            return keys[i].name;
        }
    }
    return "";
}

int app_key_code(const char *name) {
    char c = name[0];
    if (c && !name[1] && ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'))) {
        return c >= 'a' ? c - 'a' + 'A' : c;
    }
    for (size_t i = 0; i < CORE_COUNT_OF(keys); i++) {
        if (strcmp(keys[i].name, name) == 0) {
            return keys[i].code;
        }
    }
    return -1;
}

void app_utf8(int32_t c, char out[5]) {
    uint8_t *o = (uint8_t *)out;
    if (c > 0 && c < 0x80) {
        *o++ = (uint8_t)c;
    } else if (c >= 0x80 && c < 0x800) {
        *o++ = (uint8_t)(0xc0 | c >> 6);
        *o++ = (uint8_t)(0x80 | (c & 63));
    } else if (c >= 0x800 && c < 0x10000 && (c < 0xd800 || c > 0xdfff)) {
        *o++ = (uint8_t)(0xe0 | c >> 12);
        *o++ = (uint8_t)(0x80 | (c >> 6 & 63));
        *o++ = (uint8_t)(0x80 | (c & 63));
    } else if (c >= 0x10000 && c < 0x110000) {
        *o++ = (uint8_t)(0xf0 | c >> 18);
        *o++ = (uint8_t)(0x80 | (c >> 12 & 63));
        *o++ = (uint8_t)(0x80 | (c >> 6 & 63));
        *o++ = (uint8_t)(0x80 | (c & 63));
    }
    *o = 0;
}

static bool unknown_key(const char *action, const char *name) {
    const char *names[CORE_COUNT_OF(keys)];
    for (size_t i = 0; i < CORE_COUNT_OF(keys); i++) {
        names[i] = keys[i].name;
    }
    const char *near = core_nearest(name, names, CORE_COUNT_OF(keys));
    return core_fail_quiet(
        "action '%s': no key '%s'%s%s%s; keys are a-z, 0-9 and names as space, left, "
        "lshift, f5, mouse1, pad_a, pad_leftx",
        action, name, near ? ", did you mean '" : "", near ? near : "", near ? "'?" : "");
}

bool app_input_bind(app_input *in, const char *action, const char *text) {
    app_action bound = {0};
    if (!action[0] || strlen(action) >= sizeof bound.name) {
        return core_fail_quiet("action '%s': its name must have 1 to %zu bytes", action,
                               sizeof bound.name - 1);
    }
    strcpy(bound.name, action);
    while (*text) {
        size_t length = strcspn(text, ", ");
        char name[32] = "";
        int8_t sign = length && text[0] == '-' ? -1 : 1;
        size_t skip = length && (text[0] == '-' || text[0] == '+');
        snprintf(name, sizeof name, "%.*s", (int)(length - skip), text + skip);
        if (name[0]) {
            int code = app_key_code(name);
            if (code < 0) {
                return unknown_key(action, name);
            }
            if (bound.count == APP_MAX_BINDINGS) {
                return core_fail_quiet("action '%s': more than %d keys", action, APP_MAX_BINDINGS);
            }
            bound.binding[bound.count++] = (app_binding){(int16_t)code, sign};
        }
        text += length + (text[length] != 0);
    }
    uint32_t slot = 0;
    while (slot < in->action_count && strcmp(in->action[slot].name, action) != 0) {
        slot++;
    }
    if (slot == APP_MAX_ACTIONS) {
        return core_fail_quiet("action '%s': more than %d actions", action, APP_MAX_ACTIONS);
    }
    in->action[slot] = bound;
    in->action_count = CORE_MAX(in->action_count, slot + 1);
    return true;
}

bool app_input_binding(const app_input *in, const char *action, char *out, size_t size) {
    for (uint32_t a = 0; a < in->action_count; a++) {
        const app_action *at = &in->action[a];
        if (strcmp(at->name, action) != 0) {
            continue;
        }
        size_t used = 0;
        out[0] = 0;
        for (uint32_t b = 0; b < at->count && used < size; b++) {
            char letter[8];
            used += (size_t)snprintf(out + used, size - used, "%s%s%s", b ? "," : "",
                                     at->binding[b].sign < 0 ? "-" : "",
                                     app_key_name(at->binding[b].code, letter));
        }
        return true;
    }
    return false;
}

bool app_input_bound(const app_input *in, int code) {
    for (uint32_t a = 0; a < in->action_count; a++) {
        for (uint32_t b = 0; b < in->action[a].count; b++) {
            if (in->action[a].binding[b].code == code) {
                return true;
            }
        }
    }
    return false;
}

void app_input_init(app_input *in) {
    memset(in, 0, sizeof *in);
    in->dead_zone = 0.2f;
}

void app_input_queue(app_input *in, const gfx_event *event) {
    gfx_event *last = in->queued ? &in->queue[in->queued - 1] : NULL;
    if (last && last->type == GFX_EVENT_MOUSE_MOVE && event->type == GFX_EVENT_MOUSE_MOVE) {
        *last = *event; // only where the pointer ends up matters to a step
        return;
    }
    if (in->queued < APP_MAX_EVENTS) {
        in->queue[in->queued++] = *event;
    } else if (in->dropped++ == 0) {
        core_log(CORE_LOG_WARN, "input: more than %d events in one step; the rest is dropped",
                 APP_MAX_EVENTS);
    }
}

// Where the pointer will be once the queue is heard.
static void pointer(const app_input *in, float *x, float *y) {
    *x = in->mouse_x, *y = in->mouse_y;
    for (uint32_t i = 0; i < in->queued; i++) {
        if (in->queue[i].type == GFX_EVENT_MOUSE_MOVE) {
            *x = in->queue[i].x, *y = in->queue[i].y;
        }
    }
}

bool app_input_send_key(app_input *in, const char *name, bool pressed) {
    int code = app_key_code(name);
    if (code < 0 || code >= APP_AXIS_CODE) {
        return false;
    }
    gfx_event e = {.type = GFX_EVENT_KEY, .code = code, .pressed = pressed};
    if (code >= APP_PAD_CODE) {
        e.type = GFX_EVENT_PAD_BUTTON;
        e.code -= APP_PAD_CODE;
    } else if (code >= APP_MOUSE_CODE) {
        e.type = GFX_EVENT_MOUSE_BUTTON;
        e.code -= APP_MOUSE_CODE;
        pointer(in, &e.x, &e.y);
    }
    app_input_queue(in, &e);
    return true;
}

bool app_input_send_axis(app_input *in, const char *name, float value) {
    int code = app_key_code(name);
    if (code < APP_AXIS_CODE) {
        return false;
    }
    // A trigger rests at -1, as GLFW says it.
    bool trigger = code >= APP_AXIS_CODE + 4;
    gfx_event e = {.type = GFX_EVENT_PAD_AXIS,
                   .code = code - APP_AXIS_CODE,
                   .x = trigger ? 2.0f * value - 1.0f : value};
    app_input_queue(in, &e);
    return true;
}

static int32_t codepoint(const char *s, size_t length) {
    const uint8_t *b = (const uint8_t *)s;
    int32_t c = length == 1 ? b[0] : b[0] & (0x7f >> length);
    for (size_t i = 1; i < length; i++) {
        c = c << 6 | (b[i] & 63);
    }
    return c;
}

bool app_input_send_text(app_input *in, const char *utf8) {
    for (const char *s = utf8; *s;) {
        size_t length = core_utf8_length(s);
        if (!length) {
            return false;
        }
        gfx_event e = {.type = GFX_EVENT_TEXT, .code = codepoint(s, length), .pressed = 1};
        app_input_queue(in, &e);
        s += length;
    }
    return true;
}

// The way outside the dead zone is stretched to the whole: no jump at its edge.
static float live_axis(const app_input *in, int axis, float raw) {
    if (axis >= 4) {
        raw = 0.5f * (raw + 1.0f);
    }
    float size = CORE_MIN(raw < 0 ? -raw : raw, 1.0f);
    float live = size <= in->dead_zone ? 0.0f : (size - in->dead_zone) / (1.0f - in->dead_zone);
    return raw < 0 ? -live : live;
}

static void apply_pad(app_input *in, const gfx_event *e) {
    if (e->type == GFX_EVENT_PAD && !e->pressed) { // unplugged: nothing is held any more
        memset(in->pad, 0, sizeof in->pad);
        memset(in->down + APP_PAD_CODE, 0, APP_INPUT_CODES - APP_PAD_CODE);
    } else if (e->type == GFX_EVENT_PAD_AXIS && e->code >= 0 && e->code < APP_PAD_AXES) {
        in->pad[e->code] = live_axis(in, e->code, e->x);
        in->down[APP_AXIS_CODE + e->code] = in->pad[e->code] > 0.5f;
    }
}

static int event_code(const gfx_event *e) {
    return e->type == GFX_EVENT_MOUSE_BUTTON ? e->code + APP_MOUSE_CODE
           : e->type == GFX_EVENT_PAD_BUTTON ? e->code + APP_PAD_CODE
                                             : e->code;
}

// A key that goes down and up within one step is down for that step: a slow frame loses no tap.
static void set_key(app_input *in, int code, bool pressed) {
    in->tapped[code] = !pressed && in->fresh[code];
    in->fresh[code] |= pressed;
    in->down[code] = pressed || in->tapped[code];
}

static void end_taps(app_input *in) {
    for (int i = 0; i < APP_INPUT_CODES; i++) {
        in->down[i] &= !in->tapped[i];
    }
    memset(in->fresh, 0, sizeof in->fresh);
    memset(in->tapped, 0, sizeof in->tapped);
}

static void apply(app_input *in, const gfx_event *e) {
    int code = event_code(e);
    switch (e->type) {
    case GFX_EVENT_KEY:
    case GFX_EVENT_MOUSE_BUTTON:
    case GFX_EVENT_PAD_BUTTON:
        if (code >= 0 && code < APP_INPUT_CODES) {
            set_key(in, code, e->pressed != 0);
        }
        break;
    case GFX_EVENT_PAD:
    case GFX_EVENT_PAD_AXIS:
        apply_pad(in, e);
        break;
    case GFX_EVENT_MOUSE_MOVE:
        in->move_x += e->x - in->mouse_x;
        in->move_y += e->y - in->mouse_y;
        in->mouse_x = e->x;
        in->mouse_y = e->y;
        break;
    case GFX_EVENT_SCROLL:
        in->scroll_x += e->x;
        in->scroll_y += e->y;
        break;
    case GFX_EVENT_FOCUS:
        if (!e->pressed) { // releases that happen elsewhere are never seen
            memset(in->down, 0, sizeof in->down);
            memset(in->pad, 0, sizeof in->pad);
        }
        break;
    default:
        break;
    }
}

void app_input_step(app_input *in, const gfx_event *event, uint32_t count) {
    in->move_x = in->move_y = in->scroll_x = in->scroll_y = 0.0f;
    end_taps(in);
    for (uint32_t i = 0; i < count; i++) {
        apply(in, &event[i]);
    }
}

static const app_action *find_action(const app_input *in, const char *name) {
    for (uint32_t i = 0; i < in->action_count; i++) {
        if (strcmp(in->action[i].name, name) == 0) {
            return &in->action[i];
        }
    }
    return NULL;
}

// What a binding adds to its action's axis, -1..1.
static float pull(const app_input *in, const app_binding *b) {
    float value =
        b->code >= APP_AXIS_CODE ? in->pad[b->code - APP_AXIS_CODE] : (float)in->down[b->code];
    return value * (float)b->sign;
}

bool app_input_down(const app_input *in, const char *name, bool *known) {
    const app_action *action = find_action(in, name);
    *known = true;
    if (action) {
        bool down = false;
        for (uint32_t i = 0; i < action->count; i++) {
            down |= pull(in, &action->binding[i]) * (float)action->binding[i].sign > 0.5f;
        }
        return down;
    }
    int code = app_key_code(name);
    *known = code >= 0;
    return *known && in->down[code];
}

float app_input_axis(const app_input *in, const char *name, bool *known) {
    const app_action *action = find_action(in, name);
    *known = true;
    if (action) {
        float low = 0.0f, high = 0.0f;
        for (uint32_t i = 0; i < action->count; i++) {
            float value = pull(in, &action->binding[i]);
            low = CORE_MIN(low, value);
            high = CORE_MAX(high, value);
        }
        return low + high;
    }
    const struct {
        const char *name;
        float value;
    } axes[] = {{"mouse_x", in->mouse_x}, {"mouse_y", in->mouse_y},   {"move_x", in->move_x},
                {"move_y", in->move_y},   {"scroll_x", in->scroll_x}, {"scroll_y", in->scroll_y}};
    for (size_t i = 0; i < CORE_COUNT_OF(axes); i++) {
        if (strcmp(axes[i].name, name) == 0) {
            return axes[i].value;
        }
    }
    int code = app_key_code(name);
    if (code >= APP_AXIS_CODE) {
        return in->pad[code - APP_AXIS_CODE];
    }
    return app_input_down(in, name, known) ? 1.0f : 0.0f;
}
