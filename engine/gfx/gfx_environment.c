// Image-based light: the environment as a cube map, its irradiance as spherical harmonics, its
// reflections filtered by roughness.
#include "gfx/gfx_device_internal.h"

#include "core/hash.h"

#include <stb_image.h>

#include <string.h>

enum { SOURCE_SIZE = 128, SOURCE_LEVELS = 8, HARMONICS_LEVEL = 3 };

void gfx_environment_release(gfx_environment_maps *m) {
    const GLuint textures[3] = {m->source, m->filtered, m->panorama};
    glDeleteTextures(3, textures);
    *m = (gfx_environment_maps){0};
}

void gfx_environment_write(const gfx_device *d, const gfx_world *world,
                           struct gfx_view_block *out) {
    const gfx_environment *e = &world->environment;
    memcpy(out->sky_zenith, e->zenith, sizeof e->zenith);
    memcpy(out->sky_horizon, e->horizon, sizeof e->horizon);
    memcpy(out->sky_ground, e->ground, sizeof e->ground);
    memcpy(out->sky_glow, e->glow, sizeof e->glow);
    memcpy(out->sky_sun, &e->sun, sizeof e->sun);
    out->sky_zenith[3] = e->intensity;
    out->sky_sun[3] = e->glow_exponent;
    memcpy(out->harmonics, d->environment.harmonics, sizeof out->harmonics);
}

