#include "core/vfs.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/file.h"
#include "core/log.h"
#include "unity.h"

// root/a holds game files, root/b a later mount, root/secret what must never be reached.
static char root[64];
static core_vfs *vfs;

static char *real(const char *inner) {
    static char path[4][512];
    static int turn;
    turn = (turn + 1) % 4;
    snprintf(path[turn], sizeof path[turn], "%s/%s", root, inner);
    return path[turn];
}

static void put(const char *inner, const char *text) {
    TEST_ASSERT_TRUE(core_file_write(real(inner), text, strlen(text)));
}

static void expect_text(const char *path, const char *text) {
    size_t size = 0;
    char *got = core_vfs_read(vfs, path, &size);
    TEST_ASSERT_NOT_NULL_MESSAGE(got, core_last_error());
    TEST_ASSERT_EQUAL_STRING(text, got);
    TEST_ASSERT_EQUAL_UINT64(strlen(text), size);
    core_free(got);
}

static void expect_refused(const char *path, const char *why) {
    core_clear_error();
    TEST_ASSERT_NULL(core_vfs_read(vfs, path, NULL));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(core_last_error(), why), core_last_error());
    TEST_ASSERT_FALSE(core_vfs_exists(vfs, path));
    TEST_ASSERT_EQUAL_UINT64(0, core_vfs_stamp(vfs, path));
    char out[4200];
    TEST_ASSERT_FALSE(core_vfs_resolve(vfs, path, out, sizeof out));
}

void setUp(void) {
    core_log_set_level(CORE_LOG_ERROR + 1);
    strcpy(root, "build/vfs-test-XXXXXX");
    TEST_ASSERT_NOT_NULL(mkdtemp(root));
    put("a/one.txt", "one of a");
    put("a/models/fox.cmesh", "fox");
    put("a/models/deep/er/leaf", "leaf");
    put("b/one.txt", "one of b");
    put("secret/key", "SECRET");
    vfs = core_vfs_create();
    TEST_ASSERT_TRUE(core_vfs_mount(vfs, real("a"), "", false));
}

void tearDown(void) {
    core_vfs_destroy(vfs);
    char command[128];
    snprintf(command, sizeof command, "rm -rf '%s'", root);
    TEST_ASSERT_EQUAL_INT(0, system(command));
}

static void reads_through_normal_forms(void) {
    expect_text("one.txt", "one of a");
    expect_text("./models//fox.cmesh", "fox");
    expect_text("models/deep/er/leaf", "leaf");
}

static void dots_lead_nowhere(void) {
    expect_refused("../secret/key", "'..'");
    expect_refused("models/../one.txt", "'..'");
    expect_refused("..", "'..'");
    expect_refused("models/..", "'..'");
    expect_text("one.txt", "one of a");
    put("a/..dots", "a name that only begins like it");
    expect_text("..dots", "a name that only begins like it");
}

static void absolute_paths_lead_nowhere(void) {
    char *absolute = realpath(real("a/one.txt"), NULL);
    expect_refused(absolute, "is absolute");
    expect_refused("/etc/passwd", "is absolute");
    expect_refused("//one.txt", "is absolute");
    free(absolute);
}

static void links_lead_nowhere(void) {
    TEST_ASSERT_EQUAL_INT(0, symlink("../secret", real("a/out")));
    TEST_ASSERT_EQUAL_INT(0, symlink("../secret/key", real("a/key")));
    TEST_ASSERT_EQUAL_INT(0, symlink("one.txt", real("a/inside")));
    expect_refused("out/key", "'out' is a symbolic link");
    expect_refused("out", "'out' is a symbolic link");
    expect_refused("key", "'key' is a symbolic link");
    expect_refused("inside", "'inside' is a symbolic link");
    char *names = core_vfs_list(vfs, "");
    TEST_ASSERT_EQUAL_STRING("models\none.txt", names);
    core_free(names);
    TEST_ASSERT_NULL(core_vfs_list(vfs, "out"));
}

static void special_files_are_refused_without_waiting(void) {
    TEST_ASSERT_EQUAL_INT(0, mkfifo(real("a/pipe"), 0600));
    expect_refused("pipe", "no file 'pipe'");
    TEST_ASSERT_NULL(core_vfs_read(vfs, "models", NULL));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "it is a folder"));
}

