// Triangle meshes: what slides over inner edges, rests, is shot at them, asks about them; and what
// is refused.
#include "core/hash.h"
#include "core/log.h"
#include "core/rng.h"
#include "phys/phys.h"
#include "unity.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SIDE 65u // corners along a side of the grid

static phys_world *world;
static float place[3 * SIDE * SIDE];
static uint32_t corner[6 * (SIDE - 1) * (SIDE - 1)];
static uint8_t area[2 * (SIDE - 1) * (SIDE - 1)];

void setUp(void) {
    phys_world_desc d = phys_world_desc_default();
    world = phys_world_create(&d);
}
void tearDown(void) { phys_world_destroy(world); }

static float pick(core_rng *rng, float lo, float hi) {
    return lo + (hi - lo) * core_rng_float(rng);
}

static float flat(float x, float z) {
    (void)x;
    (void)z;
    return 0.0f;
}
static float valley(float x, float z) {
    (void)z;
    return x < 0 ? -x : x;
}
static float ridge(float x, float z) { return -valley(x, z); }

// A square of side 32 m in cells of 0.5 m, diagonals in turn, front up.
static core_soup_data grid(float (*height)(float, float)) {
    uint32_t n = 0;
    for (uint32_t j = 0; j < SIDE; j++) {
        for (uint32_t i = 0; i < SIDE; i++) {
            float *p = place + 3 * (j * SIDE + i);
            p[0] = 0.5f * ((float)i - 32.0f);
            p[2] = 0.5f * ((float)j - 32.0f);
            p[1] = height(p[0], p[2]);
        }
    }
    for (uint32_t j = 0; j + 1 < SIDE; j++) {
        for (uint32_t i = 0; i + 1 < SIDE; i++) {
            uint32_t a = j * SIDE + i, b = a + 1, c = a + SIDE, d = c + 1;
            bool other = ((i + j) & 1u) != 0;
            uint32_t cell[6] = {a, c, other ? d : b, other ? a : b, other ? d : c, other ? b : d};
            memcpy(corner + n, cell, sizeof cell);
            n += 6;
        }
    }
    return (core_soup_data){SIDE * SIDE, n / 3, place, corner, NULL};
}

static phys_body add_mesh(const core_soup_data *soup, core_vec3 at, core_quat turn) {
    phys_body_desc d = phys_body_desc_default();
    d.type = PHYS_STATIC;
    d.position = at;
    d.rotation = turn;
    phys_shape_desc s = phys_shape_desc_default(PHYS_MESH);
    s.mesh = soup;
    s.friction = 0.0f;
    return phys_body_create(world, &d, &s, 1);
}

static const float gem[] = {0.5f, 0,     0, -0.5f, 0, 0,    0, 0.5f, 0,
                            0,    -0.5f, 0, 0,     0, 0.5f, 0, 0,    -0.5f};
static phys_body add(phys_shape_type type, core_vec3 at, core_vec3 v, float friction) {
    phys_body_desc d = phys_body_desc_default();
    d.position = at;
    d.velocity = v;
    phys_shape_desc s = phys_shape_desc_default(type);
    s.radius = 0.5f;
    s.half_height = 0.5f;
    s.half = core_v3(0.5f, 0.25f, 0.5f);
    s.points = gem;
    s.point_count = 6;
    s.friction = friction;
    return phys_body_create(world, &d, &s, 1);
}
static core_vec3 at(phys_body b) {
    core_vec3 p = {0, 0, 0};
    phys_body_position(world, b, &p);
    return p;
}
static core_vec3 speed(phys_body b) {
    core_vec3 v = {0, 0, 0};
    phys_body_velocity(world, b, &v);
    return v;
}
static void run(int steps) {
    for (int i = 0; i < steps; i++) {
        TEST_ASSERT_TRUE(phys_world_step(world, 1.0f / 60.0f));
    }
}

