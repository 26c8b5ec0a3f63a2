#include "core/stream.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PER_LINE 12 // numbers in a line of text

core_stream core_stream_writer(const char *what, core_stream_form form) {
    return (core_stream){.what = what, .form = form, .writing = true};
}

core_stream core_stream_reader(const char *what, core_stream_form form, const void *data,
                               size_t size) {
    return (core_stream){
        .what = what, .form = form, .data = (uint8_t *)(uintptr_t)data, .size = size};
}

void core_stream_release(core_stream *s) {
    if (s->writing) {
        core_free(s->data);
        s->data = NULL;
    }
}

bool core_stream_fail(core_stream *s, const char *field, const char *expected, ...) {
    if (!s->failed) {
        char text[256];
        va_list args;
        va_start(args, expected);
        vsnprintf(text, sizeof text, expected, args);
        va_end(args);
        core_fail("%s: %s: %s", s->what, field, text);
    }
    s->failed = true;
    return false;
}

// ---- bytes ----

static void append(core_stream *s, const void *bytes, size_t size) {
    if (s->size + size > s->capacity) {
        size_t grown = CORE_MAX((size_t)4096, 2 * (s->size + size));
        s->data = core_realloc(s->data, s->capacity, grown);
        s->capacity = grown;
    }
    if (size) {
        memcpy(s->data + s->size, bytes, size);
    }
    s->size += size;
}

static bool raw(core_stream *s, const char *name, void *bytes, size_t size) {
    if (s->failed) {
        return false;
    }
    if (s->writing) {
        append(s, bytes, size);
        return true;
    }
    if (size > s->size - s->at) {
        return core_stream_fail(s, name, "%zu bytes expected, %zu are left", size, s->size - s->at);
    }
    if (size) {
        memcpy(bytes, s->data + s->at, size);
    }
    s->at += size;
    return true;
}

// ---- text ----

static void print(core_stream *s, const char *format, ...) {
    char text[128];
    va_list args;
    va_start(args, format);
    int n = vsnprintf(text, sizeof text, format, args);
    va_end(args);
    append(s, text, (size_t)n);
}

static void indent(core_stream *s) {
    for (int i = 0; i < s->depth; i++) {
        append(s, "  ", 2);
    }
}

static int peek(core_stream *s) {
    for (;;) {
        while (s->at < s->size && strchr(" \t\r\n", s->data[s->at])) {
            s->at++;
        }
        if (s->size - s->at < 2 || memcmp(s->data + s->at, "--", 2) != 0) {
            break;
        }
        while (s->at < s->size && s->data[s->at] != '\n') {
            s->at++;
        }
    }
    return s->at < s->size ? s->data[s->at] : -1;
}

static bool token(core_stream *s, const char *name, const char *text) {
    size_t n = strlen(text);
    peek(s);
    if (s->failed || s->size - s->at < n || memcmp(s->data + s->at, text, n) != 0) {
        return core_stream_fail(s, name, "\"%s\" expected", text);
    }
    s->at += n;
    return true;
}

// `name =`: a name with characters beyond Lua's stands in brackets.
static bool key(core_stream *s, const char *name) {
    bool plain = strspn(name, "abcdefghijklmnopqrstuvwxyz_0123456789") == strlen(name);
    char text[160];
    snprintf(text, sizeof text, plain ? "%s" : "[\"%s\"]", name);
    if (s->writing) {
        indent(s);
        print(s, "%s = ", text);
        return true;
    }
    return token(s, name, text) && token(s, name, "=");
}

// The next word: digits, letters, signs and points, copied so that it ends.
static bool word(core_stream *s, const char *name, char out[48]) {
    size_t n = 0;
    peek(s);
    while (s->at < s->size && n < 47 && strchr("+-.0123456789abcdefxinABCDEF", s->data[s->at]) &&
           s->data[s->at]) {
        out[n++] = (char)s->data[s->at++];
    }
    out[n] = 0;
    return n > 0 || core_stream_fail(s, name, "a number expected");
}

static size_t kind_size(char kind) { return kind == 'd' ? 8 : kind == 'b' || kind == 'x' ? 1 : 4; }

