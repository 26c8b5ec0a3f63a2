// corsac-convert: the command line of the converter (`corsac convert` executes it).
#include "convert.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int usage(const char *why, const char *what) {
    fprintf(stderr,
            "corsac convert: %s%s\n"
            "usage: corsac convert IN OUT_DIR [--compress M] [--dry-run] [--scale FACTOR]\n"
            "                                     [--fps N] [--quiet]\n"
            "  IN        a model: glTF, GLB, FBX, Collada, OBJ, ... whatever assimp reads\n"
            "  OUT_DIR   gets NAME.cmodel and its meshes, skeleton, clips, textures, a scene that\n"
            "            shows them (NAME.lua) and what was changed or dropped (NAME.report.json)\n"
            "  --compress  clips within M metres of the source at joints and 0.1 m around them\n"
            "              (0.0005 is half a millimetre); without it they keep their keys\n"
            "  --scale   factor on lengths; without it FBX files are scaled by their own unit\n"
            "  --fps     ticks per second where the file gives none (25)\n",
            why, what);
    return 2;
}

static bool positive(const char *text, double *out) {
    char *end = NULL;
    *out = text ? strtod(text, &end) : 0;
    return end && *end == 0 && isfinite(*out) && *out > 0;
}

int main(int argc, char **argv) {
    convert_options o = {0};
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--dry-run") == 0) {
            o.dry_run = true;
        } else if (strcmp(argv[i], "--quiet") == 0) {
            o.quiet = true;
        } else if (strcmp(argv[i], "--scale") == 0 || strcmp(argv[i], "--fps") == 0 ||
                   strcmp(argv[i], "--compress") == 0) {
            double *to = argv[i][2] == 's'   ? &o.scale
                         : argv[i][2] == 'c' ? &o.compress
                                             : &o.ticks_per_second;
            if (!positive(i + 1 < argc ? argv[i + 1] : NULL, to)) {
                return usage("expected a number > 0 after ", argv[i]);
            }
            i++;
        } else if (argv[i][0] == '-') {
            return usage("unknown option ", argv[i]);
        } else if (!o.in) {
            o.in = argv[i];
        } else if (!o.out_dir) {
            o.out_dir = argv[i];
        } else {
            return usage("one model at a time; unexpected ", argv[i]);
        }
    }
    if (!o.in || (!o.out_dir && !o.dry_run)) {
        return usage(o.in ? "the output folder is missing" : "the model is missing", "");
    }
    return corsac_convert(&o);
}
