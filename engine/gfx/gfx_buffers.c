// GL buffers: per-frame streams, and the common vertex and index buffers of a world's meshes.
#include "gfx/gfx_device_internal.h"

#include <string.h>

// Covers every alignment that storage and uniform blocks may ask for.
enum { STREAM_ALIGN = 256 };

void *gfx_stream_begin(gfx_stream *s, size_t bytes, uint32_t frame) {
    bytes = CORE_MAX(bytes, (size_t)STREAM_ALIGN);
    if (bytes > s->segment) {
        gfx_stream_release(s);
        s->segment = (bytes + bytes / 2 + STREAM_ALIGN - 1) / STREAM_ALIGN * STREAM_ALIGN;
        size_t size = s->segment * GFX_FRAMES;
        const GLbitfield flags = GL_MAP_WRITE_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
        glCreateBuffers(1, &s->name);
        glNamedBufferStorage(s->name, (GLsizeiptr)size, NULL, flags);
        s->map = glMapNamedBufferRange(s->name, 0, (GLsizeiptr)size, flags);
    }
    return s->map + s->segment * frame;
}

void gfx_stream_bind(const gfx_stream *s, GLenum target, GLuint binding, size_t bytes,
                     uint32_t frame) {
    bytes = CORE_MAX(bytes, (size_t)16);
    glBindBufferRange(target, binding, s->name, (GLintptr)(s->segment * frame), (GLsizeiptr)bytes);
}

void gfx_stream_bind_texels(gfx_stream *s, GLuint unit, GLenum format, size_t bytes,
                            uint32_t frame) {
    bytes = CORE_MAX(bytes, (size_t)16);
    if (!s->texels[frame]) {
        glCreateTextures(GL_TEXTURE_BUFFER, 1, &s->texels[frame]);
    }
    glTextureBufferRange(s->texels[frame], format, s->name, (GLintptr)(s->segment * frame),
                         (GLsizeiptr)bytes);
    glBindTextureUnit(unit, s->texels[frame]);
}

// The storage lives on until the commands that read it are done.
void gfx_stream_release(gfx_stream *s) {
    glDeleteBuffers(1, &s->name);
    glDeleteTextures(GFX_FRAMES, s->texels);
    *s = (gfx_stream){0};
}

// ---- geometry ----

static GLuint storage(size_t bytes) {
    GLuint b;
    glCreateBuffers(1, &b);
    glNamedBufferStorage(b, (GLsizeiptr)CORE_MAX(bytes, (size_t)16), NULL, GL_DYNAMIC_STORAGE_BIT);
    return b;
}

static void attribute(GLuint vao, GLuint binding, GLuint index, GLint size, GLenum type,
                      size_t offset) {
    glEnableVertexArrayAttrib(vao, index);
    glVertexArrayAttribBinding(vao, index, binding);
    if (index == GFX_ATTR_JOINT) {
        glVertexArrayAttribIFormat(vao, index, size, type, (GLuint)offset);
    } else {
        GLboolean normalized = type != GL_FLOAT;
        glVertexArrayAttribFormat(vao, index, size, type, normalized, (GLuint)offset);
    }
}

static GLuint vertex_array(const gfx_geometry *g, bool skinned) {
    GLuint vao;
    glCreateVertexArrays(1, &vao);
    glVertexArrayVertexBuffer(vao, 0, g->position, 0, 3 * sizeof(float));
    glVertexArrayVertexBuffer(vao, 1, g->shade, 0, sizeof(gfx_vertex_shade));
    attribute(vao, 0, GFX_ATTR_POSITION, 3, GL_FLOAT, 0);
    attribute(vao, 1, GFX_ATTR_NORMAL, 3, GL_SHORT, offsetof(gfx_vertex_shade, normal));
    attribute(vao, 1, GFX_ATTR_TANGENT, 4, GL_SHORT, offsetof(gfx_vertex_shade, tangent));
    attribute(vao, 1, GFX_ATTR_UV, 2, GL_FLOAT, offsetof(gfx_vertex_shade, uv));
    attribute(vao, 1, GFX_ATTR_COLOR, 4, GL_UNSIGNED_BYTE, offsetof(gfx_vertex_shade, color));
    if (skinned) {
        glVertexArrayVertexBuffer(vao, 2, g->skin, 0, sizeof(gfx_vertex_skin));
        attribute(vao, 2, GFX_ATTR_JOINT, 4, GL_UNSIGNED_SHORT, offsetof(gfx_vertex_skin, joint));
        attribute(vao, 2, GFX_ATTR_WEIGHT, 4, GL_FLOAT, offsetof(gfx_vertex_skin, weight));
    }
    glVertexArrayElementBuffer(vao, g->index);
    return vao;
}

