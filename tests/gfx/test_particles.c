// Particles: their way against the equation of motion, births against rate and path, the same bits
// on every instruction set; sprites and texts in the world where they should stand.
#include "gfx/gfx_particles.h"
#include "support/gfx_fixture.h"

#include "unity.h"

#include <math.h>
#include <string.h>

void setUp(void) {}
void tearDown(void) {}

static const float dt = 1.0f / 60.0f;

static gfx_world *make_world(void) {
    gfx_world_desc desc = gfx_world_desc_default();
    desc.max_instances = desc.max_lights = 16;
    return gfx_world_create(&desc);
}

// One particle, straight up.
static gfx_emitter add_one(gfx_world *world, gfx_emitter_desc *d) {
    d->rate = 0.0f, d->burst = 1;
    gfx_emitter e = gfx_emitter_create(world, d);
    TEST_ASSERT_FALSE_MESSAGE(core_handle_is_null(e), core_last_error());
    return e;
}

static core_vec3 only(gfx_world *world, gfx_emitter e) {
    core_vec3 at;
    TEST_ASSERT_EQUAL_UINT32(1, gfx_emitter_particles(world, e, &at, 1));
    return at;
}

// dv/dt = g - k (v - w), by Runge and Kutta in double precision.
static void fly(const gfx_emitter_desc *d, double seconds, double out[3]) {
    const double g[3] = {(double)d->acceleration.x, (double)d->acceleration.y,
                         (double)d->acceleration.z};
    const double w[3] = {(double)d->wind.x, (double)d->wind.y, (double)d->wind.z};
    const double k = (double)d->drag;
    const int n = 4000;
    double h = seconds / n;
    for (int c = 0; c < 3; ++c) {
        double x = 0, v = c == 1 ? (double)d->speed[0] : 0.0;
        for (int i = 0; i < n; ++i) {
            double a1 = g[c] - k * (v - w[c]), v2 = v + h / 2 * a1;
            double a2 = g[c] - k * (v2 - w[c]), v3 = v + h / 2 * a2;
            double a3 = g[c] - k * (v3 - w[c]), v4 = v + h * a3;
            double a4 = g[c] - k * (v4 - w[c]);
            x += h / 6 * (v + 2 * v2 + 2 * v3 + v4);
            v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
        }
        out[c] = x;
    }
}

static void test_the_way_solves_the_equation_of_motion(void) {
    const float drags[] = {0.0f, 1e-4f, 0.02f, 0.099f, 0.101f, 0.5f, 8.0f};
    for (size_t i = 0; i < CORE_COUNT_OF(drags); ++i) {
        gfx_world *world = make_world();
        gfx_emitter_desc d = gfx_emitter_desc_default();
        d.life[0] = d.life[1] = 5.0f;
        d.speed[0] = d.speed[1] = 7.0f;
        d.acceleration = core_v3(0.5f, -9.81f, 0.0f);
        d.wind = core_v3(3.0f, 0.0f, -2.0f);
        d.drag = drags[i];
        gfx_emitter e = add_one(world, &d);
        for (int step = 1; step <= 240; ++step) {
            gfx_world_step(world, dt);
            if (step % 60 == 0) {
                double want[3];
                core_vec3 got = only(world, e);
                fly(&d, step / 60.0, want);
                TEST_ASSERT_DOUBLE_WITHIN(1e-4 + 1e-5 * fabs(want[0]), want[0], (double)got.x);
                TEST_ASSERT_DOUBLE_WITHIN(1e-4 + 1e-5 * fabs(want[1]), want[1], (double)got.y);
                TEST_ASSERT_DOUBLE_WITHIN(1e-4 + 1e-5 * fabs(want[2]), want[2], (double)got.z);
            }
        }
        gfx_world_destroy(world);
    }
}

static void test_births_and_deaths_keep_the_rate(void) {
    gfx_world *world = make_world();
    gfx_emitter_desc d = gfx_emitter_desc_default();
    d.rate = 333.0f;
    d.life[0] = d.life[1] = 0.5f;
    gfx_emitter e = gfx_emitter_create(world, &d);
    for (int step = 1; step <= 300; ++step) {
        gfx_world_step(world, dt);
        float seconds = CORE_MIN((float)step * dt, 0.5f);
        uint32_t alive = gfx_emitter_particles(world, e, NULL, 0);
        TEST_ASSERT_UINT32_WITHIN(1, (uint32_t)(333.0f * seconds), alive);
    }
    TEST_ASSERT_TRUE(gfx_emitter_set_rate(world, e, 0.0f));
    for (int step = 0; step < 31; ++step) {
        gfx_world_step(world, dt);
    }
    TEST_ASSERT_EQUAL_UINT32(0, gfx_emitter_particles(world, e, NULL, 0));
    TEST_ASSERT_TRUE(gfx_emitter_burst(world, e, 1000000)); // more than it holds: the oldest go
    TEST_ASSERT_UINT32_WITHIN(16, 168, gfx_emitter_particles(world, e, NULL, 0));
    gfx_world_destroy(world);
}

