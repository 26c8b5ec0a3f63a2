// Draws what stands in the world for one frame without being a mesh: lines.
#include "gfx/gfx_device_internal.h"

#include <string.h>

void gfx_marks_release(gfx_marks *m) {
    gfx_stream_release(&m->lines);
    *m = (gfx_marks){0};
}

bool gfx_marks_wanted(const gfx_world *world) { return world->lines.count > 0; }

bool gfx_marks_draw(gfx_device *d, gfx_world *world) {
    size_t count = world->lines.count, bytes = count * sizeof(struct gfx_line_block);
    GLuint program = gfx_shaders_get(&d->shaders, "line.vert", "line.frag", 0);
    if (!program) {
        return false;
    }
    memcpy(gfx_stream_begin(&d->marks.lines, bytes, d->frame), world->lines.data, bytes);
    gfx_stream_bind(&d->marks.lines, GL_SHADER_STORAGE_BUFFER, GFX_SSBO_QUADS, bytes, d->frame);
    glUseProgram(program);
    glBindVertexArray(d->empty_vao);
    glDisable(GL_CULL_FACE);
    glDrawArrays(GL_TRIANGLES, 0, (GLsizei)count * 6);
    glEnable(GL_CULL_FACE);
    world->stats.draws++;
    return true;
}
