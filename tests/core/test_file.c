#include "core/file.h"

#include <fcntl.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/file_at.h"
#include "core/log.h"
#include "unity.h"

static char root[64];

static char *in_root(const char *inner) {
    static char path[4][4200];
    static int turn;
    turn = (turn + 1) % 4;
    snprintf(path[turn], sizeof path[turn], "%s/%s", root, inner);
    return path[turn];
}

void setUp(void) {
    core_log_set_level(CORE_LOG_ERROR + 1);
    strcpy(root, "build/file-test-XXXXXX");
    TEST_ASSERT_NOT_NULL(mkdtemp(root));
}

void tearDown(void) {
    char command[128];
    snprintf(command, sizeof command, "rm -rf '%s'", root);
    TEST_ASSERT_EQUAL_INT(0, system(command));
}

static void expect_content(const char *path, const char *text) {
    size_t size = 0;
    char *got = core_file_read(path, &size);
    TEST_ASSERT_NOT_NULL_MESSAGE(got, core_last_error());
    TEST_ASSERT_EQUAL_STRING(text, got);
    TEST_ASSERT_EQUAL_UINT64(strlen(text), size);
    core_free(got);
}

static void what_is_written_is_read(void) {
    TEST_ASSERT_TRUE(core_file_write(in_root("a/b//c.txt"), "first", 5));
    expect_content(in_root("a/b/c.txt"), "first");
    TEST_ASSERT_TRUE(core_file_write(in_root("a/b/c.txt"), "", 0));
    expect_content(in_root("a/b/c.txt"), "");
    char *absolute = realpath(root, NULL), path[5000];
    snprintf(path, sizeof path, "%s/x/y", absolute);
    TEST_ASSERT_TRUE(core_file_write(path, "abs", 3));
    expect_content(in_root("x/y"), "abs");
    free(absolute);
    TEST_ASSERT_TRUE(core_file_write("file-test.tmp", "here", 4)); // no folder in the path
    expect_content("file-test.tmp", "here");
    unlink("file-test.tmp");
}

static void large_files_come_back_whole(void) {
    size_t bytes = 3000001;
    uint8_t *data = malloc(bytes);
    for (size_t i = 0; i < bytes; ++i) {
        data[i] = (uint8_t)(i * 31 >> 3);
    }
    TEST_ASSERT_TRUE(core_file_write(in_root("large"), data, bytes));
    size_t size;
    uint8_t *got = core_file_read(in_root("large"), &size);
    TEST_ASSERT_EQUAL_UINT64(bytes, size);
    TEST_ASSERT_EQUAL_MEMORY(data, got, bytes);
    TEST_ASSERT_EQUAL_UINT8(0, got[bytes]);
    core_free(got);
    free(data);
}

static void expect_unreadable(const char *path, const char *why) {
    core_clear_error();
    TEST_ASSERT_NULL(core_file_read(path, NULL));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(core_last_error(), why), core_last_error());
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(core_last_error(), path), core_last_error());
}

static void unreadable_files_say_why(void) {
    TEST_ASSERT_TRUE(core_file_write(in_root("hello.lua"), "x", 1));
    expect_unreadable(in_root("helo.lua"), "no such file, did you mean '");
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "/hello.lua'?"));
    expect_unreadable(in_root("entirely.different"), "no such file");
    TEST_ASSERT_NULL(strstr(core_last_error(), "mean"));
    expect_unreadable(in_root("none/hello.lua"), "its folder does not exist");
    expect_unreadable(root, "it is a folder, expected a file");
    expect_unreadable(in_root("hello.lua/x"), "Not a directory");
    TEST_ASSERT_EQUAL_INT(0, mkfifo(in_root("pipe"), 0600));
    expect_unreadable(in_root("pipe"), "no regular file");
    expect_unreadable("", "cannot open");
    TEST_ASSERT_TRUE(core_file_write(in_root("sparse"), "x", 1));
    TEST_ASSERT_EQUAL_INT(0, truncate(in_root("sparse"), (off_t)1 << 40));
    expect_unreadable(in_root("sparse"), "1099511627776 bytes exceed the limit of 1073741824");
}

// What virtual files rest on: the open itself refuses links, so a file swapped for a link after any
// look at it is refused too.
static void links_are_followed_on_request_only(void) {
    TEST_ASSERT_TRUE(core_file_write(in_root("target"), "text", 4));
    TEST_ASSERT_EQUAL_INT(0, symlink("target", in_root("link")));
    expect_content(in_root("link"), "text");
    TEST_ASSERT_NULL(core_file_read_at(AT_FDCWD, in_root("link"), false, "shown", NULL));
    TEST_ASSERT_EQUAL_STRING("cannot open 'shown': symbolic links are not followed here",
                             core_last_error());
    char *text = core_file_read_at(AT_FDCWD, in_root("target"), false, "shown", NULL);
    TEST_ASSERT_EQUAL_STRING("text", text);
    core_free(text);
}

static void unwritable_files_say_why(void) {
    TEST_ASSERT_TRUE(core_file_write(in_root("file"), "x", 1));
    TEST_ASSERT_FALSE(core_file_write(in_root("file/inside"), "x", 1));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "Not a directory"));
    TEST_ASSERT_FALSE(core_file_write(root, "x", 1));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "Is a directory"));
    TEST_ASSERT_FALSE(core_file_write(in_root("folder/"), "x", 1));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "cannot write '"));
    TEST_ASSERT_FALSE(core_file_write("", "x", 1));
    static char endless[6000];
    memset(endless, 'a', sizeof endless - 1);
    TEST_ASSERT_FALSE(core_file_write(endless, "x", 1));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "too long"));
    expect_content(in_root("file"), "x");
}

// A reader never sees half of a file that is written again and again.
static _Atomic bool writing;
static void *write_in_turns(void *arg) {
    static char text[2][65536];
    memset(text[0], 'a', sizeof text[0]);
    memset(text[1], 'b', sizeof text[1]);
    for (int i = 0; atomic_load(&writing); ++i) {
        core_file_write(arg, text[i & 1], sizeof text[0]);
    }
    return NULL;
}

static void readers_never_see_a_part(void) {
    char path[128];
    snprintf(path, sizeof path, "%s/shared", root);
    static char first[65536];
    memset(first, 'a', sizeof first);
    TEST_ASSERT_TRUE(core_file_write(path, first, sizeof first));
    atomic_store(&writing, true);
    pthread_t thread;
    TEST_ASSERT_EQUAL_INT(0, pthread_create(&thread, NULL, write_in_turns, path));
    int torn = 0;
    for (int i = 0; i < 1000; ++i) {
        size_t size = 0;
        char *got = core_file_read(path, &size);
        torn += !got || size != 65536 || got[0] != got[65535] || got[0] != got[30000];
        core_free(got);
    }
    atomic_store(&writing, false);
    pthread_join(thread, NULL);
    TEST_ASSERT_EQUAL_INT(0, torn);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(what_is_written_is_read);
    RUN_TEST(large_files_come_back_whole);
    RUN_TEST(unreadable_files_say_why);
    RUN_TEST(links_are_followed_on_request_only);
    RUN_TEST(unwritable_files_say_why);
    RUN_TEST(readers_never_see_a_part);
    return UNITY_END();
}
