#include "core/log.h"

#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define LOG_SINKS_MAX 8

static struct {
    pthread_mutex_t lock;
    core_log_level level;
    int sink_count;
    struct {
        core_log_sink *sink;
        void *ctx;
    } sinks[LOG_SINKS_MAX];
} logger = {.lock = PTHREAD_MUTEX_INITIALIZER, .level = CORE_LOG_INFO};

// Set while this thread holds the lock and runs sinks, so that a sink may log (to stderr only).
static _Thread_local bool inside_sink;

static void write_stderr(core_log_level level, const char *line) {
    static const char *const prefix[] = {"debug: ", "", "warning: ", "error: "};
    if (level >= logger.level) {
        fprintf(stderr, "%s%s\n", prefix[level], line);
    }
}

static void emit_line(core_log_level level, const char *line) {
    write_stderr(level, line);
    if (inside_sink) {
        return;
    }
    inside_sink = true;
    for (int i = 0; i < logger.sink_count; ++i) {
        logger.sinks[i].sink(logger.sinks[i].ctx, level, line);
    }
    inside_sink = false;
}

// Splits at newlines and makes control characters harmless: names of files and texts of scripts
// end up here and must not steer a terminal.
static void emit_text(core_log_level level, char *text) {
    for (char *line = text;;) {
        char *end = line;
        for (; *end && *end != '\n'; ++end) {
            unsigned char c = (unsigned char)*end;
            *end = c == '\t' ? ' ' : c < 32 || c == 127 ? '?' : *end;
        }
        bool last = !*end;
        *end = '\0';
        emit_line(level, line);
        if (last || !end[1]) {
            return;
        }
        line = end + 1;
    }
}

void core_log(core_log_level level, const char *fmt, ...) {
    char text[CORE_LOG_TEXT_MAX];
    va_list args;
    va_start(args, fmt);
    int length = vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    if (length >= (int)sizeof text) {
        memcpy(text + sizeof text - 4, "...", 4);
    }
    if (inside_sink) {
        emit_text(level, text);
        return;
    }
    pthread_mutex_lock(&logger.lock);
    emit_text(level, text);
    pthread_mutex_unlock(&logger.lock);
}

core_log_level core_log_set_level(core_log_level level) {
    pthread_mutex_lock(&logger.lock);
    core_log_level former = logger.level;
    logger.level = level;
    pthread_mutex_unlock(&logger.lock);
    return former;
}

bool core_log_add_sink(core_log_sink *sink, void *ctx) {
    if (inside_sink) {
        return false;
    }
    pthread_mutex_lock(&logger.lock);
    bool room = logger.sink_count < LOG_SINKS_MAX;
    if (room) {
        logger.sinks[logger.sink_count].sink = sink;
        logger.sinks[logger.sink_count++].ctx = ctx;
    }
    pthread_mutex_unlock(&logger.lock);
    return room;
}

void core_log_remove_sink(core_log_sink *sink, void *ctx) {
    if (inside_sink) {
        return;
    }
    pthread_mutex_lock(&logger.lock);
    for (int i = 0; i < logger.sink_count; ++i) {
        if (logger.sinks[i].sink == sink && logger.sinks[i].ctx == ctx) {
            memmove(&logger.sinks[i], &logger.sinks[i + 1],
                    (size_t)(logger.sink_count - i - 1) * sizeof logger.sinks[0]);
            logger.sink_count--;
            break;
        }
    }
    pthread_mutex_unlock(&logger.lock);
}
