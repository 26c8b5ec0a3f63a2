// Text and the 2D layer: metrics against the font's own tables, UTF-8, lines, clips, sprites, and
// places of the screen against the camera's geometry.
#include "gfx/gfx_text.h"
#include "support/gfx_fixture.h"

#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

void setUp(void) {}
void tearDown(void) {}

static const char sans[] = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
static const float white[4] = {1.0f, 1.0f, 1.0f, 1.0f};

static gfx_world *make_world(void) {
    gfx_world_desc desc = gfx_world_desc_default();
    desc.max_instances = desc.max_lights = 16;
    return gfx_world_create(&desc);
}

static gfx_text_box measure(gfx_world *world, const char *text, float size, float width) {
    gfx_text_desc d = gfx_text_desc_default();
    gfx_text_box box;
    d.text = text, d.font = "sans", d.size = size, d.width = width;
    TEST_ASSERT_TRUE_MESSAGE(gfx_text_measure(world, &d, &box), core_last_error());
    return box;
}

// The font read by ourselves: units of the em square, big-endian.
typedef struct tables {
    uint8_t *file;
    stbtt_fontinfo info;
} tables;

static tables open_tables(void) {
    tables t = {0};
    FILE *f = fopen(sans, "rb");
    TEST_ASSERT_NOT_NULL_MESSAGE(f, "fonts-dejavu-core is not installed");
    fseek(f, 0, SEEK_END);
    size_t size = (size_t)ftell(f);
    rewind(f);
    t.file = core_alloc(size);
    TEST_ASSERT_EQUAL_UINT64(size, fread(t.file, 1, size, f));
    fclose(f);
    TEST_ASSERT_TRUE(stbtt_InitFont(&t.info, t.file, 0));
    return t;
}

static void test_width_is_advances_and_kerning(void) {
    gfx_world *world = make_world();
    tables t = open_tables();
    int ascent, descent, gap, a, v, kern;
    stbtt_GetFontVMetrics(&t.info, &ascent, &descent, &gap);
    stbtt_GetCodepointHMetrics(&t.info, 'A', &a, &kern);
    stbtt_GetCodepointHMetrics(&t.info, 'V', &v, &kern);
    kern = stbtt_GetCodepointKernAdvance(&t.info, 'A', 'V');
    TEST_ASSERT_LESS_THAN(0, kern); // the pair is drawn together
    const float sizes[] = {12.0f, 20.0f, 47.0f, 256.0f};
    for (int i = 0; i < 4; ++i) {
        float unit = sizes[i] / (float)(ascent - descent);
        gfx_text_box box = measure(world, "AV", sizes[i], 0.0f);
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, (float)(a + kern + v) * unit, box.width);
        TEST_ASSERT_EQUAL_FLOAT(sizes[i], box.height);
        TEST_ASSERT_EQUAL_UINT32(1, box.lines);
    }
    core_free(t.file);
    gfx_world_destroy(world);
}

static void test_glyphs_stand_on_the_baseline(void) {
    gfx_world *world = make_world();
    tables t = open_tables();
    int ascent, descent, gap, advance, bearing;
    stbtt_GetFontVMetrics(&t.info, &ascent, &descent, &gap);
    stbtt_GetCodepointHMetrics(&t.info, 0xe9, &advance, &bearing);
    float unit = 40.0f / (float)(ascent - descent);
    gfx_growing at = {0};
    const char text[] = "\xc3\xa9x\ny";
    gfx_text_layout(gfx_face_get(world, "sans"), text, sizeof text - 1, 40.0f, 0.0f, 0.0f, &at);
    const gfx_glyph_at *g = at.data;
    TEST_ASSERT_EQUAL_UINT64(3, at.count);
    TEST_ASSERT_EQUAL_UINT32(0xe9, g[0].codepoint); // two bytes, one character
    advance += stbtt_GetCodepointKernAdvance(&t.info, 0xe9, 'x');
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, (float)advance * unit, g[1].x);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, (float)ascent * unit, g[0].y);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, (float)ascent * unit + 40.0f, g[2].y); // one size further down
    TEST_ASSERT_EQUAL_FLOAT(0.0f, g[2].x);
    gfx_growing_release(&at);
    core_free(t.file);
    gfx_world_destroy(world);
}

