// The checking half of the bindings, for the calling half (bind.c).
#ifndef SCRIPT_BIND_CHECK_H
#define SCRIPT_BIND_CHECK_H

#include "script/bind.h"

enum { BIND_PATH_BYTES = 256 };

// Where in the arguments the check is, for the message: "argument 1 (options), field body.radius".
typedef struct bind_path {
    lua_State *L;
    script *s;
    const char *owner; // "corsac.phys.setGravity"
    int argument;
    const char *argument_name;
    char field[BIND_PATH_BYTES];
} bind_path;

// Arguments from stack index `first` on, into out; raises errors.
void bind_check_args(bind_path *path, const bind_fn *fn, int first, unsigned char *out);
void bind_check_phase(script *s, lua_State *L, const bind_fn *fn, const char *owner);
// Class of the object at an index, NULL for anything else.
const bind_type *bind_type_at(script *s, lua_State *L, int index);
// "the string "abc"", "a Body", "nothing (nil)".
void bind_describe_value(script *s, lua_State *L, int index, char *out, size_t size);
const char *bind_article(const char *noun); // "a" or "an"

#endif
