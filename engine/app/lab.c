// `corsac lab`: hands over to the Python instrument beside the program.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "app/commands.h"
#include "core/base.h"

#define MAX_WORDS 256

// The folder two levels up from this program's file: the tree's root (build/corsac) or the prefix.
static bool root_of_program(char *out, size_t size) {
    ssize_t n = readlink("/proc/self/exe", out, size - 1);
    if (n <= 0) {
        return core_fail("corsac lab: cannot find out where this program lies");
    }
    out[n] = 0;
    for (int up = 0; up < 2; up++) {
        char *slash = strrchr(out, '/');
        if (slash) {
            *slash = 0;
        }
    }
    return true;
}

int app_command_lab(int argc, const char *const *argv) {
    char root[3072], python[4096], script[4096], self[4096];
    if (!root_of_program(root, sizeof root)) {
        return 5;
    }
    snprintf(python, sizeof python, "%s/build/venv/bin/python3", root);
    snprintf(script, sizeof script, "%s/tools/lab", root);
    snprintf(self, sizeof self, "%s/build/corsac", root);
    if (access(python, X_OK) != 0 || access(script, R_OK) != 0) {
        core_fail(
            "corsac lab: needs the source tree with its Python environment (%s); run `make lab` "
            "there once, which makes it",
            python);
        return 5;
    }
    const char *words[MAX_WORDS + 3] = {python, script};
    int n = 2;
    for (int i = 0; i < argc && n < MAX_WORDS; i++) {
        words[n++] = argv[i];
    }
    setenv("CORSAC", self, 0);
    execv(python, (char *const *)words);
    core_fail("corsac lab: cannot start %s", python);
    return 5;
}