static void long_paths_are_refused(void) {
    char path[3000];
    memset(path, 'a', sizeof path - 1);
    path[sizeof path - 1] = '\0';
    expect_refused(path, "too long");
    path[300] = '\0';
    expect_refused(path, "too long");
    for (int i = 0; i < 2000; i += 2) {
        memcpy(path + i, "a/", 3);
    }
    expect_refused(path, "too long");
    path[CORE_VFS_PATH_MAX - 1] = '\0';
    expect_refused(path, "no file");
}

static void missing_names_get_the_nearest(void) {
    expect_refused("One.TXT", "did you mean 'one.txt'?");
    expect_refused("models/fix.cmesh", "did you mean 'models/fox.cmesh'?");
    expect_refused("modles/fox.cmesh", "did you mean 'models'?");
    expect_refused("models/deep/re/leaf", "did you mean 'models/deep/er'?");
    expect_refused("entirely/else", "no file 'entirely/else' in the mounted folders (");
    TEST_ASSERT_NULL(strstr(core_last_error(), "mean"));
}

static void later_mounts_hide_earlier_ones(void) {
    TEST_ASSERT_TRUE(core_vfs_mount(vfs, real("b"), "", false));
    expect_text("one.txt", "one of b");
    expect_text("models/fox.cmesh", "fox");
    TEST_ASSERT_TRUE(core_vfs_mount(vfs, real("b"), "mods//b/", false));
    expect_text("mods/b/one.txt", "one of b");
    expect_refused("modsb/one.txt", "no file");
    char *names = core_vfs_list(vfs, "mods");
    TEST_ASSERT_EQUAL_STRING("b", names);
    core_free(names);
    names = core_vfs_list(vfs, "");
    TEST_ASSERT_EQUAL_STRING("models\nmods\none.txt", names);
    core_free(names);
    TEST_ASSERT_FALSE(core_vfs_mount(vfs, real("none"), "", false));
    TEST_ASSERT_FALSE(core_vfs_mount(vfs, real("a/one.txt"), "", false));
    TEST_ASSERT_FALSE(core_vfs_mount(vfs, real("b"), "../up", false));
}

static void writes_stay_in_writable_mounts(void) {
    TEST_ASSERT_FALSE(core_vfs_write(vfs, "new.txt", "x", 1));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "no folder is mounted writable"));
    TEST_ASSERT_TRUE(core_vfs_mount(vfs, real("b"), "save", true));
    TEST_ASSERT_TRUE(core_vfs_write(vfs, "save/x/y/z.bin", "1\0002", 3));
    size_t size = 0;
    char *got = core_file_read(real("b/x/y/z.bin"), &size);
    TEST_ASSERT_NOT_NULL(got);
    TEST_ASSERT_EQUAL_UINT64(3, size);
    TEST_ASSERT_EQUAL_INT('2', got[2]);
    core_free(got);
    TEST_ASSERT_FALSE(core_vfs_write(vfs, "save/../a/new.txt", "x", 1));
    TEST_ASSERT_FALSE(core_vfs_write(vfs, "save", "x", 1));
    TEST_ASSERT_FALSE(core_vfs_write(vfs, "save/one.txt/x", "x", 1));
    TEST_ASSERT_FALSE(core_vfs_write(vfs, "save/x", "x", 1));
    // Through a link that leads out: refused as a folder, replaced as a file.
    TEST_ASSERT_EQUAL_INT(0, symlink("../secret", real("b/out")));
    TEST_ASSERT_EQUAL_INT(0, symlink("../secret/key", real("b/key")));
    TEST_ASSERT_FALSE(core_vfs_write(vfs, "save/out/key", "hacked", 6));
    TEST_ASSERT_TRUE(core_vfs_write(vfs, "save/key", "mine", 4));
    expect_text("save/key", "mine");
    got = core_file_read(real("secret/key"), &size);
    TEST_ASSERT_EQUAL_STRING("SECRET", got);
    core_free(got);
    char *names = core_vfs_list(vfs, "save"); // and no temporary file is left
    TEST_ASSERT_EQUAL_STRING("key\none.txt\nx", names);
    core_free(names);
}

static void resolve_gives_the_real_path(void) {
    char out[4200];
    TEST_ASSERT_TRUE(core_vfs_resolve(vfs, "models/fox.cmesh", out, sizeof out));
    char *expected = realpath(real("a/models/fox.cmesh"), NULL);
    TEST_ASSERT_EQUAL_STRING(expected, out);
    free(expected);
    TEST_ASSERT_FALSE(core_vfs_resolve(vfs, "models/fox.cmesh", out, 10));
}

