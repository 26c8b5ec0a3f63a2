#include "support/accuracy.h"

#include "unity.h"

#include <stdio.h>

void accuracy_at_most(const char *name, double value, double bound, const char *unit) {
    printf("accuracy: {\"name\": \"%s\", \"value\": %.9g, \"bound\": %.9g, \"unit\": \"%s\"}\n",
           name, value, bound, unit);
    TEST_ASSERT_TRUE_MESSAGE(value <= bound, name);
}
