// One log for the process. Lines go to stderr (stdout belongs to results) and to sinks.
#ifndef CORE_LOG_H
#define CORE_LOG_H

#include "core/base.h"

typedef enum core_log_level {
    CORE_LOG_DEBUG,
    CORE_LOG_INFO,
    CORE_LOG_WARN,
    CORE_LOG_ERROR
} core_log_level;

// Longest text of one call with its zero; longer ones end in "...".
#define CORE_LOG_TEXT_MAX 4096

// A text of several lines becomes several log lines; control characters become '?'.
void core_log(core_log_level level, const char *fmt, ...) CORE_PRINTF(2, 3);
// Lines below `level` are dropped for stderr (default CORE_LOG_INFO; --quiet sets CORE_LOG_WARN).
// Sinks get every line. Returns the former level.
core_log_level core_log_set_level(core_log_level level);

// `text` carries no newline and is valid during the call only. Sinks may be called from any thread,
// one at a time. A line that a sink itself logs goes to stderr alone.
typedef void core_log_sink(void *ctx, core_log_level level, const char *text);
// At most 8 sinks. Returns false when full, or from inside a sink.
bool core_log_add_sink(core_log_sink *sink, void *ctx);
void core_log_remove_sink(core_log_sink *sink, void *ctx);

#endif
