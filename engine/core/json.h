// Writes JSON to a growing buffer; commas and indentation are its business. Reading is cJSON's.
#ifndef CORE_JSON_H
#define CORE_JSON_H

#include "core/base.h"

typedef struct core_json {
    char *text; // zero-terminated; core_json_release frees it
    size_t length, capacity;
    int depth;
    bool first, pretty;
} core_json;

void core_json_init(core_json *j, bool pretty);
void core_json_release(core_json *j);
// key NULL inside arrays and at the top. Keys and strings are escaped; bytes that are no UTF-8
// become U+FFFD.
void core_json_object(core_json *j, const char *key);
void core_json_end_object(core_json *j);
void core_json_array(core_json *j, const char *key);
void core_json_end_array(core_json *j);
// Shortest text that reads back to the same double; NaN and infinities become null.
void core_json_number(core_json *j, const char *key, double value);
void core_json_int(core_json *j, const char *key, int64_t value);
void core_json_bool(core_json *j, const char *key, bool value);
void core_json_null(core_json *j, const char *key);
void core_json_string(core_json *j, const char *key, const char *utf8);

// Bytes of the UTF-8 sequence at s, 0 when it is none (RFC 3629: shortest form, no surrogates, at
// most U+10FFFF). Reads no further than a terminating zero.
size_t core_utf8_length(const char *s);

// The number's text alone (tables, CSV). Returns its length.
#define CORE_JSON_NUMBER_MAX 32
size_t core_json_format(double value, char out[CORE_JSON_NUMBER_MAX]);

#endif
