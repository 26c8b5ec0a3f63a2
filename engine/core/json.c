#include "core/json.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FIRST_CAPACITY 1024u
#define INDENT         2

void core_json_init(core_json *j, bool pretty) {
    *j = (core_json){.capacity = FIRST_CAPACITY, .first = true, .pretty = pretty};
    j->text = core_alloc(j->capacity);
}

void core_json_release(core_json *j) {
    core_free(j->text);
    *j = (core_json){0};
}

static void append(core_json *j, const char *text, size_t length) {
    if (j->length + length + 1 > j->capacity) {
        size_t capacity = CORE_MAX(j->capacity * 2, j->length + length + 1);
        j->text = core_realloc(j->text, j->capacity, capacity);
        j->capacity = capacity;
    }
    memcpy(j->text + j->length, text, length);
    j->length += length;
    j->text[j->length] = '\0';
}

static void append_text(core_json *j, const char *text) { append(j, text, strlen(text)); }

static void new_line(core_json *j) {
    if (j->pretty) {
        append(j, "\n", 1);
        for (int i = 0; i < j->depth * INDENT; ++i) {
            append(j, " ", 1);
        }
    }
}

size_t core_utf8_length(const char *text) {
    const uint8_t *s = (const uint8_t *)text;
    if (s[0] < 0x80) {
        return 1;
    }
    size_t length = s[0] >= 0xf0 ? 4 : s[0] >= 0xe0 ? 3 : 2;
    if (s[0] < 0xc2 || s[0] > 0xf4) {
        return 0;
    }
    uint8_t low = 0x80, high = 0xbf;
    low = s[0] == 0xe0 ? 0xa0 : s[0] == 0xf0 ? 0x90 : low;
    high = s[0] == 0xed ? 0x9f : s[0] == 0xf4 ? 0x8f : high;
    if (s[1] < low || s[1] > high) {
        return 0;
    }
    for (size_t i = 2; i < length; ++i) {
        if ((s[i] & 0xc0) != 0x80) {
            return 0;
        }
    }
    return length;
}

static void append_control(core_json *j, uint8_t c) {
    static const char names[] = "btn\0fr"; // \b \t \n (no letter for 11) \f \r
    char text[8];
    if (c >= 8 && c <= 13 && c != 11) {
        snprintf(text, sizeof text, "\\%c", names[c - 8]);
    } else {
        snprintf(text, sizeof text, "\\u%04x", c);
    }
    append_text(j, text);
}

static void append_quoted(core_json *j, const char *utf8) {
    append(j, "\"", 1);
    for (const uint8_t *s = (const uint8_t *)utf8; *s;) {
        size_t length = core_utf8_length((const char *)s);
        if (length == 0) {
            append_text(j, "\xef\xbf\xbd"); // U+FFFD
            length = 1;
        } else if (*s < 0x20) {
            append_control(j, *s);
        } else {
            if (*s == '"' || *s == '\\') {
                append(j, "\\", 1);
            }
            append(j, (const char *)s, length);
        }
        s += length;
    }
    append(j, "\"", 1);
}

// Comma, line and key before a value.
static void begin_value(core_json *j, const char *key) {
    if (j->depth > 0) {
        if (!j->first) {
            append(j, ",", 1);
        }
        new_line(j);
    }
    j->first = false;
    if (key) {
        append_quoted(j, key);
        append_text(j, j->pretty ? ": " : ":");
    }
}

static void open_scope(core_json *j, const char *key, const char *bracket) {
    begin_value(j, key);
    append(j, bracket, 1);
    j->depth++;
    j->first = true;
}

static void close_scope(core_json *j, const char *bracket) {
    CORE_ASSERT(j->depth > 0);
    bool empty = j->first;
    j->depth--;
    j->first = false;
    if (!empty) {
        new_line(j);
    }
    append(j, bracket, 1);
}

void core_json_object(core_json *j, const char *key) { open_scope(j, key, "{"); }
void core_json_end_object(core_json *j) { close_scope(j, "}"); }
void core_json_array(core_json *j, const char *key) { open_scope(j, key, "["); }
void core_json_end_array(core_json *j) { close_scope(j, "]"); }

size_t core_json_format(double value, char out[CORE_JSON_NUMBER_MAX]) {
    if (!isfinite(value)) {
        return (size_t)snprintf(out, CORE_JSON_NUMBER_MAX, "null");
    }
    // A normal double that has a text of at most 15 digits gets it at 15 (DBL_DIG); 17 always do.
    // Denormal numbers have fewer digits to lose.
    int digits = fabs(value) < DBL_MIN ? 1 : DBL_DIG;
    int length;
    do {
        length = snprintf(out, CORE_JSON_NUMBER_MAX, "%.*g", digits, value);
    } while (digits++ < DBL_DECIMAL_DIG && strtod(out, NULL) != value);
    for (char *c = out; *c; ++c) {
        *c = *c == ',' ? '.' : *c; // a locale's decimal comma
    }
    return (size_t)length;
}

void core_json_number(core_json *j, const char *key, double value) {
    char text[CORE_JSON_NUMBER_MAX];
    size_t length = core_json_format(value, text);
    begin_value(j, key);
    append(j, text, length);
}

void core_json_int(core_json *j, const char *key, int64_t value) {
    char text[CORE_JSON_NUMBER_MAX];
    snprintf(text, sizeof text, "%" PRId64, value);
    begin_value(j, key);
    append_text(j, text);
}

void core_json_bool(core_json *j, const char *key, bool value) {
    begin_value(j, key);
    append_text(j, value ? "true" : "false");
}

void core_json_null(core_json *j, const char *key) {
    begin_value(j, key);
    append_text(j, "null");
}

void core_json_string(core_json *j, const char *key, const char *utf8) {
    begin_value(j, key);
    append_quoted(j, utf8);
}
