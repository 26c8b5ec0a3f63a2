// The world's storage: what every file of this room reads. Not public.
#ifndef PHYS_WORLD_H
#define PHYS_WORLD_H

#include "phys/cloth.h"
#include "phys/geom.h"
#include "phys/joint.h"
#include "phys/motion.h"
#include "phys/mover.h"
#include "phys/phys.h"
#include "phys/spent.h"
#include "phys/vec.h"

#include "core/memory.h"
#include "core/simd.h"

enum {
    PHYS_WORLD_COOKIE = 0x70776f31,
    PHYS_BODY_COOKIE = 0x70626f31,
    PHYS_SHAPE_COOKIE = 0x70736831,
    PHYS_TRIGGER_COOKIE = 0x70747231,
    PHYS_FIELD_COOKIE = 0x70666c31
};

// Distances in metres. Contacts are kept when closer than the margin, so that a body about to touch
// is slowed before it sinks in.
#define PHYS_MARGIN 0.02f

// Points are kept while their bodies moved less than this to each other (m) and each turned less
// than this (cosine of half the angle, 5 degrees).
#define PHYS_KEEP_DISTANCE 0.005f
#define PHYS_KEEP_COSINE   0.99905f
#define PHYS_APART         1e30f // separation of a pair out of reach
#define PHYS_FAST          0.05f // m: pairs that approach by more in a step are swept unless they touch
#define PHYS_NEAR          0.001f  // m: gap up to which a pair counts as touching then
#define PHYS_TOUCH         0.0005f // gaps up to this count as touching in events
#define PHYS_FAR           1e6f    // positions beyond are refused
#define PHYS_BOUNCE_MIN    0.2f // m/s: slower impacts do not bounce (they would never come to rest)

enum {
    PHYS_BODY_FRAME = 1u,     // principal axes differ from the body's: `iq*` is used
    PHYS_BODY_ISOTROPIC = 2u, // equal moments (balls): no gyroscopic term, no inertia rotation
    PHYS_BODY_LOST = 4u,      // became non-finite: frozen, named once, left out
    PHYS_BODY_ASLEEP = 16u,   // at rest with its island: takes no part until touched
    PHYS_BODY_CREEPS = 32u,   // left its place of rest, but slowly
    PHYS_BODY_EVENTS = 8u     // contacts are reported
};

// px: body origin, cx: centre of mass, lc: centre in the body's frame. im, ix: inverse mass and
// principal inverse moments; iq: body to principal frame. ex, tx: force and torque of the next
// step.
#define PHYS_BODY_COLUMNS(X)                                                                       \
    X(float, px, CORE_COLUMN_STATE)                                                                \
    X(float, py, CORE_COLUMN_STATE)                                                                \
    X(float, pz, CORE_COLUMN_STATE)                                                                \
    X(float, qx, CORE_COLUMN_STATE)                                                                \
    X(float, qy, CORE_COLUMN_STATE)                                                                \
    X(float, qz, CORE_COLUMN_STATE)                                                                \
    X(float, qw, CORE_COLUMN_STATE)                                                                \
    X(float, vx, CORE_COLUMN_STATE)                                                                \
    X(float, vy, CORE_COLUMN_STATE)                                                                \
    X(float, vz, CORE_COLUMN_STATE)                                                                \
    X(float, wx, CORE_COLUMN_STATE)                                                                \
    X(float, wy, CORE_COLUMN_STATE)                                                                \
    X(float, wz, CORE_COLUMN_STATE)                                                                \
    X(float, cx, CORE_COLUMN_STATE)                                                                \
    X(float, cy, CORE_COLUMN_STATE)                                                                \
    X(float, cz, CORE_COLUMN_STATE)                                                                \
    X(float, lcx, CORE_COLUMN_STATE)                                                               \
    X(float, lcy, CORE_COLUMN_STATE)                                                               \
    X(float, lcz, CORE_COLUMN_STATE)                                                               \
    X(float, im, CORE_COLUMN_STATE)                                                                \
    X(float, ix, CORE_COLUMN_STATE)                                                                \
    X(float, iy, CORE_COLUMN_STATE)                                                                \
    X(float, iz, CORE_COLUMN_STATE)                                                                \
    X(core_quat, iq, CORE_COLUMN_STATE)                                                            \
    X(core_vec3, force, CORE_COLUMN_STATE)                                                         \
    X(core_vec3, torque, CORE_COLUMN_STATE)                                                        \
    X(float, linear_damping, CORE_COLUMN_STATE)                                                    \
    X(float, angular_damping, CORE_COLUMN_STATE)                                                   \
    X(float, gravity_scale, CORE_COLUMN_STATE)                                                     \
    X(uint8_t, type, CORE_COLUMN_STATE)                                                            \
    X(uint8_t, layer, CORE_COLUMN_STATE)                                                           \
    X(uint16_t, flags, CORE_COLUMN_STATE)                                                          \
    X(uint32_t, shape, CORE_COLUMN_STATE) /* first shape's slot; 0: none */                        \
    X(uint64_t, user, CORE_COLUMN_STATE)                                                           \
    X(uint8_t, locks, CORE_COLUMN_STATE)                                                           \
    X(float, still, CORE_COLUMN_STATE) /* s within reach of rest_place, rest_turn */               \
    X(core_vec3, rest_place, CORE_COLUMN_STATE)                                                    \
    X(core_quat, rest_turn, CORE_COLUMN_STATE)                                                     \
    X(uint32_t, sleep_island, CORE_COLUMN_STATE)                                                   \
    X(uint8_t, level, 0)     /* of substeps */                                                     \
    X(uint32_t, touching, 0) /* contacts of this step */                                           \
    X(core_vec3, seen, 0)                                                                          \
    X(uint8_t, through, 0) /* accuracy: place at the last sample */
