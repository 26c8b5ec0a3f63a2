// The world: plain data that devices draw. Lights, instances and materials are columns behind
// handles; nothing here knows GL.
#include "gfx/gfx_internal.h"

#include "gfx/gfx_cluster.h"
#include "gfx/gfx_particles.h"
#include "gfx/gfx_terrain.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

CORE_COLUMNS_DEFINE(gfx_lights, GFX_LIGHT_COLUMNS)
CORE_COLUMNS_DEFINE(gfx_instances, GFX_INSTANCE_COLUMNS)
CORE_COLUMNS_DEFINE(gfx_meshes, GFX_MESH_COLUMNS)
CORE_COLUMNS_DEFINE(gfx_materials, GFX_MATERIAL_COLUMNS)

enum { MAX_MESHES = 1 << 16, MAX_MATERIALS = 1 << 16 };

gfx_world_desc gfx_world_desc_default(void) { return (gfx_world_desc){.cookie = GFX_COOKIE}; }

// Identity only: it tells a device that its copies belong to another world.
static uint64_t next_world_id(void) {
    static atomic_uint_fast64_t last;
    return atomic_fetch_add(&last, 1) + 1;
}

gfx_world *gfx_world_create(const gfx_world_desc *desc) {
    if (!desc || desc->cookie != GFX_COOKIE) {
        core_fail("gfx_world_create: start from gfx_world_desc_default()");
        return NULL;
    }
    gfx_world *w = core_alloc(sizeof *w);
    w->id = next_world_id();
    w->jobs = desc->jobs;
    w->metrics = desc->metrics;
    gfx_settings_default(&w->settings);
    w->vfs = desc->vfs;
    gfx_world_begin_frame(w);
    const float ambient[3] = {0.32f, 0.36f, 0.42f}, background[3] = {0.11f, 0.14f, 0.18f};
    memcpy(w->ambient, ambient, sizeof ambient);
    memcpy(w->background, background, sizeof background);
    uint32_t lights = desc->max_lights ? desc->max_lights : 1u << 17;
    uint32_t instances = desc->max_instances ? desc->max_instances : 1u << 20;
    if (!gfx_lights_init(&w->lights, "gfx.lights", lights) ||
        !gfx_instances_init(&w->instances, "gfx.instances", instances) ||
        !gfx_meshes_init(&w->meshes, "gfx.meshes", MAX_MESHES) ||
        !gfx_materials_init(&w->materials, "gfx.materials", MAX_MATERIALS)) {
        gfx_world_destroy(w);
        return NULL;
    }
    return w;
}

void gfx_world_destroy(gfx_world *world) {
    if (!world) {
        return;
    }
    for (uint32_t i = 0; i < core_columns_count(&world->instances.set); ++i) {
        core_free(world->instances.palette[i]);
    }
    for (uint32_t i = 0; i < core_columns_count(&world->meshes.set); ++i) {
        gfx_mesh_store_release(&world->meshes.store[i]);
    }
    core_columns_release(&world->lights.set);
    core_columns_release(&world->instances.set);
    core_columns_release(&world->meshes.set);
    core_columns_release(&world->materials.set);
    if (world->effects_made) {
        core_columns_release(&world->effects.set);
    }
    if (world->viewports_made) {
        core_columns_release(&world->viewports.set);
    }
    gfx_growing_release(&world->commands);
    gfx_growing_release(&world->lines);
    gfx_growing_release(&world->boards);
    gfx_particles_destroy(world->particles);
    gfx_terrains_destroy(world->terrains);
    gfx_growing_release(&world->text);
    gfx_faces_release(&world->faces);
    core_free(world);
}

size_t gfx_world_bytes(const gfx_world *world) {
    size_t made = world->particles ? core_columns_bytes(&world->particles->emitters.set) : 0;
    made += world->terrains ? core_columns_bytes(&world->terrains->rows.set) : 0;
    return sizeof *world + made + core_columns_bytes(&world->lights.set) +
           core_columns_bytes(&world->instances.set) + core_columns_bytes(&world->meshes.set) +
           core_columns_bytes(&world->materials.set) + world->commands.bytes + world->text.bytes +
           world->lines.bytes + world->boards.bytes + world->heap_bytes;
}

