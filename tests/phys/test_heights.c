// Fields of heights: against the same triangles as a mesh, against their own formula, what rests
// and rolls on them, holes, materials, what is shot at them, cloth and movers on them, bad input.
#include "core/log.h"
#include "phys/phys.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 33 };
static phys_world *w;
static float height[SIDE * SIDE];
static core_heights_data field;
static uint64_t seed;

static float random_in(float lo, float hi) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return lo + (hi - lo) * ((float)(seed >> 40) / 16777216.0f);
}

void setUp(void) {
    phys_world_desc d = phys_world_desc_default();
    w = phys_world_create(&d);
    seed = 5;
    memset(height, 0, sizeof height);
    field = (core_heights_data){SIDE, SIDE, 0.5f, 0.5f, {-8, 0, -8}, height};
}
void tearDown(void) { phys_world_destroy(w); }

static void make_hills(void) {
    for (int z = 0; z < SIDE; z++) {
        for (int x = 0; x < SIDE; x++) {
            height[z * SIDE + x] =
                sinf(0.4f * (float)x) * cosf(0.3f * (float)z) + random_in(-0.1f, 0.1f);
        }
    }
}
static phys_body add_field(const uint8_t *cells) {
    phys_shape_desc s = phys_shape_desc_default(PHYS_MESH);
    s.heights = &field;
    s.cells = cells;
    phys_body_desc b = phys_body_desc_default();
    b.type = PHYS_STATIC;
    return phys_body_create(w, &b, &s, 1);
}
static phys_body add(phys_shape_type type, core_vec3 at, float size, core_vec3 v) {
    phys_shape_desc s = phys_shape_desc_default(type);
    s.radius = s.half_height = size;
    s.half = core_v3(size, size, size);
    phys_body_desc b = phys_body_desc_default();
    b.position = at;
    b.velocity = v;
    return phys_body_create(w, &b, &s, 1);
}
static core_vec3 at(phys_body b) {
    core_vec3 p = {0, 0, 0};
    phys_body_position(w, b, &p);
    return p;
}
static void run(int steps) {
    for (int i = 0; i < steps; i++) {
        TEST_ASSERT_TRUE(phys_world_step(w, 1.0f / 60.0f));
    }
}

// Height of the surface, from the two triangles of the cell.
static double surface(double x, double z) {
    double u = (x + 8) / 0.5, v = (z + 8) / 0.5;
    int i = (int)u, j = (int)v;
    double a = u - i, b = v - j;
    double h00 = (double)height[j * SIDE + i], h11 = (double)height[(j + 1) * SIDE + i + 1];
    double h10 = (double)height[j * SIDE + i + 1], h01 = (double)height[(j + 1) * SIDE + i];
    return b > a ? h00 + b * (h01 - h00) + a * (h11 - h01)
                 : h00 + a * (h10 - h00) + b * (h11 - h10);
}

static void test_rays_meet_the_surface(void) {
    make_hills();
    add_field(NULL);
    double worst = 0;
    for (int i = 0; i < 2000; i++) {
        float x = random_in(-7.99f, 7.99f), z = random_in(-7.99f, 7.99f);
        phys_hit h;
        TEST_ASSERT_TRUE(phys_world_ray(w, core_v3(x, 5, z), core_v3(0, -10, 0), NULL, &h));
        worst = fmax(worst, fabs((double)h.point.y - surface((double)x, (double)z)));
        TEST_ASSERT_TRUE(h.normal.y > 0);
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0, worst);
    phys_hit h;
    TEST_ASSERT_FALSE(phys_world_ray(w, core_v3(8.1f, 5, 0), core_v3(0, -10, 0), NULL, &h));
}

