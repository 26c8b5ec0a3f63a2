// Shader programs from files: #include, feature bits as defines, variants made on demand and kept.
#ifndef GFX_SHADER_H
#define GFX_SHADER_H

#include "core/vfs.h"

#include <glad/gl.h>

// Feature bits: bit i defines the name i as 1 in every stage.
#define GFX_FEATURES(X)                                                                            \
    X(CLUSTERED, "USE_CLUSTERED_RENDERING")                                                        \
    X(INSTANCING, "USE_INSTANCING")                                                                \
    X(SKINNING, "USE_SKINNING")                                                                    \
    X(SHADOWS, "USE_SHADOWS")                                                                      \
    X(SOFT_SHADOWS, "USE_SOFT_SHADOWS")                                                            \
    X(TEXTURES, "USE_TEXTURES")                                                                    \
    X(ALPHA_MASK, "USE_ALPHA_MASK")                                                                \
    X(BLEND, "USE_BLEND")                                                                          \
    X(IBL, "USE_IBL")                                                                              \
    X(PANORAMA, "USE_PANORAMA")                                                                    \
    X(COUNT_LISTS, "PASS_COUNT")                                                                   \
    X(SUM_LISTS, "PASS_SUM")                                                                       \
    X(FILL_LISTS, "PASS_FILL")                                                                     \
    X(DEBUG, "USE_DEBUG")                                                                          \
    X(DEPTH_ONLY, "DEPTH_ONLY")                                                                    \
    X(TEXT, "USE_TEXT")                                                                            \
    X(IMAGE, "USE_IMAGE")                                                                          \
    X(AO, "USE_AO")                                                                                \
    X(FOG, "USE_FOG")                                                                              \
    X(BLOOM, "USE_BLOOM")                                                                          \
    X(AUTO_EXPOSURE, "USE_AUTO_EXPOSURE")                                                          \
    X(GRADE, "USE_GRADE")                                                                          \
    X(TERRAIN, "USE_TERRAIN")                                                                      \
    X(SMOOTH, "USE_SMOOTH")                                                                        \
    X(HOOK, "USE_HOOK")

#define GFX_FEATURE_INDEX_(id, name) GFX_FEATURE_INDEX_##id,
#define GFX_FEATURE_BIT_(id, name)   GFX_FEATURE_##id = 1u << GFX_FEATURE_INDEX_##id,
enum { GFX_FEATURES(GFX_FEATURE_INDEX_) GFX_FEATURE_COUNT };
enum { GFX_FEATURES(GFX_FEATURE_BIT_) };

enum { GFX_SHADER_FILES = 32, GFX_SHADER_PATH = 64, GFX_PROGRAM_VARIANTS = 256 };

typedef struct gfx_program {
    const char *vertex, *fragment, *compute; // file names; literals
    uint32_t features;
    char hook[GFX_SHADER_PATH]; // virtual path of what #include "HOOK" stands for, "": none
    GLuint name; // 0: it failed, and fails again without a new attempt until files change
    uint64_t stamp;
} gfx_program;

typedef struct gfx_shaders {
    core_vfs *vfs;
    gfx_program program[GFX_PROGRAM_VARIANTS];
    uint32_t count;
} gfx_shaders;

void gfx_shaders_release(gfx_shaders *shaders);
// The program of two files (compute NULL) or of one compute file for a set of feature bits. NULL +
// core_fail with the file and line of the first error.
GLuint gfx_shaders_get(gfx_shaders *shaders, const char *vertex, const char *fragment,
                       uint32_t features);
// The same with a script's file in it: `hook` is its virtual path.
GLuint gfx_shaders_get_hooked(gfx_shaders *shaders, const char *vertex, const char *fragment,
                              uint32_t features, const char *hook);
GLuint gfx_shaders_compute(gfx_shaders *shaders, const char *compute, uint32_t features);
// Builds again what was made from files that changed since; false + core_fail when a program fails,
// which then keeps its old form.
bool gfx_shaders_reload(gfx_shaders *shaders);

#endif