void gfx_world_counts(const gfx_world *world, core_metrics *metrics) {
    core_metrics_set(metrics, CORE_COUNT_LIGHTS, core_columns_count(&world->lights.set));
    core_metrics_set(metrics, CORE_COUNT_CLUSTERS, world->stats.clusters);
    core_metrics_set(metrics, CORE_COUNT_LIGHT_REFS, world->stats.light_refs);
    core_metrics_set(metrics, CORE_COUNT_DRAWS, world->stats.draws);
    core_metrics_set(metrics, CORE_COUNT_TRIANGLES, world->stats.triangles);
}

gfx_stats gfx_world_stats(const gfx_world *world) { return world->stats; }

void *gfx_grow(gfx_growing *array, size_t element, size_t extra) {
    size_t need = (array->count + extra) * element;
    if (need == 0) {
        return array->data;
    }
    if (need > array->bytes) {
        size_t bytes = array->bytes ? array->bytes : 1024;
        while (bytes < need) {
            bytes *= 2;
        }
        array->data = core_realloc(array->data, array->bytes, bytes);
        array->bytes = bytes;
    }
    void *first = (char *)array->data + array->count * element;
    array->count += extra;
    return first;
}

void gfx_growing_release(gfx_growing *array) {
    core_free(array->data);
    *array = (gfx_growing){0};
}

// ---- lights ----

static bool finite3(core_vec3 v) { return isfinite(v.x) && isfinite(v.y) && isfinite(v.z); }

gfx_light_desc gfx_light_desc_default(gfx_light_type type) {
    return (gfx_light_desc){.type = type,
                            .direction = {0.0f, -1.0f, 0.0f},
                            .color = {1.0f, 1.0f, 1.0f},
                            .intensity = type == GFX_DIRECTIONAL ? CORE_PI_F : 10.0f,
                            .radius = 10.0f,
                            .inner = 0.4f,
                            .outer = 0.6f,
                            .source = type == GFX_DIRECTIONAL ? 0.00465f : 0.05f,
                            .shadows = type == GFX_DIRECTIONAL,
                            .cookie = GFX_COOKIE};
}

static bool check_light(const gfx_light_desc *d) {
    if (d->cookie != GFX_COOKIE) {
        return core_fail("gfx_light_create: start from gfx_light_desc_default()");
    }
    if (!finite3(d->position) || !finite3(d->direction)) {
        return core_fail("gfx_light_create: position and direction must be finite numbers");
    }
    for (int i = 0; i < 3; ++i) {
        if (!(d->color[i] >= 0.0f) || !isfinite(d->color[i])) {
            return core_fail("gfx_light_create: color[%d] is %g, expected a finite number >= 0", i,
                             (double)d->color[i]);
        }
    }
    if (!(d->intensity >= 0.0f) || !isfinite(d->intensity)) {
        return core_fail("gfx_light_create: intensity is %g, expected a finite number >= 0",
                         (double)d->intensity);
    }
    if (d->type != GFX_DIRECTIONAL && (!(d->radius > 0.0f) || !isfinite(d->radius))) {
        return core_fail("gfx_light_create: radius is %g m, expected a finite number > 0",
                         (double)d->radius);
    }
    if (!(d->source >= 0.0f) || !isfinite(d->source)) {
        return core_fail("gfx_light_create: source is %g, expected a finite number >= 0",
                         (double)d->source);
    }
    if (d->type == GFX_SPOT &&
        !(d->inner >= 0.0f && d->inner < d->outer && d->outer < 0.5f * CORE_PI_F)) {
        return core_fail("gfx_light_create: spot angles are inner %g, outer %g, expected 0 <= "
                         "inner < outer < pi/2",
                         (double)d->inner, (double)d->outer);
    }
    return true;
}