// The same triangles as a mesh give the same answers, slanted rays and closest points included.
static void test_it_answers_as_a_mesh(void) {
    make_hills();
    phys_world *fields = w;
    phys_body body = add_field(NULL);
    phys_shape_view v;
    TEST_ASSERT_TRUE(phys_world_shape(w, 0, &v));
    uint32_t count = phys_shape_triangles(&v, 0.01f, 1, NULL, 0);
    TEST_ASSERT_EQUAL_UINT32(2 * (SIDE - 1) * (SIDE - 1), count);
    core_vec3 *corner = malloc(3 * count * sizeof *corner);
    uint32_t *index = malloc(3 * count * sizeof *index);
    phys_shape_triangles(&v, 0.01f, 1, corner, count);
    for (uint32_t i = 0; i < 3 * count; i++) {
        index[i] = i;
    }
    core_soup_data soup = {3 * count, count, &corner[0].x, index, NULL};
    setUp();
    phys_shape_desc s = phys_shape_desc_default(PHYS_MESH);
    s.mesh = &soup;
    phys_body_desc b = phys_body_desc_default();
    b.type = PHYS_STATIC;
    TEST_ASSERT_FALSE(core_handle_is_null(phys_body_create(w, &b, &s, 1)));
    for (int i = 0; i < 1000; i++) {
        core_vec3 from = core_v3(random_in(-8, 8), random_in(-2, 3), random_in(-8, 8));
        core_vec3 way = core_v3(random_in(-9, 9), random_in(-9, 9), random_in(-9, 9));
        phys_hit one, other;
        bool a = phys_world_ray(fields, from, way, NULL, &one);
        TEST_ASSERT_EQUAL(a, phys_world_ray(w, from, way, NULL, &other));
        TEST_ASSERT_FLOAT_WITHIN(1e-5f, one.fraction, other.fraction);
        a = phys_world_closest(fields, from, 2, NULL, &one);
        TEST_ASSERT_EQUAL(a, phys_world_closest(w, from, 2, NULL, &other));
        TEST_ASSERT_FLOAT_WITHIN(1e-4f, one.fraction, other.fraction);
    }
    TEST_ASSERT_TRUE(phys_body_destroy(fields, body));
    phys_world_destroy(fields);
    free(corner);
    free(index);
}

static void test_every_shape_rests_on_it(void) {
    add_field(NULL);
    static const phys_shape_type type[] = {PHYS_SPHERE, PHYS_BOX, PHYS_CYLINDER, PHYS_CAPSULE};
    static const float rest[] = {0.3f, 0.3f, 0.3f, 0.6f};
    phys_body b[4];
    for (int i = 0; i < 4; i++) {
        b[i] = add(type[i], core_v3(-6.0f + 3.0f * (float)i, 0.8f, 0.1f), 0.3f, core_v3(0, 0, 0));
    }
    run(240);
    for (int i = 0; i < 4; i++) {
        TEST_ASSERT_FLOAT_WITHIN(i == 3 ? 0.31f : 0.003f, rest[i], at(b[i]).y);
        TEST_ASSERT_TRUE(at(b[i]).y > 0.295f);
    }
}

// A ball that rolls and a box that slides over the inner edges of level ground keep straight.
static void test_nothing_stumbles_over_inner_edges(void) {
    add_field(NULL);
    phys_body ball = add(PHYS_SPHERE, core_v3(-7, 0.2f, 0.13f), 0.2f, core_v3(6, 0, 0));
    phys_body box = add(PHYS_BOX, core_v3(-7, 0.2f, 3.17f), 0.2f, core_v3(6, 0, 0));
    float high = 0;
    for (int i = 0; i < 60; i++) {
        run(1);
        high = fmaxf(high, fmaxf(at(ball).y, at(box).y));
    }
    printf("over inner edges: ball z %.5f, box z %.5f, highest %.5f\n", (double)at(ball).z - 0.13,
           (double)at(box).z - 3.17, (double)high - 0.2);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 0.13f, at(ball).z);
    TEST_ASSERT_FLOAT_WITHIN(3e-3f, 3.17f, at(box).z);
    TEST_ASSERT_FLOAT_WITHIN(2e-3f, 0.2f, high);
}

static void test_holes_let_through_and_materials_hold(void) {
    uint8_t cells[(SIDE - 1) * (SIDE - 1)] = {0};
    for (int z = 14; z < 18; z++) {
        for (int x = 14; x < 18; x++) {
            cells[z * (SIDE - 1) + x] = PHYS_HOLE;
        }
    }
    for (int z = 0; z < 8; z++) { // along the near border: ice
        memset(cells + z * (SIDE - 1), 1, SIDE - 1);
    }
    phys_material material[2] = {{.friction = 0.8f}, {.friction = 0}};
    phys_shape_desc s = phys_shape_desc_default(PHYS_MESH);
    s.heights = &field;
    s.cells = cells;
    s.materials = material;
    s.material_count = 2;
    phys_body_desc d = phys_body_desc_default();
    d.type = PHYS_STATIC;
    phys_body_create(w, &d, &s, 1);
    phys_body falls = add(PHYS_SPHERE, core_v3(0, 1, 0), 0.3f, core_v3(0, 0, 0));
    phys_body stays = add(PHYS_SPHERE, core_v3(3, 1, 3), 0.3f, core_v3(0, 0, 0));
    phys_body ice = add(PHYS_BOX, core_v3(-7, 0.2f, -6), 0.2f, core_v3(3, 0, 0));
    phys_body rough = add(PHYS_BOX, core_v3(-7, 0.2f, 5), 0.2f, core_v3(3, 0, 0));
    run(120);
    TEST_ASSERT_TRUE(at(falls).y < -2);
    TEST_ASSERT_FLOAT_WITHIN(0.003f, 0.3f, at(stays).y);
    TEST_ASSERT_FLOAT_WITHIN(0.1f, -1.0f, at(ice).x); // 3 m/s for 2 s
    TEST_ASSERT_TRUE(at(rough).x < -6.2f);
    phys_hit h;
    TEST_ASSERT_FALSE(phys_world_ray(w, core_v3(0, 5, 0), core_v3(0, -10, 0), NULL, &h));
}

