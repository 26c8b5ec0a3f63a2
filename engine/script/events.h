// Functions that scripts give to triggers and bodies, and the events of a step that call them.
#ifndef SCRIPT_EVENTS_H
#define SCRIPT_EVENTS_H

#include "script/internal.h"

typedef enum script_callbacks {
    SCRIPT_ON_TRIGGER,
    SCRIPT_ON_CONTACT,
    SCRIPT_ON_BREAK
} script_callbacks;

// Keeps functions for an object: stack indices, 0 for none. Trigger: enter, stay, exit; contact:
// begin, end, and 0; joint: break, 0, 0.
void script_keep_callbacks(script *s, lua_State *L, script_callbacks kind, core_handle h,
                           const int functions[3]);
// A trigger is about to be destroyed: its functions go after the exits of the bodies inside.
void script_forget_trigger(lua_State *L, core_handle trigger);

#endif