// Without friction on a flat floor of 8,192 triangles: straight on, at one height, at one speed.
static void slides_straight(phys_shape_type type, float height, core_vec3 v) {
    core_soup_data soup = grid(flat);
    add_mesh(&soup, core_v3(0, 0, 0), core_quat_identity());
    phys_body b = add(type, core_v3(-12, height, -6), v, 0.0f);
    float most = 0.0f, low = 1e9f, high = -1e9f, turn = 0.0f;
    for (int i = 0; i < 240; i++) {
        run(1);
        core_vec3 p = at(b), o;
        phys_body_angular_velocity(world, b, &o);
        float aside = (p.x + 12) * v.z - (p.z + 6) * v.x;
        most = fmaxf(most, fabsf(aside) / core_v3_length(v));
        turn = fmaxf(turn, core_v3_length(o));
        low = i > 10 ? fminf(low, p.y) : low;
        high = i > 10 ? fmaxf(high, p.y) : high;
    }
    float lost = core_v3_length(v) - core_v3_length(speed(b));
    TEST_ASSERT_TRUE(most < 1e-4f);
    TEST_ASSERT_TRUE(high - low < 2e-4f);
    TEST_ASSERT_TRUE(fabsf(lost) < 1e-3f);
    TEST_ASSERT_TRUE(turn < 1e-3f);
}
static void test_ball_slides_straight(void) {
    slides_straight(PHYS_SPHERE, 0.5f, core_v3(5, 0, 2.3f));
}
static void test_box_slides_straight(void) {
    slides_straight(PHYS_BOX, 0.25f, core_v3(5, 0, 2.3f));
}
static void test_cylinder_slides_straight(void) {
    slides_straight(PHYS_CYLINDER, 0.5f, core_v3(4, 0, -1.1f));
}

// Every kind comes to rest on the floor, at its height, and tells of one touch.
static void test_every_kind_rests(void) {
    static const phys_shape_type type[] = {PHYS_SPHERE, PHYS_BOX, PHYS_CAPSULE, PHYS_CYLINDER,
                                           PHYS_HULL};
    static const float low[] = {0.5f, 0.25f, 0.5f, 0.5f, 0.288675f};
    core_soup_data soup = grid(flat);
    core_quat turn = {0.1825742f, 0.3651484f, 0.5477226f, 0.7302967f};
    phys_body_desc d = phys_body_desc_default();
    core_vec3 up = core_quat_rotate(turn, core_v3(0, 1, 0));
    phys_world_set_gravity(world, core_v3_scale(up, -9.81f));
    d.type = PHYS_STATIC;
    d.rotation = turn;
    d.contact_events = true;
    phys_shape_desc s = phys_shape_desc_default(PHYS_MESH);
    s.mesh = &soup;
    phys_body_create(world, &d, &s, 1);
    phys_body body[5];
    uint32_t begun = 0;
    for (int k = 0; k < 5; k++) {
        core_vec3 p = core_quat_rotate(turn, core_v3(2.3f * (float)k - 5, 1.2f, 0.13f));
        body[k] = add(type[k], p, core_v3(0, 0, 0), 0.6f);
        phys_body_set_rotation(world, body[k], k == 4 ? core_quat_identity() : turn);
    }
    for (int i = 0; i < 400; i++) {
        uint32_t n;
        run(1);
        const phys_event *e = phys_world_events(world, &n);
        for (uint32_t k = 0; k < n; k++) {
            begun += e[k].kind == PHYS_CONTACT_BEGIN;
        }
    }
    for (int k = 0; k < 5; k++) {
        core_vec3 p = at(body[k]);
        float h = core_v3_dot(p, up);
        TEST_ASSERT_TRUE(core_v3_length(speed(body[k])) < 2e-3f);
        TEST_ASSERT_FLOAT_WITHIN(type[k] == PHYS_HULL ? 0.02f : 1.5e-3f,
                                 low[k] + (type[k] == PHYS_CAPSULE && h > 0.9f ? 0.5f : 0.0f), h);
    }
    TEST_ASSERT_TRUE(begun >= 5 && begun <= 12); // a hop or two, never one a triangle
    phys_accuracy a;
    phys_world_accuracy(world, &a);
    TEST_ASSERT_TRUE(a.penetration_max_m < 1.5e-3);
}