CORE_COLUMNS_DECLARE(phys_bodies, PHYS_BODY_COLUMNS)

// body: slot (handle index) of the owner. next: slot of the body's next shape. x0..z1: bounds,
// grown by the margin.
#define PHYS_SHAPE_COLUMNS(X)                                                                      \
    X(uint32_t, body, CORE_COLUMN_STATE)                                                           \
    X(uint32_t, next, CORE_COLUMN_STATE)                                                           \
    X(uint32_t, type, CORE_COLUMN_STATE)                                                           \
    X(uint32_t, hull, CORE_COLUMN_STATE) /* number in the list of hulls, or meshes, from 1 */      \
    X(core_vec3, half, CORE_COLUMN_STATE)                                                          \
    X(float, radius, CORE_COLUMN_STATE)                                                            \
    X(core_vec3, position, CORE_COLUMN_STATE)                                                      \
    X(core_quat, rotation, CORE_COLUMN_STATE)                                                      \
    X(float, friction, CORE_COLUMN_STATE)                                                          \
    X(float, rolling, CORE_COLUMN_STATE)                                                           \
    X(float, restitution, CORE_COLUMN_STATE)                                                       \
    X(float, x0, CORE_COLUMN_STATE)                                                                \
    X(float, y0, CORE_COLUMN_STATE)                                                                \
    X(float, z0, CORE_COLUMN_STATE)                                                                \
    X(float, x1, CORE_COLUMN_STATE)                                                                \
    X(float, y1, CORE_COLUMN_STATE)                                                                \
    X(float, z1, CORE_COLUMN_STATE)                                                                \
    X(uint8_t, moved, 0) /* left its bounds in this step, which were renewed */                    \
    X(uint32_t, row, 0)  /* the owner's row, of this step */
CORE_COLUMNS_DECLARE(phys_shapes, PHYS_SHAPE_COLUMNS)

// One contact point. ra, rb: from the centres of mass, world axes, at the start of the step.
typedef struct phys_point {
    core_vec3 ra, rb;
    float separation;     // m, < 0: overlap
    float base;           // separation when the point was made
    float normal_impulse; // N s of a substep, carried from step to step
    uint32_t feature;     // which corner, edge or face made it
} phys_point;
typedef struct phys_manifold {
    core_vec3 normal;   // unit, from a to b
    uint32_t count;     // 0..4
    core_vec3 friction; // N s, on b, sum over the points
    float twist;        // N m s about the normal, on b
    phys_point point[4];
    float apart; // without points: the pair's distance is at least this (m)
    // Where both bodies were when the pair was searched: rotations, and the centre of the smaller
    // one seen from the larger.
    core_quat qa, qb;
    core_vec3 offset;
} phys_manifold;

