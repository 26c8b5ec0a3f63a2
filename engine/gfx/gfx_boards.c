// Draws pictures, texts and particles in the world: squares from far to near, one draw for all that
// follow one another with one texture.
#include "gfx/gfx_device_internal.h"
#include "gfx/gfx_particles.h"
#include "gfx/gfx_text.h"

#include <string.h>

void gfx_boards_release(gfx_boards *b) {
    gfx_stream_release(&b->stream);
    glDeleteSamplers(1, &b->sampler);
    gfx_growing *const arrays[] = {&b->blocks, &b->runs,    &b->order,
                                   &b->inner,  &b->scratch, &b->glyphs};
    for (size_t i = 0; i < CORE_COUNT_OF(arrays); ++i) {
        gfx_growing_release(arrays[i]);
    }
    *b = (gfx_boards){0};
}

bool gfx_boards_wanted(const gfx_world *world) {
    return world->boards.count > 0 || gfx_emitters_count(world) > 0;
}

typedef struct pass { // what all squares of a frame share
    gfx_device *device;
    gfx_world *world;
    gfx_boards *boards;
    const gfx_view *view;
    core_vec3 right, up, ahead; // of the camera
} pass;

static void extend_run(gfx_boards *b, GLuint texture, uint32_t features, size_t before) {
    uint32_t added = (uint32_t)(b->blocks.count - before);
    gfx_quad_run *last = b->runs.count ? (gfx_quad_run *)b->runs.data + b->runs.count - 1 : NULL;
    if (last && last->texture == texture && last->features == features) {
        last->count += added;
    } else if (added) {
        *(gfx_quad_run *)gfx_grow(&b->runs, sizeof *last, 1) =
            (gfx_quad_run){(uint32_t)before, added, texture, features};
    }
}

static void put3(float out[4], core_vec3 v, float w) {
    out[0] = v.x, out[1] = v.y, out[2] = v.z, out[3] = w;
}

// ---- boards ----

// Half edges of a board of 1 x 1 m.
static void axes_of(const pass *p, const gfx_board_desc *d, core_vec3 *right, core_vec3 *up) {
    const core_vec3 y = {0.0f, 1.0f, 0.0f};
    *right = p->right, *up = p->up;
    if (d->facing == GFX_FACE_UPRIGHT) {
        *right = core_v3_normalize(core_v3_cross(p->ahead, y), p->right);
        *up = y;
    } else if (d->facing == GFX_FACE_FIXED) {
        *right = core_quat_rotate(d->rotation, core_v3(1.0f, 0.0f, 0.0f));
        *up = core_quat_rotate(d->rotation, y);
    }
    *right = core_v3_scale(*right, 0.5f), *up = core_v3_scale(*up, 0.5f);
}

static struct gfx_board_block *add_block(const pass *p, const gfx_board_desc *d) {
    struct gfx_board_block *b = gfx_grow(&p->boards->blocks, sizeof *b, 1);
    *b = (struct gfx_board_block){.uv = {0.0f, 0.0f, 1.0f, 1.0f}};
    memcpy(b->color, d->color, sizeof b->color);
    return b;
}

static void add_picture(const pass *p, const gfx_board *board, const gfx_texture *t) {
    const gfx_board_desc *d = &board->desc;
    const float *s = d->source;
    float w = (float)t->width, h = (float)t->height;
    core_vec3 right, up;
    axes_of(p, d, &right, &up);
    struct gfx_board_block *b = add_block(p, d);
    float wide = w / h;
    if (s[2] > 0.0f) {
        b->uv[0] = s[0] / w, b->uv[1] = s[1] / h;
        b->uv[2] = (s[0] + s[2]) / w, b->uv[3] = (s[1] + s[3]) / h;
        wide = s[2] / s[3];
    }
    float width = d->width > 0.0f ? d->width : d->height * wide;
    put3(b->place, d->position, d->additive ? 1.0f : 0.0f);
    put3(b->right, core_v3_scale(right, width), 0.0f);
    put3(b->up, core_v3_scale(up, d->height), 0.0f);
}

// Size in the atlas at which a line so high in the world looks sharp.
static float raster_size(const pass *p, const gfx_board_desc *d, float distance) {
    static const float sizes[] = {16.0f, 24.0f, 32.0f, 48.0f, 64.0f, 96.0f, 128.0f};
    float reach = p->view->orthographic ? 1.0f : CORE_MAX(distance, p->view->near_plane);
    float pixels = d->height * 0.5f * (float)p->device->height / (reach * p->view->tan_y);
    size_t i = 0;
    while (i + 1 < CORE_COUNT_OF(sizes) && sizes[i] < pixels) {
        ++i;
    }
    return sizes[i];
}