static void test_utf8(void) {
    static const struct {
        const char *bytes;
        uint32_t want[4];
        int count;
    } cases[] = {{"A", {'A'}, 1},
                 {"\xc3\xa9", {0xe9}, 1},
                 {"\xe2\x82\xac", {0x20ac}, 1},
                 {"\xf0\x9f\xa6\x8a", {0x1f98a}, 1},
                 {"\xffz", {0xfffd, 'z'}, 2},
                 {"\xc3z", {0xfffd, 'z'}, 2},        // cut short
                 {"\xe2\x82", {0xfffd, 0xfffd}, 2}}; // at the end
    for (size_t i = 0; i < CORE_COUNT_OF(cases); ++i) {
        const uint8_t *at = (const uint8_t *)cases[i].bytes, *end = at + strlen(cases[i].bytes);
        int count = 0;
        while (at < end) {
            TEST_ASSERT_LESS_THAN(4, count);
            TEST_ASSERT_EQUAL_HEX32(cases[i].want[count], gfx_next_codepoint(&at, end));
            count++;
        }
        TEST_ASSERT_EQUAL_INT(cases[i].count, count);
    }
}

static void test_lines_break_at_spaces(void) {
    gfx_world *world = make_world();
    float word = measure(world, "little", 20.0f, 0.0f).width;
    gfx_text_box box = measure(world, "little little little", 20.0f, word * 2.5f);
    TEST_ASSERT_EQUAL_UINT32(2, box.lines);
    TEST_ASSERT_EQUAL_FLOAT(40.0f, box.height);
    TEST_ASSERT_TRUE(box.width > 2.0f * word && box.width <= 2.5f * word);
    box = measure(world, "little", 20.0f, word * 0.5f); // no space: between letters
    TEST_ASSERT_GREATER_THAN(1, box.lines);
    TEST_ASSERT_TRUE(box.width <= word * 0.5f);
    TEST_ASSERT_EQUAL_UINT32(6, measure(world, "little", 20.0f, 1.0f).lines); // one letter at least
    TEST_ASSERT_EQUAL_UINT32(3, measure(world, "a\n\nb", 20.0f, 0.0f).lines);
    TEST_ASSERT_EQUAL_UINT32(1, measure(world, "", 20.0f, 0.0f).lines);
    gfx_growing at = {0};
    gfx_text_layout(gfx_face_get(world, "sans"), "ab", 2, 20.0f, 100.0f, 1.0f, &at);
    float wide = measure(world, "ab", 20.0f, 0.0f).width;
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 100.0f - wide, ((gfx_glyph_at *)at.data)[0].x);
    gfx_growing_release(&at);
    gfx_world_destroy(world);
}

static void test_errors(void) {
    gfx_world *world = make_world();
    gfx_text_desc d = gfx_text_desc_default();
    gfx_text_box box;
    TEST_ASSERT_FALSE(gfx_text(world, &d)); // no text
    d.text = "a", d.font = "fonts/none.ttf";
    TEST_ASSERT_FALSE(gfx_text_measure(world, &d, &box));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "fonts/none.ttf"));
    d.cookie = 0;
    TEST_ASSERT_FALSE(gfx_text(world, &d));
    gfx_sprite_desc s = gfx_sprite_desc_default();
    TEST_ASSERT_FALSE(gfx_sprite(world, &s));
    TEST_ASSERT_FALSE(gfx_clip_pop(world));
    for (int i = 0; i < GFX_CLIPS; ++i) {
        TEST_ASSERT_TRUE(gfx_clip_push(world, 0, 0, 10, 10));
    }
    TEST_ASSERT_FALSE(gfx_clip_push(world, 0, 0, 10, 10));
    gfx_world_begin_frame(world); // forgets them
    TEST_ASSERT_FALSE(gfx_clip_pop(world));
    gfx_world_destroy(world);
}

// ---- pictures ----

static const uint8_t *pixel(const uint8_t *rgba, int x, int y) { return rgba + 4 * (y * 64 + x); }

static void dark(gfx_world *world) { gfx_world_set_background(world, 0, 0, 0); }

// Pixels whose red is above the half, in a rectangle.
static int lit(const uint8_t *rgba, int x0, int y0, int x1, int y1) {
    int count = 0;
    for (int y = y0; y < y1; ++y) {
        for (int x = x0; x < x1; ++x) {
            count += pixel(rgba, x, y)[0] > 127;
        }
    }
    return count;
}

static void test_clips_cut(void) {
    gfx_fixture f = gfx_fixture_open(64, 64, false);
    dark(f.world);
    TEST_ASSERT_TRUE(gfx_clip_push(f.world, 8, 4, 40, 20));
    TEST_ASSERT_TRUE(gfx_clip_push(f.world, 0, 10, 20, 50)); // together: 8..20 x 10..24
    gfx_rect(f.world, 0, 0, 64, 64, white);
    TEST_ASSERT_TRUE(gfx_clip_pop(f.world));
    TEST_ASSERT_TRUE(gfx_clip_pop(f.world));
    gfx_rect(f.world, 60, 60, 4, 4, white); // and none again
    uint8_t *rgba = gfx_fixture_ldr(&f);
    TEST_ASSERT_EQUAL_INT(12 * 14, lit(rgba, 8, 10, 20, 24));
    TEST_ASSERT_EQUAL_INT(12 * 14 + 16, lit(rgba, 0, 0, 64, 64));
    core_free(rgba);
    gfx_fixture_close(&f);
}