void gfx_geometry_release(gfx_geometry *g) {
    const GLuint buffers[4] = {g->position, g->shade, g->skin, g->index};
    glDeleteBuffers(4, buffers);
    glDeleteVertexArrays(2, g->vao);
    core_free(g->place);
    *g = (gfx_geometry){0};
}

static void write(GLuint buffer, size_t at, size_t element, const void *data, size_t count) {
    glNamedBufferSubData(buffer, (GLintptr)(at * element), (GLsizeiptr)(count * element), data);
}

// Skinned meshes come first, so that the skin buffer ends with the last of them.
static void upload(gfx_geometry *g, const gfx_world *world, bool skinned, uint32_t *vertex,
                   uint32_t *index) {
    uint32_t n = core_columns_count(&world->meshes.set);
    for (uint32_t i = 0; i < n; ++i) {
        const gfx_mesh_store *m = &world->meshes.store[i];
        if ((m->skin != NULL) != skinned) {
            continue;
        }
        core_handle h = core_columns_handle(&world->meshes.set, i);
        g->place[h.index] = (gfx_mesh_place){.generation = h.generation,
                                             .number = h.index,
                                             .first_index = *index,
                                             .index_count = m->index_count,
                                             .base_vertex = *vertex,
                                             .skinned = skinned};
        write(g->position, *vertex, 3 * sizeof(float), m->position, m->vertex_count);
        write(g->shade, *vertex, sizeof *m->shade, m->shade, m->vertex_count);
        if (skinned) {
            write(g->skin, *vertex, sizeof *m->skin, m->skin, m->vertex_count);
        }
        write(g->index, *index, sizeof *m->index, m->index, m->index_count);
        *vertex += m->vertex_count;
        *index += m->index_count;
    }
}

bool gfx_geometry_update(gfx_geometry *g, const gfx_world *world) {
    if (g->world == world->id && g->version == world->mesh_version) {
        return true;
    }
    gfx_geometry_release(g);
    uint32_t n = core_columns_count(&world->meshes.set);
    size_t vertices = 0, skinned = 0, indices = 0;
    uint32_t places = 1;
    for (uint32_t i = 0; i < n; ++i) {
        const gfx_mesh_store *m = &world->meshes.store[i];
        vertices += m->vertex_count;
        skinned += m->skin ? m->vertex_count : 0;
        indices += m->index_count;
        places = CORE_MAX(places, core_columns_handle(&world->meshes.set, i).index + 1);
    }
    if (vertices > INT32_MAX || indices > UINT32_MAX) {
        return core_fail("gfx: the meshes have %zu vertices and %zu indices, more than a buffer "
                         "can address",
                         vertices, indices);
    }
    g->place = core_alloc(places * sizeof *g->place);
    g->places = places;
    g->position = storage(vertices * 3 * sizeof(float));
    g->shade = storage(vertices * sizeof(gfx_vertex_shade));
    g->skin = storage(skinned * sizeof(gfx_vertex_skin));
    g->index = storage(indices * sizeof(uint32_t));
    g->vao[0] = vertex_array(g, false);
    g->vao[1] = vertex_array(g, true);
    uint32_t vertex = 0, index = 0;
    upload(g, world, true, &vertex, &index);
    upload(g, world, false, &vertex, &index);
    g->world = world->id;
    g->version = world->mesh_version;
    return true;
}
