// Ten thousand random walks of movers.
#include "phys/mover_walks.h"

void setUp(void) {}
void tearDown(void) {}

static void test_ten_thousand_walks(void) {
    phys_world_desc d = phys_world_desc_default();
    phys_world *w = phys_world_create(&d);
    random_walks(w, 500);
    phys_world_destroy(w);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_ten_thousand_walks);
    return UNITY_END();
}
