// Input: window events are queued as they come and sampled once per step, so that a step sees one
// unchanging state, and a recording holds each step's events. Named actions are bound to keys.
#ifndef APP_INPUT_H
#define APP_INPUT_H

#include "gfx/gfx.h"

#define APP_MAX_EVENTS   256 // per step; more are dropped with a warning
#define APP_MAX_ACTIONS  64
#define APP_MAX_BINDINGS 8
#define APP_INPUT_CODES  546 // GLFW key codes, mouse buttons, gamepad buttons, gamepad axes
#define APP_MOUSE_CODE   512 // 8 buttons
#define APP_PAD_CODE     520 // 15 buttons
#define APP_AXIS_CODE    540 // 6 axes
#define APP_PAD_AXES     6

typedef struct app_binding {
    int16_t code;
    int8_t sign; // what the key adds to the action's axis: +1 or -1
} app_binding;

typedef struct app_action {
    char name[32];
    app_binding binding[APP_MAX_BINDINGS];
    uint32_t count;
} app_action;

typedef struct app_input {
    gfx_event queue[APP_MAX_EVENTS]; // since the last step
    uint32_t queued, dropped;
    bool down[APP_INPUT_CODES];
    // Went down in this step; and went up again in it: such a tap is held until the next one.
    bool fresh[APP_INPUT_CODES], tapped[APP_INPUT_CODES];
    float pad[APP_PAD_AXES]; // sticks -1..1, triggers 0..1, outside the dead zone
    float dead_zone;         // share of a stick's way that counts as rest, [0, 0.9]
    float mouse_x, mouse_y, move_x, move_y, scroll_x, scroll_y; // moves and scroll: of this step
    app_action action[APP_MAX_ACTIONS];
    uint32_t action_count;
} app_input;

// Name of a key or button ("space", "a", "left", "mouse1"), "" for unknown codes. `buffer` holds
// one-letter names.
const char *app_key_name(int code, char buffer[8]);
int app_key_code(const char *name);            // -1: unknown
void app_utf8(int32_t codepoint, char out[5]); // "" for what is no character

void app_input_init(app_input *in);
// keys: names separated by commas, "-" before one makes it pull the axis down: "-a,d,pad_leftx".
// Replaces what the action was bound to. False + core_fail_quiet (nearest key) for unknown keys.
bool app_input_bind(app_input *in, const char *action, const char *keys);
// The keys of an action as bind takes them; false when there is no such action.
bool app_input_binding(const app_input *in, const char *action, char *out, size_t size);
bool app_input_bound(const app_input *in, int code);

void app_input_queue(app_input *in, const gfx_event *event);
// Queues what a person would do, for bots: a key or button by name, an axis of a gamepad, text.
// False for unknown names and bytes that are no UTF-8.
bool app_input_send_key(app_input *in, const char *name, bool pressed);
bool app_input_send_axis(app_input *in, const char *name, float value);
bool app_input_send_text(app_input *in, const char *utf8);
// Starts a step with these events: state changes, moves and scroll are summed.
void app_input_step(app_input *in, const gfx_event *event, uint32_t count);

bool app_input_down(const app_input *in, const char *name, bool *known);
float app_input_axis(const app_input *in, const char *name, bool *known);

#endif
