// Saved scenes: equal hash after a load, equal steps from there on, and files that lie.
#include "core/hash.h"
#include "core/log.h"
#include "scene/scene.h"
#include "unity.h"

#include <string.h>

static core_vfs *vfs;

void setUp(void) {
    core_log_set_level(CORE_LOG_ERROR + 1);
    vfs = core_vfs_create();
    core_vfs_mount(vfs, "assets", "", false);
}

void tearDown(void) { core_vfs_destroy(vfs); }

static scene_entity body(scene *s, phys_shape_type type, core_vec3 at, phys_body_type moves,
                         scene_entity parent) {
    static const float corner[] = {0.3f, 0, 0, -0.3f, 0, 0, 0, 0.3f, 0, 0, 0, 0.3f};
    phys_body_desc desc = phys_body_desc_default();
    phys_shape_desc shape = phys_shape_desc_default(type);
    gfx_instance_desc draw = {.mesh = gfx_mesh_builtin(scene_gfx(s), "sphere")};
    desc.type = moves;
    shape.radius = 0.3f;
    shape.half = moves == PHYS_STATIC ? core_v3(10, 0.5f, 10) : core_v3(0.3f, 0.2f, 0.3f);
    shape.points = corner;
    shape.point_count = 4;
    scene_spawn_desc d = scene_spawn_desc_default();
    d.position = at;
    d.body = &desc;
    d.shapes = &shape;
    d.shape_count = 1;
    d.name = type == PHYS_SPHERE ? "ball" : NULL;
    d.draw = &draw;
    d.parent = parent;
    return scene_spawn(s, &d);
}

static void add_physics(scene *s) {
    phys_shape_type type[] = {PHYS_SPHERE, PHYS_BOX, PHYS_HULL};
    scene_entity last = body(s, PHYS_BOX, core_v3(0, -0.5f, 0), PHYS_STATIC, CORE_NULL_HANDLE);
    for (int i = 0; i < 9; i++) {
        last = body(s, type[i % 3], core_v3(0.1f * (float)(i % 2), 0.5f + 0.7f * (float)i, 0),
                    PHYS_DYNAMIC, i % 4 == 3 ? last : CORE_NULL_HANDLE);
    }
    phys_joint_desc joint = phys_joint_desc_default(PHYS_JOINT_BALL);
    joint.a = scene_entity_body(s, last);
    joint.anchor = core_v3(0, 7, 0);
    phys_joint_create(scene_phys(s), &joint);
    phys_trigger_desc trigger = phys_trigger_desc_default(PHYS_BOX);
    trigger.half = core_v3(1, 1, 1);
    phys_trigger_create(scene_phys(s), &trigger);
    phys_field_desc field = phys_field_desc_default(PHYS_FIELD_UNIFORM);
    field.acceleration = core_v3(0.1f, 0, 0);
    phys_field_create(scene_phys(s), &field);
    phys_world_set_rule(scene_phys(s), 1, 2, false);
}

static void add_walker(scene *s) {
    scene_spawn_desc d = scene_spawn_desc_default();
    d.model = scene_model_load(s, "models/fox.cmodel");
    d.clip = scene_model_find_clip(s, d.model, "walk");
    d.tags = (uint64_t)1 << scene_tag(s, "animal");
    scene_entity fox = scene_spawn(s, &d);
    TEST_ASSERT_TRUE(scene_alive(s, fox));
    nav_world *nav = scene_nav(s);
    nav_graph_desc ground = nav_graph_desc_default();
    nav_graph graph = nav_graph_create(nav, &ground);
    uint32_t a = nav_graph_add_node(nav, graph, core_v3(0, 0, 3)),
             b = nav_graph_add_node(nav, graph, core_v3(4, 0, 3)),
             c = nav_graph_add_node(nav, graph, core_v3(4, 0, 6));
    nav_graph_connect(nav, graph, a, b);
    nav_graph_connect(nav, graph, b, c);
    nav_agent_desc walks = nav_agent_desc_default();
    walks.position = core_v3(0, 0, 3);
    nav_agent agent = nav_agent_create(nav, &walks);
    scene_set_agent(s, fox, agent, 0);
    nav_agent_go(nav, agent, graph, core_v3(4, 0, 6));
    audio_source_desc source = audio_source_desc_default();
    source.sound = scene_sound_load(s, "sounds/hum.wav");
    source.loop = true;
    scene_set_sound(s, fox, audio_source_create(scene_audio(s), &source));
    gfx_light_desc light = gfx_light_desc_default(GFX_POINT);
    light.position = core_v3(0, 3, 0);
    gfx_light_create(scene_gfx(s), &light);
}

