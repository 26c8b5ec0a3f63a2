// What a run measures: stages (nested timers), counts, accuracy, memory, user figures. The names
// are a contract with the outside: see the lists below; new ones may be added, none is renamed.
#ifndef CORE_METRICS_H
#define CORE_METRICS_H

#include "core/base.h"

#define CORE_STAGES(X)                                                                             \
    X(SCRIPT, "script")                                                                            \
    X(SCENE, "scene")                                                                              \
    X(PHYS, "phys")                                                                                \
    X(PHYS_FIELDS, "phys.fields")                                                                  \
    X(PHYS_BROAD, "phys.broad")                                                                    \
    X(PHYS_NARROW, "phys.narrow")                                                                  \
    X(PHYS_ISLANDS, "phys.islands")                                                                \
    X(PHYS_SOLVE, "phys.solve")                                                                    \
    X(PHYS_CCD, "phys.ccd")                                                                        \
    X(ANIM, "anim")                                                                                \
    X(NAV, "nav")                                                                                  \
    X(AUDIO, "audio")                                                                              \
    X(METRICS, "metrics")                                                                          \
    X(GFX_CULL, "gfx.cull")                                                                        \
    X(GFX_CLUSTER, "gfx.cluster")                                                                  \
    X(GFX_DRAW, "gfx.draw")                                                                        \
    X(GFX_GPU, "gfx.gpu")

#define CORE_COUNTS(X)                                                                             \
    X(BODIES, "bodies")                                                                            \
    X(AWAKE, "awake")                                                                              \
    X(SHAPES, "shapes")                                                                            \
    X(PAIRS, "pairs")                                                                              \
    X(CONTACTS, "contacts")                                                                        \
    X(JOINTS, "joints")                                                                            \
    X(ISLANDS, "islands")                                                                          \
    X(ISLANDS_COARSE, "islands_coarse") /* with fewer substeps than the solver's default */        \
    X(ISLANDS_FINE, "islands_fine")     /* with more */                                            \
    X(SUBSTEPS_MAX, "substeps_max")     /* most that any island took */                            \
    X(TRIGGERS, "triggers")                                                                        \
    X(LIGHTS, "lights")                                                                            \
    X(CLUSTERS, "clusters")                                                                        \
    X(LIGHT_REFS, "light_refs")                                                                    \
    X(DRAWS, "draws")                                                                              \
    X(TRIANGLES, "triangles")                                                                      \
    X(SKELETONS, "skeletons")                                                                      \
    X(BONES, "bones")                                                                              \
    X(NAV_NODES, "nav_nodes")                                                                      \
    X(AGENTS, "agents")                                                                            \
    X(PATHS, "paths")                                                                              \
    X(VOICES, "voices")                                                                            \
    X(ENTITIES, "entities")                                                                        \
    X(LUA_KB, "lua_kb")

#define CORE_ENUM_STAGE_(id, name) CORE_STAGE_##id,
#define CORE_ENUM_COUNT_(id, name) CORE_COUNT_##id,
typedef enum core_stage { CORE_STAGES(CORE_ENUM_STAGE_) CORE_STAGE_TOTAL } core_stage;
typedef enum core_count { CORE_COUNTS(CORE_ENUM_COUNT_) CORE_COUNT_TOTAL } core_count;

const char *core_stage_name(core_stage stage);
const char *core_count_name(core_count count);

typedef struct core_metrics core_metrics;
core_metrics *core_metrics_create(void);
void core_metrics_destroy(core_metrics *m);

// A step's boundaries; stage times inside one step are summed, then become one sample.
void core_metrics_step_begin(core_metrics *m);
void core_metrics_step_end(core_metrics *m);
// So much of the running step's time was not its own (a picture that was asked for): step_ms leaves
// it out, stages keep theirs.
void core_metrics_step_exclude_ns(core_metrics *m, uint64_t ns);
// Stages nest; each time is inclusive. m may be NULL (no cost but the test). Main thread only.
void core_stage_begin(core_metrics *m, core_stage stage);
void core_stage_end(core_metrics *m, core_stage stage);
// Adds time measured elsewhere (GPU, worker) to the running step.
void core_stage_add_ns(core_metrics *m, core_stage stage, uint64_t ns);

void core_metrics_set(core_metrics *m, core_count count, double value);
double core_metrics_get(const core_metrics *m, core_count count);

typedef struct core_summary {
    double mean, p50, p95, p99, max, total; // ms
    uint64_t samples;
} core_summary;
core_summary core_metrics_step(const core_metrics *m);
core_summary core_metrics_stage(const core_metrics *m, core_stage stage);
// Last step's time in ms: the overlay and --metrics-csv read it.
double core_metrics_stage_last(const core_metrics *m, core_stage stage);
double core_metrics_step_last(const core_metrics *m);
uint64_t core_metrics_steps(const core_metrics *m);

// Chrome trace events: when on, every stage becomes an event. Main thread only.
bool core_metrics_trace(core_metrics *m, const char *path);

#endif
