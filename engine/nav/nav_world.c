// The world of navigation: creation, settings, the step, what it holds.
#include <stdlib.h>
#include <string.h>

#include "core/nearest.h"
#include "nav/nav_internal.h"

#define DEFAULT_AGENTS (1u << 16)
#define MOST_GRAPHS    1024u
#define MOST_PATHS     (1u << 17)

nav_world_desc nav_world_desc_default(void) {
    return (nav_world_desc){.max_agents = DEFAULT_AGENTS, .cookie = NAV_WORLD_COOKIE};
}

nav_world *nav_world_create(const nav_world_desc *desc) {
    if (!desc || desc->cookie != NAV_WORLD_COOKIE) {
        core_fail("nav_world_create: the description was not made by nav_world_desc_default()");
        return NULL;
    }
    nav_world *w = core_alloc(sizeof *w);
    w->jobs = desc->jobs;
    w->metrics = desc->metrics;
    w->weight = 1.0f;
    uint32_t agents = desc->max_agents ? desc->max_agents : DEFAULT_AGENTS;
    if (!nav_graphs_init(&w->graph, "nav.graphs", MOST_GRAPHS) ||
        !nav_grids_init(&w->grid, "nav.grids", MOST_GRAPHS) ||
        !nav_meshes_init(&w->mesh, "nav.meshes", MOST_GRAPHS) ||
        !nav_flows_init(&w->flow, "nav.flows", MOST_GRAPHS) ||
        !nav_paths_init(&w->path, "nav.paths", CORE_MAX(agents, MOST_PATHS)) ||
        !nav_agents_init(&w->agent, "nav.agents", agents)) {
        nav_world_destroy(w);
        return NULL;
    }
    return w;
}

void nav_world_destroy(nav_world *w) {
    if (!w) {
        return;
    }
    for (uint32_t n = core_columns_count(&w->path.set); n > 0; n--) {
        nav_path_destroy(w, core_columns_handle(&w->path.set, n - 1));
    }
    for (uint32_t n = core_columns_count(&w->graph.set); n > 0; n--) {
        nav_graph_destroy(w, core_columns_handle(&w->graph.set, n - 1));
    }
    for (uint32_t n = core_columns_count(&w->grid.set); n > 0; n--) {
        nav_grid_destroy(w, core_columns_handle(&w->grid.set, n - 1));
    }
    for (uint32_t n = core_columns_count(&w->mesh.set); n > 0; n--) {
        nav_mesh_destroy(w, core_columns_handle(&w->mesh.set, n - 1));
    }
    for (uint32_t n = core_columns_count(&w->flow.set); n > 0; n--) {
        nav_flow_release(w->flow.data[n - 1]);
    }
    core_columns_release(&w->flow.set);
    nav_builder_release(w);
    nav_coarse_release(&w->coarse);
    core_free(w->encounters.data);
    core_free(w->obstacles.data);
    core_free(w->way.point);
    core_free(w->way.link);
    nav_view_scratch_release(&w->views);
    nav_view_scratch_release(&w->slice.views);
    core_columns_release(&w->mesh.set);
    nav_grid_scratch_release(w);
    core_columns_release(&w->grid.set);
    core_columns_release(&w->graph.set);
    core_columns_release(&w->path.set);
    core_columns_release(&w->agent.set);
    nav_scratch_release(&w->scratch);
    nav_crowd_release(&w->crowd);
    core_free(w);
}

bool nav_world_step(nav_world *w, float dt) {
    if (!(dt > 0.0f && dt <= 1.0f)) {
        return core_fail("nav_world_step: dt is %g s, expected 0 < dt <= 1", (double)dt);
    }
    core_stage_begin(w->metrics, CORE_STAGE_NAV);
    for (uint32_t row = 0; row < core_columns_count(&w->mesh.set); row++) {
        if (w->mesh.data[row]->dirty) {
            nav_mesh_renew(w, row, w->mesh.data[row]->desc.tiles_per_step);
        }
    }
    w->plans_left = NAV_PLANS_A_STEP;
    if (w->slice_budget) {
        nav_slices_step(w);
    }
    nav_agents_step(w, dt);
    nav_paths_refresh(w);
    core_stage_end(w->metrics, CORE_STAGE_NAV);
    return true;
}