static void stamps_follow_the_file(void) {
    uint64_t before = core_vfs_stamp(vfs, "one.txt");
    TEST_ASSERT_TRUE(before != 0);
    TEST_ASSERT_EQUAL_UINT64(before, core_vfs_stamp(vfs, "one.txt"));
    put("a/one.txt", "one of A");
    uint64_t changed = core_vfs_stamp(vfs, "one.txt");
    TEST_ASSERT_TRUE(changed != before && changed != 0);
    TEST_ASSERT_EQUAL_INT(0, unlink(real("a/one.txt")));
    TEST_ASSERT_EQUAL_UINT64(0, core_vfs_stamp(vfs, "one.txt"));
}

static void what_was_read_is_watched(void) {
    char path[CORE_VFS_PATH_MAX];
    size_t size;
    core_free(core_vfs_read(vfs, "models/fox.cmesh", &size)); // before: not remembered
    core_vfs_watch(vfs);
    core_free(core_vfs_read(vfs, "./one.txt", &size));
    TEST_ASSERT_FALSE(core_vfs_changed(vfs, path));
    put("a/models/fox.cmesh", "another fox");
    TEST_ASSERT_FALSE(core_vfs_changed(vfs, path));
    put("a/one.txt", "one of A");
    TEST_ASSERT_TRUE(core_vfs_changed(vfs, path));
    TEST_ASSERT_EQUAL_STRING("one.txt", path);
    TEST_ASSERT_FALSE(core_vfs_changed(vfs, path)); // told once
    TEST_ASSERT_EQUAL_INT(0, unlink(real("a/one.txt")));
    TEST_ASSERT_FALSE(core_vfs_changed(vfs, path)); // perhaps it is being written
    TEST_ASSERT_TRUE(core_vfs_mount(vfs, real("b"), "", false));
    TEST_ASSERT_TRUE(core_vfs_changed(vfs, path)); // another file hides it
}

// A second thread keeps swapping a folder or file for a link that leads out.
typedef struct swap {
    char path[256], away[256];
    const char *target;
} swap;

static _Atomic bool swapping;
static void *swap_in_turns(void *arg) {
    const swap *s = arg;
    while (atomic_load(&swapping)) {
        rename(s->path, s->away);
        if (symlink(s->target, s->path) != 0) {
            break;
        }
        unlink(s->path);
        rename(s->away, s->path);
    }
    return NULL;
}

static void read_while_swapping(const char *name, const char *target) {
    swap s = {.target = target};
    snprintf(s.path, sizeof s.path, "%s", real(name));
    snprintf(s.away, sizeof s.away, "%s", real("a/away"));
    atomic_store(&swapping, true);
    pthread_t thread;
    TEST_ASSERT_EQUAL_INT(0, pthread_create(&thread, NULL, swap_in_turns, &s));
    int harmless = 0, refused = 0, secret = 0, reads = 0;
    for (; reads < 20000 || (refused == 0 && reads < 1000000); ++reads) {
        char *got = core_vfs_read(vfs, "swap/key", NULL);
        harmless += got && strcmp(got, "harmless") == 0;
        secret += got && strcmp(got, "SECRET") == 0;
        refused += !got;
        core_free(got);
    }
    atomic_store(&swapping, false);
    pthread_join(thread, NULL);
    TEST_ASSERT_EQUAL_INT(0, secret);
    TEST_ASSERT_EQUAL_INT(reads, harmless + refused);
    TEST_ASSERT_GREATER_THAN_INT(0, refused); // the race did happen
}

static void a_folder_swapped_for_a_link_leads_nowhere(void) {
    put("a/swap/key", "harmless");
    read_while_swapping("a/swap", "../secret");
}

static void a_file_swapped_for_a_link_leads_nowhere(void) {
    put("a/swap/key", "harmless");
    read_while_swapping("a/swap/key", "../../secret/key");
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(reads_through_normal_forms);
    RUN_TEST(dots_lead_nowhere);
    RUN_TEST(absolute_paths_lead_nowhere);
    RUN_TEST(links_lead_nowhere);
    RUN_TEST(special_files_are_refused_without_waiting);
    RUN_TEST(long_paths_are_refused);
    RUN_TEST(missing_names_get_the_nearest);
    RUN_TEST(what_was_read_is_watched);
    RUN_TEST(later_mounts_hide_earlier_ones);
    RUN_TEST(writes_stay_in_writable_mounts);
    RUN_TEST(resolve_gives_the_real_path);
    RUN_TEST(stamps_follow_the_file);
    RUN_TEST(a_folder_swapped_for_a_link_leads_nowhere);
    RUN_TEST(a_file_swapped_for_a_link_leads_nowhere);
    return UNITY_END();
}
