// Large crowds: 1,000 cross a circle through its middle, 200 meet in a corridor.
#include "support/nav_crowd.h"
#include "unity.h"

static crowd c;

void setUp(void) {}
void tearDown(void) { nav_world_destroy(c.world); }

static void a_thousand_cross_a_circle(void) {
    const int n = 1000;
    float radius = (float)n * 1.1f / (2 * CORE_PI_F), side = 2 * radius + 8, middle = side / 2;
    crowd_room(&c, side, side, 2 * side, 2 * side, 3);
    for (int i = 0; i < n; i++) {
        float angle = 2 * CORE_PI_F * (float)i / (float)n;
        float x = radius * core_cosf(angle), z = radius * core_sinf(angle);
        crowd_send(&c, middle + x, middle + z, middle - x, middle - z);
    }
    crowd_walk(&c, 420, 6);
    crowd_report(&c, "1,000 on a circle");
    TEST_ASSERT_EQUAL_INT(n, c.arrived);
    TEST_ASSERT_TRUE(c.overlap <= 0.02f);
    TEST_ASSERT_TRUE(c.time <= 1.5f * 2 * radius / 1.5f);
}

static void two_hundred_meet_in_a_corridor(void) {
    crowd_room(&c, 60, 12, 24, 36, 2.4f);
    for (int i = 0; i < 200; i++) {
        float row = (float)(i / 20), z = 1 + (float)(i % 20 / 2), x = 10.5f - 0.9f * row;
        if (i % 2) {
            crowd_send(&c, x, z, 49.5f - 0.9f * row, z);
        } else {
            crowd_send(&c, 60 - x, z, 10.5f + 0.9f * row, z);
        }
    }
    crowd_walk(&c, 300, 2);
    crowd_report(&c, "200 in a corridor of 2.4 m");
    TEST_ASSERT_EQUAL_INT(200, c.arrived);
    TEST_ASSERT_TRUE(c.overlap <= 0.02f);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(a_thousand_cross_a_circle);
    RUN_TEST(two_hundred_meet_in_a_corridor);
    return UNITY_END();
}
