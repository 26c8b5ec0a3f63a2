// corsac.phys.newRagdoll: bodies and joints from a list of bones.
#include "script/bind_body.h"
#include "script/bind_cloth.h"
#include "script/bind_joint.h"
#include "script/bind_region.h"
#include "script/internal.h"

typedef struct bone_options {
    int64_t parent;
    core_vec3 head, tail, axis;
    core_quat rotation;
    float radius, mass, cone, twist, lower, upper;
    bool hinge;
} bone_options;
typedef struct ragdoll_options {
    bind_list bones;
    const char *layer;
    float friction, linear_damping, angular_damping;
} ragdoll_options;
typedef struct ragdoll_call {
    ragdoll_options options;
} ragdoll_call;

static void read_bones(const bind_list *list, phys_ragdoll_bone *out) {
    const bone_options *o = list->items;
    for (uint32_t i = 0; i < list->count; i++) {
        int64_t parent = CORE_CLAMP(o[i].parent, 0, 1 << 20); // Lua counts from 1, 0 is none
        out[i] = (phys_ragdoll_bone){.parent = (int32_t)parent - 1,
                                     .bone = i,
                                     .head = o[i].head,
                                     .tail = o[i].tail,
                                     .rotation = o[i].rotation,
                                     .radius = o[i].radius,
                                     .mass = o[i].mass,
                                     .cone = o[i].cone,
                                     .twist = o[i].twist,
                                     .hinge = o[i].hinge,
                                     .axis = o[i].axis,
                                     .lower = o[i].lower,
                                     .upper = o[i].upper};
    }
}

static int new_ragdoll(script *s, lua_State *L, void *args) {
    const ragdoll_options *o = &((ragdoll_call *)args)->options;
    enum { MOST = 256 };
    phys_ragdoll_bone bone[MOST];
    phys_body body[MOST];
    phys_joint joint[MOST];
    if (o->bones.count > MOST) {
        bind_error(L, "corsac.phys.newRagdoll: %u bones, expected at most %d",
                   (unsigned)o->bones.count, MOST);
    }
    read_bones(&o->bones, bone);
    phys_ragdoll_desc d = phys_ragdoll_desc_default();
    d.bones = bone;
    d.bone_count = o->bones.count;
    d.layer = o->layer ? bind_layer(s, L, o->layer) : 0;
    d.friction = o->friction;
    d.linear_damping = o->linear_damping;
    d.angular_damping = o->angular_damping;
    if (!phys_ragdoll_create(scene_phys(s->scene), &d, body, joint)) {
        bind_fail(L);
    }
    lua_createtable(L, (int)d.bone_count, 0);
    lua_createtable(L, (int)d.bone_count, 0);
    for (uint32_t i = 0; i < d.bone_count; i++) {
        bind_push(s, L, &bind_body_type, body[i]);
        lua_rawseti(L, -3, (int)i + 1);
        if (core_handle_is_null(joint[i])) {
            lua_pushboolean(L, false);
        } else {
            bind_push(s, L, &bind_joint_type, joint[i]);
        }
        lua_rawseti(L, -2, (int)i + 1);
    }
    return 2;
}

#define BONE(name, kind, member, ...)                                                              \
    { name, kind, BIND_AT(bone_options, member), __VA_ARGS__ }
static const bind_arg bone_fields[] = {
    BONE("parent", BIND_INT, parent, "number of an earlier bone; without, a root",
         .optional = true),
    BONE("head", BIND_VEC3, head, "place of its joint, in the world", "m"),
    BONE("tail", BIND_VEC3, tail, "its other end", "m"),
    BONE("rotation", BIND_QUAT, rotation, "of its body", .optional = true, .def_text = "none"),
    BONE("radius", BIND_FLOAT, radius, "of its capsule; 0: 0.15 of the length", "m",
         BIND_NOT_NEGATIVE, .optional = true),
    BONE("mass", BIND_FLOAT, mass, "0: as of water", "kg", BIND_NOT_NEGATIVE, .optional = true),
    BONE("cone", BIND_FLOAT, cone, "largest lean against the parent", "rad", BIND_POSITIVE,
         .optional = true, .def = 0.8),
    BONE("twist", BIND_FLOAT, twist, "to either side", "rad", BIND_POSITIVE, .optional = true,
         .def = 0.5),
    BONE("axis", BIND_VEC3, axis, "a hinge about this direction instead of cone and twist",
         .optional = true, .def_text = "none", BIND_GIVEN(bone_options, hinge)),
    BONE("lower", BIND_FLOAT, lower, "of the hinge, from this pose", "rad", .optional = true),
    BONE("upper", BIND_FLOAT, upper, "of the hinge, from this pose", "rad", .optional = true),
    {0}};

#define OPTION(name, kind, member, ...)                                                            \
    { name, kind, BIND_AT(ragdoll_options, member), __VA_ARGS__ }
static const bind_arg fields[] = {
    OPTION("bones", BIND_LIST, bones, "parents before children", .fields = bone_fields,
           .size = sizeof(bone_options)),
    OPTION("layer", BIND_STRING, layer, "name of its collision layer", .optional = true,
           .def_text = "default"),
    OPTION("friction", BIND_FLOAT, friction, "Coulomb's coefficient", NULL, BIND_NOT_NEGATIVE,
           .optional = true, .def = 0.6),
    OPTION("linearDamping", BIND_FLOAT, linear_damping, "loss of velocity", "1/s",
           BIND_NOT_NEGATIVE, .optional = true, .def = 0.05),
    OPTION("angularDamping", BIND_FLOAT, angular_damping, "loss of angular velocity", "1/s",
           BIND_NOT_NEGATIVE, .optional = true, .def = 1),
    {0}};

const bind_fn bind_ragdoll_functions[] = {
    {"newRagdoll",
     "Makes a body a bone, its origin at the bone's head, and the joints between: lists in the "
     "order of the bones, joints false for roots.",
     BIND_ARGS({"options", BIND_OPTIONS, BIND_AT(ragdoll_call, options), "the ragdoll",
                .fields = fields}),
     BIND_RETURNS({"bodies", "corsac.Body[]", NULL}, {"joints", "(corsac.Joint|false)[]", NULL}),
     sizeof(ragdoll_call), BIND_SIM, .mod = true, .cost = 10000, .run = new_ragdoll},
    {0}};