// In a valley of right angle a ball touches both sides; on a ridge a box lies on its edge.
static void test_valley_and_ridge(void) {
    core_soup_data soup = grid(valley);
    add_mesh(&soup, core_v3(0, 0, 0), core_quat_identity());
    phys_body ball = add(PHYS_SPHERE, core_v3(0.02f, 0.9f, 0.2f), core_v3(0, 0, 0), 0.5f);
    run(200);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 0.5f * 1.41421356f, at(ball).y);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 0.0f, at(ball).x);
    core_soup_data hill = grid(ridge);
    add_mesh(&hill, core_v3(0, 0, 100), core_quat_identity());
    phys_body box = add(PHYS_BOX, core_v3(0.0f, 0.255f, 100.1f), core_v3(0, 0, 0), 0.5f);
    run(30);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 0.25f, at(box).y);
}

// Every kind at 10 .. 800 m/s against a wall of triangles of no thickness,
// spinning: none behind.
static void test_nothing_passes(void) {
    core_soup_data soup = grid(flat);
    core_quat upright = {0.70710678f, 0, 0, 0.70710678f};
    core_rng rng = core_rng_make(7, 1);
    phys_world_set_gravity(world, core_v3(0, 0, 0));
    add_mesh(&soup, core_v3(0, 0, 0), upright); // in the plane z = 0
    static const phys_shape_type type[] = {PHYS_SPHERE, PHYS_BOX, PHYS_CAPSULE, PHYS_CYLINDER,
                                           PHYS_HULL};
    phys_body body[50];
    for (int k = 0; k < 50; k++) {
        float v = 10.0f * (float)(1 + k * 8 % 80), sign = k % 2 ? 1.0f : -1.0f;
        core_vec3 from = {pick(&rng, -12, 12), pick(&rng, -12, 12),
                          sign * (1.0f + pick(&rng, 0, 30))};
        body[k] = add(type[k % 5], from, core_v3(pick(&rng, -2, 2), 0, -sign * v), 0.5f);
        phys_body_set_angular_velocity(world, body[k], core_v3(pick(&rng, -40, 40), 5, 30));
        phys_body_set_layer(world, body[k], 1);
    }
    phys_world_set_rule(world, 1, 1, false);
    int behind = 0;
    for (int i = 0; i < 30; i++) {
        run(1);
        for (int k = 0; k < 50; k++) {
            core_vec3 p = at(body[k]);
            if (fabsf(p.x) < 16 && fabsf(p.y) < 16 && p.z * (k % 2 ? 1.0f : -1.0f) < 0.0f &&
                i < 89) {
                static int c[200];
                if (!c[k]++)
                    printf("%d kind %d step %d %g %g %g v %d\n", k, type[k % 5], i, p.x, p.y, p.z,
                           10 * (1 + k * 8 % 80));
            }
            behind += fabsf(p.x) < 16 && fabsf(p.y) < 16 && p.z * (k % 2 ? 1.0f : -1.0f) < 0.0f;
        }
    }
    TEST_ASSERT_EQUAL_INT(0, behind);
}

// Two triangles of 14 km: a box slides on them and rests as on small ones.
static void test_very_large_triangles(void) {
    static const float p[] = {-1e4f, 0, -1e4f, 1e4f, 0, -1e4f, 1e4f, 0, 1e4f, -1e4f, 0, 1e4f};
    static const uint32_t i[] = {0, 2, 1, 0, 3, 2};
    core_soup_data soup = {4, 2, p, i, NULL};
    add_mesh(&soup, core_v3(0, 0, 0), core_quat_identity());
    phys_body box = add(PHYS_BOX, core_v3(300, 0.5f, 300.2f), core_v3(0, 0, 0), 0.5f);
    phys_body ball = add(PHYS_SPHERE, core_v3(-2000, 0.6f, 170), core_v3(3, 0, 0), 0.0f);
    run(240);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 0.25f, at(box).y);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 0.5f, at(ball).y);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 3.0f, speed(ball).x);
    TEST_ASSERT_FLOAT_WITHIN(2e-2f, -1988.0f, at(ball).x);
}

