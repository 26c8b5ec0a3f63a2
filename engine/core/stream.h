// Saved state, written and read by the same code: each call carries a field's name and place, and
// the stream decides which way the bytes go. Two forms: packed binary, and Lua text that a person
// can read (`return { ... }`; numbers exact, structures as hexadecimal).
//
// A read never goes beyond its bytes. The first field that does not fit ends the stream: that and
// all further calls return false, and one line names the file, the field and what was expected.
#ifndef CORE_STREAM_H
#define CORE_STREAM_H

#include "core/columns.h"

typedef enum core_stream_form { CORE_STREAM_BINARY, CORE_STREAM_TEXT } core_stream_form;

typedef struct core_stream {
    const char *what; // for errors: a file's name
    core_stream_form form;
    bool writing, failed;
    uint8_t *data; // writing: owned; reading: borrowed
    size_t size, capacity, at;
    int depth;
} core_stream;

core_stream core_stream_writer(const char *what, core_stream_form form);
core_stream core_stream_reader(const char *what, core_stream_form form, const void *data,
                               size_t size);
void core_stream_release(core_stream *s); // a writer's bytes
// Ends the stream: "WHAT: FIELD: EXPECTED". Returns false.
bool core_stream_fail(core_stream *s, const char *field, const char *expected, ...)
    __attribute__((format(printf, 3, 4)));

// A group of fields: `name = { ... }` in text, nothing in binary.
bool core_stream_open(core_stream *s, const char *name);
bool core_stream_close(core_stream *s);

// Kinds of CORE_COLUMN_KIND: 'f' floats, 'd' doubles, 'u' 32-bit words, 'b' bytes as numbers, 'x'
// bytes as hexadecimal. `bytes` of them, a multiple of the kind's size.
bool core_stream_list(core_stream *s, const char *name, char kind, void *items, size_t bytes);
bool core_stream_u32(core_stream *s, const char *name, uint32_t *value);
bool core_stream_u64(core_stream *s, const char *name, uint64_t *value);
// A count or number that must be at most `most`.
bool core_stream_count(core_stream *s, const char *name, uint32_t *value, uint32_t most);
// Zero-terminated text in text[capacity].
bool core_stream_string(core_stream *s, const char *name, char *text, size_t capacity);
// Writes the value; when reading, what was saved must equal it. `why` says what it means if not.
bool core_stream_same(core_stream *s, const char *name, uint64_t value, const char *why);
// A whole column set with its handles. Reading replaces it, or leaves it as it is and fails.
bool core_stream_columns(core_stream *s, core_columns *set);

#endif
