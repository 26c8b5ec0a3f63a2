// Ragdolls: bodies where the bones are, limits from the rest pose, poses handed over and back, a
// pile that comes to rest, bones of a skeleton, bad input.
#include "core/log.h"
#include "phys/phys.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static phys_world *w;
void setUp(void) {
    phys_world_desc d = phys_world_desc_default();
    w = phys_world_create(&d);
}
void tearDown(void) { phys_world_destroy(w); }

static void run(int steps) {
    for (int i = 0; i < steps; i++) {
        TEST_ASSERT_TRUE(phys_world_step(w, 1.0f / 60.0f));
    }
}

// A person of 1.7 m: hips, chest, head, arms and legs, knees and elbows that bend one way.
enum { BONES = 11 };
static void person(phys_ragdoll_bone b[BONES], core_vec3 at) {
    static const struct {
        int parent;
        float head[3], tail[3], radius, mass;
    } part[BONES] = {
        {-1, {0, 0.95f, 0}, {0, 1.15f, 0}, 0.13f, 15},
        {0, {0, 1.15f, 0}, {0, 1.45f, 0}, 0.14f, 20},
        {1, {0, 1.45f, 0}, {0, 1.72f, 0}, 0.1f, 5},
        {1, {0.2f, 1.4f, 0}, {0.48f, 1.4f, 0}, 0.05f, 2.5f},
        {3, {0.48f, 1.4f, 0}, {0.76f, 1.4f, 0}, 0.04f, 2},
        {1, {-0.2f, 1.4f, 0}, {-0.48f, 1.4f, 0}, 0.05f, 2.5f},
        {5, {-0.48f, 1.4f, 0}, {-0.76f, 1.4f, 0}, 0.04f, 2},
        {0, {0.1f, 0.9f, 0}, {0.1f, 0.5f, 0}, 0.07f, 8},
        {7, {0.1f, 0.5f, 0}, {0.1f, 0.05f, 0}, 0.05f, 5},
        {0, {-0.1f, 0.9f, 0}, {-0.1f, 0.5f, 0}, 0.07f, 8},
        {9, {-0.1f, 0.5f, 0}, {-0.1f, 0.05f, 0}, 0.05f, 5},
    };
    memset(b, 0, sizeof(phys_ragdoll_bone) * BONES);
    for (int i = 0; i < BONES; i++) {
        const float *h = part[i].head, *t = part[i].tail;
        b[i].parent = part[i].parent;
        b[i].head = core_v3_add(at, core_v3(h[0], h[1], h[2]));
        b[i].tail = core_v3_add(at, core_v3(t[0], t[1], t[2]));
        b[i].radius = part[i].radius;
        b[i].mass = part[i].mass;
        b[i].hinge = i == 4 || i == 6 || i == 8 || i == 10;
        b[i].axis = i < 7 ? core_v3(0, 1, 0) : core_v3(1, 0, 0);
        b[i].lower = i == 4 ? -2.2f : 0.0f; // elbows forward, knees backward
        b[i].upper = i == 4 ? 0.0f : 2.2f;
    }
}
static phys_ragdoll_desc desc_of(const phys_ragdoll_bone *b) {
    phys_ragdoll_desc d = phys_ragdoll_desc_default();
    d.bones = b;
    d.bone_count = BONES;
    return d;
}
static void add_floor(void) {
    phys_shape_desc s = phys_shape_desc_default(PHYS_PLANE);
    phys_body_desc b = phys_body_desc_default();
    b.type = PHYS_STATIC;
    phys_body_create(w, &b, &s, 1);
}

static void test_bodies_are_where_the_bones_are(void) {
    phys_ragdoll_bone b[BONES];
    phys_body body[BONES];
    phys_joint joint[BONES];
    person(b, core_v3(3, 2, 1));
    phys_ragdoll_desc d = desc_of(b);
    TEST_ASSERT_TRUE(phys_ragdoll_create(w, &d, body, joint));
    TEST_ASSERT_EQUAL_UINT32(BONES, phys_body_count(w));
    TEST_ASSERT_EQUAL_UINT32(BONES - 1, phys_joint_count(w));
    float mass = 0;
    for (int i = 0; i < BONES; i++) {
        core_vec3 p;
        phys_body_position(w, body[i], &p);
        TEST_ASSERT_FLOAT_WITHIN(1e-6f, b[i].head.y, p.y);
        mass += phys_body_mass(w, body[i]);
    }
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 75.0f, mass);
    TEST_ASSERT_TRUE(core_handle_is_null(joint[0]));
}

// In a pose beyond the rest pose the limits are still those of the rest pose.
static void test_poses_pass_both_ways(void) {
    phys_ragdoll_bone b[BONES];
    phys_body body[BONES];
    phys_joint joint[BONES];
    phys_ragdoll_pose pose[BONES];
    person(b, core_v3(0, 0, 0));
    core_quat turn = core_quat_axis_angle(core_v3(0, 0, 1), 1.0f);
    for (int i = 0; i < BONES; i++) { // all of it turned and thrown
        pose[i] = (phys_ragdoll_pose){.position = core_quat_rotate(turn, b[i].head),
                                      .velocity = core_v3(1, 2, 3),
                                      .rotation = turn};
        pose[i].position.y += 5;
    }
    phys_ragdoll_desc d = desc_of(b);
    d.pose = pose;
    d.linear_damping = d.angular_damping = 0;
    TEST_ASSERT_TRUE(phys_ragdoll_create(w, &d, body, joint));
    float angle;
    TEST_ASSERT_TRUE(phys_joint_coordinate(w, joint[8], &angle));
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 0, angle);
    run(30);
    for (int i = 0; i < BONES; i++) { // a throw without any force between the parts
        core_vec3 p;
        core_quat q;
        phys_body_position(w, body[i], &p);
        phys_body_rotation(w, body[i], &q);
        TEST_ASSERT_FLOAT_WITHIN(2e-3f, pose[i].position.x + 0.5f, p.x);
        TEST_ASSERT_FLOAT_WITHIN(2e-3f, pose[i].position.z + 1.5f, p.z);
        TEST_ASSERT_FLOAT_WITHIN(1e-3f, turn.z, q.z);
    }
}