static void test_no_speed_takes_anything_through(void) {
    make_hills();
    add_field(NULL);
    phys_body b[60];
    for (int i = 0; i < 60; i++) {
        core_vec3 from = core_v3(random_in(-6, 6), 8, random_in(-6, 6));
        phys_shape_type type = i % 3 == 0 ? PHYS_SPHERE : i % 3 == 1 ? PHYS_BOX : PHYS_CAPSULE;
        core_vec3 v = core_v3(random_in(-20, 20), -random_in(50, 500), random_in(-20, 20));
        b[i] = add(type, from, 0.1f, v);
        phys_body_set_layer(w, b[i], 1);
    }
    phys_world_set_rule(w, 1, 1, false);
    run(40);
    for (int i = 0; i < 60; i++) {
        core_vec3 p = at(b[i]);
        if (fabsf(p.x) < 7.5f && fabsf(p.z) < 7.5f) {
            TEST_ASSERT_TRUE((double)p.y > surface((double)p.x, (double)p.z) - 0.02);
        }
    }
}

static void test_cloth_and_movers_on_it(void) {
    make_hills();
    add_field(NULL);
    phys_cloth_desc d = phys_cloth_desc_default();
    d.columns = d.rows = 20;
    d.origin = core_v3(-2, 1.6f, -2);
    d.across = core_v3(2, 0, 0);
    d.down = core_v3(0, 0, 2);
    phys_cloth cloth = phys_cloth_create(w, &d);
    phys_mover_desc m = phys_mover_desc_default();
    m.position = core_v3(4, 3, 0);
    phys_mover mover = phys_mover_create(w, &m);
    phys_mover_walk(w, mover, core_v3(-1, 0, 0.5f));
    double deepest = -1, low = 1;
    for (int i = 0; i < 240; i++) {
        run(1);
        phys_cloth_view v;
        phys_cloth_read(w, cloth, &v);
        for (uint32_t k = 0; k < v.count; k++) {
            deepest = fmax(deepest, surface((double)v.x[k], (double)v.z[k]) - (double)v.y[k]);
        }
        phys_mover_state s;
        phys_mover_read(w, mover, &s);
        low = fmin(low, (double)s.position.y - 0.9 -
                            surface((double)s.position.x, (double)s.position.z));
    }
    printf("heights: cloth %.2f mm into the surface, mover's soles at %.2f mm\n", deepest * 1e3,
           low * 1e3);
    TEST_ASSERT_TRUE(deepest < -0.005);
    TEST_ASSERT_TRUE(low > -1e-3);
}

static void test_bad_input_is_refused(void) {
    height[40] = NAN;
    TEST_ASSERT_TRUE(core_handle_is_null(add_field(NULL)));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "point (7, 1)"));
    height[40] = 0;
    field.columns = 1;
    TEST_ASSERT_TRUE(core_handle_is_null(add_field(NULL)));
    field.columns = SIDE;
    field.step_x = 0;
    TEST_ASSERT_TRUE(core_handle_is_null(add_field(NULL)));
    field.step_x = 0.5f;
    phys_body body = add_field(NULL);
    TEST_ASSERT_FALSE(core_handle_is_null(body));
    TEST_ASSERT_TRUE(phys_body_destroy(w, body));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_rays_meet_the_surface);
    RUN_TEST(test_it_answers_as_a_mesh);
    RUN_TEST(test_every_shape_rests_on_it);
    RUN_TEST(test_nothing_stumbles_over_inner_edges);
    RUN_TEST(test_holes_let_through_and_materials_hold);
    RUN_TEST(test_no_speed_takes_anything_through);
    RUN_TEST(test_cloth_and_movers_on_it);
    RUN_TEST(test_bad_input_is_refused);
    return UNITY_END();
}
