// Movers: storage, and what the world calls. Not public.
#ifndef PHYS_MOVER_H
#define PHYS_MOVER_H

#include "core/columns.h"
#include "phys/phys.h"

enum { PHYS_MOVER_COOKIE = 0x706d7631 };

// drift: velocity that is not the wish's (falling, a jump, the platform that was left). place: the
// mover seen from the body it stands on, whose turn was `turn_from` then.
#define PHYS_MOVER_COLUMNS(X)                                                                      \
    X(core_vec3, position, CORE_COLUMN_STATE)                                                      \
    X(float, radius, CORE_COLUMN_STATE)                                                            \
    X(float, half_height, CORE_COLUMN_STATE)                                                       \
    X(float, slope_cos, CORE_COLUMN_STATE)                                                         \
    X(float, step, CORE_COLUMN_STATE)                                                              \
    X(float, push, CORE_COLUMN_STATE)                                                              \
    X(float, mass, CORE_COLUMN_STATE)                                                              \
    X(float, gravity_scale, CORE_COLUMN_STATE)                                                     \
    X(uint32_t, layers, CORE_COLUMN_STATE)                                                         \
    X(uint64_t, user, CORE_COLUMN_STATE)                                                           \
    X(core_vec3, wish, CORE_COLUMN_STATE)                                                          \
    X(core_vec3, drift, CORE_COLUMN_STATE)                                                         \
    X(core_vec3, velocity, CORE_COLUMN_STATE)                                                      \
    X(uint8_t, ground, CORE_COLUMN_STATE)                                                          \
    X(core_handle, body, CORE_COLUMN_STATE)                                                        \
    X(core_vec3, place, CORE_COLUMN_STATE)                                                         \
    X(core_quat, turn_from, CORE_COLUMN_STATE)                                                     \
    X(core_vec3, normal, CORE_COLUMN_STATE)                                                        \
    X(core_vec3, point, CORE_COLUMN_STATE)                                                         \
    X(float, turn, CORE_COLUMN_STATE)
CORE_COLUMNS_DECLARE(phys_movers, PHYS_MOVER_COLUMNS)

// The distance at which a mover stays from what it touches (m): room for the error of a cast.
#define PHYS_MOVER_SKIN 3e-3f

// Moves all of them by dt, in the order of their rows. still: no body moved in this step.
void phys_movers_update(phys_world *world, float dt, bool still);

#endif