static scene *make(void) {
    scene_desc desc = scene_desc_default();
    desc.vfs = vfs;
    desc.seed = 5;
    scene *s = scene_create(&desc);
    scene_layer(s, "default");
    scene_layer(s, "stones");
    add_physics(s);
    add_walker(s);
    return s;
}

static void run(scene *s, int steps) {
    for (int i = 0; i < steps; i++) {
        TEST_ASSERT_TRUE(scene_step(s));
    }
}

static void load(scene *s, const void *data, size_t size) {
    char *script;
    TEST_ASSERT_TRUE_MESSAGE(scene_load(s, "slot", data, size, &script), core_last_error());
    TEST_ASSERT_EQUAL_STRING("{\"gold\":7}", script);
    core_free(script);
}

static void round_trip(core_stream_form form) {
    scene *s = make(), *fresh = make();
    run(s, 90);
    size_t size;
    void *data = scene_save(s, form, "{\"gold\":7}", &size);
    uint64_t saved = scene_hash(s);
    run(s, 60);
    uint64_t later = scene_hash(s);
    TEST_ASSERT_TRUE(saved != later);

    load(fresh, data, size); // into a scene that has just begun
    TEST_ASSERT_EQUAL_HEX64(saved, scene_hash(fresh));
    TEST_ASSERT_EQUAL_UINT64(90, scene_step_index(fresh));
    TEST_ASSERT_EQUAL_STRING("ball", scene_entity_name(fresh, scene_find(fresh, "ball")));
    run(fresh, 60);
    TEST_ASSERT_EQUAL_HEX64(later, scene_hash(fresh));

    load(s, data, size); // into the one that went on
    TEST_ASSERT_EQUAL_HEX64(saved, scene_hash(s));
    run(s, 60);
    TEST_ASSERT_EQUAL_HEX64(later, scene_hash(s));

    size_t again_size;
    load(s, data, size);
    void *again = scene_save(s, form, "{\"gold\":7}", &again_size);
    TEST_ASSERT_EQUAL_UINT64(size, again_size);
    TEST_ASSERT_EQUAL_MEMORY(data, again, size);
    core_free(again);
    core_free(data);
    scene_destroy(fresh);
    scene_destroy(s);
}

static void binary_round_trip(void) { round_trip(CORE_STREAM_BINARY); }
static void text_round_trip(void) { round_trip(CORE_STREAM_TEXT); }

static void what_came_later_is_gone_and_what_went_is_back(void) {
    scene *s = make();
    uint32_t bodies = phys_body_count(scene_phys(s)), count = scene_entity_count(s);
    scene_entity ball = scene_find(s, "ball");
    run(s, 5);
    size_t size;
    void *data = scene_save(s, CORE_STREAM_BINARY, "{\"gold\":7}", &size);
    scene_entity extra = body(s, PHYS_SPHERE, core_v3(3, 3, 3), PHYS_DYNAMIC, CORE_NULL_HANDLE);
    scene_despawn(s, ball);
    run(s, 5);
    load(s, data, size);
    TEST_ASSERT_FALSE(scene_alive(s, extra));
    TEST_ASSERT_TRUE(scene_alive(s, ball));
    TEST_ASSERT_EQUAL_UINT32(bodies, phys_body_count(scene_phys(s)));
    TEST_ASSERT_EQUAL_UINT32(count, scene_entity_count(s));
    run(s, 5);
    core_free(data);
    scene_destroy(s);
}

static void refuse(scene *s, const void *data, size_t size, const char *text) {
    uint64_t before = scene_hash(s);
    char *script = NULL;
    TEST_ASSERT_FALSE(scene_load(s, "slot", data, size, &script));
    TEST_ASSERT_NULL(script);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(core_last_error(), text), core_last_error());
    TEST_ASSERT_EQUAL_HEX64(before, scene_hash(s)); // as before, whatever was already read
}