// Pairs whose shapes can touch in one point without an arm on either side (ball on ball, ball on
// anything static) keep 1 point; all others up to 4. Slots are stable, rows are of this step.
#define PHYS_BALL_COLUMNS(X)                                                                       \
    X(uint32_t, sa, CORE_COLUMN_STATE)                                                             \
    X(uint32_t, sb, CORE_COLUMN_STATE)                                                             \
    X(float, jn, CORE_COLUMN_STATE)                                                                \
    X(float, jx, CORE_COLUMN_STATE)                                                                \
    X(float, jy, CORE_COLUMN_STATE)                                                                \
    X(uint8_t, touch, CORE_COLUMN_STATE)                                                           \
    X(float, jz, CORE_COLUMN_STATE)                                                                \
    X(float, rx, CORE_COLUMN_STATE)                                                                \
    X(float, ry, CORE_COLUMN_STATE)                                                                \
    X(float, rz, CORE_COLUMN_STATE)                                                                \
    X(float, friction, CORE_COLUMN_STATE)                                                          \
    X(float, rolling, CORE_COLUMN_STATE)                                                           \
    X(float, restitution, CORE_COLUMN_STATE)                                                       \
    X(float, nx, 0)                                                                                \
    X(float, ny, 0)                                                                                \
    X(float, nz, 0)                                                                                \
    X(float, separation, 0)                                                                        \
    X(uint32_t, a, 0)                                                                              \
    X(uint32_t, b, 0)                                                                              \
    X(float, reach, CORE_COLUMN_STATE)   /* sum of the radii; fixed: endless */                    \
    X(uint8_t, fixed, CORE_COLUMN_STATE) /* b is no ball that moves */                             \
    X(uint32_t, stamp, 0)
CORE_COLUMNS_DECLARE(phys_balls, PHYS_BALL_COLUMNS)
#define PHYS_CONTACT_COLUMNS(X)                                                                    \
    X(uint32_t, sa, CORE_COLUMN_STATE)                                                             \
    X(uint32_t, sb, CORE_COLUMN_STATE)                                                             \
    X(uint8_t, touch, CORE_COLUMN_STATE)                                                           \
    X(float, friction, CORE_COLUMN_STATE)                                                          \
    X(float, restitution, CORE_COLUMN_STATE)                                                       \
    X(phys_manifold, manifold, CORE_COLUMN_STATE)                                                  \
    X(uint32_t, a, 0)                                                                              \
    X(uint32_t, b, 0)                                                                              \
    X(uint32_t, stamp, 0)
CORE_COLUMNS_DECLARE(phys_contacts, PHYS_CONTACT_COLUMNS)

// A shape near a mesh: owns as many rows of the two sets above as there are directions in which it
// is touched. touch: some of them touch. qa..offset, searched: how the pair was when it was last
// looked at, and how far around.
#define PHYS_MESH_PARTS 8u
typedef struct phys_mesh_rows {
    uint32_t slot[PHYS_MESH_PARTS];
} phys_mesh_rows;
#define PHYS_MESH_PAIR_COLUMNS(X)                                                                  \
    X(uint32_t, sa, CORE_COLUMN_STATE)                                                             \
    X(uint32_t, sb, CORE_COLUMN_STATE)                                                             \
    X(uint8_t, ball, CORE_COLUMN_STATE)                                                            \
    X(uint8_t, touch, CORE_COLUMN_STATE)                                                           \
    X(uint8_t, count, CORE_COLUMN_STATE) /* rows owned */                                          \
    X(uint8_t, used, CORE_COLUMN_STATE)  /* rows that hold something */                            \
    X(phys_mesh_rows, rows, CORE_COLUMN_STATE)                                                     \
    X(core_quat, qa, CORE_COLUMN_STATE)                                                            \
    X(core_quat, qb, CORE_COLUMN_STATE)                                                            \
    X(core_vec3, offset, CORE_COLUMN_STATE)                                                        \
    X(float, searched, CORE_COLUMN_STATE)                                                          \
    X(uint8_t, wanted, 0)                                                                          \
    X(uint32_t, a, 0)                                                                              \
    X(uint32_t, b, 0)                                                                              \
    X(uint32_t, stamp, 0)