// Sunk to just above its middle, every kind is pushed out to the side that it is on, gently.
static void test_deep_ones_come_out(void) {
    static const phys_shape_type type[] = {PHYS_SPHERE, PHYS_BOX, PHYS_CAPSULE, PHYS_CYLINDER,
                                           PHYS_HULL};
    core_soup_data soup = grid(flat);
    add_mesh(&soup, core_v3(0, 0, 0), core_quat_identity());
    phys_body body[5];
    for (int k = 0; k < 5; k++) {
        body[k] = add(type[k], core_v3(3.1f * (float)k - 6, 0.05f, 0.2f), core_v3(0, 0, 0), 0.5f);
    }
    float top = 0.0f;
    for (int i = 0; i < 300; i++) {
        run(1);
        for (int k = 0; k < 5; k++) {
            top = fmaxf(top, at(body[k]).y);
        }
    }
    for (int k = 0; k < 5; k++) {
        TEST_ASSERT_TRUE(at(body[k]).y > 0.24f);
    }
    TEST_ASSERT_TRUE(top < 1.3f);
}

// From behind a one-sided mesh things pass; from the front they do not.
static void test_one_sided(void) {
    core_soup_data soup = grid(flat);
    phys_body_desc d = phys_body_desc_default();
    d.type = PHYS_STATIC;
    phys_shape_desc s = phys_shape_desc_default(PHYS_MESH);
    s.mesh = &soup;
    s.one_sided = true;
    phys_body_create(world, &d, &s, 1);
    phys_body up = add(PHYS_BOX, core_v3(0.1f, -2, 0.2f), core_v3(0, 12, 0), 0.5f);
    phys_body down = add(PHYS_SPHERE, core_v3(4.1f, 30, 0.2f), core_v3(0, -90, 0), 0.5f);
    run(30);
    TEST_ASSERT_TRUE(at(up).y > 1.0f);
    run(270);
    TEST_ASSERT_FLOAT_WITHIN(2e-3f, 0.25f, at(up).y);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 0.5f, at(down).y);
    phys_hit h;
    phys_filter all = phys_filter_default();
    TEST_ASSERT_TRUE(phys_world_ray(world, core_v3(9, 1, 9), core_v3(0, -2, 0), &all, &h));
    TEST_ASSERT_FALSE(phys_world_ray(world, core_v3(9, -1, 9), core_v3(0, 2, 0), &all, &h));
}

static void test_questions(void) {
    core_soup_data soup = grid(valley);
    core_quat turn = {0, 0.38268343f, 0, 0.92387953f}; // 45 degrees about y
    phys_body mesh = add_mesh(&soup, core_v3(3, 1, 2), turn);
    phys_hit h;
    core_rng rng = core_rng_make(3, 1);
    for (int k = 0; k < 500; k++) { // every vertical ray hits, edges and corners too
        core_vec3 l = {pick(&rng, -15, 15), 20, pick(&rng, -15, 15)};
        l.x = k % 3 == 0 ? 0.5f * roundf(2 * l.x) : l.x;
        l.z = k % 2 == 0 ? 0.5f * roundf(2 * l.z) : l.z;
        core_vec3 o = core_v3_add(core_v3(3, 1, 2), core_quat_rotate(turn, l));
        TEST_ASSERT_TRUE(phys_world_ray(world, o, core_v3(0, -40, 0), NULL, &h));
        TEST_ASSERT_FLOAT_WITHIN(1e-4f, 1 + fabsf(l.x), h.point.y);
        const uint32_t *t = corner + 3 * h.triangle;
        TEST_ASSERT_TRUE(h.triangle < soup.triangle_count && place[3 * t[0]] - 0.51f < l.x &&
                         l.x < place[3 * t[0]] + 0.51f);
    }
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0.70710678f, h.normal.y);
    phys_shape_desc ball = phys_shape_desc_default(PHYS_SPHERE);
    ball.radius = 0.5f;
    core_vec3 from = core_v3(3, 11, 2);
    TEST_ASSERT_TRUE(
        phys_world_cast(world, &ball, from, core_quat_identity(), core_v3(0, -20, 0), NULL, &h));
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, (10.0f - 0.70710678f) / 20.0f, h.fraction);
    TEST_ASSERT_TRUE(core_handle_equal(mesh, h.body));
    phys_body found;
    core_vec3 over = core_v3(3, 1.72f, 2), in = core_v3(3, 1.69f, 2);
    TEST_ASSERT_EQUAL_UINT32(
        0, phys_world_overlap(world, &ball, over, core_quat_identity(), NULL, &found, 1));
    TEST_ASSERT_EQUAL_UINT32(
        1, phys_world_overlap(world, &ball, in, core_quat_identity(), NULL, &found, 1));
    TEST_ASSERT_TRUE(phys_world_closest(world, core_v3(3, 4, 2), 50, NULL, &h));
    TEST_ASSERT_FLOAT_WITHIN(1e-4f, 3.0f * 0.70710678f, h.fraction);
    TEST_ASSERT_FALSE(phys_world_closest(world, core_v3(3, 4, 2), 2.0f, NULL, &h));
}