static void refusals_name_the_field(void) {
    scene *s = make();
    run(s, 20);
    size_t size;
    char *data = scene_save(s, CORE_STREAM_BINARY, "", &size);
    refuse(s, data, 0, "no saved scene");
    refuse(s, "nonsense", 8, "no saved scene");
    refuse(s, data, 10, "header: cut short");
    refuse(s, data, size - 1, "bytes expected");
    data[size / 2] ^= 1;
    refuse(s, data, size, "header: the checksum is another");
    core_free(data);

    data = scene_save(s, CORE_STREAM_TEXT, "", &size);
    refuse(s, data, size / 2, "slot: ");
    char *type = strstr(strstr(data, "[\"phys.bodies\"]"), "    type = {");
    type = strchr(type, '{') + 1;
    while (*type < '0' || *type > '9') {
        type++;
    }
    *type = '9';
    refuse(s, data, size, "slot: phys.bodies: row 0: type 9");
    core_free(data);

    scene *other = make();
    scene_sound_load(other, "sounds/chime.wav");
    data = scene_save(s, CORE_STREAM_BINARY, "", &size);
    refuse(other, data, size, "slot: sounds: the scene has other sounds");
    core_free(data);
    scene_destroy(other);
    scene_destroy(s);
}

// Damage that every checksum of the file agrees with: numbers of the text are changed. Each file is
// refused, or loads and steps.
static void damaged_text_never_crashes(void) {
    scene *s = make();
    run(s, 40);
    size_t size;
    char *data = scene_save(s, CORE_STREAM_TEXT, "", &size), *copy = core_alloc(size + 1);
    core_rng rng = core_rng_make(3, 1);
    int loaded = 0, refused = 0;
    for (int i = 0; i < 400; i++) {
        memcpy(copy, data, size + 1);
        for (uint32_t k = 0; k <= core_rng_below(&rng, 3); k++) {
            size_t at = core_rng_below(&rng, (uint32_t)size);
            while (copy[at] < '0' || copy[at] > '9') {
                at = (at + 1) % size;
            }
            copy[at] = (char)('0' + core_rng_below(&rng, 10));
        }
        char *script = NULL;
        bool good = scene_load(s, "slot", copy, size, &script);
        core_free(script);
        loaded += good;
        refused += !good;
        if (good) {
            scene_step(s);
            scene_step(s);
            TEST_ASSERT_TRUE(scene_load(s, "slot", data, size, &script));
            core_free(script);
        }
    }
    TEST_ASSERT_GREATER_THAN_INT(20, loaded); // or the files would not be worth trying
    TEST_ASSERT_GREATER_THAN_INT(20, refused);
    core_free(copy);
    core_free(data);
    scene_destroy(s);
}

// The same for binary: bytes anywhere, with the outer checksum made to agree.
static void damaged_binary_never_crashes(void) {
    scene *s = make();
    run(s, 40);
    size_t size, head = 24;
    uint8_t *data = scene_save(s, CORE_STREAM_BINARY, "", &size), *copy = core_alloc(size);
    core_rng rng = core_rng_make(4, 1);
    int refused = 0;
    for (int i = 0; i < 400; i++) {
        memcpy(copy, data, size);
        copy[head + core_rng_below(&rng, (uint32_t)(size - head))] ^= 1 << core_rng_below(&rng, 8);
        uint64_t hash = core_hash(copy + head, size - head, 1);
        memcpy(copy + 16, &hash, sizeof hash);
        char *script = NULL;
        bool good = scene_load(s, "slot", copy, size, &script);
        core_free(script);
        refused += !good;
        if (good) {
            scene_step(s);
        }
    }
    TEST_ASSERT_GREATER_THAN_INT(300, refused); // columns carry checksums of their own
    core_free(copy);
    core_free(data);
    scene_destroy(s);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(binary_round_trip);
    RUN_TEST(text_round_trip);
    RUN_TEST(what_came_later_is_gone_and_what_went_is_back);
    RUN_TEST(refusals_name_the_field);
    RUN_TEST(damaged_text_never_crashes);
    RUN_TEST(damaged_binary_never_crashes);
    return UNITY_END();
}