CORE_COLUMNS_DECLARE(phys_mesh_pairs, PHYS_MESH_PAIR_COLUMNS)

// layers: bit per layer seen, never 0.
#define PHYS_TRIGGER_COLUMNS(X)                                                                    \
    X(uint32_t, type, CORE_COLUMN_STATE)                                                           \
    X(core_vec3, position, CORE_COLUMN_STATE)                                                      \
    X(core_quat, rotation, CORE_COLUMN_STATE)                                                      \
    X(core_vec3, half, CORE_COLUMN_STATE)                                                          \
    X(float, radius, CORE_COLUMN_STATE)                                                            \
    X(uint32_t, layers, CORE_COLUMN_STATE)                                                         \
    X(uint64_t, user, CORE_COLUMN_STATE)
CORE_COLUMNS_DECLARE(phys_triggers, PHYS_TRIGGER_COLUMNS)
// Visits: who is inside which trigger, sorted by trigger slot, then body slot.
#define PHYS_VISIT_COLUMNS(X)                                                                      \
    X(core_handle, trigger, CORE_COLUMN_STATE)                                                     \
    X(core_handle, body, CORE_COLUMN_STATE)
CORE_COLUMNS_DECLARE(phys_visits, PHYS_VISIT_COLUMNS)
#define PHYS_FIELD_COLUMNS(X) X(phys_field_desc, desc, CORE_COLUMN_STATE)
CORE_COLUMNS_DECLARE(phys_fields, PHYS_FIELD_COLUMNS)

// A hull and who uses it: equal point sets share one.
typedef struct phys_hull_entry {
    phys_geom_hull hull;
    uint64_t hash; // of the points it was made from
    uint32_t users;
} phys_hull_entry;

typedef struct phys_event_list {
    phys_event *event;
    uint32_t count, capacity;
} phys_event_list;

// Finds the contact of a pair of shape slots. Open addressing, rebuilt from the columns when
// needed.
typedef struct phys_pair_map {
    uint64_t *key;   // slot a << 32 | slot b, a < b; 0: empty
    uint32_t *value; // contact slot << 2 | kind (0: points, 1: ball, 2: mesh)
    uint32_t capacity, count;
} phys_pair_map;

typedef struct phys_pair { // shape rows
    uint32_t a, b;
} phys_pair;
typedef struct phys_pair_list {
    phys_pair *pair;
    uint32_t count, capacity;
} phys_pair_list;

typedef struct phys_box {
    float lo[3], hi[3];
} phys_box;
// A complete binary tree of boxes over rows of shapes, see tree.c.
typedef struct phys_tree {
    uint32_t *order; // [count] shape rows
    phys_box *node;  // [2 * leaves]
    uint32_t count, leaves, capacity, age;
} phys_tree;

typedef struct phys_broad_method {
    const char *name;
    // Fills world->pairs from the shapes' bounds: all of them, or, when partial, those with a shape
    // that moved.
    void (*find)(phys_world *world);
    bool partial;
} phys_broad_method;
typedef struct phys_solver_method {
    const char *name;
    int substeps, iterations; // defaults
    bool sleeps;              // leaves sleeping bodies out and has levels of substeps
    void (*step)(phys_world *world, float dt);
} phys_solver_method;
// Levels of substeps, as multiples of half the solver's default.
enum {
    PHYS_LEVEL_DEFAULT,
    PHYS_LEVEL_MORE,
    PHYS_LEVEL_MOST,
    PHYS_LEVEL_FEW, // calm chains
    PHYS_LEVEL_NET, // cloth of rods
    PHYS_LEVELS
};

