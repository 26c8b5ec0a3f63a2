#include "audio/audio_library.h"

#include <dlfcn.h>
#include <string.h>

// ISO C has no cast between object and function pointers; POSIX dlsym relies on equal size.
static bool fetch(void *handle, const char *name, void *slot) {
    void *symbol = dlsym(handle, name);
    memcpy(slot, &symbol, sizeof symbol);
    return symbol != NULL;
}

bool audio_library_open(audio_library *lib) {
    *lib = (audio_library){.handle = dlopen("libopenal.so.1", RTLD_NOW | RTLD_LOCAL)};
    if (!lib->handle) {
        return core_fail_quiet("audio: OpenAL is not installed (libopenal.so.1); on Debian: apt "
                               "install libopenal1");
    }
    bool all = true;
#define FETCH(type, name) all = fetch(lib->handle, #name, &lib->name) && all;
    AUDIO_LIBRARY(FETCH)
#undef FETCH
    if (!all) {
        audio_library_close(lib);
        return core_fail_quiet("audio: libopenal.so.1 lacks functions of OpenAL 1.1");
    }
#define FETCH(type, name)                                                                          \
    do {                                                                                           \
        void *symbol = lib->alcGetProcAddress(NULL, #name);                                        \
        memcpy(&lib->name, &symbol, sizeof symbol);                                                \
    } while (0);
    AUDIO_LIBRARY_EXTENSIONS(FETCH)
#undef FETCH
    if (!lib->alcSetThreadContext) {
        audio_library_close(lib);
        return core_fail_quiet("audio: this OpenAL lacks ALC_EXT_thread_local_context; install "
                               "OpenAL Soft (libopenal1)");
    }
    return true;
}

void audio_library_close(audio_library *lib) {
    if (lib->handle) {
        dlclose(lib->handle);
    }
    *lib = (audio_library){0};
}