// A float that is no number or infinite has no literal in Lua: its bits stand in quotes.
static void write_number(core_stream *s, char kind, const uint8_t *at) {
    float f;
    double d;
    uint32_t u;
    memcpy(&u, at, kind_size(kind) < 4 ? 1 : 4);
    memcpy(&f, at, kind == 'f' ? 4 : 0);
    memcpy(&d, at, kind == 'd' ? 8 : 0);
    if (kind == 'b') {
        print(s, "%u", at[0]);
    } else if (kind == 'u') {
        print(s, "%u", u);
    } else if (kind == 'f') {
        isfinite(f) ? print(s, "%.9g", (double)f) : print(s, "\"%08x\"", u);
    } else {
        uint64_t bits;
        memcpy(&bits, at, 8);
        isfinite(d) ? print(s, "%.17g", d) : print(s, "\"%016llx\"", (unsigned long long)bits);
    }
}

static bool read_number(core_stream *s, const char *name, char kind, uint8_t *out) {
    char text[48], *end = text;
    bool quoted = peek(s) == '"';
    if ((quoted && !token(s, name, "\"")) || !word(s, name, text) ||
        (quoted && !token(s, name, "\""))) {
        return false;
    }
    if (quoted || kind == 'u' || kind == 'b') {
        unsigned long long bits = strtoull(text, &end, quoted ? 16 : 10);
        bool fits = kind == 'd' || bits <= (kind == 'b' ? UINT8_MAX : UINT32_MAX);
        memcpy(out, &bits, kind_size(kind));
        return (*end == 0 && fits && text[0] != '-') ||
               core_stream_fail(s, name, "\"%s\" is no number of its kind", text);
    }
    if (kind == 'f') {
        float f = strtof(text, &end);
        memcpy(out, &f, sizeof f);
    } else {
        double d = strtod(text, &end);
        memcpy(out, &d, sizeof d);
    }
    return (*end == 0) || core_stream_fail(s, name, "\"%s\" is no number", text);
}

static bool text_hex(core_stream *s, const char *name, uint8_t *items, size_t bytes) {
    if (s->writing) {
        append(s, "\"", 1);
        for (size_t i = 0; i < bytes; i++) {
            print(s, "%02x", items[i]);
        }
        append(s, "\"", 1);
        return true;
    }
    if (!token(s, name, "\"") || (s->size - s->at) / 2 < bytes) {
        return core_stream_fail(s, name, "%zu bytes in hexadecimal expected", bytes);
    }
    for (size_t i = 0; i < bytes; i++) {
        char pair[3] = {(char)s->data[s->at], (char)s->data[s->at + 1], 0}, *end;
        items[i] = (uint8_t)strtoul(pair, &end, 16);
        if (end != pair + 2 || pair[0] == '+' || pair[0] == '-' || pair[0] == ' ') {
            return core_stream_fail(s, name, "%zu bytes in hexadecimal expected", bytes);
        }
        s->at += 2;
    }
    return token(s, name, "\"");
}

static bool text_list(core_stream *s, const char *name, char kind, uint8_t *items, size_t bytes) {
    if (kind == 'x') {
        return text_hex(s, name, items, bytes);
    }
    size_t size = kind_size(kind), count = bytes / size;
    bool good = s->writing || token(s, name, "{");
    if (s->writing) {
        append(s, "{", 1);
    }
    for (size_t i = 0; good && i < count; i++) {
        if (s->writing) {
            if (i % PER_LINE == 0 && count > PER_LINE) {
                append(s, "\n", 1);
                indent(s);
                append(s, " ", 1);
            }
            append(s, " ", 1);
            write_number(s, kind, items + i * size);
            append(s, ",", i + 1 < count ? 1 : 0);
        } else {
            good = read_number(s, name, kind, items + i * size) &&
                   (i + 1 == count || token(s, name, ","));
        }
    }
    if (s->writing) {
        append(s, " }", 2);
    }
    return good && (s->writing || token(s, name, "}"));
}