// An emitter that flies on a line leaves its particles on it, evenly, between steps too.
static void test_a_moving_source_leaves_an_even_trail(void) {
    gfx_world *world = make_world();
    gfx_emitter_desc d = gfx_emitter_desc_default();
    d.rate = 600.0f; // ten a step
    d.life[0] = d.life[1] = 10.0f;
    d.speed[0] = d.speed[1] = 0.0f;
    gfx_emitter e = gfx_emitter_create(world, &d);
    for (int step = 1; step <= 30; ++step) {
        gfx_emitter_set_pose(world, e, core_v3((float)step, 0, 0), (core_quat){0});
        gfx_world_step(world, dt);
    }
    core_vec3 at[512];
    uint32_t n = gfx_emitter_particles(world, e, at, 512);
    TEST_ASSERT_UINT32_WITHIN(1, 300, n);
    for (uint32_t i = 1; i < n; ++i) {
        TEST_ASSERT_FLOAT_WITHIN(2e-3f, 0.1f, at[i].x - at[i - 1].x);
    }
    gfx_world_destroy(world);
}

// Frames between steps show moments between them, whoever asked for which before.
static void test_moments(void) {
    gfx_world *world = make_world();
    gfx_emitter_desc d = gfx_emitter_desc_default();
    d.speed[0] = d.speed[1] = 6.0f;
    gfx_emitter e = add_one(world, &d);
    for (int i = 0; i < 10; ++i) {
        gfx_world_step(world, dt);
    }
    const float alpha[] = {1.0f, 0.0f, 0.25f, 1.0f};
    for (int i = 0; i < 4; ++i) {
        gfx_world_set_moment(world, alpha[i]);
        TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0.1f * (9.0f + alpha[i]), only(world, e).y);
    }
    gfx_world_destroy(world);
}

static void test_the_same_bits_on_every_instruction_set(void) {
    gfx_world *world = make_world();
    gfx_emitter_desc d = gfx_emitter_desc_default();
    d.rate = 5000.0f, d.spread = 1.0f, d.drag = 0.7f;
    d.life[0] = 0.3f, d.speed[1] = 9.0f;
    d.shape = GFX_EMIT_SPHERE, d.extent = core_v3(1, 2, 3);
    gfx_emitter e = gfx_emitter_create(world, &d);
    for (int i = 0; i < 90; ++i) {
        gfx_world_step(world, dt);
    }
    static core_vec3 at[CORE_SIMD_SETS][8192];
    uint32_t first = 0;
    core_simd_set before = core_simd_active();
    for (int set = 0; set < CORE_SIMD_SETS; ++set) {
        if (set > (int)core_simd_best() || !core_simd_use((core_simd_set)set)) {
            continue;
        }
        uint32_t n = gfx_emitter_particles(world, e, at[set], 8192);
        first = set ? first : n;
        TEST_ASSERT_EQUAL_UINT32(first, n);
        TEST_ASSERT_EQUAL_MEMORY(at[0], at[set], n * sizeof at[0][0]);
    }
    TEST_ASSERT_GREATER_THAN(2000, first);
    core_simd_use(before);
    gfx_world_destroy(world);
}

// Uniform in the ball: half of its particles within the half of its volume.
static void test_shapes_are_filled_evenly(void) {
    gfx_world *world = make_world();
    gfx_emitter_desc d = gfx_emitter_desc_default();
    d.rate = 0, d.burst = 8000;
    d.speed[0] = d.speed[1] = 0.0f;
    d.extent = core_v3(1, 1, 1);
    static core_vec3 at[8192];
    for (int shape = GFX_EMIT_SPHERE; shape <= GFX_EMIT_BOX; ++shape) {
        d.shape = (gfx_emit_shape)shape;
        gfx_emitter e = gfx_emitter_create(world, &d);
        gfx_world_step(world, dt);
        uint32_t n = gfx_emitter_particles(world, e, at, 8192), inner = 0;
        TEST_ASSERT_EQUAL_UINT32(8000, n);
        for (uint32_t i = 0; i < n; ++i) {
            core_vec3 p = at[i];
            float reach = CORE_MAX(fabsf(p.x), CORE_MAX(fabsf(p.y), fabsf(p.z)));
            reach = shape == GFX_EMIT_SPHERE ? core_v3_length(p) : reach;
            TEST_ASSERT_TRUE(reach < 1.00001f);
            inner += reach < 0.7937005f; // the cube root of a half
        }
        TEST_ASSERT_UINT32_WITHIN(180, 4000, inner); // four standard deviations
    }
    gfx_world_destroy(world);
}

