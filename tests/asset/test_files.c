// The engine's files: round trips byte for byte, layout by hand, and hostile bytes: every
// truncation and thousands of bit flips either decode to data that keeps the rules or are refused
// with a line.
#include "asset/asset.h"
#include "core/rng.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void setUp(void) {}
void tearDown(void) {}

#define BONES 3u
static char names[BONES][CORE_NAME_MAX] = {"root", "arm", "hand"};
static const int32_t parents[BONES] = {-1, 0, 1};
static const core_vec3 translations[BONES] = {{0, 1, 0}, {0, 2, 0}, {3, 0, 0}};
static const core_quat rotations[BONES] = {{0, 0, 0, 1}, {0, 0.6f, 0, 0.8f}, {0, 0, 0, 1}};
static const core_vec3 scales[BONES] = {{1, 1, 1}, {1, 2, 1}, {1, 1, 1}};

static void *skeleton_file(size_t *size) {
    core_mat4 inverse[BONES] = {core_mat4_identity(), core_mat4_identity(), core_mat4_identity()};
    inverse[1].m[13] = -2;
    core_skeleton_data s = {
        BONES,  (const char(*)[CORE_NAME_MAX])names, parents, translations, rotations, scales,
        inverse};
    return asset_skeleton_encode(&s, size);
}

static void *clip_file(size_t *size) {
    core_key key[5] = {0};
    for (int k = 0; k < 5; k++) {
        key[k] = (core_key){(float)k * 0.25f, {(float)k, 2, 3}, {0, 0.6f, 0, 0.8f}, {1, 1, 1}};
    }
    core_clip_track track[2] = {{.bone = 0, .key_count = 5, .key = key},
                                {.bone = 2, .key_count = 1, .key = key}};
    core_clip_data c = {
        .name = "walk", .duration = 1.25f, .bone_count = BONES, .track_count = 2, .track = track};
    return asset_clip_encode(&c, size);
}

static void *mesh_file(size_t *size) {
    static const float position[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0},
                       normal[9] = {0, 0, 1, 0, 0, 1, 0, 0, 1};
    static const float uv[6] = {0, 0, 1, 0, 0, 1};
    static const uint16_t joint[12] = {0, 1, 2, 0, 1, 0, 0, 0, 2, 0, 0, 0};
    static const float weight[12] = {0.5f, 0.25f, 0.25f, 0, 1, 0, 0, 0, 1, 0, 0, 0};
    static const uint32_t index[3] = {0, 1, 2};
    core_mesh_data m = {.vertex_count = 3,
                        .index_count = 3,
                        .position = position,
                        .normal = normal,
                        .uv = uv,
                        .joint = joint,
                        .weight = weight,
                        .index = index,
                        .bounds = {{0, 0, 0}, {1, 1, 0}}};
    return asset_mesh_encode(&m, BONES, size);
}

static void *sound_file(size_t *size) {
    static const int16_t sample[8] = {0, 100, -100, 32767, -32768, 5, 6, 7};
    core_sound_data s = {2, 44100, 4, sample};
    return asset_sound_encode(&s, size);
}

static void *model_file(size_t *size) {
    static asset_model_mesh mesh = {"m/body.cmesh", 0, true};
    static asset_model_clip clip = {"walk", "m/walk.canim"};
    static core_material_data material = {.name = "fur \"red\"",
                                          .base_color = {1, 0.5f, 0.25f, 1},
                                          .roughness = 0.75f,
                                          .normal_scale = 1,
                                          .occlusion_strength = 1,
                                          .alpha_cutoff = 0.5f,
                                          .alpha_mode = 1,
                                          .base_color_image = "m/fur.png"};
    asset_model m = {1, 1, 1, &mesh, &material, &clip, "m/fox.cskel"};
    return asset_model_encode(&m, size);
}

static void *decode_skeleton(const void *b, size_t n) { return asset_skeleton_decode(b, n, "f"); }
static void *decode_clip(const void *b, size_t n) { return asset_clip_decode(b, n, "f"); }
static void *decode_mesh(const void *b, size_t n) { return asset_mesh_decode(b, n, "f"); }
static void *decode_sound(const void *b, size_t n) { return asset_sound_decode(b, n, "f"); }
static void *decode_model(const void *b, size_t n) { return asset_model_decode(b, n, "f"); }
static void *encode_skeleton(const void *d, size_t *n) { return asset_skeleton_encode(d, n); }
static void *encode_clip(const void *d, size_t *n) { return asset_clip_encode(d, n); }
static void *encode_mesh(const void *d, size_t *n) { return asset_mesh_encode(d, BONES, n); }
static void *encode_sound(const void *d, size_t *n) { return asset_sound_encode(d, n); }
static void *encode_model(const void *d, size_t *n) { return asset_model_encode(d, n); }

