// Clustered against plain forward up to 8,192 lights, on the report's hall: difference zero.
#include "support/gfx_fixture.h"

#include "core/rng.h"
#include "support/accuracy.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>

void setUp(void) {}
void tearDown(void) {}

enum { WIDTH = 160, HEIGHT = 90 };

static float difference(uint32_t lights, const char *method) {
    gfx_fixture f = gfx_fixture_open(WIDTH, HEIGHT, true);
    core_rng rng = core_rng_make(1, 1);
    gfx_add(f.world, "box", core_v3(0, -0.5f, 0), core_v3(100, 1, 100), 0.8f, 0.8f, 0.8f);
    for (int i = 0; i < 200; ++i) {
        float x = core_rng_float(&rng), z = core_rng_float(&rng), side = 1 + core_rng_float(&rng);
        gfx_add(f.world, "box", core_v3(100 * x - 50, side, 100 * z - 50),
                core_v3(side, 2 * side, side), 0.9f, 0.8f, 0.7f);
    }
    for (uint32_t i = 0; i < lights; ++i) {
        float x = core_rng_float(&rng), y = core_rng_float(&rng), z = core_rng_float(&rng);
        gfx_add_point(f.world, core_v3(100 * x - 50, 10 * y, 100 * z - 50), 5.0f, 3.0f);
    }
    gfx_look(f.world, core_v3(0, 3, 50), core_v3(0, 1, 0));
    TEST_ASSERT_TRUE(gfx_world_set(f.world, "assign", method));
    TEST_ASSERT_TRUE(gfx_world_set(f.world, "render", "forward"));
    float *forward = gfx_fixture_hdr(&f);
    TEST_ASSERT_TRUE(gfx_world_set(f.world, "render", "clustered"));
    float *clustered = gfx_fixture_hdr(&f);
    float worst = gfx_max_difference(forward, clustered, WIDTH * HEIGHT * 4);
    printf("%u lights, %s: largest difference %g\n", lights, method, (double)worst);
    core_free(forward);
    core_free(clustered);
    gfx_fixture_close(&f);
    return worst;
}

static void test_many_lights(void) {
    const uint32_t counts[] = {512, 2048, 8192};
    double worst = 0.0;
    for (size_t i = 0; i < CORE_COUNT_OF(counts); ++i) {
        worst = fmax(worst, (double)difference(counts[i], "simd"));
    }
    accuracy_at_most("gfx: clustered against plain forward, 512 to 8,192 lights", worst, 0.0,
                     "radiance");
    TEST_ASSERT_EQUAL_FLOAT(0.0f, difference(2048, "naive"));
    TEST_ASSERT_EQUAL_FLOAT(0.0f, difference(2048, "per_light"));
    TEST_ASSERT_EQUAL_FLOAT(0.0f, difference(2048, "gpu"));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_many_lights);
    return UNITY_END();
}
