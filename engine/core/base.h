// The ground every file stands on: fixed-width types, attributes, the assert hook, and the one
// way in which a function that can fail says why.
#ifndef CORE_BASE_H
#define CORE_BASE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// Padding unit of every column: the widest kernel (AVX-512) handles 16 floats at once.
#define CORE_LANES 16
#define CORE_ALIGN 64

#define CORE_COUNT_OF(array) (sizeof(array) / sizeof((array)[0]))
// min/max with a stated order: b wins when either is NaN or both are zeros (as MINPS/MAXPS do).
#define CORE_MIN(a, b)        ((a) < (b) ? (a) : (b))
#define CORE_MAX(a, b)        ((a) > (b) ? (a) : (b))
#define CORE_CLAMP(x, lo, hi) CORE_MIN(CORE_MAX(x, lo), hi)

#if defined(__GNUC__)
#define CORE_PRINTF(fmt, args) __attribute__((format(printf, fmt, args)))
#define CORE_NORETURN          __attribute__((noreturn))
#else
#define CORE_PRINTF(fmt, args)
#define CORE_NORETURN
#endif

// Called when CORE_ASSERT fails. Returning continues after the assert (tests do that by longjmp or
// by counting). The default prints to stderr and aborts.
typedef void core_assert_fn(const char *expr, const char *file, int line);
// Installs a hook for the whole process; NULL restores the default. Returns the former hook.
core_assert_fn *core_set_assert_hook(core_assert_fn *hook);
void core_assert_failed(const char *expr, const char *file, int line);

// Programming errors only: never for input from scripts, files or users. Active in MODE=debug,
// asan and tsan; compiled out in release.
#if defined(CORE_DEBUG)
#define CORE_ASSERT(cond) ((cond) ? (void)0 : core_assert_failed(#cond, __FILE__, __LINE__))
#else
#define CORE_ASSERT(cond) ((void)sizeof(!(cond)))
#endif

// Records one readable line (what, which file or object, what was expected, what to do) as this
// thread's last error, logs it at level error, and returns false, so that a failing function can
// end in `return core_fail("...")`.
bool core_fail(const char *fmt, ...) CORE_PRINTF(1, 2);
// As core_fail, without logging: for errors that a caller will report itself (script bindings).
bool core_fail_quiet(const char *fmt, ...) CORE_PRINTF(1, 2);
// The calling thread's last error, "" when there was none since core_clear_error. Valid until the
// next failure on this thread.
const char *core_last_error(void);
void core_clear_error(void);

// Heap access of the engine: every engine allocation goes through these so that
// `steady_allocations` is an honest count. Zeroed memory, 16-byte aligned (core_realloc: the part
// beyond old_bytes is zero). Out of memory ends the program with one line and exit code 5 (nothing
// sensible can follow): check sizes that come from files before asking. core_free(NULL) is fine.
void *core_alloc(size_t bytes);
void *core_realloc(void *block, size_t old_bytes, size_t new_bytes);
void core_free(void *block);
// Number of core_alloc/core_realloc calls in this process so far (atomic, monotonic).
uint64_t core_alloc_count(void);

#endif
