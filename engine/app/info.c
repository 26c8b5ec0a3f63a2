// `corsac info`: what this build and this machine offer.
#include <stdio.h>
#include <string.h>

#include "app/commands.h"
#include "app/files.h"
#include "app/report.h"
#include "core/log.h"
#include "core/simd.h"

static void print_simd(void) {
    printf("instruction sets:");
    for (int set = 0; set <= (int)core_simd_best(); set++) {
        printf(" %s", core_simd_name((core_simd_set)set));
    }
    printf(" (default %s)\n", core_simd_name(core_simd_best()));
}

static void print_rooms(void) {
    static const char *const rooms[] = {"scene", "script", "phys", "gfx", "anim", "nav", "audio"};
    printf("rooms:");
    for (size_t i = 0; i < CORE_COUNT_OF(rooms); i++) {
        if (scene_room_built(rooms[i])) {
            printf(" %s", rooms[i]);
        }
    }
    printf("\n");
}

static void print_graphics(void) {
    char home[APP_PATH_MAX], assets[APP_PATH_MAX + 16];
    if (!app_home(home, sizeof home)) {
        printf("graphics: no assets found; set CORSAC_HOME to the folder that holds assets/\n");
        return;
    }
    snprintf(assets, sizeof assets, "%s/assets", home);
    printf("assets: %s\n", assets);
    core_vfs *vfs = core_vfs_create();
    gfx_device_desc desc = gfx_device_desc_default();
    desc.width = desc.height = 64;
    desc.vfs = vfs;
    gfx_device *device = core_vfs_mount(vfs, assets, "", false) ? gfx_device_create(&desc) : NULL;
    if (device) {
        printf("graphics: %s%s\n", gfx_device_name(device),
               gfx_device_software(device) ? " (in software)" : "");
        gfx_device_destroy(device);
    } else {
        printf("graphics: none: %s\n", core_last_error());
    }
    core_vfs_destroy(vfs);
}

int app_command_info(int argc, const char *const *argv) {
    if (argc > 0) {
        core_fail("corsac info: takes no words, got '%s'", argv[0]);
        return 2;
    }
    core_log_level level = core_log_set_level(CORE_LOG_ERROR + 1);
    printf("corsac %s, %s\n", APP_VERSION,
#if defined(__clang__)
           "clang " __clang_version__
#else
           "gcc " __VERSION__
#endif
    );
    print_simd();
    core_jobs *jobs = core_jobs_create(0);
    printf("processors: %d\n", core_jobs_threads(jobs));
    core_jobs_destroy(jobs);
    print_rooms();
    print_graphics();
    core_log_set_level(level);
    return 0;
}