static GLuint cube(uint32_t size, int levels) {
    GLuint t;
    glCreateTextures(GL_TEXTURE_CUBE_MAP, 1, &t);
    glTextureStorage2D(t, levels, GL_RGBA16F, (GLsizei)size, (GLsizei)size);
    glTextureParameteri(t, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    return t;
}

static bool read_panorama(gfx_device *d, const char *path) {
    size_t size;
    void *file = d->vfs ? core_vfs_read(d->vfs, path, &size) : NULL;
    if (!file) {
        return false;
    }
    int width, height, channels; // 8-bit pictures are linearised by stb_image
    bool sane = gfx_mips_check(path, file, size);
    float *rgb =
        sane ? stbi_loadf_from_memory(file, (int)size, &width, &height, &channels, 3) : NULL;
    core_free(file);
    if (!rgb) {
        return sane &&
               core_fail("%s: no picture that can be read (%s)", path, stbi_failure_reason());
    }
    glCreateTextures(GL_TEXTURE_2D, 1, &d->environment.panorama);
    glTextureStorage2D(d->environment.panorama, 1, GL_RGB16F, width, height);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glTextureSubImage2D(d->environment.panorama, 0, 0, 0, width, height, GL_RGB, GL_FLOAT, rgb);
    glTextureParameteri(d->environment.panorama, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTextureParameteri(d->environment.panorama, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    stbi_image_free(rgb);
    return true;
}

// Draws all faces of one level of a cube with the current program.
static void draw_faces(gfx_device *d, GLuint texture, GLint level, uint32_t size) {
    GLuint target;
    glCreateFramebuffers(1, &target);
    glBindFramebuffer(GL_FRAMEBUFFER, target);
    glViewport(0, 0, (GLsizei)size, (GLsizei)size);
    glUniform1f(GFX_U_SIZE, (float)size);
    glBindVertexArray(d->empty_vao);
    for (int face = 0; face < 6; ++face) {
        glNamedFramebufferTextureLayer(target, GL_COLOR_ATTACHMENT0, texture, level, face);
        glUniform1i(GFX_U_FACE, face);
        glDrawArrays(GL_TRIANGLES, 0, 3);
    }
    glDeleteFramebuffers(1, &target);
}

static uint32_t features_of(const gfx_world *world) {
    return world->panorama_path[0] ? GFX_FEATURE_PANORAMA : 0;
}

static bool make_source(gfx_device *d, const gfx_world *world) {
    GLuint program =
        gfx_shaders_get(&d->shaders, "fullscreen.vert", "environment.frag", features_of(world));
    if (!program) {
        return false;
    }
    d->environment.source = cube(SOURCE_SIZE, SOURCE_LEVELS);
    glUseProgram(program);
    glBindTextureUnit(GFX_TEX_PANORAMA, d->environment.panorama);
    draw_faces(d, d->environment.source, 0, SOURCE_SIZE);
    glGenerateTextureMipmap(d->environment.source);
    return true;
}

static bool make_filtered(gfx_device *d, int samples) {
    GLuint program = gfx_shaders_get(&d->shaders, "fullscreen.vert", "prefilter.frag", 0);
    if (!program) {
        return false;
    }
    d->environment.filtered = cube(GFX_ENVIRONMENT_SIZE, GFX_ENVIRONMENT_LEVELS);
    glUseProgram(program);
    glBindTextureUnit(GFX_TEX_ENVIRONMENT, d->environment.source);
    glUniform1i(GFX_U_SAMPLES, samples);
    for (int level = 0; level < GFX_ENVIRONMENT_LEVELS; ++level) {
        float roughness = (float)level / (GFX_ENVIRONMENT_LEVELS - 1);
        glUniform1f(GFX_U_ROUGHNESS, CORE_MAX(roughness, 0.02f));
        draw_faces(d, d->environment.filtered, level, GFX_ENVIRONMENT_SIZE >> level);
    }
    return true;
}

// ---- irradiance ----

// Direction of a face's point (x, y) in -1..1: the twin of faceDirection in cube.glsl.
static core_vec3 face_direction(int face, float x, float y) {
    const core_vec3 d[6] = {{1, -y, -x}, {-1, -y, x}, {x, 1, y},
                            {x, -1, -y}, {x, -y, 1},  {-x, -y, -1}};
    return core_v3_normalize(d[face], core_v3(0.0f, 1.0f, 0.0f));
}

// Basis without its constants, in the order of environmentIrradiance in ambient.glsl.
static void basis(core_vec3 n, double out[9]) {
    const double x = n.x, y = n.y, z = n.z;
    const double b[9] = {1.0, y, z, x, x * y, y * z, 3.0 * z * z - 1.0, x * z, x * x - y * y};
    memcpy(out, b, sizeof b);
}

// Projects a level of the cube on nine harmonics and convolves with the clamped cosine over pi:
// band factors 1, 2/3, 1/4 (Ramamoorthi, Hanrahan 2001).
void gfx_environment_project(const float *rgba, uint32_t size, float out[9][4]) {
    // Squares of the basis functions' constants, times the band factors.
    static const double weight[9] = {0.0795774715,
                                     0.2387324146 * 2.0 / 3.0,
                                     0.2387324146 * 2.0 / 3.0,
                                     0.2387324146 * 2.0 / 3.0,
                                     1.1936620732 / 4.0,
                                     1.1936620732 / 4.0,
                                     0.0994718394 / 4.0,
                                     1.1936620732 / 4.0,
                                     0.2984155183 / 4.0};
    double sum[9][3] = {{0}};
    const float *texel = rgba;
    for (int face = 0; face < 6; ++face) {
        for (uint32_t i = 0; i < size * size; ++i, texel += 4) {
            float x = 2.0f * ((float)(i % size) + 0.5f) / (float)size - 1.0f;
            float y = 2.0f * ((float)(i / size) + 0.5f) / (float)size - 1.0f;
            double b[9], r2 = 1.0 + (double)(x * x) + (double)(y * y);
            double angle = 4.0 / ((double)size * size * r2 * core_sqrt(r2));
            basis(face_direction(face, x, y), b);
            for (int k = 0; k < 9; ++k) {
                for (int c = 0; c < 3; ++c) {
                    sum[k][c] += (double)texel[c] * b[k] * angle;
                }
            }
        }
    }
    for (int k = 0; k < 9; ++k) {
        for (int c = 0; c < 3; ++c) {
            out[k][c] = (float)(sum[k][c] * weight[k]);
        }
        out[k][3] = 0.0f;
    }
}

static void make_harmonics(gfx_environment_maps *m) {
    enum { SIZE = SOURCE_SIZE >> HARMONICS_LEVEL };
    size_t bytes = 6 * SIZE * SIZE * 4 * sizeof(float);
    float *rgba = core_alloc(bytes);
    glGetTextureImage(m->source, HARMONICS_LEVEL, GL_RGBA, GL_FLOAT, (GLsizei)bytes, rgba);
    gfx_environment_project(rgba, SIZE, m->harmonics);
    core_free(rgba);
}

// ---- frame ----

static uint64_t key_of(const gfx_world *world) {
    const gfx_environment *e = &world->environment; // field by field: padding has no meaning
    uint64_t h = core_hash_string(world->panorama_path);
    h = core_hash(e->zenith, sizeof e->zenith, h);
    h = core_hash(e->horizon, sizeof e->horizon, h);
    h = core_hash(e->ground, sizeof e->ground, h);
    h = core_hash(e->glow, sizeof e->glow, h);
    h = core_hash(&e->sun, sizeof e->sun, h);
    h = core_hash(&e->intensity, sizeof e->intensity, h);
    h = core_hash_mix(h, (uint64_t)world->settings.ibl_samples);
    return core_hash(&e->glow_exponent, sizeof e->glow_exponent, h) | 1;
}

// The sky's shaders read the view block, so this frame's one without harmonics is bound meanwhile.
bool gfx_environment_update(gfx_device *d, const gfx_world *world) {
    gfx_environment_maps *m = &d->environment;
    if (!world->environment_set || m->key == key_of(world)) {
        return true;
    }
    gfx_environment_release(m);
    if (world->panorama_path[0] && !read_panorama(d, world->panorama_path)) {
        return false;
    }
    struct gfx_view_block *b = core_alloc(sizeof *b);
    GLuint block;
    gfx_environment_write(d, world, b);
    glCreateBuffers(1, &block);
    glNamedBufferStorage(block, sizeof *b, b, 0);
    core_free(b);
    glBindBufferBase(GL_UNIFORM_BUFFER, GFX_UBO_VIEW, block);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glDisable(GL_BLEND);
    bool ok = make_source(d, world) && make_filtered(d, (int)world->settings.ibl_samples);
    glDeleteBuffers(1, &block);
    if (ok) {
        make_harmonics(m);
        m->key = key_of(world);
        d->passes += GFX_ENVIRONMENT_LEVELS + 1;
    }
    return ok;
}

bool gfx_environment_draw(gfx_device *d, const gfx_world *world) {
    GLuint program = gfx_shaders_get(&d->shaders, "sky.vert", "sky.frag", features_of(world));
    if (!program) {
        return false;
    }
    glDepthFunc(GL_EQUAL); // where depth is still infinity
    glDepthMask(GL_FALSE);
    glUseProgram(program);
    glBindVertexArray(d->empty_vao);
    glBindTextureUnit(GFX_TEX_PANORAMA, d->environment.panorama);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    d->passes++;
    return true;
}