static void add_text(const pass *p, const gfx_board *board, float distance) {
    const char *text = p->world->text.data;
    gfx_quads *q = &p->device->quads;
    const gfx_face *face =
        gfx_face_get(p->world, board->font == GFX_NO_TEXT ? NULL : text + board->font);
    if (!face) {
        return;
    }
    q->font = q->font ? q->font : gfx_font_create();
    text += board->text;
    const gfx_board_desc *d = &board->desc;
    gfx_command c = {.h = raster_size(p, d, distance), .align = 0.5f};
    c.text_length = (uint32_t)strlen(text);
    gfx_text_box box = gfx_text_layout(face, text, c.text_length, c.h, 0.0f, 0.5f, NULL);
    p->boards->glyphs.count = 0;
    gfx_font_quads(q->font, face, text, &c, &p->boards->glyphs);
    const struct gfx_quad_block *g = p->boards->glyphs.data;
    core_vec3 right, up;
    axes_of(p, d, &right, &up);
    float metres = d->height / c.h; // a pixel of the atlas
    for (size_t i = 0; i < p->boards->glyphs.count; ++i) {
        float w = g[i].axes[0], h = g[i].axes[3];
        float x = 2.0f * (g[i].place[0] + 0.5f * w) * metres;
        float y = (box.height - 2.0f * g[i].place[1] - h) * metres;
        struct gfx_board_block *b = add_block(p, d);
        put3(b->place, core_v3_mad(core_v3_mad(d->position, right, x), up, y),
             d->additive ? 1.0f : 0.0f);
        put3(b->right, core_v3_scale(right, w * metres), 0.0f);
        put3(b->up, core_v3_scale(up, h * metres), 0.0f);
        memcpy(b->uv, g[i].uv, sizeof b->uv);
    }
}

static void add_board(const pass *p, const gfx_board *board, float distance) {
    size_t before = p->boards->blocks.count;
    if (board->image != GFX_NO_TEXT) {
        const char *path = (const char *)p->world->text.data + board->image;
        const gfx_texture *t = gfx_texture_get(p->device, path, true);
        if (t) {
            add_picture(p, board, t);
            extend_run(p->boards, t->name, GFX_FEATURE_IMAGE, before);
        }
        return;
    }
    add_text(p, board, distance);
    const gfx_font *font = p->device->quads.font;
    extend_run(p->boards, font ? gfx_font_texture(font) : 0, GFX_FEATURE_TEXT, before);
}

// ---- particles ----

// Value at u of keys evenly spaced over [0, 1]; `stride` floats from key to key.
static float at_key(const float *key, uint32_t keys, uint32_t stride, float u) {
    float at = u * (float)(keys - 1);
    uint32_t i = CORE_MIN((uint32_t)at, keys > 1 ? keys - 2 : 0);
    const float *a = key + (size_t)i * stride;
    return keys > 1 ? a[0] + (a[stride] - a[0]) * (at - (float)i) : a[0];
}

static void write_particle(const pass *p, const gfx_emitter_store *e, const gfx_particle_view *v,
                           uint32_t i, struct gfx_board_block *out) {
    const gfx_emitter_desc *d = &e->desc;
    float u = v->u[i], sine = 0.0f, cosine = 1.0f;
    float half = 0.5f * at_key(d->size, d->size_keys, 1, u) * e->scale[v->row[i]];
    if (v->angle[i] != 0.0f) {
        core_sincosf(v->angle[i], &sine, &cosine);
    }
    core_vec3 right = core_v3_mad(core_v3_scale(p->right, half * cosine), p->up, half * sine);
    core_vec3 up = core_v3_mad(core_v3_scale(p->up, half * cosine), p->right, -half * sine);
    put3(out->place, core_v3(v->x[i], v->y[i], v->z[i]), d->additive ? 1.0f : 0.0f);
    put3(out->right, right, 0.0f);
    put3(out->up, up, 0.0f);
    uint32_t columns = d->frames[0], rows = d->frames[1];
    uint32_t frame = CORE_MIN((uint32_t)(u * (float)(columns * rows)), columns * rows - 1);
    float w = 1.0f / (float)columns, h = 1.0f / (float)rows;
    out->uv[0] = (float)(frame % columns) * w, out->uv[1] = (float)(frame / columns) * h;
    out->uv[2] = out->uv[0] + w, out->uv[3] = out->uv[1] + h;
    for (uint32_t k = 0; k < 4; ++k) {
        out->color[k] = at_key(&d->color[0][k], d->color_keys, 4, u);
    }
}

// Bits of a float so that larger ones come first, for those that are not negative.
static uint64_t far_first(float x) {
    uint32_t bits;
    x = CORE_MAX(x, 0.0f);
    memcpy(&bits, &x, sizeof bits);
    return ~bits;
}

