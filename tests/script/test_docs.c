// docs/api.md and the editor stubs are what the tables say now.
#include "script/bind.h"

#include "unity.h"

#include <lauxlib.h>

#include <stdio.h>
#include <string.h>

void setUp(void) {}
void tearDown(void) {}

static void must_equal_file(char *text, const char *path) {
    FILE *file = fopen(path, "rb");
    TEST_ASSERT_NOT_NULL_MESSAGE(file, path);
    size_t size = strlen(text);
    char *have = core_alloc(size + 2);
    size_t got = fread(have, 1, size + 1, file);
    fclose(file);
    bool same = got == size && memcmp(have, text, size) == 0;
    core_free(have);
    core_free(text);
    TEST_ASSERT_TRUE_MESSAGE(same, "the file is stale: run `make docs`");
}

static void test_the_reference_page_is_fresh(void) {
    must_equal_file(bind_docs_markdown(), "docs/api.md");
}
static void test_the_editor_stubs_are_fresh(void) {
    must_equal_file(bind_docs_stubs(), "scripts/types/corsac.lua");
}

static void test_the_editor_stubs_are_lua(void) {
    lua_State *L = luaL_newstate();
    int rc = luaL_loadfile(L, "scripts/types/corsac.lua");
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, rc, lua_tostring(L, -1));
    lua_close(L);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_the_reference_page_is_fresh);
    RUN_TEST(test_the_editor_stubs_are_fresh);
    RUN_TEST(test_the_editor_stubs_are_lua);
    return UNITY_END();
}