// Ice in one half, rubber in the other.
static void test_materials(void) {
    core_soup_data soup = grid(flat);
    for (uint32_t t = 0; t < soup.triangle_count; t++) {
        area[t] = place[3 * corner[3 * t]] < 0 ? 0 : 1;
    }
    soup.area = area;
    static const phys_material material[] = {{.friction = 0}, {.friction = 1, .restitution = 0.8f}};
    phys_body_desc d = phys_body_desc_default();
    d.type = PHYS_STATIC;
    phys_shape_desc s = phys_shape_desc_default(PHYS_MESH);
    s.mesh = &soup;
    s.materials = material;
    s.material_count = 2;
    phys_body_create(world, &d, &s, 1);
    phys_body ice = add(PHYS_BOX, core_v3(-12, 0.25f, 4), core_v3(2, 0, 0), 1.0f);
    phys_body rubber = add(PHYS_BOX, core_v3(6, 0.25f, 4), core_v3(2, 0, 0), 1.0f);
    phys_body bounce = add(PHYS_SPHERE, core_v3(6, 2.5f, -6), core_v3(0, 0, 0), 1.0f);
    float top = 0;
    run(40);
    for (int i = 0; i < 80; i++) {
        run(1);
        top = fmaxf(top, at(bounce).y);
    }
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 2.0f, speed(ice).x);
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 0.0f, speed(rubber).x);
    TEST_ASSERT_FLOAT_WITHIN(0.02f, 6.0f + 4.0f / (2 * 9.81f), at(rubber).x); // v^2 / 2 mu g
    TEST_ASSERT_FLOAT_WITHIN(0.03f, 0.5f + 0.64f * 2.0f, top);
}

static bool refused(const core_soup_data *soup, const char *why) {
    phys_body_desc d = phys_body_desc_default();
    d.type = PHYS_STATIC;
    phys_shape_desc s = phys_shape_desc_default(PHYS_MESH);
    s.mesh = soup;
    phys_body b = phys_body_create(world, &d, &s, 1);
    return core_handle_is_null(b) && strstr(core_last_error(), why) != NULL;
}

static void test_bad_meshes_are_refused(void) {
    float p[] = {0, 0, 0, 1, 0, 0, 0, 0, 1, 2, 0, 0};
    uint32_t i[] = {0, 1, 2, 0, 1, 3};
    core_soup_data soup = {4, 2, p, i, NULL};
    TEST_ASSERT_TRUE(refused(NULL, "no triangles given"));
    soup.triangle_count = 0;
    TEST_ASSERT_TRUE(refused(&soup, "no triangles given"));
    soup.triangle_count = (1u << 24) + 1;
    TEST_ASSERT_TRUE(refused(&soup, "16777217 triangles, expected at most 16777216"));
    soup.triangle_count = 2;
    i[4] = 4;
    TEST_ASSERT_TRUE(refused(&soup, "triangle 1 names vertex 4, expected less than 4"));
    i[4] = 1;
    p[7] = NAN;
    TEST_ASSERT_TRUE(refused(&soup, "vertex 2 is at (0, nan, 1), expected finite"));
    p[7] = 0;
    i[2] = 3;
    TEST_ASSERT_TRUE(refused(&soup, "none of 2 triangles has an area"));
    i[2] = 2; // the second triangle is a line: left out
    phys_body_desc d = phys_body_desc_default();
    phys_shape_desc s = phys_shape_desc_default(PHYS_MESH);
    s.mesh = &soup;
    TEST_ASSERT_TRUE(core_handle_is_null(phys_body_create(world, &d, &s, 1)));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "only static bodies can have one"));
    d.type = PHYS_STATIC;
    TEST_ASSERT_TRUE(phys_body_alive(world, phys_body_create(world, &d, &s, 1)));
    phys_shape_view v;
    TEST_ASSERT_TRUE(phys_world_shape(world, 0, &v));
    TEST_ASSERT_EQUAL_UINT32(1, v.triangle_count);
}