// ---- settings ----

static const char *const heuristics[] = {"euclid", "octile", "zero", NULL};
static const char *const avoidances[] = {"orca", "none", NULL};
static const char *const grid_methods[] = {"jump", "astar", NULL};
static const char *const settings[] = {"heuristic", "weight", "avoidance", "slice", "bodies"};

const char *const *nav_method_names(const char *kind) {
    static const char *const none[] = {NULL};
    return strcmp(kind, "heuristic") == 0   ? heuristics
           : strcmp(kind, "grid") == 0      ? grid_methods
           : strcmp(kind, "avoidance") == 0 ? avoidances
                                            : none;
}

static int place_of(const char *value, const char *const *names) {
    for (int i = 0; names[i]; i++) {
        if (strcmp(value, names[i]) == 0) {
            return i;
        }
    }
    return -1;
}

static bool set_weight(nav_world *w, const char *value) {
    char *end;
    float weight = strtof(value, &end);
    if (end == value || *end || !(weight >= 1.0f && weight <= 10.0f)) {
        return core_fail("nav.weight=%s: expected a number from 1 to 10", value);
    }
    w->weight = weight;
    return true;
}

static bool set_slice(nav_world *w, const char *value) {
    char *end;
    long budget = strtol(value, &end, 10);
    if (end == value || *end || budget < 0 || budget > 1000000000) {
        return core_fail("nav.slice=%s: expected a whole number of expansions in a step, 0: "
                         "searches end at once",
                         value);
    }
    w->slice_budget = (uint32_t)budget;
    return true;
}

static bool set_bodies(nav_world *w, const char *value) {
    static const char *const names[] = {"on", "off", NULL};
    int i = place_of(value, names);
    if (i < 0) {
        return core_fail("nav.bodies=%s: expected on or off", value);
    }
    w->no_bodies = i == 1;
    return true;
}
bool nav_world_minds_bodies(const nav_world *w) { return !w->no_bodies; }

bool nav_world_set_obstacles(nav_world *w, const nav_obstacle *o, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        core_vec3 sum = core_v3_add(o[i].position, o[i].velocity);
        if (!(core_absf(sum.x) <= 1e7f && core_absf(sum.y) <= 1e7f && core_absf(sum.z) <= 1e7f) ||
            !(o[i].radius > 0.0f && o[i].radius <= 1e3f)) {
            return core_fail("nav_world_set_obstacles: number %u has a radius of %g m at (%g, %g, "
                             "%g), expected more than 0 up to 1000 and finite numbers",
                             i, (double)o[i].radius, (double)o[i].position.x,
                             (double)o[i].position.y, (double)o[i].position.z);
        }
    }
    // Room for some from the start: a body that comes near later asks for no memory.
    nav_buffer_fit(&w->obstacles, (size_t)CORE_MAX(count + 1, 64u) * sizeof *o);
    if (count) {
        memcpy(w->obstacles.data, o, count * sizeof *o);
    }
    w->obstacle_count = count;
    return true;
}

bool nav_world_set(nav_world *w, const char *name, const char *value) {
    if (strcmp(name, "bodies") == 0) {
        return set_bodies(w, value);
    }
    if (strcmp(name, "slice") == 0) {
        return set_slice(w, value);
    }
    if (strcmp(name, "weight") == 0) {
        return set_weight(w, value);
    }
    if (strcmp(name, "heuristic") == 0) {
        int i = place_of(value, heuristics);
        if (i < 0) {
            return core_fail("nav.heuristic=%s: expected euclid, octile or zero", value);
        }
        w->heuristic = (nav_heuristic)i;
        return true;
    }
    if (strcmp(name, "avoidance") == 0) {
        int i = place_of(value, avoidances);
        if (i < 0) {
            return core_fail("nav.avoidance=%s: expected orca or none", value);
        }
        w->no_avoidance = i == 1;
        return true;
    }
    const char *near = core_nearest(name, settings, CORE_COUNT_OF(settings));
    return core_fail(
        "nav.%s: no such setting; %s%s%sthere are heuristic, weight, avoidance, slice and bodies",
        name, near ? "did you mean " : "", near ? near : "", near ? "? " : "");
}