static bool end_field(core_stream *s, const char *name) {
    if (s->writing) {
        append(s, ",\n", 2);
        return true;
    }
    return token(s, name, ",");
}

// ---- fields ----

bool core_stream_open(core_stream *s, const char *name) {
    if (s->failed || s->form == CORE_STREAM_BINARY) {
        return !s->failed;
    }
    bool good = s->depth || s->writing || token(s, name, "return");
    if (s->depth) {
        good = key(s, name);
    } else if (s->writing) {
        print(s, "-- %s\nreturn ", name);
    }
    if (s->writing) {
        append(s, "{\n", 2);
    }
    s->depth++;
    return good && (s->writing || token(s, name, "{"));
}

bool core_stream_close(core_stream *s) {
    if (s->failed || s->form == CORE_STREAM_BINARY) {
        return !s->failed;
    }
    s->depth--;
    if (s->writing) {
        indent(s);
        append(s, s->depth ? "},\n" : "}\n", s->depth ? 3 : 2);
        return true;
    }
    return token(s, "end", s->depth ? "}," : "}");
}

bool core_stream_list(core_stream *s, const char *name, char kind, void *items, size_t bytes) {
    if (s->failed || s->form == CORE_STREAM_BINARY) {
        return !s->failed && raw(s, name, items, bytes);
    }
    return key(s, name) && text_list(s, name, kind, items, bytes) && end_field(s, name);
}

bool core_stream_u32(core_stream *s, const char *name, uint32_t *value) {
    if (s->failed || s->form == CORE_STREAM_BINARY) {
        return !s->failed && raw(s, name, value, sizeof *value);
    }
    uint8_t bytes[4];
    memcpy(bytes, value, sizeof bytes);
    if (!key(s, name)) {
        return false;
    }
    if (s->writing) {
        write_number(s, 'u', bytes);
    } else if (!read_number(s, name, 'u', bytes)) {
        return false;
    }
    memcpy(value, bytes, sizeof bytes);
    return end_field(s, name);
}

bool core_stream_u64(core_stream *s, const char *name, uint64_t *value) {
    return core_stream_list(s, name, 'x', value, sizeof *value);
}

bool core_stream_count(core_stream *s, const char *name, uint32_t *value, uint32_t most) {
    return core_stream_u32(s, name, value) &&
           (*value <= most || core_stream_fail(s, name, "%u, expected at most %u", *value, most));
}

// Printable ASCII without quotes and backslashes stands as it is, other bytes as \ddd.
static bool text_string(core_stream *s, const char *name, char *text, size_t capacity) {
    if (s->writing) {
        append(s, "\"", 1);
        for (const unsigned char *c = (unsigned char *)text; *c; c++) {
            bool plain = *c >= 32 && *c < 127 && *c != '"' && *c != '\\';
            print(s, plain ? "%c" : "\\%03d", *c);
        }
        append(s, "\"", 1);
        return true;
    }
    size_t n = 0;
    if (!token(s, name, "\"")) {
        return false;
    }
    while (s->at < s->size && s->data[s->at] != '"' && n + 1 < capacity) {
        int c = s->data[s->at++];
        if (c == '\\') {
            unsigned code = 0;
            int digits = 0;
            for (; digits < 3 && s->at < s->size; digits++, s->at++) {
                code = code * 10 + (unsigned)(s->data[s->at] - '0');
            }
            if (digits < 3 || code == 0 || code > 255) {
                return core_stream_fail(s, name, "\\ and three digits expected");
            }
            c = (int)code;
        }
        text[n++] = (char)c;
    }
    text[n] = 0;
    return token(s, name, "\"");
}

bool core_stream_string(core_stream *s, const char *name, char *text, size_t capacity) {
    if (!s->failed && s->form == CORE_STREAM_TEXT) {
        return key(s, name) && text_string(s, name, text, capacity) && end_field(s, name);
    }
    uint32_t length = s->writing ? (uint32_t)strlen(text) : 0;
    if (!core_stream_count(s, name, &length, (uint32_t)capacity - 1) ||
        !raw(s, name, text, length)) {
        return false;
    }
    if (!s->writing) {
        text[length] = 0;
    }
    return true;
}

