#include "core/base.h"

#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/log.h"

#define ERROR_TEXT_MAX 2048

static void assert_default(const char *expr, const char *file, int line) {
    fprintf(stderr, "%s:%d: assertion failed: %s\n", file, line, expr);
    abort();
}

static _Atomic(core_assert_fn *) assert_hook = assert_default;
static _Atomic uint64_t alloc_count;
static _Thread_local char last_error[ERROR_TEXT_MAX];

core_assert_fn *core_set_assert_hook(core_assert_fn *hook) {
    core_assert_fn *former = atomic_exchange(&assert_hook, hook ? hook : assert_default);
    return former == assert_default ? NULL : former;
}

void core_assert_failed(const char *expr, const char *file, int line) {
    core_assert_fn *hook = atomic_load(&assert_hook);
    hook(expr, file, line);
}

// Formats aside first: an argument may be core_last_error() itself.
CORE_PRINTF(1, 0) static void record_error(const char *fmt, va_list args) {
    char text[ERROR_TEXT_MAX];
    vsnprintf(text, sizeof text, fmt, args);
    memcpy(last_error, text, strlen(text) + 1);
}

bool core_fail(const char *fmt, ...) {
    va_list args;
    va_start(args, fmt);
    record_error(fmt, args);
    va_end(args);
    core_log(CORE_LOG_ERROR, "%s", last_error);
    return false;
}

bool core_fail_quiet(const char *fmt, ...) {
    va_list args;
    va_start(args, fmt);
    record_error(fmt, args);
    va_end(args);
    return false;
}

const char *core_last_error(void) { return last_error; }
void core_clear_error(void) { last_error[0] = '\0'; }

// _Exit: nothing that runs at exit can be trusted without memory. 5: the environment lacks
// something.
CORE_NORETURN static void out_of_memory(size_t bytes) {
    fprintf(stderr, "corsac: out of memory: cannot get %zu bytes\n", bytes);
    _Exit(5);
}

void *core_alloc(size_t bytes) {
    atomic_fetch_add_explicit(&alloc_count, 1, memory_order_relaxed);
    void *block = calloc(1, bytes ? bytes : 1);
    if (!block) {
        out_of_memory(bytes);
    }
    return block;
}

void *core_realloc(void *block, size_t old_bytes, size_t new_bytes) {
    atomic_fetch_add_explicit(&alloc_count, 1, memory_order_relaxed);
    char *grown = realloc(block, new_bytes ? new_bytes : 1);
    if (!grown) {
        out_of_memory(new_bytes);
    }
    if (new_bytes > old_bytes) {
        memset(grown + old_bytes, 0, new_bytes - old_bytes);
    }
    return grown;
}

void core_free(void *block) { free(block); }

uint64_t core_alloc_count(void) { return atomic_load_explicit(&alloc_count, memory_order_relaxed); }
