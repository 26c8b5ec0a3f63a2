// Links that leave a surface, areas of different cost, ways in part: choices against closed forms.
#include <math.h>
#include <string.h>

#include "core/rng.h"
#include "nav/nav.h"
#include "support/nav_boxes.h"
#include "unity.h"

static nav_world *world;

void setUp(void) {
    nav_world_desc desc = nav_world_desc_default();
    world = nav_world_create(&desc);
}
void tearDown(void) {
    nav_world_destroy(world);
    core_clear_error();
}

static nav_mesh_desc level_desc(void) {
    nav_mesh_desc d = nav_mesh_desc_default();
    d.cell_size = 0.1f;
    d.agent_radius = 0.2f;
    d.tile_cells = 32;
    d.bounds = (core_aabb){{0, 0, 0}, {20, 0, 10}};
    return d;
}
static void put(nav_mesh m, uint64_t key, core_vec3 low, core_vec3 high) {
    nav_box b;
    TEST_ASSERT_TRUE(nav_mesh_put(world, m, key, nav_box_soup(&b, low, high)));
}

// Two platforms, 4 m apart.
static nav_mesh platforms(float height) {
    nav_mesh_desc d = level_desc();
    nav_mesh m = nav_mesh_build(world, NULL, &d);
    put(m, 1, core_v3(0, -1, 0), core_v3(8, 0, 10));
    put(m, 2, core_v3(12, -1, 0), core_v3(20, height, 10));
    nav_mesh_update(world, m);
    return m;
}
static uint32_t add_jump(nav_mesh m, float z, float height, float cost, bool both) {
    nav_mesh_link_desc d = nav_mesh_link_desc_default();
    d.start = core_v3(7.5f, 0, z), d.end = core_v3(12.5f, height, z);
    d.cost = cost, d.both_ways = both;
    return nav_mesh_add_link(world, m, &d);
}
static nav_result way(nav_mesh m, core_vec3 a, core_vec3 b, bool partial, core_vec3 *p,
                      uint32_t *link) {
    nav_mesh_query q = nav_mesh_query_default();
    nav_result r;
    q.mesh = m, q.start = a, q.goal = b, q.partial = partial;
    TEST_ASSERT_TRUE(nav_mesh_find_way(world, &q, &r, p, link, 64));
    return r;
}

