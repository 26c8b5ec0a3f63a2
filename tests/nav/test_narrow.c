// Places too narrow for two: streams that meet in a door take turns, nobody waits for ever, nobody
// overlaps.
#include "support/nav_crowd.h"
#include "unity.h"

static crowd c;

void setUp(void) {}
void tearDown(void) {
    nav_world_destroy(c.world);
    core_clear_error();
}

static void streams(int rows, int columns) {
    for (int row = 0; row < rows; row++) {
        for (int k = 0; k < columns; k++) {
            float x = 2 + 0.9f * (float)row, z = 1.5f + 1.1f * (float)k;
            crowd_send(&c, x, z, 24 - x, z);
            crowd_send(&c, 24 - x, z, x, z);
        }
    }
}

static void two_meet_in_a_door(void) {
    crowd_room(&c, 24, 12, 11.6f, 12.4f, 0.8f);
    crowd_send(&c, 4, 6.1f, 20, 6.1f);
    crowd_send(&c, 20, 6.1f, 4, 6.1f);
    crowd_walk(&c, 40, 1);
    crowd_report(&c, "two in a door");
    TEST_ASSERT_EQUAL_INT(2, c.arrived);
    TEST_ASSERT_TRUE(c.overlap <= 0.02f);
    TEST_ASSERT_TRUE(c.time < 1.6f * 16 / 1.5f);
}

static void opposing_streams_share_a_door(void) {
    crowd_room(&c, 24, 12, 11.6f, 12.4f, 0.8f);
    streams(1, 8);
    crowd_walk(&c, 90, 1);
    crowd_report(&c, "8 against 8 in a door of 0.8 m");
    TEST_ASSERT_EQUAL_INT(16, c.arrived);
    TEST_ASSERT_TRUE(c.overlap <= 0.02f);
    TEST_ASSERT_TRUE(c.time < 80);
}

static void a_long_passage_is_used_one_way_at_a_time(void) {
    crowd_room(&c, 24, 12, 6, 18, 1.0f);
    for (int i = 0; i < 4; i++) {
        crowd_send(&c, 1 + (float)i, 4, 23 - (float)i, 4);
        crowd_send(&c, 23 - (float)i, 8, 1 + (float)i, 8);
    }
    crowd_walk(&c, 120, 1);
    crowd_report(&c, "4 against 4 in a passage of 12 m");
    TEST_ASSERT_EQUAL_INT(8, c.arrived);
    TEST_ASSERT_TRUE(c.overlap <= 0.02f);
}

// Wide enough for two streams: no turns are taken, the way is hardly longer than alone.
static void wide_doors_are_no_gates(void) {
    crowd_room(&c, 24, 12, 11.6f, 12.4f, 3.0f);
    crowd_send(&c, 4, 6.1f, 20, 6.1f);
    crowd_send(&c, 20, 6.1f, 4, 6.1f);
    crowd_walk(&c, 40, 1);
    TEST_ASSERT_EQUAL_INT(2, c.arrived);
    TEST_ASSERT_TRUE(c.time < 1.05f * 16 / 1.5f + 0.5f);
}

// Who has arrived makes room and comes back.
static void the_arrived_make_room(void) {
    crowd_room(&c, 24, 12, 30, 30, 3.0f);
    for (int i = 0; i < 14; i++) { // a fence across
        crowd_send(&c, 12, 1 + 0.8f * (float)i, 12, 1 + 0.8f * (float)i);
    }
    crowd_walk(&c, 5, 1);
    TEST_ASSERT_EQUAL_INT(14, c.arrived);
    crowd_send(&c, 6, 6, 18, 6);
    c.arrived = 0;
    crowd_walk(&c, 40, 1);
    crowd_report(&c, "through a fence of the arrived");
    TEST_ASSERT_EQUAL_INT(15, c.arrived);
    TEST_ASSERT_TRUE(c.overlap <= 0.02f);
    for (int i = 0; i < 300; i++) {
        nav_world_step(c.world, 1.0f / 60.0f);
    }
    for (int i = 0; i < 14; i++) {
        core_vec3 p;
        nav_agent_position(c.world, c.agent[i], &p);
        TEST_ASSERT_FLOAT_WITHIN(0.21f, 12, p.x);
        TEST_ASSERT_FLOAT_WITHIN(0.21f, 1 + 0.8f * (float)i, p.z);
    }
}

// A ball rolls through the crowd, straight on: nobody is run over, all arrive.
static void moving_obstacles_are_avoided(void) {
    crowd_room(&c, 30, 12, 40, 40, 3.0f);
    for (int i = 0; i < 10; i++) {
        crowd_send(&c, 2, 1 + (float)i, 28, 1 + (float)i);
    }
    nav_obstacle ball = {{28, 0, 6}, {-2, 0, 0}, 0.8f};
    float nearest = 99;
    for (int step = 0; step < 60 * 40; step++) {
        TEST_ASSERT_TRUE(nav_world_set_obstacles(c.world, &ball, 1));
        nav_world_step(c.world, 1.0f / 60.0f);
        ball.position.x += ball.velocity.x / 60.0f;
        for (int i = 0; i < 10; i++) {
            core_vec3 p;
            nav_agent_position(c.world, c.agent[i], &p);
            nearest = fminf(nearest, hypotf(p.x - ball.position.x, p.z - ball.position.z));
        }
    }
    crowd_measure(&c);
    printf("nearest to the ball: %.3f m of 1.1 m\n", (double)nearest);
    TEST_ASSERT_EQUAL_INT(10, c.arrived);
    TEST_ASSERT_TRUE(nearest >= 1.1f * 0.98f);
    ball.radius = 0;
    TEST_ASSERT_FALSE(nav_world_set_obstacles(c.world, &ball, 1));
    ball.radius = 1, ball.velocity.x = NAN;
    TEST_ASSERT_FALSE(nav_world_set_obstacles(c.world, &ball, 1));
}

// A hundred go to one point: all arrive, nobody pushes on.
static void a_hundred_to_one_point(void) {
    crowd_room(&c, 30, 30, 40, 40, 3.0f);
    for (int i = 0; i < 100; i++) {
        crowd_send(&c, 2 + (float)(i % 10), 10 + (float)(i / 10), 22, 15);
    }
    crowd_walk(&c, 60, 2);
    crowd_report(&c, "a hundred to one point");
    TEST_ASSERT_EQUAL_INT(100, c.arrived);
    TEST_ASSERT_TRUE(c.overlap <= 0.02f);
    float far = 0;
    for (int i = 0; i < 100; i++) { // a disc of that many, at a packing of a quarter
        core_vec3 p;
        nav_agent_position(c.world, c.agent[i], &p);
        far = fmaxf(far, hypotf(p.x - 22, p.z - 15));
    }
    printf("all within %.2f m\n", (double)far);
    TEST_ASSERT_TRUE(far < 0.3f * sqrtf(100 * 4.0f));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(two_meet_in_a_door);
    RUN_TEST(opposing_streams_share_a_door);
    RUN_TEST(a_long_passage_is_used_one_way_at_a_time);
    RUN_TEST(wide_doors_are_no_gates);
    RUN_TEST(the_arrived_make_room);
    RUN_TEST(moving_obstacles_are_avoided);
    RUN_TEST(a_hundred_to_one_point);
    return UNITY_END();
}