gfx_light gfx_light_create(gfx_world *world, const gfx_light_desc *desc) {
    if (!check_light(desc)) {
        return CORE_NULL_HANDLE;
    }
    gfx_light light = core_columns_add(&world->lights.set);
    if (core_handle_is_null(light)) {
        return light;
    }
    gfx_lights *l = &world->lights;
    uint32_t i = core_columns_row(&l->set, light);
    core_vec3 d = core_v3_normalize(desc->direction, core_v3(0.0f, -1.0f, 0.0f));
    bool black = desc->color[0] == 0.0f && desc->color[1] == 0.0f && desc->color[2] == 0.0f;
    l->type[i] = desc->type;
    l->px[i] = desc->position.x, l->py[i] = desc->position.y, l->pz[i] = desc->position.z;
    l->dx[i] = d.x, l->dy[i] = d.y, l->dz[i] = d.z;
    l->r[i] = black ? 1.0f : desc->color[0];
    l->g[i] = black ? 1.0f : desc->color[1];
    l->b[i] = black ? 1.0f : desc->color[2];
    l->intensity[i] = desc->intensity;
    l->radius[i] = desc->type == GFX_DIRECTIONAL ? 0.0f : desc->radius;
    l->inner[i] = desc->inner, l->outer[i] = desc->outer;
    l->source[i] = desc->source;
    l->shadows[i] = desc->shadows;
    return light;
}

static bool row_of(const core_columns *set, core_handle h, const char *call, uint32_t *row) {
    *row = core_columns_row(set, h);
    return *row != CORE_NO_ROW ||
           core_fail("%s: the handle (index %u, generation %u) is stale or null", call, h.index,
                     h.generation);
}

bool gfx_light_destroy(gfx_world *world, gfx_light light) {
    return core_columns_remove(&world->lights.set, light, NULL, NULL) ||
           core_fail("gfx_light_destroy: the handle is stale or null");
}

bool gfx_light_alive(const gfx_world *world, gfx_light light) {
    return core_columns_row(&world->lights.set, light) != CORE_NO_ROW;
}

bool gfx_light_set_position(gfx_world *world, gfx_light light, core_vec3 position) {
    uint32_t i;
    if (!row_of(&world->lights.set, light, "gfx_light_set_position", &i)) {
        return false;
    }
    if (!finite3(position)) {
        return core_fail("gfx_light_set_position: the position must be finite numbers");
    }
    gfx_lights *l = &world->lights;
    l->px[i] = position.x, l->py[i] = position.y, l->pz[i] = position.z;
    return true;
}

bool gfx_light_set_direction(gfx_world *world, gfx_light light, core_vec3 direction) {
    uint32_t i;
    if (!row_of(&world->lights.set, light, "gfx_light_set_direction", &i)) {
        return false;
    }
    if (!finite3(direction)) {
        return core_fail("gfx_light_set_direction: the direction must be finite numbers");
    }
    core_vec3 d = core_v3_normalize(direction, core_v3(0.0f, -1.0f, 0.0f));
    world->lights.dx[i] = d.x, world->lights.dy[i] = d.y, world->lights.dz[i] = d.z;
    return true;
}

bool gfx_light_set_color(gfx_world *world, gfx_light light, float r, float g, float b,
                         float intensity) {
    uint32_t i;
    if (!row_of(&world->lights.set, light, "gfx_light_set_color", &i)) {
        return false;
    }
    if (!(r >= 0.0f && g >= 0.0f && b >= 0.0f && intensity >= 0.0f) || !isfinite(r + g + b) ||
        !isfinite(intensity)) {
        return core_fail("gfx_light_set_color: %g, %g, %g, intensity %g: expected finite numbers "
                         ">= 0",
                         (double)r, (double)g, (double)b, (double)intensity);
    }
    gfx_lights *l = &world->lights;
    l->r[i] = r, l->g[i] = g, l->b[i] = b, l->intensity[i] = intensity;
    return true;
}