static void add_particles(const pass *p, const gfx_emitter_store *e) {
    gfx_particles *all = p->world->particles;
    gfx_boards *b = p->boards;
    // None was born so lately that it could be alive.
    if ((float)(all->step - e->last) * all->dt > e->desc.life[1] + 2.0f * all->dt) {
        return;
    }
    gfx_particle_view v = gfx_particles_scratch(all, e->capacity);
    uint32_t n = CORE_SIMD_SELECT(gfx_particles_at)(e, all->step, all->part, all->dt, &v);
    size_t before = b->blocks.count;
    struct gfx_board_block *block = gfx_grow(&b->blocks, sizeof *block, n);
    b->inner.count = b->scratch.count = 0;
    gfx_sort_key *key = gfx_grow(&b->inner, sizeof *key, n);
    for (uint32_t i = 0; i < n; ++i) {
        core_vec3 to = core_v3_sub(core_v3(v.x[i], v.y[i], v.z[i]), p->view->position);
        key[i] = (gfx_sort_key){.key = far_first(core_v3_dot(to, p->ahead)), .row = i};
    }
    if (!e->desc.additive) { // sums do not depend on the order
        gfx_sort_keys(key, gfx_grow(&b->scratch, sizeof *key, n), n);
    }
    for (uint32_t i = 0; i < n; ++i) {
        write_particle(p, e, &v, key[i].row, &block[i]);
    }
    const gfx_texture *t = e->image[0] ? gfx_texture_get(p->device, e->image, true) : NULL;
    extend_run(b, t ? t->name : 0, t ? GFX_FEATURE_IMAGE : 0, before);
}

// ---- the pass ----

// Boards and emitters from far to near; among equals in the order in which they were made.
static uint32_t sort_items(const pass *p) {
    const gfx_board *board = p->world->boards.data;
    uint32_t boards = (uint32_t)p->world->boards.count, emitters = gfx_emitters_count(p->world);
    uint32_t count = boards + emitters;
    p->boards->order.count = p->boards->scratch.count = 0;
    gfx_sort_key *key = gfx_grow(&p->boards->order, sizeof *key, count);
    for (uint32_t i = 0; i < count; ++i) {
        core_vec3 at = i < boards ? board[i].desc.position
                                  : p->world->particles->emitters.store[i - boards].desc.position;
        float ahead = core_v3_dot(core_v3_sub(at, p->view->position), p->ahead);
        key[i] = (gfx_sort_key){.key = far_first(ahead), .row = i};
    }
    gfx_sort_keys(key, gfx_grow(&p->boards->scratch, sizeof *key, count), count);
    return count;
}

static void collect(const pass *p) {
    const gfx_board *board = p->world->boards.data;
    uint32_t boards = (uint32_t)p->world->boards.count, count = sort_items(p);
    p->boards->blocks.count = p->boards->runs.count = 0;
    for (uint32_t i = 0; i < count; ++i) {
        uint32_t row = ((const gfx_sort_key *)p->boards->order.data)[i].row;
        if (row < boards) {
            core_vec3 to = core_v3_sub(board[row].desc.position, p->view->position);
            add_board(p, &board[row], core_v3_length(to));
        } else {
            add_particles(p, &p->world->particles->emitters.store[row - boards]);
        }
    }
}

static bool submit(const pass *p) {
    gfx_device *d = p->device;
    gfx_boards *b = p->boards;
    if (!b->sampler) { // the atlas of glyphs is read between its texels here
        glCreateSamplers(1, &b->sampler);
        glSamplerParameteri(b->sampler, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
        glSamplerParameteri(b->sampler, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    }
    glBindVertexArray(d->empty_vao);
    glDisable(GL_CULL_FACE);
    bool ok = true;
    for (size_t i = 0; i < b->runs.count && ok; ++i) {
        const gfx_quad_run *run = (const gfx_quad_run *)b->runs.data + i;
        GLuint program = gfx_shaders_get(&d->shaders, "board.vert", "board.frag", run->features);
        ok = program != 0;
        if (ok) {
            glUseProgram(program);
            glBindTextureUnit(GFX_TEX_IMAGE, run->texture);
            glBindSampler(GFX_TEX_IMAGE, run->features & GFX_FEATURE_TEXT ? b->sampler : 0);
            glDrawArrays(GL_TRIANGLES, (GLint)run->first * 6, (GLsizei)run->count * 6);
            p->world->stats.draws++;
        }
    }
    glBindSampler(GFX_TEX_IMAGE, 0);
    glEnable(GL_CULL_FACE);
    return ok;
}

bool gfx_boards_draw(gfx_device *d, gfx_world *world, const gfx_view *view) {
    const float *m = view->view.m;
    pass p = {
        d, world, &d->boards, view, {m[0], m[4], m[8]}, {m[1], m[5], m[9]}, {-m[2], -m[6], -m[10]}};
    collect(&p);
    size_t bytes = d->boards.blocks.count * sizeof(struct gfx_board_block);
    if (bytes == 0) {
        return true;
    }
    memcpy(gfx_stream_begin(&d->boards.stream, bytes, d->frame), d->boards.blocks.data, bytes);
    gfx_stream_bind(&d->boards.stream, GL_SHADER_STORAGE_BUFFER, GFX_SSBO_QUADS, bytes, d->frame);
    return submit(&p);
}