static void test_errors(void) {
    gfx_world *world = make_world();
    gfx_emitter_desc d = gfx_emitter_desc_default();
    d.life[0] = 2.0f;
    TEST_ASSERT_TRUE(core_handle_is_null(gfx_emitter_create(world, &d)));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "life is 2 to 1"));
    d = gfx_emitter_desc_default();
    d.rate = 1e9f;
    TEST_ASSERT_TRUE(core_handle_is_null(gfx_emitter_create(world, &d)));
    d.rate = NAN;
    TEST_ASSERT_TRUE(core_handle_is_null(gfx_emitter_create(world, &d)));
    d = gfx_emitter_desc_default();
    gfx_emitter e = gfx_emitter_create(world, &d);
    TEST_ASSERT_TRUE(gfx_emitter_destroy(world, e));
    TEST_ASSERT_FALSE(gfx_emitter_destroy(world, e));
    TEST_ASSERT_FALSE(gfx_emitter_burst(world, e, 1));
    TEST_ASSERT_EQUAL_UINT32(0, gfx_emitter_particles(world, e, NULL, 0));
    gfx_board_desc b = gfx_board_desc_default();
    TEST_ASSERT_FALSE(gfx_draw_board(world, &b));
    b.text = b.image = "both";
    TEST_ASSERT_FALSE(gfx_draw_board(world, &b));
    gfx_world_destroy(world);
}

// ---- pictures ----

enum { W = 64 };

static gfx_fixture open_dark(void) {
    gfx_fixture f = gfx_fixture_open(W, W, true);
    gfx_world_set_background(f.world, 0, 0, 0);
    gfx_look(f.world, core_v3(0, 0, 10), core_v3(0, 0, 0));
    gfx_camera c = gfx_world_camera(f.world);
    c.ortho_height = 8.0f; // 8 pixels a metre
    gfx_world_set_camera(f.world, &c);
    return f;
}

// The integral of a soft disc: (1 - r^2)^2 over the unit disc is pi / 3.
static void test_a_particle_has_its_size_and_colour(void) {
    gfx_fixture f = open_dark();
    gfx_emitter_desc d = gfx_emitter_desc_default();
    d.size[0] = 4.0f;
    d.color[0][0] = 2.0f, d.color[0][1] = 0.5f, d.color[0][3] = 0.5f;
    d.speed[0] = d.speed[1] = 0.0f;
    add_one(f.world, &d);
    gfx_world_step(f.world, dt);
    float *rgba = gfx_fixture_hdr(&f);
    double sum[2] = {0, 0};
    for (int i = 0; i < W * W; ++i) {
        sum[0] += (double)rgba[4 * i], sum[1] += (double)rgba[4 * i + 1];
    }
    double want = 3.14159265 / 3.0 * 16.0 * 16.0; // radius 16 pixels, colour times coverage is 1
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * want, want, sum[0]);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * want, 0.25 * want, sum[1]);
    core_free(rgba);
    gfx_fixture_close(&f);
}

// Smoke in front of fire hides a part of it, behind it none.
static void test_boards_cover_from_far_to_near(void) {
    for (int order = 0; order < 2; ++order) {
        gfx_fixture f = open_dark();
        gfx_emitter_desc d = gfx_emitter_desc_default();
        d.size[0] = 4.0f, d.speed[0] = d.speed[1] = 0.0f;
        d.position.z = order ? -1.0f : 1.0f;
        d.color[0][0] = 0.0f;
        d.color[0][3] = 0.75f; // covers, no red
        add_one(f.world, &d);
        d.position.z = 0.0f;
        d.color[0][0] = 1.0f, d.color[0][3] = 1.0f;
        add_one(f.world, &d); // red
        gfx_world_step(f.world, dt);
        float *rgba = gfx_fixture_hdr(&f);
        TEST_ASSERT_FLOAT_WITHIN(0.02f, order ? 1.0f : 0.25f, rgba[4 * (32 * W + 32)]);
        core_free(rgba);
        gfx_fixture_close(&f);
    }
}