static void links_join_what_is_apart(void) {
    nav_mesh m = platforms(1);
    core_vec3 a = {2, 0, 2}, b = {18, 1, 2}, p[64];
    uint32_t link[64];
    TEST_ASSERT_EQUAL_INT(NAV_NO_PATH, way(m, a, b, false, p, link).status);
    uint32_t far = add_jump(m, 8, 1, 0, false), near = add_jump(m, 3, 1, 0, false);
    nav_result r = way(m, a, b, false, p, link);
    double legs = 2 * hypot(5.5, 1), jump = hypot(5, 1);
    TEST_ASSERT_EQUAL_INT(NAV_FOUND, r.status);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, legs + jump, r.cost);
    TEST_ASSERT_EQUAL_UINT32(4, r.count);
    TEST_ASSERT_EQUAL_UINT32(near, link[1]);
    TEST_ASSERT_EQUAL_UINT32(NAV_NO_LINK, link[0]);
    TEST_ASSERT_EQUAL_UINT32(NAV_NO_LINK, link[2]);
    TEST_ASSERT_EQUAL_INT(NAV_NO_PATH, way(m, b, a, false, p, link).status); // one way
    TEST_ASSERT_TRUE(nav_mesh_set_link_open(world, m, near, false));
    r = way(m, a, b, false, p, link);
    TEST_ASSERT_EQUAL_UINT32(far, link[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 2 * hypot(5.5, 6) + jump, r.cost);
    nav_mesh_set_link_open(world, m, near, true);
    TEST_ASSERT_TRUE(nav_mesh_remove_link(world, m, near));
    TEST_ASSERT_FALSE(nav_mesh_remove_link(world, m, near));
    way(m, a, b, false, p, link);
    TEST_ASSERT_EQUAL_UINT32(far, link[1]);
    uint32_t back = add_jump(m, 3, 1, 0.5f, true); // cheaper than its length, both ways
    r = way(m, b, a, false, p, link);
    TEST_ASSERT_EQUAL_UINT32(back, link[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, legs + 0.5, r.cost);
}

// A link is taken only where it is shorter; chains of links are found; a cheap one far away wins.
static void links_are_chosen_by_cost(void) {
    core_rng rng = core_rng_make(4, 1);
    nav_mesh_desc d = level_desc();
    nav_mesh m = nav_mesh_build(world, NULL, &d);
    put(m, 1, core_v3(0, -1, 0), core_v3(20, 0, 10));
    nav_mesh_update(world, m);
    enum { LINKS = 5 };
    core_vec3 from[LINKS], to[LINKS];
    float cost[LINKS];
    for (int i = 0; i < LINKS; i++) {
        nav_mesh_link_desc l = nav_mesh_link_desc_default();
        l.start = from[i] = core_v3(1 + 18 * core_rng_float(&rng), 0, 1 + 8 * core_rng_float(&rng));
        l.end = to[i] = core_v3(1 + 18 * core_rng_float(&rng), 0, 1 + 8 * core_rng_float(&rng));
        l.cost = cost[i] = 0.1f + 3 * core_rng_float(&rng);
        nav_mesh_add_link(world, m, &l);
    }
    int used = 0;
    for (int k = 0; k < 60; k++) {
        core_vec3 a = {1 + 18 * core_rng_float(&rng), 0, 1 + 8 * core_rng_float(&rng)};
        core_vec3 b = {1 + 18 * core_rng_float(&rng), 0, 1 + 8 * core_rng_float(&rng)};
        // On open ground every piece is straight: Bellman and Ford over the links' ends.
        double best[LINKS], least = (double)core_v3_length(core_v3_sub(b, a));
        for (int i = 0; i < LINKS; i++) {
            best[i] = (double)core_v3_length(core_v3_sub(from[i], a)) + (double)cost[i];
        }
        for (int round = 0; round < LINKS; round++) {
            for (int i = 0; i < LINKS; i++) {
                for (int j = 0; j < LINKS; j++) {
                    double g = best[j] + (double)core_v3_length(core_v3_sub(from[i], to[j])) +
                               (double)cost[i];
                    best[i] = fmin(best[i], g);
                }
            }
        }
        for (int i = 0; i < LINKS; i++) {
            least = fmin(least, best[i] + (double)core_v3_length(core_v3_sub(b, to[i])));
        }
        core_vec3 p[64];
        uint32_t link[64];
        nav_result r = way(m, a, b, false, p, link);
        TEST_ASSERT_EQUAL_INT(NAV_FOUND, r.status);
        TEST_ASSERT_TRUE(r.cost >= least - 1e-4 && r.cost <= least * 1.02);
        for (uint32_t i = 0; i < r.count; i++) {
            used += link[i] != NAV_NO_LINK;
        }
    }
    TEST_ASSERT_TRUE(used >= 15);
}

static void agents_take_links(void) {
    nav_mesh m = platforms(1);
    add_jump(m, 3, 1, 0, false);
    nav_agent_desc d = nav_agent_desc_default();
    d.position = core_v3(2, 0, 2);
    nav_agent agent = nav_agent_create(world, &d);
    TEST_ASSERT_TRUE(nav_agent_go_on_mesh(world, agent, m, core_v3(18, 1, 2)));
    int on_link = 0, steps = 0;
    core_vec3 p;
    while (nav_agent_status(world, agent) == NAV_AGENT_WALKING && steps < 3000) {
        nav_world_step(world, 1.0f / 60.0f);
        nav_agent_position(world, agent, &p);
        if (nav_agent_link(world, agent) != NAV_NO_LINK && p.x > 8 && p.x < 12) {
            on_link++;
            TEST_ASSERT_FLOAT_WITHIN(0.1f, (p.x - 7.5f) / 5.0f, p.y); // along the link
        }
        steps++;
    }
    TEST_ASSERT_EQUAL_INT(NAV_AGENT_ARRIVED, nav_agent_status(world, agent));
    TEST_ASSERT_TRUE(on_link > 100);
    TEST_ASSERT_FLOAT_WITHIN(0.05f, 1.0f, p.y);
    TEST_ASSERT_TRUE(steps < 60 * (17.0 / 1.5 + 4));
}

// Straight up.
static void ladders(void) {
    nav_mesh_desc d = level_desc();
    nav_mesh m = nav_mesh_build(world, NULL, &d);
    put(m, 1, core_v3(0, -1, 0), core_v3(10, 0, 10));
    put(m, 2, core_v3(10, -1, 0), core_v3(20, 4, 10));
    nav_mesh_update(world, m);
    nav_mesh_link_desc l = nav_mesh_link_desc_default();
    l.start = core_v3(9.5f, 0, 5), l.end = core_v3(10.5f, 4, 5);
    l.kind = NAV_LINK_LADDER, l.both_ways = true, l.user = 77;
    uint32_t id = nav_mesh_add_link(world, m, &l);
    nav_agent_desc a = nav_agent_desc_default();
    a.position = core_v3(15, 4, 5);
    nav_agent agent = nav_agent_create(world, &a);
    nav_agent_go_on_mesh(world, agent, m, core_v3(3, 0, 5));
    for (int i = 0; i < 1500; i++) {
        nav_world_step(world, 1.0f / 60.0f);
    }
    core_vec3 p;
    nav_agent_position(world, agent, &p);
    TEST_ASSERT_EQUAL_INT(NAV_AGENT_ARRIVED, nav_agent_status(world, agent));
    TEST_ASSERT_FLOAT_WITHIN(0.15f, 3, p.x);
    TEST_ASSERT_FLOAT_WITHIN(0.01f, 0, p.y);
    nav_mesh_link_desc back;
    TEST_ASSERT_TRUE(nav_mesh_get_link(world, m, id, &back));
    TEST_ASSERT_EQUAL_UINT64(77, back.user);
    TEST_ASSERT_EQUAL_INT(NAV_LINK_LADDER, back.kind);
}

// ---- areas ----

// Least cost over a border at x = 10 by cutting thirds off: the law of refraction.
static double refracted(core_vec3 a, core_vec3 b, double ca, double cb) {
    double low = 0.2, high = 9.8;
    for (int i = 0; i < 200; i++) {
        double t[2] = {low + (high - low) / 3, high - (high - low) / 3}, f[2];
        for (int k = 0; k < 2; k++) {
            f[k] = ca * hypot(10 - (double)a.x, t[k] - (double)a.z) +
                   cb * hypot((double)b.x - 10, (double)b.z - t[k]);
        }
        low = f[0] < f[1] ? low : t[0];
        high = f[0] < f[1] ? t[1] : high;
    }
    double t = 0.5 * (low + high);
    return ca * hypot(10 - (double)a.x, t - (double)a.z) +
           cb * hypot((double)b.x - 10, (double)b.z - t);
}

static void areas_refract_ways(void) {
    core_rng rng = core_rng_make(8, 1);
    nav_mesh_desc d = level_desc();
    nav_mesh m = nav_mesh_build(world, NULL, &d);
    put(m, 1, core_v3(0, -1, 0), core_v3(20, 0, 10));
    core_aabb mud = {{10, -1, -1}, {21, 1, 11}};
    TEST_ASSERT_TRUE(nav_mesh_mark(world, m, 5, &mud, 3));
    nav_mesh_update(world, m);
    float cost[NAV_AREAS] = {0};
    double sum = 0;
    for (int k = 0; k < 100; k++) {
        cost[3] = k % 2 ? 4.0f : 1.5f;
        nav_mesh_query q = nav_mesh_query_default();
        q.mesh = m;
        q.start = core_v3(0.5f + 9 * core_rng_float(&rng), 0, 0.5f + 9 * core_rng_float(&rng));
        q.goal = core_v3(10.5f + 9 * core_rng_float(&rng), 0, 0.5f + 9 * core_rng_float(&rng));
        q.area_cost = cost;
        nav_result r;
        TEST_ASSERT_TRUE(nav_mesh_find_way(world, &q, &r, NULL, NULL, 0));
        double least = refracted(q.start, q.goal, 1, (double)cost[3]);
        TEST_ASSERT_EQUAL_INT(NAV_FOUND, r.status);
        TEST_ASSERT_TRUE(r.cost >= least * (1 - 1e-3) && r.cost <= least * 1.02);
        sum += r.cost / least - 1;
    }
    TEST_ASSERT_TRUE(sum / 100 < 0.002);
}

// A strip of mud between: through it when it is cheap, round it when not, never when it is closed.
static void areas_are_gone_round(void) {
    nav_mesh_desc d = level_desc();
    nav_mesh m = nav_mesh_build(world, NULL, &d);
    put(m, 1, core_v3(0, -1, 0), core_v3(20, 0, 10));
    core_aabb mud = {{9, -1, -1}, {11, 1, 8}};
    nav_mesh_mark(world, m, 5, &mud, 3);
    nav_mesh_update(world, m);
    const float costs[3] = {1.2f, 20.0f, INFINITY};
    nav_mesh_query q = nav_mesh_query_default();
    q.mesh = m, q.start = core_v3(5, 0, 2), q.goal = core_v3(15, 0, 2);
    double through = 8 + 2 * 1.2, round = 2 * hypot(4, 6) + 2;
    for (int k = 0; k < 3; k++) {
        float cost[NAV_AREAS] = {0};
        cost[3] = costs[k];
        q.area_cost = cost;
        nav_result r;
        core_vec3 p[64];
        TEST_ASSERT_TRUE(nav_mesh_find_way(world, &q, &r, p, NULL, 64));
        TEST_ASSERT_EQUAL_INT(NAV_FOUND, r.status);
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * round, k ? round : through, r.cost);
        for (uint32_t i = 0; k && i < r.count; i++) {
            TEST_ASSERT_FALSE(p[i].x > 9.01f && p[i].x < 10.99f && p[i].z < 7.9f);
        }
    }
    mud.max.z = 11; // all across: no way when it may not be walked
    nav_mesh_mark(world, m, 5, &mud, 3);
    nav_mesh_update(world, m);
    float cost[NAV_AREAS] = {0};
    cost[3] = INFINITY;
    q.area_cost = cost;
    nav_result r;
    core_vec3 p[64];
    nav_mesh_find_way(world, &q, &r, p, NULL, 64);
    TEST_ASSERT_EQUAL_INT(NAV_NO_PATH, r.status);
    q.partial = true;
    nav_mesh_find_way(world, &q, &r, p, NULL, 64);
    TEST_ASSERT_EQUAL_INT(NAV_PARTIAL, r.status);
    TEST_ASSERT_FLOAT_WITHIN(0.11f, 9.0f, p[r.count - 1].x);
    cost[3] = -1;
    TEST_ASSERT_FALSE(nav_mesh_find_way(world, &q, &r, p, NULL, 64));
    cost[3] = NAN;
    TEST_ASSERT_FALSE(nav_mesh_find_way(world, &q, &r, p, NULL, 64));
}

