// Options of a body, shared by corsac.phys.newBody and corsac.scene.spawn.
#ifndef SCRIPT_BIND_BODY_H
#define SCRIPT_BIND_BODY_H

#include "script/bind.h"

typedef struct bind_shape_options {
    int shape;
    core_vec3 size, normal, position;
    core_quat rotation;
    float radius, height, density, friction, restitution, rolling;
    bind_numbers points, triangles, heights, step, cells;
    int64_t columns;
    bool one_sided;
    bool has_shape, has_size, has_radius, has_height, has_normal, has_points, has_triangles;
    bool has_heights;
} bind_shape_options;

typedef struct bind_body_options {
    bind_shape_options shape; // when `shapes` is empty
    bind_list shapes;         // of bind_shape_options
    int type;
    core_vec3 velocity, angular_velocity;
    float linear_damping, angular_damping, gravity_scale;
    const char *layer;                      // NULL: "default"
    const char *locks;                      // NULL: none
    int on_contact, on_contact_end, on_hit; // stack indices, 0: none
} bind_body_options;

extern const bind_arg bind_body_fields[];

enum { BIND_SHAPES_MAX = 256 };
// Fills the room's descriptions: `out` for the body (pose left alone), shapes[BIND_SHAPES_MAX] and
// their number. Raises a Lua error when fields do not fit the shape.
uint32_t bind_body_read(script *s, lua_State *L, const char *owner,
                        const bind_body_options *options, phys_body_desc *out,
                        phys_shape_desc *shapes);
// Keeps the functions among the options for the body that was made.
void bind_body_callbacks(script *s, lua_State *L, const bind_body_options *options, phys_body body);
// Size that a built-in unit mesh takes to look like the body's first shape.
core_vec3 bind_body_mesh_scale(const bind_body_options *options);

// PHYS_LOCK_ flags of words, "x turnY"; NULL: 0. Raises a Lua error for others.
uint32_t bind_locks(lua_State *L, const char *owner, const char *words);

const char *bind_shape_name(phys_shape_type type);

extern const bind_type bind_body_type, bind_entity_type;

#endif
