// `corsac lab`, `corsac tune`: hand over to the Python instrument beside the program.
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

// Replaces this process by Python: with the lab's packages, or with the system's one.
static int run_python(const char *command, const char *script, bool packages, int argc,
                      const char *const *argv) {
    char root[3072], python[4096], path[4096], self[4096];
    if (!root_of_program(root, sizeof root)) {
        return 5;
    }
    snprintf(python, sizeof python, "%s/build/venv/bin/python3", root);
    snprintf(path, sizeof path, "%s/tools/%s", root, script);
    snprintf(self, sizeof self, "%s/build/corsac", root);
    bool own = access(python, X_OK) == 0;
    if (access(path, R_OK) != 0 || (packages && !own)) {
        core_fail("corsac %s: needs the source tree with its Python environment (%s); run `make "
                  "lab` there once, which makes it",
                  command, python);
        return 5;
    }
    const char *words[MAX_WORDS + 3] = {own ? python : "python3", path};
    int n = 2;
    for (int i = 0; i < argc && n < MAX_WORDS; i++) {
        words[n++] = argv[i];
    }
    setenv("CORSAC", self, 0);
    execvp(words[0], (char *const *)words);
    core_fail("corsac %s: cannot start %s", command, words[0]);
    return 5;
}

int app_command_lab(int argc, const char *const *argv) {
    return run_python("lab", "lab", true, argc, argv);
}

int app_command_tune(int argc, const char *const *argv) {
    return run_python("tune", "lab/tune.py", false, argc, argv);
}
