// Which passes the frames had, and what the GPU took for each by timestamps between them.
#include "gfx/gfx_device_internal.h"

#include <string.h>

static gfx_pass_use *find(gfx_device *d, const char *name) {
    for (uint32_t i = 0; i < d->pass_count; ++i) {
        if (strcmp(d->pass[i].name, name) == 0) {
            return &d->pass[i];
        }
    }
    if (d->pass_count == GFX_PASSES) {
        return NULL;
    }
    d->pass[d->pass_count] = (gfx_pass_use){.name = name};
    return &d->pass[d->pass_count++];
}

// Timer queries of software renderers are wrong by factors: none there.
static void stamp(gfx_device *d, gfx_pass_turn *turn) {
    if (!d->software) {
        GLuint *query = &turn->query[turn->count];
        if (!*query) {
            glCreateQueries(GL_TIMESTAMP, 1, query);
        }
        glQueryCounter(*query, GL_TIMESTAMP);
    }
}

void gfx_pass_begin(gfx_device *d, const char *name) {
    gfx_pass_turn *turn = &d->pass_turn[d->frame];
    gfx_pass_use *use = find(d, name);
    if (!use || turn->count == GFX_PASSES) {
        return;
    }
    use->runs++;
    stamp(d, turn);
    turn->name[turn->count++] = name;
}

void gfx_passes_end_turn(gfx_device *d) { stamp(d, &d->pass_turn[d->frame]); }

// The GPU is done with this turn's former use: its times are there.
void gfx_passes_begin_turn(gfx_device *d) {
    gfx_pass_turn *turn = &d->pass_turn[d->frame];
    GLuint64 from = 0, to = 0;
    for (uint32_t i = 0; i <= turn->count && turn->count && !d->software; ++i, from = to) {
        glGetQueryObjectui64v(turn->query[i], GL_QUERY_RESULT, &to);
        if (i > 0) {
            gfx_pass_use *use = find(d, turn->name[i - 1]);
            double ms = (double)(to - from) * 1e-6; // with what the processor kept the GPU waiting
            use->gpu_ms = use->gpu_ms > 0.0 ? CORE_MIN(use->gpu_ms, ms) : ms;
        }
    }
    turn->count = 0;
}

const gfx_pass_use *gfx_device_passes(const gfx_device *d, uint32_t *count) {
    *count = d->pass_count;
    return d->pass;
}

void gfx_passes_release(gfx_device *d) {
    for (int i = 0; i < GFX_FRAMES; ++i) {
        glDeleteQueries(GFX_PASSES + 1, d->pass_turn[i].query);
    }
}