typedef struct format {
    const char *name;
    void *(*make)(size_t *);
    void *(*decode)(const void *, size_t);
    void *(*encode)(const void *, size_t *);
    bool text;
} format;
static const format formats[] = {
    {"skeleton", skeleton_file, decode_skeleton, encode_skeleton, false},
    {"clip", clip_file, decode_clip, encode_clip, false},
    {"mesh", mesh_file, decode_mesh, encode_mesh, false},
    {"sound", sound_file, decode_sound, encode_sound, false},
    {"model", model_file, decode_model, encode_model, true},
};

static void test_round_trips(void) {
    for (size_t i = 0; i < CORE_COUNT_OF(formats); i++) {
        size_t size = 0, again = 0;
        void *file = formats[i].make(&size);
        TEST_ASSERT_NOT_NULL_MESSAGE(file, formats[i].name);
        void *data = formats[i].decode(file, size);
        TEST_ASSERT_NOT_NULL_MESSAGE(data, core_last_error());
        void *second = formats[i].encode(data, &again);
        TEST_ASSERT_EQUAL_UINT64(size, again);
        TEST_ASSERT_EQUAL_MEMORY_MESSAGE(file, second, size, formats[i].name);
        core_free(second);
        core_free(data);
        core_free(file);
    }
}

// Every length short of the whole is refused. Exact blocks let the sanitizer see reads past the
// end.
static void test_truncated_files_are_refused(void) {
    for (size_t i = 0; i < CORE_COUNT_OF(formats); i++) {
        size_t size = 0;
        uint8_t *file = formats[i].make(&size);
        size_t whole = formats[i].text ? size - 2 : size; // "}\n": the newline may go
        for (size_t n = 0; n < whole; n++) {
            uint8_t *cut = malloc(n ? n : 1);
            memcpy(cut, file, n);
            core_clear_error();
            void *data = formats[i].decode(cut, n);
            TEST_ASSERT_NULL_MESSAGE(data, formats[i].name);
            TEST_ASSERT_TRUE(strncmp(core_last_error(), "f: ", 3) == 0);
            free(cut);
        }
        core_free(file);
    }
}

static bool all_finite(const float *v, size_t n) {
    for (size_t i = 0; v && i < n; i++) {
        if (!isfinite(v[i])) {
            return false;
        }
    }
    return true;
}

static void check_mesh(const core_mesh_data *m) {
    TEST_ASSERT_TRUE(all_finite(m->position, 3 * m->vertex_count));
    for (uint32_t i = 0; i < m->index_count; i++) {
        TEST_ASSERT_TRUE(m->index[i] < m->vertex_count);
    }
}

static void check_clip(const core_clip_data *c) {
    TEST_ASSERT_TRUE(c->duration > 0);
    for (uint32_t t = 0; t < c->track_count; t++) {
        TEST_ASSERT_TRUE(c->track[t].bone < c->bone_count);
        for (uint32_t k = 0; k < c->track[t].key_count; k++) {
            TEST_ASSERT_TRUE(all_finite(&c->track[t].key[k].time, 11));
            TEST_ASSERT_TRUE(k == 0 || c->track[t].key[k].time > c->track[t].key[k - 1].time);
        }
    }
}

static void test_bit_flips_keep_the_rules(void) {
    core_rng rng = core_rng_make(7, 1);
    for (size_t i = 0; i < CORE_COUNT_OF(formats); i++) {
        size_t size = 0;
        uint8_t *file = formats[i].make(&size);
        uint8_t *bad = malloc(size);
        int refused = 0;
        for (int n = 0; n < 4000; n++) {
            memcpy(bad, file, size);
            for (uint32_t flips = 1 + core_rng_below(&rng, 3); flips > 0; flips--) {
                bad[core_rng_below(&rng, (uint32_t)size)] ^=
                    (uint8_t)(1u << core_rng_below(&rng, 8));
            }
            void *data = formats[i].decode(bad, size);
            refused += data == NULL;
            if (data && formats[i].decode == decode_mesh) {
                check_mesh(data);
            } else if (data && formats[i].decode == decode_clip) {
                check_clip(data);
            }
            core_free(data);
        }
        TEST_ASSERT_TRUE_MESSAGE(refused > 100, formats[i].name);
        free(bad);
        core_free(file);
    }
}