// ---- ways in part ----

static void partial_ways_end_nearest(void) {
    nav_mesh m = platforms(0);
    core_vec3 p[64];
    nav_result r = way(m, core_v3(2, 0, 2), core_v3(18, 0, 9), true, p, NULL);
    TEST_ASSERT_EQUAL_INT(NAV_PARTIAL, r.status);
    core_vec3 end = p[r.count - 1];
    TEST_ASSERT_FLOAT_WITHIN(0.11f, 7.8f, end.x);
    TEST_ASSERT_FLOAT_WITHIN(0.01f, 9, end.z);
    TEST_ASSERT_DOUBLE_WITHIN(0.15, hypot(5.8, 7), r.cost);
    r = way(m, core_v3(2, 0, 2), core_v3(10, 0, 5), true, p, NULL); // in the gap
    TEST_ASSERT_EQUAL_INT(NAV_PARTIAL, r.status);
    r = way(m, core_v3(2, 0, 2), core_v3(-50, 0, 5), true, p, NULL); // far off
    TEST_ASSERT_EQUAL_INT(NAV_PARTIAL, r.status);
    TEST_ASSERT_FLOAT_WITHIN(0.11f, 0.2f, p[r.count - 1].x);
    TEST_ASSERT_EQUAL_INT(NAV_NO_PATH,
                          way(m, core_v3(2, 0, 2), core_v3(-50, 0, 5), false, p, NULL).status);
    r = way(m, core_v3(10, 0, 5), core_v3(2, 0, 2), true, p, NULL); // starts nowhere
    TEST_ASSERT_EQUAL_INT(NAV_NO_PATH, r.status);
}