// Equal soups are kept once; memory comes back.
static void test_memory_is_counted(void) {
    core_soup_data soup = grid(flat);
    size_t none = phys_world_bytes(world);
    phys_body a = add_mesh(&soup, core_v3(0, 0, 0), core_quat_identity());
    size_t one = phys_world_bytes(world);
    phys_body b = add_mesh(&soup, core_v3(0, 9, 0), core_quat_identity());
    size_t two = phys_world_bytes(world);
    TEST_ASSERT_TRUE(one - none > 8192 * 28 && one - none < 8192 * 120);
    TEST_ASSERT_TRUE(two - one < 4096);
    phys_body_destroy(world, a);
    phys_body_destroy(world, b);
    TEST_ASSERT_TRUE(phys_world_bytes(world) < one - 8192 * 28);
}

static uint64_t state_hash(void) {
    const core_columns *set[16];
    uint64_t h = 0, column[CORE_COLUMNS_MAX];
    int n = phys_world_state(world, set, 16);
    for (int i = 0; i < n; i++) {
        core_columns_hash(set[i], column);
        for (uint32_t k = 0; k < set[i]->column_count; k++) {
            h = core_hash_mix(h, column[k]);
        }
    }
    return h;
}

static float bumps(float x, float z) { return 0.6f * core_sinf(x * 0.9f) * core_cosf(z * 0.7f); }

// A heap on bumpy ground: goes on with the same bits after a restore, and nothing sinks.
static void test_restored_heap_steps_on(void) {
    core_soup_data soup = grid(bumps);
    core_rng rng = core_rng_make(11, 1);
    add_mesh(&soup, core_v3(0, 0, 0), core_quat_identity());
    for (int k = 0; k < 40; k++) {
        static const phys_shape_type type[] = {PHYS_SPHERE, PHYS_BOX, PHYS_CAPSULE, PHYS_CYLINDER,
                                               PHYS_HULL};
        core_vec3 p = {pick(&rng, -4, 4), 1.5f + 0.4f * (float)k, pick(&rng, -4, 4)};
        add(type[k % 5], p, core_v3(0, 0, 0), 0.5f);
    }
    run(90);
    size_t size = phys_world_save_size(world);
    void *saved = malloc(size);
    phys_world_save(world, saved);
    run(60);
    uint64_t want = state_hash();
    TEST_ASSERT_TRUE(phys_world_restore(world, saved, size));
    run(60);
    TEST_ASSERT_EQUAL_HEX64(want, state_hash());
    free(saved);
    run(120);
    for (uint32_t i = 0; i < phys_body_count(world); i++) {
        core_vec3 p = at(phys_body_at(world, i));
        TEST_ASSERT_TRUE(fabsf(p.x) > 16 || fabsf(p.z) > 16 || p.y >= bumps(p.x, p.z) - 0.01f);
    }
    phys_accuracy a;
    phys_world_accuracy(world, &a);
    TEST_ASSERT_TRUE(a.penetration_max_m < 0.03 && a.penetration_mean_m < 0.001);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_ball_slides_straight);
    RUN_TEST(test_box_slides_straight);
    RUN_TEST(test_cylinder_slides_straight);
    RUN_TEST(test_every_kind_rests);
    RUN_TEST(test_valley_and_ridge);
    RUN_TEST(test_nothing_passes);
    RUN_TEST(test_very_large_triangles);
    RUN_TEST(test_deep_ones_come_out);
    RUN_TEST(test_one_sided);
    RUN_TEST(test_questions);
    RUN_TEST(test_materials);
    RUN_TEST(test_bad_meshes_are_refused);
    RUN_TEST(test_memory_is_counted);
    RUN_TEST(test_restored_heap_steps_on);
    return UNITY_END();
}
