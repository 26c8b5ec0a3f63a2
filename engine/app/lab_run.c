// `corsac lab-run NAME --case JSON`: runs one lab kernel on one case and prints its figures as one
// line of JSON. `--list` prints the kernels. The lab's experiments are made of such runs.
#include <cjson/cJSON.h>
#include <stdio.h>
#include <string.h>

#include "app/commands.h"
#include "app/lab_kernels.h"
#include "core/nearest.h"
#include "core/simd.h"

#define MAX_PARAMS 64

static int list_kernels(void) {
    core_json out;
    core_json_init(&out, true);
    core_json_array(&out, NULL);
    for (size_t i = 0; app_lab_kernels[i]; i++) {
        core_json_object(&out, NULL);
        core_json_string(&out, "name", app_lab_kernels[i]->name);
        core_json_string(&out, "what", app_lab_kernels[i]->what);
        core_json_string(&out, "params", app_lab_kernels[i]->params);
        core_json_end_object(&out);
    }
    core_json_end_array(&out);
    puts(out.text);
    core_json_release(&out);
    return 0;
}

static const core_lab_kernel *find_kernel(const char *name) {
    const char *names[MAX_PARAMS];
    size_t n = 0;
    for (; app_lab_kernels[n] && n < MAX_PARAMS; n++) {
        if (strcmp(app_lab_kernels[n]->name, name) == 0) {
            return app_lab_kernels[n];
        }
        names[n] = app_lab_kernels[n]->name;
    }
    const char *near = core_nearest(name, names, n);
    core_fail("corsac lab-run: no kernel '%s'%s%s%s; `corsac lab-run --list` shows all", name,
              near ? ", did you mean '" : "", near ? near : "", near ? "'?" : "");
    return NULL;
}

// The parameters of a flat JSON object; texts are borrowed from `root`.
static bool read_case(const cJSON *root, core_lab_param *param, uint32_t *count) {
    *count = 0;
    if (!cJSON_IsObject(root)) {
        return core_fail("corsac lab-run: --case takes a JSON object such as '{\"n\": 100}'");
    }
    const cJSON *item = NULL;
    cJSON_ArrayForEach(item, root) {
        bool number = cJSON_IsNumber(item) || cJSON_IsBool(item);
        if ((!number && !cJSON_IsString(item)) || *count == MAX_PARAMS) {
            return core_fail(
                "corsac lab-run: parameter '%s' of --case: a number or a text expected, "
                "at most %d of them",
                item->string, MAX_PARAMS);
        }
        double value = cJSON_IsBool(item) ? cJSON_IsTrue(item) : item->valuedouble;
        param[(*count)++] =
            (core_lab_param){item->string, number ? NULL : item->valuestring, number ? value : 0};
    }
    return true;
}

static bool run_case(const core_lab_kernel *kernel, const core_lab_case *c) {
    const char *simd = core_lab_text(c, "simd", "auto");
    for (int s = 0; s < CORE_SIMD_SETS; s++) {
        if (strcmp(simd, core_simd_name((core_simd_set)s)) == 0 &&
            !core_simd_use((core_simd_set)s)) {
            return false;
        }
    }
    core_json out;
    core_json_init(&out, false);
    core_json_object(&out, NULL);
    core_json_string(&out, "kernel", kernel->name);
    core_json_string(&out, "simd", core_simd_name(core_simd_active()));
    bool fine = kernel->run(c, &out);
    core_json_end_object(&out);
    if (fine) {
        puts(out.text);
    }
    core_json_release(&out);
    return fine;
}

int app_command_lab_run(int argc, const char *const *argv) {
    if (argc == 1 && strcmp(argv[0], "--list") == 0) {
        return list_kernels();
    }
    if (argc < 1 || argc == 2 || argc > 3 || (argc == 3 && strcmp(argv[1], "--case") != 0)) {
        core_fail(
            "corsac lab-run: usage: corsac lab-run NAME [--case JSON] or corsac lab-run --list");
        return 2;
    }
    const core_lab_kernel *kernel = find_kernel(argv[0]);
    if (!kernel) {
        return 2;
    }
    cJSON *root = cJSON_Parse(argc == 3 ? argv[2] : "{}");
    core_lab_param param[MAX_PARAMS];
    core_lab_case c = {param, 0};
    bool fine = read_case(root, param, &c.count) && run_case(kernel, &c);
    cJSON_Delete(root);
    return fine ? 0 : 2;
}