// Where static bodies changed; see phys_world_static_changes.
#define PHYS_STATIC_LOG 256u
typedef struct phys_static_log {
    uint64_t version, oldest; // changes oldest + 1 .. version are in the ring
    core_aabb change[PHYS_STATIC_LOG];
} phys_static_log;

struct phys_world {
    core_jobs *jobs;
    core_metrics *metrics;
    phys_spent *spent;
    core_vec3 gravity;
    const phys_broad_method *broad;
    const phys_solver_method *solver;
    int substeps, iterations; // 0: the solver's default
    phys_bodies bodies;
    phys_shapes shapes;
    phys_balls balls;
    phys_contacts contacts;
    phys_mesh_pairs mesh_pairs;
    phys_joints joints;
    phys_joint_pairs joint_pairs;
    struct phys_hull_entry *hulls; // shared by shapes with equal points
    uint32_t hull_count, hull_capacity;
    struct phys_mesh_entry *meshes; // shared likewise
    uint32_t mesh_count, mesh_capacity;
    phys_triggers triggers;
    phys_visits visits;
    phys_fields fields;
    phys_movers movers;
    phys_cloths cloths;
    phys_particles particles;
    phys_holds holds;
    bool cloth_iterates;             // edges one by one instead of whole lines
    uint32_t rule[32];               // bit b of rule[a]: layers a and b collide
    phys_event_list events, pending; // of the last step; of removals since
    phys_pair_map map;
    phys_pair_list pairs;
    phys_tree fixed_tree, moving_tree;
    bool trees_stale;    // rows changed
    bool shapes_changed; // bodies came or went since the last step
    bool edited;         // bodies were made, moved or removed since the last step
    phys_static_log statics;
    bool any_moved;   // some shape left its bounds in this step
    bool rows_stale;  // contacts' body rows are to be looked up again
    bool pairs_stale; // layers or rules changed: every pair is to be asked again
    uint32_t *order;  // sweep order of shape rows, kept between steps
    uint32_t order_count, order_capacity;
    core_arena scratch;                // of one step
    uint32_t stamp;                    // number of the broad phase, marks living pairs
    const phys_integrator *integrator; // of bodies that touch nothing; NULL: the solver's own
    bool auto_integrator;              // that one only where forces are not constant
    phys_force_fn *force;              // NULL: none
    void *force_ctx;
    uint8_t mix_friction, mix_restitution; // rules of material.c
    bool sleep;
    bool joints_iterate;                 // chains and trees are left to sweeps: a baseline
    uint32_t layers;                     // bit per layer that some body with a shape is in
    uint32_t islands;                    // of the last step
    uint32_t level_islands[PHYS_LEVELS]; // awake ones
    uint32_t touching;                   // contacts of the last step
    // Accuracy: the first sample since bodies were last added, moved or removed, and the work that
    // forces did since.
    bool measured;
    double time, first_time, first_energy, first_momentum[3], energy_scale, work;
    uint32_t tunnelled;
};

// A shape in the world: what collision functions read.
typedef struct phys_geom {
    phys_shape_type type;
    core_vec3 position;
    core_quat rotation;
    phys_mat3 axes; // body to world
    core_vec3 half;
    float radius, half_height; // capsule, cylinder: along the local y axis
    const phys_geom_hull *hull;
    const struct phys_mesh *mesh;
} phys_geom;

extern const phys_broad_method phys_broad_brute, phys_broad_sap, phys_broad_tree;
extern const phys_solver_method phys_solver_sequential, phys_solver_soft, phys_solver_impulse;

static inline core_vec3 phys_get3(const float *x, const float *y, const float *z, uint32_t i) {
    return core_v3(x[i], y[i], z[i]);
}
static inline void phys_put3(float *x, float *y, float *z, uint32_t i, core_vec3 v) {
    x[i] = v.x;
    y[i] = v.y;
    z[i] = v.z;
}
static inline core_quat phys_body_quat(const phys_bodies *b, uint32_t i) {
    return (core_quat){b->qx[i], b->qy[i], b->qz[i], b->qw[i]};
}
static inline uint32_t phys_slot_row(const core_columns *set, uint32_t slot) {
    return set->pool.row[slot - 1];
}
static inline uint32_t phys_row_slot(const core_columns *set, uint32_t row) {
    return set->pool.slot_of_row[row] + 1;
}

