// Joints: storage, and what the rest of the room calls. Not public.
#ifndef PHYS_JOINT_H
#define PHYS_JOINT_H

#include "core/columns.h"
#include "phys/phys.h"

enum { PHYS_JOINT_COOKIE = 0x706a7431 };
enum { PHYS_JOINT_HARD = 6, PHYS_JOINT_SOFT = 3 }; // most rows of each kind

enum {
    PHYS_JOINT_LIMITED = 1u,
    PHYS_JOINT_DRIVEN = 2u,
    PHYS_JOINT_COLLIDE = 4u // the two bodies may touch
};

// Impulses of a substep, carried from step to step: N s or N m s by row.
typedef struct phys_joint_impulse {
    float hard[PHYS_JOINT_HARD], soft[PHYS_JOINT_SOFT];
} phys_joint_impulse;

// a, b: slots of the bodies, 0: the world. la, lb: anchors from the centres of mass in the bodies'
// axes; qa, qb: the joint's frame seen from them, x along the axis. phase: pivot, rad of a beyond
// ratio times those of b.
#define PHYS_JOINT_COLUMNS(X)                                                                      \
    X(uint32_t, a, CORE_COLUMN_STATE)                                                              \
    X(uint32_t, b, CORE_COLUMN_STATE)                                                              \
    X(uint8_t, type, CORE_COLUMN_STATE)                                                            \
    X(uint8_t, flags, CORE_COLUMN_STATE)                                                           \
    X(core_vec3, la, CORE_COLUMN_STATE)                                                            \
    X(core_vec3, lb, CORE_COLUMN_STATE)                                                            \
    X(core_quat, qa, CORE_COLUMN_STATE)                                                            \
    X(core_quat, qb, CORE_COLUMN_STATE)                                                            \
    X(core_vec3, ground_a, CORE_COLUMN_STATE)                                                      \
    X(core_vec3, ground_b, CORE_COLUMN_STATE)                                                      \
    X(float, lower, CORE_COLUMN_STATE)                                                             \
    X(float, upper, CORE_COLUMN_STATE)                                                             \
    X(float, cone, CORE_COLUMN_STATE)                                                              \
    X(float, motor_speed, CORE_COLUMN_STATE)                                                       \
    X(float, motor_max, CORE_COLUMN_STATE)                                                         \
    X(float, rest, CORE_COLUMN_STATE)                                                              \
    X(float, hertz, CORE_COLUMN_STATE)                                                             \
    X(float, damping_ratio, CORE_COLUMN_STATE)                                                     \
    X(float, damping, CORE_COLUMN_STATE)                                                           \
    X(float, ratio, CORE_COLUMN_STATE)                                                             \
    X(float, break_force, CORE_COLUMN_STATE)                                                       \
    X(float, break_torque, CORE_COLUMN_STATE)                                                      \
    X(float, phase, CORE_COLUMN_STATE)                                                             \
    X(phys_joint_impulse, impulse, CORE_COLUMN_STATE)                                              \
    X(core_vec3, force, CORE_COLUMN_STATE)                                                         \
    X(core_vec3, torque, CORE_COLUMN_STATE)                                                        \
    X(uint64_t, user, CORE_COLUMN_STATE)
CORE_COLUMNS_DECLARE(phys_joints, PHYS_JOINT_COLUMNS)

typedef struct phys_joint_pairs {
    uint64_t *key; // body slots, lower << 32 | higher
    uint32_t count, capacity;
    bool stale;
} phys_joint_pairs;

// Row of a joint's body, CORE_NO_ROW for the world.
static inline uint32_t phys_joint_body(const core_columns *bodies, uint32_t slot) {
    return slot == 0 ? CORE_NO_ROW : bodies->pool.row[slot - 1];
}

// Joints of a body that goes are removed, their events pending.
void phys_joints_drop_body(phys_world *world, uint32_t body_slot);
void phys_joints_list_pairs(phys_world *world);
// Whether some joint of the two bodies keeps them from touching. Rows.
bool phys_joints_part(const phys_world *world, uint32_t body_a, uint32_t body_b);
// What moves wakes what it is joined to.
void phys_joints_wake(phys_world *world);
// After the solver: joints whose load is beyond what they bear go, with an event.
void phys_joints_break(phys_world *world);
double phys_joints_error(const phys_world *world);

#endif
