// Import on demand: libcorsac-convert.so, where it is installed, turns any model into the engine's
// files. It is loaded for the call only, so that a program that never imports never sees assimp.
#include "asset/asset.h"

#include <dlfcn.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

typedef int convert_file_fn(const char *in, const char *out_dir);

// Beside the program, in ../lib of it, or where the system looks.
static void *open_converter(void) {
    char path[4096];
    ssize_t n = readlink("/proc/self/exe", path, sizeof path - 64);
    path[n > 0 ? n : 0] = 0;
    char *slash = strrchr(path, '/');
    static const char *const places[] = {"libcorsac-convert.so", "../lib/libcorsac-convert.so"};
    void *library = NULL;
    for (size_t i = 0; slash && !library && i < CORE_COUNT_OF(places); i++) {
        snprintf(slash + 1, 64, "%s", places[i]);
        library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    }
    return library ? library : dlopen("libcorsac-convert.so", RTLD_NOW | RTLD_LOCAL);
}

bool asset_import(const char *source, const char *out_dir) {
    void *library = open_converter();
    if (!library) {
        return core_fail("%s: importing needs libcorsac-convert.so, which is not installed; build "
                         "it with `make`, or convert the file with `corsac convert`",
                         source);
    }
    convert_file_fn *convert = NULL;
    *(void **)(void *)&convert = dlsym(library, "corsac_convert_file");
    bool good = convert && convert(source, out_dir) == 0;
    dlclose(library);
    return good || core_fail("%s: cannot be converted; `corsac convert` says why", source);
}