// A text 2 m high about the origin: lit within 16 rows of the middle, and as wide as it measures.
static void test_text_in_the_world(void) {
    for (int facing = 0; facing < 3; ++facing) {
        gfx_fixture f = open_dark();
        gfx_board_desc d = gfx_board_desc_default();
        d.text = "HH", d.font = "sans", d.height = 2.0f;
        d.facing = (gfx_facing)facing;
        TEST_ASSERT_TRUE(gfx_draw_board(f.world, &d));
        float *rgba = gfx_fixture_hdr(&f);
        int x0 = W, x1 = 0, y0 = W, y1 = 0;
        for (int i = 0; i < W * W; ++i) {
            if (rgba[4 * i] > 0.5f) {
                x0 = CORE_MIN(x0, i % W), x1 = CORE_MAX(x1, i % W);
                y0 = CORE_MIN(y0, i / W), y1 = CORE_MAX(y1, i / W);
            }
        }
        gfx_text_desc t = gfx_text_desc_default();
        gfx_text_box box;
        t.text = "HH", t.font = "sans", t.size = 16.0f; // 2 m at 8 pixels a metre
        TEST_ASSERT_TRUE(gfx_text_measure(f.world, &t, &box));
        TEST_ASSERT_INT_WITHIN(1, 63, x0 + x1); // about the middle
        TEST_ASSERT_TRUE(y0 >= 24 && y1 < 40);
        TEST_ASSERT_TRUE((float)(x1 - x0) < box.width && (float)(x1 - x0) > 0.75f * box.width);
        core_free(rgba);
        gfx_fixture_close(&f);
    }
}

// Everything that is drawn for one frame, with particles and ground: after warm-up a frame takes no
// memory, and without any of it none of its passes and shaders exist.
static void test_frames_allocate_nothing(void) {
    gfx_fixture f = gfx_fixture_open(W, W, false);
    gfx_pen pen = gfx_pen_default();
    gfx_board_desc board = gfx_board_desc_default();
    gfx_text_desc text = gfx_text_desc_default();
    gfx_emitter_desc d = gfx_emitter_desc_default();
    const float white[4] = {1, 1, 1, 1}, heights[9] = {0, 1, 0, 1, 2, 1, 0, 1, 0};
    TEST_ASSERT_TRUE(gfx_world_set(f.world, "shadows", "off")); // their maps are kept
    core_free(gfx_fixture_ldr(&f));
    gfx_device_use before = gfx_device_used(f.device);
    d.rate = 300.0f, d.spread = 1.0f;
    gfx_emitter_create(f.world, &d);
    gfx_terrain_desc ground = gfx_terrain_desc_default();
    ground.heights = (core_heights_data){3, 3, 1, 1, {0, -3, 0}, heights};
    gfx_terrain_create(f.world, &ground);
    board.text = "board", text.text = "Text over the frame", text.font = "sans";
    uint64_t calls = 0;
    for (int i = 0; i < 120; ++i) {
        calls = i == 90 ? core_alloc_count() : calls;
        gfx_world_step(f.world, dt);
        gfx_world_begin_frame(f.world);
        gfx_draw_sphere(f.world, core_v3(0, 0, 0), 1, &pen);
        gfx_draw_board(f.world, &board);
        gfx_text(f.world, &text);
        gfx_round_rect(f.world, 1, 2, 30, 20, 4, 0, white);
        TEST_ASSERT_TRUE_MESSAGE(gfx_device_render(f.device, f.world), core_last_error());
    }
    TEST_ASSERT_EQUAL_UINT64(calls, core_alloc_count());
    gfx_device_use after = gfx_device_used(f.device);
    TEST_ASSERT_EQUAL_UINT32(before.passes + 3, after.passes); // boards, lines, 2D
    gfx_fixture_close(&f);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_frames_allocate_nothing);
    RUN_TEST(test_the_way_solves_the_equation_of_motion);
    RUN_TEST(test_births_and_deaths_keep_the_rate);
    RUN_TEST(test_a_moving_source_leaves_an_even_trail);
    RUN_TEST(test_moments);
    RUN_TEST(test_the_same_bits_on_every_instruction_set);
    RUN_TEST(test_shapes_are_filled_evenly);
    RUN_TEST(test_errors);
    RUN_TEST(test_a_particle_has_its_size_and_colour);
    RUN_TEST(test_boards_cover_from_far_to_near);
    RUN_TEST(test_text_in_the_world);
    return UNITY_END();
}