static void bad_links(void) {
    nav_mesh m = platforms(0);
    nav_mesh_link_desc d = {0};
    TEST_ASSERT_EQUAL_UINT32(NAV_NO_LINK, nav_mesh_add_link(world, m, &d));
    d = nav_mesh_link_desc_default();
    d.cost = -1;
    TEST_ASSERT_EQUAL_UINT32(NAV_NO_LINK, nav_mesh_add_link(world, m, &d));
    d.cost = NAN;
    TEST_ASSERT_EQUAL_UINT32(NAV_NO_LINK, nav_mesh_add_link(world, m, &d));
    d.cost = 0;
    d.start.y = INFINITY;
    TEST_ASSERT_EQUAL_UINT32(NAV_NO_LINK, nav_mesh_add_link(world, m, &d));
    d.start = core_v3(500, 0, 0); // far from the surface: kept, never walked
    TEST_ASSERT_EQUAL_UINT32(0, nav_mesh_add_link(world, m, &d));
    TEST_ASSERT_FALSE(nav_mesh_set_link_open(world, m, 1, true));
    core_vec3 p[64];
    TEST_ASSERT_EQUAL_INT(NAV_NO_PATH,
                          way(m, core_v3(2, 0, 2), core_v3(18, 0, 2), false, p, NULL).status);
    TEST_ASSERT_EQUAL_INT(NAV_FOUND,
                          way(m, core_v3(2, 0, 2), core_v3(2, 0, 2), false, p, NULL).status);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(links_join_what_is_apart);
    RUN_TEST(links_are_chosen_by_cost);
    RUN_TEST(agents_take_links);
    RUN_TEST(ladders);
    RUN_TEST(areas_refract_ways);
    RUN_TEST(areas_are_gone_round);
    RUN_TEST(partial_ways_end_nearest);
    RUN_TEST(bad_links);
    return UNITY_END();
}