static void put_u32(uint8_t *p, uint32_t v) {
    for (int i = 0; i < 4; i++) {
        p[i] = (uint8_t)(v >> 8 * i);
    }
}

// The report's fig. 13 by byte offsets.
static void test_clip_layout(void) {
    size_t size = 0;
    uint8_t *file = clip_file(&size);
    TEST_ASSERT_EQUAL_UINT64(144 + 2 * 8 + 6 * 44, size);
    TEST_ASSERT_EQUAL_MEMORY("CAN1walk", file, 9);
    float duration;
    memcpy(&duration, file + 132, 4);
    TEST_ASSERT_FLOAT_WITHIN(0, 1.25f, duration);
    const uint8_t counts[16] = {3, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 5, 0, 0, 0};
    TEST_ASSERT_EQUAL_MEMORY(counts, file + 136, 16);
    float w;
    memcpy(&w, file + 152 + 28, 4); // time, translation, then x y z w
    TEST_ASSERT_FLOAT_WITHIN(0, 0.8f, w);
    core_free(file);
}

static void refused(const char *what, void *(*decode)(const void *, size_t), const void *bytes,
                    size_t size) {
    core_clear_error();
    TEST_ASSERT_NULL(decode(bytes, size));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(core_last_error(), what), core_last_error());
}

static void test_hostile_fields_name_themselves(void) {
    size_t size = 0;
    uint8_t *clip = clip_file(&size);
    put_u32(clip + 148, 0xffffffffu); // key count of the first track
    refused("4294967295 keys", decode_clip, clip, size);
    core_free(clip);
    clip = clip_file(&size);
    put_u32(clip + 152 + 44, 0x7fc00000u); // time of the second key: NaN
    refused("time", decode_clip, clip, size);
    put_u32(clip + 152 + 44, 0); // equal times
    refused("key 1", decode_clip, clip, size);
    core_free(clip);
    clip = clip_file(&size);
    memset(clip + 4, 'x', 128);
    refused("name", decode_clip, clip, size);
    core_free(clip);
    clip = clip_file(&size);
    put_u32(clip + 132, 0);
    refused("duration", decode_clip, clip, size);
    core_free(clip);
    uint8_t *skeleton = skeleton_file(&size);
    put_u32(skeleton + 8 + 236 + 128, 2); // bone 1's parent is bone 2: a cycle
    refused("cycles", decode_skeleton, skeleton, size);
    put_u32(skeleton + 4, 0x40000000u);
    refused("1073741824 bones", decode_skeleton, skeleton, size);
    core_free(skeleton);
    uint8_t *mesh = mesh_file(&size);
    put_u32(mesh + 4, 0xfffffff0u);
    refused("vertices", decode_mesh, mesh, size);
    core_free(mesh);
}

static void test_mesh_rules(void) {
    size_t size = 0;
    uint8_t *mesh = mesh_file(&size);
    put_u32(mesh + size - 4, 3);
    refused("index 2 is 3", decode_mesh, mesh, size);
    core_free(mesh);
}

static void test_model_paths_stay_in_the_folder(void) {
    static const char *const bad[] = {"../x.cmesh", "/etc/x", "a\\\\b"};
    for (size_t i = 0; i < CORE_COUNT_OF(bad); i++) {
        char text[128];
        snprintf(text, sizeof text, "{\"meshes\":[{\"file\":\"%s\"}]}", bad[i]);
        refused("inside the model's folder", decode_model, text, strlen(text));
    }
    const char *good = "{\"meshes\":[{\"file\":\"body.cmesh\"}],\"skeleton\":\"fox.cskel\"}";
    asset_model *m = asset_model_decode(good, strlen(good), "models/fox.cmodel");
    TEST_ASSERT_EQUAL_STRING("models/body.cmesh", m->mesh[0].path);
    TEST_ASSERT_EQUAL_STRING("models/fox.cskel", m->skeleton);
    core_free(m);
}