// Dynamic and awake; moves: that, or kinematic with a velocity.
static inline bool phys_mobile(const phys_bodies *b, uint32_t i) {
    return b->type[i] == PHYS_DYNAMIC && (b->flags[i] & PHYS_BODY_ASLEEP) == 0;
}
static inline bool phys_moves(const phys_bodies *b, uint32_t i) {
    return phys_mobile(b, i) || (b->type[i] == PHYS_KINEMATIC &&
                                 (b->vx[i] != 0.0f || b->vy[i] != 0.0f || b->vz[i] != 0.0f ||
                                  b->wx[i] != 0.0f || b->wy[i] != 0.0f || b->wz[i] != 0.0f));
}

// Takes the locked world axes out of a velocity.
static inline core_vec3 phys_lock_motion(uint8_t locks, core_vec3 v) {
    return core_v3(locks & PHYS_LOCK_X ? 0.0f : v.x, locks & PHYS_LOCK_Y ? 0.0f : v.y,
                   locks & PHYS_LOCK_Z ? 0.0f : v.z);
}
static inline core_vec3 phys_lock_turn(uint8_t locks, core_vec3 w) {
    return phys_lock_motion((uint8_t)(locks >> 3), w);
}

// world.c: the sets of state, in the order of hashes and snapshots.
enum { PHYS_SETS = 13 };
void phys_world_sets(phys_world *world, core_columns *set[PHYS_SETS]);
void phys_world_restored(phys_world *world); // fills caches again, after columns were replaced

// shape.c
bool phys_shape_check(const phys_shape_desc *shape, phys_body_type body);
bool phys_material_check(const char *what, const phys_material *material);
bool phys_body_check(const phys_body_desc *desc); // body.c: all but its shapes
// hulls.c: number of the hull of a description's points, 0 + core_fail when they span none.
uint32_t phys_hull_share(phys_world *world, const phys_shape_desc *shape);
void phys_hull_leave(phys_world *world, uint32_t number);
void phys_hulls_release(phys_world *world);
#define PHYS_HULL_FACES  64u
#define PHYS_HULL_POINTS 4096u
typedef struct phys_mass { // about the body's origin axes
    float mass;
    core_vec3 center;
    phys_mat3 inertia; // about the centre
} phys_mass;
bool phys_shape_mass(const phys_shape_desc *shape, phys_mass *out);
// Principal moments and axes of a symmetric matrix (Jacobi). Diagonal input gives the identity.
core_vec3 phys_principal(const phys_mat3 *inertia, core_quat *frame);
phys_geom phys_shape_geom(const phys_world *world, uint32_t shape_row);
core_aabb phys_geom_bounds(const phys_geom *geom);
void phys_shapes_update_bounds(phys_world *world, float dt);

// statics.c: notes that a body, if static, is where it is now (call before and after a change).
void phys_static_note(phys_world *world, uint32_t body_row);
void phys_static_forget(phys_world *world); // anything may have changed

// body.c
void phys_body_sync_center(phys_bodies *b, uint32_t row); // origin -> centre of mass
void phys_body_sync_origin(phys_bodies *b, uint32_t row); // centre of mass -> origin
core_vec3 phys_body_inverse_inertia(const phys_bodies *b, uint32_t row, core_vec3 v);

// tree.c
void phys_tree_update(phys_world *world);
// Rows whose bounds meet the box; returns how many there are, of which `capacity` are written.
uint32_t phys_tree_query(const phys_world *world, const phys_tree *tree, const phys_box *box,
                         uint32_t *out, uint32_t capacity);
void phys_trees_release(phys_world *world);

// query.c: rows of shapes whose bounds meet the box, by body; returns how many there are.
uint32_t phys_query_shapes(phys_world *world, const phys_box *box, uint32_t *out,
                           uint32_t capacity);

// material.c
phys_material phys_shape_material(const phys_shapes *s, uint32_t shape_row);
phys_material phys_mix_materials(const phys_world *world, phys_material a, phys_material b);
void phys_remix_contacts(phys_world *world); // after a change of materials or rules
bool phys_set_mixing(const char *name, const char *value, uint8_t *out);

