// What ties the files together: the model file, a scene that shows it, and the report.
#include "convert.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static bool write_model(cv_model *m) {
    char name[CORE_NAME_MAX];
    size_t size = 0;
    char *text = asset_model_encode(&m->out, &size);
    snprintf(name, sizeof name, "%s.cmodel", m->name);
    bool good = cv_write(m, name, text, size);
    core_free(text);
    return good;
}

static bool write_scene(cv_model *m) {
    core_vec3 low = m->bounds.min, high = m->bounds.max;
    double c[3] = {((double)low.x + (double)high.x) / 2, ((double)low.y + (double)high.y) / 2,
                   ((double)low.z + (double)high.z) / 2};
    double d = fmax(1e-3, sqrt(pow((double)high.x - (double)low.x, 2) +
                               pow((double)high.y - (double)low.y, 2) +
                               pow((double)high.z - (double)low.z, 2)));
    char text[4096], name[CORE_NAME_MAX];
    int n = snprintf(
        text, sizeof text,
        "-- Shows %s, clip after clip.\n"
        "local model, animator, clips, at\n"
        "function corsac.load()\n"
        "    corsac.gfx.setBackground(0.35, 0.4, 0.45)\n"
        "    corsac.gfx.setAmbient(0.4, 0.4, 0.42)\n"
        "    corsac.gfx.newLight{ type = \"directional\", direction = { -0.5, -1, -0.7 }, "
        "intensity "
        "= 2 }\n"
        "    corsac.gfx.setCamera{ position = { %.6g, %.6g, %.6g }, target = { %.6g, %.6g, %.6g "
        "},\n"
        "        near = %.6g, far = %.6g }\n"
        "    model = corsac.anim.loadModel(\"%s.cmodel\")\n"
        "    clips, at = model:getClips(), 1\n"
        "    animator = corsac.scene.spawn{ model = model, clip = clips[1] }:getAnimator()\n"
        "end\n"
        "local shown = 0\n"
        "function corsac.fixed(dt)\n"
        "    shown = shown + dt\n"
        "    if #clips > 1 and shown > 3 then\n"
        "        at, shown = at %% #clips + 1, 0\n"
        "        animator:play(clips[at], 0.25, \"smooth\")\n"
        "    end\n"
        "end\n",
        m->name, c[0] + 0.6 * d, c[1] + 0.4 * d, c[2] + 1.1 * d, c[0], c[1], c[2], d * 0.01, d * 20,
        m->name);
    snprintf(name, sizeof name, "%s.lua", m->name);
    return n > 0 && n < (int)sizeof text && cv_write(m, name, text, (size_t)n);
}

static void report_lists(const cv_model *m, core_json *j) {
    core_json_array(j, "clips");
    for (uint32_t i = 0; i < m->out.clip_count; i++) {
        core_json_object(j, NULL);
        core_json_string(j, "name", m->out.clip[i].name);
        core_json_number(j, "duration_s", m->clip[i].duration);
        core_json_int(j, "channels", m->clip[i].channel_count);
        core_json_end_object(j);
    }
    core_json_end_array(j);
    static const char *const kinds[] = {"changed", "dropped", "warning"};
    for (size_t k = 0; k < CORE_COUNT_OF(kinds); k++) {
        core_json_array(j, kinds[k]);
        for (uint32_t i = 0; i < m->note_count; i++) {
            if (strcmp(m->note[i].kind, kinds[k]) == 0) {
                core_json_string(j, NULL, m->note[i].text);
            }
        }
        core_json_end_array(j);
    }
}

static bool write_report(cv_model *m) {
    const char *slash = strrchr(m->options->in, '/');
    char name[CORE_NAME_MAX];
    core_json j;
    core_json_init(&j, true);
    core_json_object(&j, NULL);
    core_json_string(&j, "source", slash ? slash + 1 : m->options->in);
    core_json_number(&j, "scale", m->scale);
    core_json_int(&j, "meshes", m->out.mesh_count);
    core_json_int(&j, "vertices", (int64_t)m->vertices);
    core_json_int(&j, "triangles", (int64_t)m->triangles);
    core_json_int(&j, "bones", m->bone_count);
    core_json_int(&j, "materials", m->out.material_count);
    core_json_int(&j, "textures", m->texture_count);
    core_json_int(&j, "bytes", (int64_t)m->bytes);
    report_lists(m, &j);
    core_json_end_object(&j);
    snprintf(name, sizeof name, "%s.report.json", m->name);
    bool good = cv_write(m, name, j.text, j.length);
    core_json_release(&j);
    return good;
}

bool cv_finish(cv_model *m) {
    if (m->scene->mNumCameras || m->scene->mNumLights) {
        cv_note_add(m, "dropped", "%u cameras and %u lights: scenes place their own",
                    m->scene->mNumCameras, m->scene->mNumLights);
    }
    if (m->out.mesh_count == 0) {
        cv_note_add(m, "warning", "no mesh was found: the model shows nothing");
    }
    return write_model(m) && write_scene(m) && write_report(m);
}
