// Input: window events are queued as they come and sampled once per step, so that a step sees one
// unchanging state, and a recording holds each step's events. Named actions are bound to keys.
#ifndef APP_INPUT_H
#define APP_INPUT_H

#include "gfx/gfx.h"

#define APP_MAX_EVENTS   256 // per step; more are dropped with a warning
#define APP_MAX_ACTIONS  64
#define APP_MAX_BINDINGS 8
#define APP_INPUT_CODES  520 // GLFW key codes, then 8 mouse buttons from APP_MOUSE_CODE
#define APP_MOUSE_CODE   512

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
    float mouse_x, mouse_y, move_x, move_y, scroll_x, scroll_y; // moves and scroll: of this step
    app_action action[APP_MAX_ACTIONS];
    uint32_t action_count;
} app_input;

// Name of a key or button ("space", "a", "left", "mouse1"), "" for unknown codes. `buffer` holds
// one-letter names.
const char *app_key_name(int code, char buffer[8]);
int app_key_code(const char *name);            // -1: unknown
void app_utf8(int32_t codepoint, char out[5]); // "" for what is no character

// keys: names separated by commas, "-" before one makes it pull the axis down: "-a,d". False +
// core_fail (nearest key) for unknown keys.
bool app_input_bind(app_input *in, const char *action, const char *keys);
bool app_input_bound(const app_input *in, int code);

void app_input_queue(app_input *in, const gfx_event *event);
// Starts a step with these events: state changes, moves and scroll are summed.
void app_input_step(app_input *in, const gfx_event *event, uint32_t count);

bool app_input_down(const app_input *in, const char *name, bool *known);
float app_input_axis(const app_input *in, const char *name, bool *known);

#endif