// pairs.c
void phys_layers_update(phys_world *world);
// Whether a body could touch anything that there is, by the rules of layers.
static inline bool phys_meets_some(const phys_world *w, uint32_t row) {
    return (w->rule[w->bodies.layer[row]] & w->layers) != 0;
}
void phys_pair_push(phys_pair_list *list, uint32_t a, uint32_t b);
bool phys_pair_wanted(const phys_world *world, uint32_t shape_a, uint32_t shape_b);
void phys_pairs_update(phys_world *world);
void phys_pairs_drop_shape(phys_world *world, uint32_t shape_slot);
void phys_pairs_release(phys_world *world);
void phys_pairs_rebuild_map(phys_world *world);
uint32_t phys_ball_row_add(phys_world *world, uint32_t sa, uint32_t sb);    // slots of shapes, of
uint32_t phys_contact_row_add(phys_world *world, uint32_t sa, uint32_t sb); // the new row

// narrow.c: how a pair is seen now, which its last search is compared with.
typedef struct phys_pair_view {
    core_quat qa, qb;
    core_vec3 dc;     // from the centre of a to that of b
    core_vec3 offset; // centre of the smaller one seen from the larger
    float extent;     // farthest reach of the smaller one: how far a turn can move its points
} phys_pair_view;
phys_pair_view phys_view_pair(const phys_world *w, uint32_t shape_a, uint32_t shape_b,
                              uint32_t row_a, uint32_t row_b);
// Bound on how far any point moved, seen from the other body, since the last search.
float phys_moved_since(const phys_pair_view *old, const phys_pair_view *now);
bool phys_manifold_recycle(phys_manifold *m, const phys_pair_view *v, float reach);
void phys_manifold_carry(const phys_manifold *old, phys_manifold *m);
float phys_shape_extent(const phys_shapes *s, uint32_t shape);
// mesh_pairs.c
uint32_t phys_mesh_pair_add(phys_world *world, uint32_t sa, uint32_t sb, bool ball); // its slot
void phys_mesh_pair_remove(phys_world *world, uint32_t row);
void phys_mesh_pairs_narrow(phys_world *world, float dt);
// meshes.c: as for hulls.
uint32_t phys_mesh_share(phys_world *world, const phys_shape_desc *shape);
void phys_mesh_leave(phys_world *world, uint32_t number);
void phys_meshes_release(phys_world *world);
bool phys_mesh_stands(const phys_world *world, uint32_t number);
void phys_meshes_recount(phys_world *world); // after shapes were replaced
size_t phys_meshes_bytes(const phys_world *world);
const struct phys_mesh *phys_mesh_at(const phys_world *world, uint32_t number);

// narrow.c, collide*.c: out->count points closer than the margin; features and impulses are set by
// the caller. a.type <= b.type in the order of phys_shape_type.
void phys_narrow_update(phys_world *world, float dt);
CORE_SIMD_DECLARE(void, phys_narrow_balls,
                  (phys_world * world, uint32_t begin, uint32_t end, float dt))
void phys_collide(const phys_geom *a, const phys_geom *b, float margin, phys_manifold *out);
// Distance of two shapes (<= 0: overlap) and the unit direction from a to b along which it is.
float phys_separation(const phys_geom *a, const phys_geom *b, core_vec3 *normal);
// The same, and the point of b's surface that is closest.
float phys_closest_on(const phys_geom *a, const phys_geom *b, core_vec3 *normal, core_vec3 *on_b);

// sweep.c: a shape in motion about its body's centre of mass. extent: its farthest reach from
// there.
typedef struct phys_moving {
    phys_geom geom;
    core_vec3 center, v, w;
    float extent;
} phys_moving;
phys_geom phys_moving_at(const phys_moving *m, float t);
phys_moving phys_shape_moving(const phys_world *w, uint32_t shape, uint32_t row); // narrow.c
// First time in [0, dt] at which they touch. Conservative advancement; see sweep.c.
bool phys_sweep(const phys_moving *a, const phys_moving *b, float dt, float *time);