bool core_stream_same(core_stream *s, const char *name, uint64_t value, const char *why) {
    uint64_t saved = value;
    return core_stream_u64(s, name, &saved) &&
           (saved == value || core_stream_fail(s, name, "%s", why));
}

// ---- columns ----

static bool write_columns(core_stream *s, const core_columns *set) {
    size_t size = core_columns_save_size(set);
    uint8_t *block = core_alloc(size);
    core_columns_save(set, block);
    bool good;
    if (s->form == CORE_STREAM_BINARY) {
        uint64_t bytes = size;
        good = core_stream_u64(s, set->name, &bytes) && raw(s, set->name, block, size);
    } else {
        core_columns_part part;
        const uint8_t *at = core_columns_saved(set, block, &part);
        uint32_t words = (uint32_t)(part.handles_size / 4);
        good = core_stream_u32(s, "row_count", &part.count) &&
               core_stream_u32(s, "handle_words", &words) &&
               core_stream_list(s, "handles", 'u', block + (size - part.handles_size),
                                part.handles_size);
        for (uint32_t c = 0; good && c < set->column_count; c++) {
            if (set->column[c].flags & CORE_COLUMN_STATE) {
                size_t bytes = (size_t)part.count * set->column[c].size;
                char kind = set->column[c].kind ? set->column[c].kind : 'x';
                good = core_stream_list(s, set->column[c].name, kind, (void *)(uintptr_t)at, bytes);
                at += bytes;
            }
        }
    }
    core_free(block);
    return good;
}

static bool read_text_columns(core_stream *s, core_columns *set) {
    uint32_t count = 0, words = 0;
    uint32_t room = (uint32_t)CORE_MIN(s->size - s->at, (size_t)set->pool.capacity * 4 + 64);
    if (!core_stream_count(s, "row_count", &count, CORE_MIN(set->pool.capacity, room)) ||
        !core_stream_count(s, "handle_words", &words, room)) {
        return false;
    }
    size_t bytes = 0;
    for (uint32_t c = 0; c < set->column_count; c++) {
        bytes += set->column[c].flags & CORE_COLUMN_STATE ? (size_t)count * set->column[c].size : 0;
    }
    if (bytes > 64 * (s->size - s->at)) { // no number is shorter than a digit and a comma
        return core_stream_fail(s, set->name, "%u rows in %zu bytes", count, s->size - s->at);
    }
    uint8_t *values = core_alloc(bytes + 1), *handles = core_alloc((size_t)words * 4 + 1);
    uint8_t *at = values;
    bool good = core_stream_list(s, "handles", 'u', handles, (size_t)words * 4);
    for (uint32_t c = 0; good && c < set->column_count; c++) {
        if (set->column[c].flags & CORE_COLUMN_STATE) {
            size_t size = (size_t)count * set->column[c].size;
            char kind = set->column[c].kind ? set->column[c].kind : 'x';
            good = core_stream_list(s, set->column[c].name, kind, at, size);
            at += size;
        }
    }
    if (good && !core_columns_restore_parts(set, count, values, handles, (size_t)words * 4)) {
        s->failed = true;
        good = false;
    }
    core_free(values);
    core_free(handles);
    return good;
}

bool core_stream_columns(core_stream *s, core_columns *set) {
    if (!core_stream_open(s, set->name)) {
        return false;
    }
    if (s->writing) {
        return write_columns(s, set) && core_stream_close(s);
    }
    if (s->form == CORE_STREAM_TEXT) {
        return read_text_columns(s, set) && core_stream_close(s);
    }
    uint64_t bytes = 0;
    if (!core_stream_u64(s, set->name, &bytes)) {
        return false;
    }
    if (bytes > s->size - s->at) {
        return core_stream_fail(s, set->name, "%llu bytes expected, %zu are left",
                                (unsigned long long)bytes, s->size - s->at);
    }
    if (!core_columns_restore(set, s->data + s->at, (size_t)bytes)) {
        s->failed = true;
        return false;
    }
    s->at += (size_t)bytes;
    return core_stream_close(s);
}