// One sample in each encoding of a WAV file, converted by hand.
static void test_wav_encodings(void) {
    const struct {
        uint16_t tag, bits;
        uint8_t bytes[4];
        int16_t expected;
    } cases[] = {
        {1, 8, {192}, 16384},
        {1, 16, {0x34, 0x12}, 0x1234},
        {1, 24, {0xff, 0x34, 0x12}, 0x1234},
        {1, 32, {0xff, 0xff, 0x34, 0x92}, (int16_t)0x9234},
        {3, 32, {0, 0, 0, 0x3f}, 16384},  // 0.5
        {3, 32, {0, 0, 0xc0, 0x7f}, 0},   // NaN
        {3, 32, {0, 0, 0, 0xc0}, -32767}, // -2
    };
    for (size_t i = 0; i < CORE_COUNT_OF(cases); i++) {
        uint8_t file[48] = "RIFF    WAVEfmt ";
        put_u32(file + 16, 16);
        put_u32(file + 20, cases[i].tag | 1u << 16);
        put_u32(file + 24, 8000);
        put_u32(file + 28, 8000);
        put_u32(file + 32, 1 | (uint32_t)cases[i].bits << 16);
        memcpy(file + 36, "data", 4);
        put_u32(file + 40, cases[i].bits / 8u);
        memcpy(file + 44, cases[i].bytes, 4);
        core_sound_data *s = asset_sound_decode(file, 44 + cases[i].bits / 8u, "w");
        TEST_ASSERT_NOT_NULL(s);
        TEST_ASSERT_EQUAL_UINT32(8000, s->rate);
        TEST_ASSERT_EQUAL_INT16(cases[i].expected, s->sample[0]);
        core_free(s);
    }
}

// A 2 x 1 TGA written by hand: blue, then half-transparent red; and cut short.
static void test_image(void) {
    uint8_t tga[26] = {0, 0, 2, 0,  0,    0,   0, 0, 0,   0, 0, 0,   2,
                       0, 1, 0, 32, 0x28, 255, 0, 0, 255, 0, 0, 255, 128};
    core_image_data *image = asset_image_decode(tga, sizeof tga, "i", CORE_IMAGE_RGBA8_SRGB);
    TEST_ASSERT_NOT_NULL(image);
    TEST_ASSERT_EQUAL_UINT32(2, image->width);
    TEST_ASSERT_EQUAL_UINT32(1, image->height);
    const uint8_t expected[8] = {0, 0, 255, 255, 255, 0, 0, 128};
    TEST_ASSERT_EQUAL_MEMORY(expected, image->pixels, 8);
    core_free(image);
    tga[13] = 0xff; // 65282 pixels wide
    TEST_ASSERT_NULL(asset_image_decode(tga, sizeof tga, "i", CORE_IMAGE_RGBA8_SRGB));
    TEST_ASSERT_NULL(asset_image_decode("hello", 5, "i", CORE_IMAGE_RGBA8_SRGB));
}

// Grey TGA of 2 x 3 pixels, rows from the top.
static void test_heights(void) {
    const uint8_t tga[24] = {0, 0, 3, 0, 0, 0,  0, 0,   0,  0,   0, 0,
                             2, 0, 3, 0, 8, 32, 0, 255, 51, 102, 0, 0};
    core_heights_data *h = asset_heights_decode(tga, sizeof tga, "i", -5.0f, 10.0f);
    TEST_ASSERT_NOT_NULL(h);
    TEST_ASSERT_EQUAL_UINT32(2, h->columns);
    TEST_ASSERT_EQUAL_UINT32(3, h->rows);
    const float expected[6] = {-5, 10, -2, 1, -5, -5};
    for (int i = 0; i < 6; ++i) {
        TEST_ASSERT_FLOAT_WITHIN(1e-5f, expected[i], h->height[i]);
    }
    core_free(h);
    TEST_ASSERT_NULL(asset_heights_decode("hello", 5, "i", 0, 1));
    uint8_t thin[22];
    memcpy(thin, tga, sizeof thin);
    thin[12] = 1;
    TEST_ASSERT_NULL(asset_heights_decode(thin, sizeof thin, "i", 0, 1)); // one column
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_heights);
    RUN_TEST(test_round_trips);
    RUN_TEST(test_truncated_files_are_refused);
    RUN_TEST(test_bit_flips_keep_the_rules);
    RUN_TEST(test_clip_layout);
    RUN_TEST(test_hostile_fields_name_themselves);
    RUN_TEST(test_mesh_rules);
    RUN_TEST(test_model_paths_stay_in_the_folder);
    RUN_TEST(test_wav_encodings);
    RUN_TEST(test_image);
    return UNITY_END();
}