// Contact of two shapes that meet at time t, found there with anchors at the place of then: anchors
// and gaps become those of now, the gaps less what the motion closes until then.
void phys_swept_points(const phys_moving *a, const phys_moving *b, float t, phys_manifold *m);

void phys_collide_convex(const phys_geom *a, const phys_geom *b, float margin, phys_manifold *out);
// With the face of `flat` along n, whatever else would part them sooner.
void phys_collide_face(const phys_geom *flat, const phys_geom *b, core_vec3 n, float margin,
                       phys_manifold *m);
void phys_collide_plane(const phys_geom *a, const phys_geom *b, float margin, phys_manifold *out);
void phys_collide_box_box(const phys_geom *a, const phys_geom *b, float margin, phys_manifold *out);

// Picks at most 4 of n > 4 points (same plane, unit normal): keep[3] may be -1.
void phys_manifold_reduce(const core_vec3 *p, const float *separation, int n, core_vec3 normal,
                          int keep[4]);

// islands.c
void phys_islands_update(phys_world *world, float dt);
void phys_wake_row(phys_world *world, uint32_t row); // with its island
void phys_wake_all(phys_world *world);
int phys_level_substeps(const phys_world *world, uint32_t level);

// events.c, fields.c
void phys_event_push(phys_event_list *list, const phys_event *event);
void phys_events_begin(phys_world *world); // forgets the last step's, takes over the pending ones
void phys_events_triggers(phys_world *world);
void phys_events_contacts(phys_world *world, float dt);
void phys_events_contact_end(phys_world *world, phys_event_list *list, uint32_t sa, uint32_t sb);
// Sum of the fields at a place; gravity excluded.
core_vec3 phys_field_acceleration(const phys_world *world, core_vec3 at, uint32_t layer);
// The same for the body in `row`, timed now and then.
core_vec3 phys_field_pull(const phys_world *world, core_vec3 at, uint32_t row);
// Whether anything but gravity and what was applied for the step pulls at bodies; the whole of it.
bool phys_pulled(const phys_world *world);
core_vec3 phys_pull(const phys_world *world, core_vec3 at, core_vec3 velocity, float time,
                    uint32_t row);
// The integrator of a free body in this step; NULL: the solver's own.
const phys_integrator *phys_integrator_of(const phys_world *world, uint32_t row);
core_vec3 phys_field_wind(const phys_world *world, core_vec3 at, uint32_t layer); // m/s
bool phys_geom_contains(const phys_geom *geom, core_vec3 point);
phys_geom phys_geom_make(phys_shape_type type, core_vec3 position, core_quat rotation,
                         core_vec3 half, float radius);
bool phys_region_check(const char *what, phys_shape_type type, core_vec3 half, float radius,
                       core_vec3 position);

// integrate.c
void phys_integrate_velocity(phys_world *world, float h);
// Angular momentum of an angular velocity in a rotation, and back.
core_vec3 phys_momentum_of(const phys_bodies *b, uint32_t row, core_quat q, core_vec3 w);
core_vec3 phys_spin_of(const phys_bodies *b, uint32_t row, core_quat q, core_vec3 momentum);
core_quat phys_turned(core_quat q, core_vec3 turn);            // by a rotation vector, rad
void phys_put_quat(phys_bodies *b, uint32_t row, core_quat q); // made of unit length
void phys_integrate_rotation(phys_bodies *b, uint32_t row, float h);
// The change of angular velocity that keeps the momentum of a body that is not round.
void phys_finish_precession(phys_bodies *b, uint32_t row, float dt);
void phys_finish_rotation(phys_bodies *b, uint32_t row, core_vec3 turn, float dt, bool free);
// Moves a free body by a method of motion.h, from its state at the start of the step.
void phys_integrate_free(phys_world *world, uint32_t row, float dt, int substeps);
void phys_clear_forces(phys_world *world);

// continuous.c: rotations at the start of the step, on the scratch arena; then, after the solver,
// what went through something is put back to where it met it.
core_quat *phys_continuous_begin(phys_world *world);
void phys_continuous_end(phys_world *world, const core_quat *rotations, float dt);

#endif
