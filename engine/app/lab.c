// `corsac lab`, `corsac tune`: hand over to the Python instrument beside the program.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "app/commands.h"
#include "core/base.h"

#define MAX_WORDS 256

// This program's file, and the nearest folder above it that holds tools/lab: the source tree.
static bool find_tree(char *self, char *root, size_t size) {
    ssize_t n = readlink("/proc/self/exe", self, size - 1);
    self[n > 0 ? n : 0] = 0;
    snprintf(root, size, "%s", self);
    for (char *slash = strrchr(root, '/'); slash; slash = strrchr(root, '/')) {
        char there[4096];
        *slash = 0;
        snprintf(there, sizeof there, "%s/tools/lab/__main__.py", root);
        if (access(there, R_OK) == 0) {
            return true;
        }
    }
    return false;
}

// Replaces this process by Python: with the lab's packages, or with the system's one.
static int run_python(const char *command, const char *script, bool packages, int argc,
                      const char *const *argv) {
    char root[3072], python[4096], path[4096], self[3072];
    bool found = find_tree(self, root, sizeof root);
    snprintf(python, sizeof python, "%s/build/venv/bin/python3", root);
    snprintf(path, sizeof path, "%s/tools/%s", root, script);
    bool own = access(python, X_OK) == 0;
    if (!found || (packages && !own)) {
        core_fail(
            "corsac %s: needs the source tree above this program, with its Python environment "
            "(build/venv); run `make lab` there once, which makes it",
            command);
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