// Area of a rounded rectangle and of a thick line within a pixel's share of their edge.
static void test_smooth_shapes_cover_their_area(void) {
    gfx_fixture f = gfx_fixture_open(64, 64, false);
    dark(f.world);
    const struct {
        float w, h, radius, border;
    } shapes[] = {{40, 30, 10, 0}, {20, 20, 10, 0}, {30, 30, 0, 0}, {40, 30, 0, 3}};
    for (size_t i = 0; i < CORE_COUNT_OF(shapes); ++i) {
        float w = shapes[i].w, h = shapes[i].h, r = shapes[i].radius, b = shapes[i].border;
        gfx_world_begin_frame(f.world);
        gfx_round_rect(f.world, 5, 6, w, h, r, b, white);
        uint8_t *rgba = gfx_fixture_ldr(&f);
        double got = 0, want = (double)(w * h - (4.0f - CORE_PI_F) * r * r);
        want -= b > 0 ? (double)((w - 2 * b) * (h - 2 * b)) : 0.0;
        for (int k = 0; k < 64 * 64; ++k) {
            got += rgba[4 * k] / 255.0;
        }
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * want, want, got);
        core_free(rgba);
    }
    gfx_world_begin_frame(f.world);
    gfx_line(f.world, 10, 10, 50, 40, 4, white); // 50 long
    uint8_t *rgba = gfx_fixture_ldr(&f);
    double got = 0;
    for (int k = 0; k < 64 * 64; ++k) {
        got += rgba[4 * k] / 255.0;
    }
    TEST_ASSERT_DOUBLE_WITHIN(2.0, 200.0, got);
    TEST_ASSERT_EQUAL_UINT8(255, pixel(rgba, 30, 25)[0]); // its middle
    core_free(rgba);
    gfx_fixture_close(&f);
}

static void test_text_is_drawn_where_it_measures(void) {
    gfx_fixture f = gfx_fixture_open(64, 64, false);
    dark(f.world);
    gfx_text_desc d = gfx_text_desc_default();
    gfx_text_box box;
    d.text = "MM", d.font = "sans", d.size = 20, d.x = 60, d.align = 1.0f, d.y = 10;
    TEST_ASSERT_TRUE(gfx_text(f.world, &d));
    TEST_ASSERT_TRUE(gfx_text_measure(f.world, &d, &box));
    uint8_t *rgba = gfx_fixture_ldr(&f);
    int left = 60 - (int)ceilf(box.width);
    int all = lit(rgba, 0, 0, 64, 64);
    TEST_ASSERT_GREATER_THAN(60, all);
    TEST_ASSERT_EQUAL_INT(all, lit(rgba, left - 1, 10, 61, 30)); // right-aligned to x = 60
    core_free(rgba);
    gfx_fixture_close(&f);
}

static void test_rays_and_projection(void) {
    gfx_camera c = {.position = {1, 2, 3}, .rotation = {0.1f, 0.2f, -0.3f, 0.9f}};
    c.rotation = core_quat_normalize(c.rotation);
    for (int k = 0; k < 2; ++k) {
        c.ortho_height = k ? 5.0f : 0.0f;
        const float at[][2] = {{0, 0}, {320, 180}, {640, 360}, {17.5f, 300.25f}};
        for (int i = 0; i < 4; ++i) {
            core_vec3 o, d;
            gfx_camera_ray(&c, 640, 360, at[i][0], at[i][1], &o, &d);
            TEST_ASSERT_FLOAT_WITHIN(1e-6f, 1.0f, core_v3_length(d));
            core_vec3 p = gfx_camera_project(&c, 640, 360, core_v3_mad(o, d, 7.0f));
            TEST_ASSERT_FLOAT_WITHIN(1e-2f, at[i][0], p.x);
            TEST_ASSERT_FLOAT_WITHIN(1e-2f, at[i][1], p.y);
            TEST_ASSERT_TRUE(p.z > 0);
        }
    }
    core_vec3 behind = core_v3_sub(c.position, core_quat_rotate(c.rotation, core_v3(0, 0, -1)));
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, -1.0f, gfx_camera_project(&c, 640, 360, behind).z);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_width_is_advances_and_kerning);
    RUN_TEST(test_glyphs_stand_on_the_baseline);
    RUN_TEST(test_utf8);
    RUN_TEST(test_lines_break_at_spaces);
    RUN_TEST(test_errors);
    RUN_TEST(test_clips_cut);
    RUN_TEST(test_smooth_shapes_cover_their_area);
    RUN_TEST(test_text_is_drawn_where_it_measures);
    RUN_TEST(test_rays_and_projection);
    return UNITY_END();
}