void gfx_world_set_ambient(gfx_world *world, float r, float g, float b) {
    world->ambient[0] = r, world->ambient[1] = g, world->ambient[2] = b;
    world->ambient_set = true;
}

void gfx_world_set_background(gfx_world *world, float r, float g, float b) {
    world->background[0] = r, world->background[1] = g, world->background[2] = b;
}

gfx_environment gfx_environment_default(void) {
    return (gfx_environment){.intensity = 1.0f,
                             .zenith = {0.16f, 0.32f, 0.72f},
                             .horizon = {0.75f, 0.86f, 1.0f},
                             .ground = {0.22f, 0.2f, 0.18f},
                             .glow = {2.2f, 1.8f, 1.2f},
                             .glow_exponent = 64.0f,
                             .sun = {0.4f, 0.8f, 0.4f},
                             .cookie = GFX_COOKIE};
}

bool gfx_world_set_environment(gfx_world *world, const gfx_environment *e) {
    if (!e) {
        world->environment_set = false;
        return true;
    }
    if (e->cookie != GFX_COOKIE) {
        return core_fail("gfx_world_set_environment: start from gfx_environment_default()");
    }
    if (!(e->intensity > 0.0f) || !isfinite(e->intensity) || !finite3(e->sun) ||
        !(e->glow_exponent >= 1.0f && e->glow_exponent <= 4096.0f)) {
        return core_fail("gfx_world_set_environment: intensity %g, glow_exponent %g: expected > 0 "
                         "and 1..4096, and a finite sun",
                         (double)e->intensity, (double)e->glow_exponent);
    }
    if (e->panorama && strlen(e->panorama) >= CORE_NAME_MAX) {
        return core_fail("gfx_world_set_environment: the path of the panorama is too long");
    }
    world->environment = *e;
    world->environment.sun = core_v3_normalize(e->sun, core_v3(0.0f, 1.0f, 0.0f));
    world->panorama_path[0] = '\0';
    if (e->panorama) {
        strcpy(world->panorama_path, e->panorama);
    }
    world->environment.panorama = NULL;
    world->environment_set = true;
    return true;
}

// ---- materials ----

gfx_material_desc gfx_material_desc_default(void) {
    gfx_material_desc d = {.cookie = GFX_COOKIE};
    for (int i = 0; i < 4; ++i) {
        d.data.base_color[i] = 1.0f;
    }
    d.data.roughness = 0.5f;
    d.data.normal_scale = d.data.occlusion_strength = 1.0f;
    d.data.alpha_cutoff = 0.5f;
    return d;
}

gfx_material gfx_material_create(gfx_world *world, const gfx_material_desc *desc) {
    if (!desc || desc->cookie != GFX_COOKIE) {
        core_fail("gfx_material_create: start from gfx_material_desc_default()");
        return CORE_NULL_HANDLE;
    }
    gfx_hook hook = {0};
    if (desc->fragment &&
        !gfx_hook_make(world, "gfx_material_create", desc->fragment, desc->parameters, &hook)) {
        return CORE_NULL_HANDLE;
    }
    gfx_material material = core_columns_add(&world->materials.set);
    uint32_t i = core_columns_row(&world->materials.set, material);
    if (i != CORE_NO_ROW) {
        world->materials.data[i] = desc->data;
        world->materials.hook[i] = hook;
        world->material_version++;
    }
    return material;
}

bool gfx_material_destroy(gfx_world *world, gfx_material material) {
    world->material_version++;
    return core_columns_remove(&world->materials.set, material, NULL, NULL) ||
           core_fail("gfx_material_destroy: the handle is stale or null");
}

bool gfx_material_alive(const gfx_world *world, gfx_material material) {
    return core_columns_row(&world->materials.set, material) != CORE_NO_ROW;
}

bool gfx_material_set_parameters(gfx_world *world, gfx_material material,
                                 const float parameters[16]) {
    uint32_t i = core_columns_row(&world->materials.set, material);
    if (i == CORE_NO_ROW) {
        return core_fail("gfx_material_set_parameters: the handle is stale or null");
    }
    gfx_hook *hook = &world->materials.hook[i];
    memcpy(hook->parameters, parameters, sizeof hook->parameters);
    return true;
}

