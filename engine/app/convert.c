// `corsac convert`: hands over to corsac-convert, which links assimp so that this program need not.
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "app/commands.h"
#include "core/base.h"

#define MAX_WORDS 64

int app_command_convert(int argc, const char *const *argv) {
    char path[4096];
    ssize_t n = readlink("/proc/self/exe", path, sizeof path - 32);
    path[n > 0 ? n : 0] = 0;
    char *slash = strrchr(path, '/');
    snprintf(slash ? slash + 1 : path, 32, "corsac-convert");
    const char *words[MAX_WORDS + 2] = {"corsac-convert"};
    for (int i = 0; i < argc && i < MAX_WORDS; i++) {
        words[i + 1] = argv[i];
    }
    execv(path, (char *const *)words);
    core_fail("corsac convert: cannot start %s; build it with `make`, or install corsac-convert "
              "beside this program",
              path);
    return 5;
}