// ---- contents ----

int nav_world_state(const nav_world *w, const core_columns **out, int capacity) {
    const core_columns *own[] = {&w->graph.set, &w->grid.set, &w->mesh.set,
                                 &w->flow.set,  &w->path.set, &w->agent.set};
    int n = 0;
    for (size_t i = 0; i < CORE_COUNT_OF(own); i++, n++) {
        if (out && n < capacity) {
            out[n] = own[i];
        }
    }
    for (uint32_t row = 0; row < core_columns_count(&w->graph.set); row++) {
        const core_columns *sets[] = {&w->graph.data[row]->node.set, &w->graph.data[row]->link.set};
        for (size_t i = 0; i < CORE_COUNT_OF(sets); i++, n++) {
            if (out && n < capacity) {
                out[n] = sets[i];
            }
        }
    }
    return n;
}

size_t nav_world_bytes(const nav_world *w) {
    size_t bytes = sizeof *w + core_columns_bytes(&w->graph.set) +
                   core_columns_bytes(&w->path.set) + core_columns_bytes(&w->agent.set) +
                   w->scratch.capacity * (sizeof(nav_record) + sizeof(nav_heap_entry));
    for (uint32_t row = 0; row < core_columns_count(&w->graph.set); row++) {
        const nav_graph_data *g = w->graph.data[row];
        bytes += sizeof *g + core_columns_bytes(&g->node.set) + core_columns_bytes(&g->link.set) +
                 g->cells.size * sizeof *g->cells.head;
    }
    for (uint32_t row = 0; row < core_columns_count(&w->grid.set); row++) {
        const nav_grid_data *g = w->grid.data[row];
        bytes += sizeof *g + (size_t)g->stride * (g->height + 2) +
                 sizeof(uint64_t) * ((size_t)g->row_words * (g->height + 2) +
                                     (size_t)g->column_words * (g->width + 2));
    }
    bytes += w->crowd.capacity * 24 * sizeof(float);
    for (uint32_t row = 0; row < core_columns_count(&w->mesh.set); row++) {
        bytes += nav_mesh_bytes(w->mesh.data[row]);
    }
    for (uint32_t row = 0; row < core_columns_count(&w->flow.set); row++) {
        const nav_flow_data *f = w->flow.data[row];
        bytes += sizeof *f + f->views.bytes + f->first.bytes + f->next.bytes;
    }
    bytes += w->coarse.capacity * sizeof(nav_coarse_record) + w->coarse.heap.bytes;
    bytes += w->views.capacity * (sizeof(nav_view) + sizeof(uint32_t)) +
             w->views.turns * (sizeof(double) + sizeof(uint32_t));
    if (w->grid_scratch) {
        bytes += sizeof *w->grid_scratch +
                 w->grid_scratch->capacity * (sizeof(nav_grid_record) + sizeof(uint64_t));
    }
    for (uint32_t row = 0; row < core_columns_count(&w->path.set); row++) {
        bytes += w->path.points[row].capacity * (sizeof(core_vec3) + sizeof(uint32_t));
    }
    return bytes;
}

void nav_world_counts(const nav_world *w, core_metrics *metrics) {
    uint32_t nodes = 0;
    for (uint32_t row = 0; row < core_columns_count(&w->graph.set); row++) {
        nodes += w->graph.head[row].nodes;
    }
    core_metrics_set(metrics, CORE_COUNT_NAV_NODES, nodes);
    core_metrics_set(metrics, CORE_COUNT_AGENTS, core_columns_count(&w->agent.set));
    core_metrics_set(metrics, CORE_COUNT_PATHS, core_columns_count(&w->path.set));
}
