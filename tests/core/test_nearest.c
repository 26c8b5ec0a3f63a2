#include "core/nearest.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static void distances(void) {
    TEST_ASSERT_EQUAL_UINT32(0, core_name_distance("steps", "steps"));
    TEST_ASSERT_EQUAL_UINT32(0, core_name_distance("STEPS", "steps"));
    TEST_ASSERT_EQUAL_UINT32(5, core_name_distance("", "steps"));
    TEST_ASSERT_EQUAL_UINT32(5, core_name_distance("steps", ""));
    TEST_ASSERT_EQUAL_UINT32(1, core_name_distance("step", "steps"));
    TEST_ASSERT_EQUAL_UINT32(1, core_name_distance("setps", "steps"));
    TEST_ASSERT_EQUAL_UINT32(3, core_name_distance("kitten", "sitting"));
    TEST_ASSERT_EQUAL_UINT32(3, core_name_distance("ca", "abc"));
}

static void nearest_of_a_list(void) {
    const char *names[] = {"steps", "seconds", "seed", NULL, "step"};
    TEST_ASSERT_EQUAL_STRING("steps", core_nearest("stepz", names, 5));
    TEST_ASSERT_EQUAL_STRING("seed", core_nearest("sede", names, 5));
    TEST_ASSERT_EQUAL_STRING("steps", core_nearest("step", names, 5));
    TEST_ASSERT_NULL(core_nearest("quaternion", names, 5));
    TEST_ASSERT_NULL(core_nearest("x", names, 5));
    TEST_ASSERT_NULL(core_nearest("steps", names, 0));
}

static void a_beginning_is_completed(void) {
    const char *names[] = {"energy_j", "penetration_mean_m", "penetration_max_m"};
    TEST_ASSERT_EQUAL_STRING("penetration_mean_m", core_nearest("Penetration", names, 3));
    TEST_ASSERT_EQUAL_STRING("penetration_max_m", core_nearest("penetration_max", names, 3));
    TEST_ASSERT_NULL(core_nearest("pe", names, 3));
    TEST_ASSERT_NULL(core_nearest("", names, 3));
}

static void long_names_are_safe(void) {
    char a[300], b[300];
    for (int i = 0; i < 299; i++) {
        a[i] = 'a';
        b[i] = 'b';
    }
    a[299] = b[299] = 0;
    TEST_ASSERT_EQUAL_UINT32(63, core_name_distance(a, b));
    TEST_ASSERT_EQUAL_UINT32(0, core_name_distance(a, a));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(distances);
    RUN_TEST(nearest_of_a_list);
    RUN_TEST(a_beginning_is_completed);
    RUN_TEST(long_names_are_safe);
    return UNITY_END();
}