// ---- instances ----

gfx_instance gfx_instance_create(gfx_world *world, const gfx_instance_desc *desc) {
    uint32_t mesh = core_columns_row(&world->meshes.set, desc->mesh);
    if (mesh == CORE_NO_ROW) {
        core_fail("gfx_instance_create: the mesh is stale or null");
        return CORE_NULL_HANDLE;
    }
    gfx_instance instance = core_columns_add(&world->instances.set);
    uint32_t i = core_columns_row(&world->instances.set, instance);
    if (i == CORE_NO_ROW) {
        return instance;
    }
    const float *c = desc->color;
    bool zero = c[0] == 0.0f && c[1] == 0.0f && c[2] == 0.0f && c[3] == 0.0f;
    gfx_instances *s = &world->instances;
    s->mesh[i] = desc->mesh;
    s->material[i] = desc->material;
    s->changed[i] = ++world->row_version;
    world->palette_layout++; // its row had none
    s->color[i] = zero ? (gfx_rgba){1.0f, 1.0f, 1.0f, 1.0f} : (gfx_rgba){c[0], c[1], c[2], c[3]};
    gfx_instance_set_transform(world, instance, core_v3(0.0f, 0.0f, 0.0f), core_quat_identity(),
                               core_v3(1.0f, 1.0f, 1.0f));
    return instance;
}

bool gfx_instance_destroy(gfx_world *world, gfx_instance instance) {
    uint32_t i;
    if (!row_of(&world->instances.set, instance, "gfx_instance_destroy", &i)) {
        return false;
    }
    gfx_instances *s = &world->instances;
    core_free(s->palette[i]);
    world->instance_version++;
    world->palette_layout++;
    world->heap_bytes -= s->palette_bones[i] * sizeof(gfx_rows);
    bool ok = core_columns_remove(&s->set, instance, NULL, NULL);
    if (i < core_columns_count(&s->set)) {
        s->changed[i] = ++world->row_version; // another took its row
    }
    return ok;
}

bool gfx_instance_alive(const gfx_world *world, gfx_instance instance) {
    return core_columns_row(&world->instances.set, instance) != CORE_NO_ROW;
}

bool gfx_instance_set_color(gfx_world *world, gfx_instance instance, float r, float g, float b,
                            float a) {
    uint32_t i;
    if (!row_of(&world->instances.set, instance, "gfx_instance_set_color", &i)) {
        return false;
    }
    gfx_rgba color = {r, g, b, a};
    if (memcmp(&color, &world->instances.color[i], sizeof color) != 0) {
        world->instances.color[i] = color;
        world->instances.changed[i] = ++world->row_version;
    }
    return true;
}

static core_vec3 rows_point(const gfx_rows *t, core_vec3 p) {
    const float *m = t->m;
    return core_v3(m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3],
                   m[4] * p.x + m[5] * p.y + m[6] * p.z + m[7],
                   m[8] * p.x + m[9] * p.y + m[10] * p.z + m[11]);
}

// Bound on how much a matrix lengthens a vector: the Frobenius norm, or the longest column when the
// columns are orthogonal (rotation and scale).
static float rows_stretch(const gfx_rows *t, bool orthogonal) {
    const float *m = t->m;
    float column[3];
    for (int i = 0; i < 3; ++i) {
        column[i] = m[i] * m[i] + m[4 + i] * m[4 + i] + m[8 + i] * m[8 + i];
    }
    float widest = CORE_MAX(column[0], CORE_MAX(column[1], column[2]));
    return core_sqrtf(orthogonal ? widest : column[0] + column[1] + column[2]);
}