// For a moment joints part where the continuous pass holds one limb of a falling doll and not the
// next; they are whole again when the pile lies. (Twenty dolls: scripts/scenes/phys/ragdolls.lua.)
static void test_a_pile_comes_to_rest(void) {
    enum { DOLLS = 6, STEPS = 600 };
    add_floor();
    phys_body body[DOLLS][BONES];
    phys_joint joint[DOLLS][BONES];
    for (int k = 0; k < DOLLS; k++) {
        phys_ragdoll_bone b[BONES];
        person(b, core_v3(0.5f * (float)(k % 2), 0.3f + 1.9f * (float)k, 0));
        phys_ragdoll_desc d = desc_of(b);
        TEST_ASSERT_TRUE(phys_ragdoll_create(w, &d, body[k], joint[k]));
    }
    float fastest = 0, now = 0;
    for (int i = 0; i < STEPS; i++) {
        run(1);
        phys_pose_view v = phys_world_poses(w);
        now = 0;
        for (uint32_t k = 0; k < v.count; k++) {
            now = fmaxf(now, core_v3_length(core_v3(v.vx[k], v.vy[k], v.vz[k])));
            TEST_ASSERT_TRUE(v.py[k] > -0.1f && v.py[k] < 13);
        }
        fastest = fmaxf(fastest, now);
    }
    phys_accuracy a;
    phys_world_accuracy(w, &a);
    printf("ragdolls: fastest ever %.1f m/s, at the end %.3f m/s, joints apart %.2f mm\n",
           (double)fastest, (double)now, a.joint_error_max_m * 1e3);
    TEST_ASSERT_TRUE(now < 0.7f);
    TEST_ASSERT_TRUE(fastest < 25.0f); // a fall of 10 m gives 14
    TEST_ASSERT_TRUE(a.joint_error_max_m < 0.01);
    for (int k = 0; k < DOLLS; k++) { // knees bend one way
        float angle;
        phys_joint_coordinate(w, joint[k][8], &angle);
        TEST_ASSERT_TRUE(angle > -0.05f && angle < 2.25f);
    }
}

static void test_bones_of_a_skeleton(void) {
    static const char name[5][CORE_NAME_MAX] = {"hips", "spine", "stub", "arm", "hand"};
    static const int32_t parent[5] = {-1, 0, 1, 2, 3};
    static const core_vec3 translation[5] = {
        {0, 100, 0}, {0, 30, 0}, {0, 30, 0}, {0, 0.1f, 0}, {25, 0, 0}};
    core_quat rotation[5];
    core_vec3 scale[5];
    for (int i = 0; i < 5; i++) {
        rotation[i] = core_quat_identity();
        scale[i] = core_v3(1, 1, 1);
    }
    core_skeleton_data s = {5, name, parent, translation, rotation, scale, NULL};
    phys_ragdoll_bone b[5];
    uint32_t n =
        phys_ragdoll_bones(&s, core_v3(2, 0, 0), core_quat_identity(), 0.01f, 60, 0.02f, b, 5);
    TEST_ASSERT_EQUAL_UINT32(4, n); // the stub of 1 mm is left out
    TEST_ASSERT_EQUAL_UINT32(3, b[2].bone);
    TEST_ASSERT_EQUAL_INT(1, b[2].parent); // its child goes to the one above
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 1.3f, b[1].head.y);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 2.25f, b[2].tail.x);
    TEST_ASSERT_FLOAT_WITHIN(1e-5f, 2.375f, b[3].tail.x); // half as long as the arm
    TEST_ASSERT_FLOAT_WITHIN(1e-3f, 60, b[0].mass + b[1].mass + b[2].mass + b[3].mass);
}

static void test_bad_input_makes_nothing(void) {
    phys_ragdoll_bone b[BONES];
    phys_body body[BONES];
    phys_joint joint[BONES];
    person(b, core_v3(0, 0, 0));
    phys_ragdoll_desc d = desc_of(b);
    b[3].parent = 4;
    TEST_ASSERT_FALSE(phys_ragdoll_create(w, &d, body, joint));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "bone 3 has parent 4"));
    b[3].parent = 1;
    b[10].axis = core_v3(0, 0, 0); // the last joint cannot be made
    TEST_ASSERT_FALSE(phys_ragdoll_create(w, &d, body, joint));
    TEST_ASSERT_EQUAL_UINT32(0, phys_body_count(w));
    TEST_ASSERT_EQUAL_UINT32(0, phys_joint_count(w));
    b[10].axis = core_v3(1, 0, 0);
    b[2].tail = b[2].head;
    TEST_ASSERT_FALSE(phys_ragdoll_create(w, &d, body, joint));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_bodies_are_where_the_bones_are);
    RUN_TEST(test_poses_pass_both_ways);
    RUN_TEST(test_a_pile_comes_to_rest);
    RUN_TEST(test_bones_of_a_skeleton);
    RUN_TEST(test_bad_input_makes_nothing);
    return UNITY_END();
}