// Sphere round a posed mesh: every skinned vertex is a weighted mean of its images under the bones,
// so the sphere round all images of the bind sphere holds it.
static void posed_bounds(const gfx_mesh_store *mesh, const gfx_rows *bone, uint32_t bones,
                         core_vec3 *center, float *radius) {
    core_vec3 sum = {0};
    for (uint32_t i = 0; i < bones; ++i) {
        sum = core_v3_add(sum, rows_point(&bone[i], mesh->center));
    }
    *center = core_v3_scale(sum, 1.0f / (float)bones);
    *radius = 0.0f;
    for (uint32_t i = 0; i < bones; ++i) {
        core_vec3 d = core_v3_sub(rows_point(&bone[i], mesh->center), *center);
        float r = core_v3_length(d) + mesh->radius * rows_stretch(&bone[i], false);
        *radius = CORE_MAX(*radius, r);
    }
}

static void update_bounds(gfx_world *world, uint32_t i, bool orthogonal) {
    gfx_instances *s = &world->instances;
    uint32_t m = core_columns_row(&world->meshes.set, s->mesh[i]);
    if (m == CORE_NO_ROW) {
        return;
    }
    const gfx_mesh_store *mesh = &world->meshes.store[m];
    core_vec3 center = mesh->center;
    float radius = mesh->radius;
    if (s->palette[i]) {
        posed_bounds(mesh, (const gfx_rows *)s->palette[i], s->palette_bones[i], &center, &radius);
    }
    core_vec3 c = rows_point(&s->rows[i], center);
    s->cx[i] = c.x, s->cy[i] = c.y, s->cz[i] = c.z;
    s->cr[i] = radius * rows_stretch(&s->rows[i], orthogonal);
}

bool gfx_instance_set_transform(gfx_world *world, gfx_instance instance, core_vec3 t, core_quat r,
                                core_vec3 s) {
    uint32_t i;
    if (!row_of(&world->instances.set, instance, "gfx_instance_set_transform", &i)) {
        return false;
    }
    core_mat4 m = core_mat4_trs(t, r, s);
    gfx_rows rows;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 4; ++column) {
            rows.m[row * 4 + column] = m.m[column * 4 + row];
        }
    }
    if (memcmp(&rows, &world->instances.rows[i], sizeof rows) == 0) {
        return true; // shadow maps of things at rest stay as they are
    }
    world->instances.rows[i] = rows;
    world->instances.changed[i] = ++world->row_version;
    world->instance_version++;
    update_bounds(world, i, true);
    return true;
}

bool gfx_instance_set_palette(gfx_world *world, gfx_instance instance, const float *rows3x4,
                              uint32_t count) {
    uint32_t i;
    if (!row_of(&world->instances.set, instance, "gfx_instance_set_palette", &i)) {
        return false;
    }
    gfx_instances *s = &world->instances;
    uint32_t m = core_columns_row(&world->meshes.set, s->mesh[i]);
    uint32_t bones = m == CORE_NO_ROW ? 0 : world->meshes.store[m].bones;
    if (!rows3x4 || count < bones || count == 0) {
        return core_fail("gfx_instance_set_palette: %u matrices, the mesh has %u bones", count,
                         bones);
    }
    bool same = s->palette_bones[i] == count &&
                memcmp(s->palette[i], rows3x4, count * sizeof(gfx_rows)) == 0;
    if (same) {
        return true;
    }
    if (s->palette_bones[i] != count) {
        size_t old = s->palette_bones[i] * sizeof(gfx_rows), bytes = count * sizeof(gfx_rows);
        s->palette[i] = core_realloc(s->palette[i], old, bytes);
        s->palette_bones[i] = count;
        world->palette_layout++;
        world->heap_bytes += bytes - old;
    }
    memcpy(s->palette[i], rows3x4, count * sizeof(gfx_rows));
    s->changed[i] = ++world->row_version;
    world->instance_version++;
    update_bounds(world, i, false);
    return true;
}

// ---- camera ----

void gfx_world_set_camera(gfx_world *world, const gfx_camera *camera) {
    world->camera = *camera;
    world->camera_set = true;
}

gfx_camera gfx_world_camera(const gfx_world *world) { return gfx_world_camera_or_default(world); }
