// A script's life: conf, parameters, several states on one world, objects, data for the next scene.
#include "script/json.h"
#include "script/world.h"

#include "unity.h"

static world w;

void setUp(void) { world_open(&w); }
void tearDown(void) { world_close(&w); }

static void must_run(const char *text) {
    TEST_ASSERT_TRUE_MESSAGE(world_run(&w, text), script_last_error(w.script));
}
static void must_hold(const char *text) {
    TEST_ASSERT_EQUAL_STRING("", world_error(&w, BIND_FIXED, text));
}

static void test_conf_says_what_it_was_told(void) {
    static const char text[] =
        "function corsac.conf(t) t.steps = 90 t.dt = 0.01 t.seed = 7 t.threads = 2\n"
        "t.size = {640, 360} t.render = 'clustered' t.title = 'Fox'\n"
        "t.phys = {solver = 'soft', substeps = 4} t.actions = {jump = 'space'} end";
    script_conf conf;
    core_vfs_write(w.vfs, "scene.lua", text, strlen(text));
    TEST_ASSERT_TRUE(script_load_file(w.script, "scene.lua", &conf));
    TEST_ASSERT_EQUAL_UINT64(90, conf.steps);
    TEST_ASSERT_EQUAL_UINT64(7, conf.seed);
    TEST_ASSERT_TRUE(conf.has_seed);
    TEST_ASSERT_EQUAL_INT(2, conf.threads);
    TEST_ASSERT_EQUAL_UINT32(640, conf.width);
    TEST_ASSERT_EQUAL_UINT32(360, conf.height);
    TEST_ASSERT_EQUAL_STRING("clustered", conf.render);
    TEST_ASSERT_EQUAL_STRING("Fox", conf.title);
    TEST_ASSERT_EQUAL_UINT32(3, conf.setting_count);
    TEST_ASSERT_EQUAL_STRING("actions.jump", conf.setting_name[0]);
    TEST_ASSERT_EQUAL_STRING("phys.solver", conf.setting_name[1]);
    TEST_ASSERT_EQUAL_STRING("soft", conf.setting_value[1]);
    TEST_ASSERT_EQUAL_STRING("4", conf.setting_value[2]);
}

static void test_parameters_take_the_type_of_their_default(void) {
    must_run("local given, none = corsac.param('given', 1), corsac.param('none', 'x')\n"
             "function corsac.load() assert(given == 7.5 and none == 'x') end");
    TEST_ASSERT_TRUE(script_param_declared(w.script, "given"));
    TEST_ASSERT_FALSE(script_param_declared(w.script, "wrong"));
}

static void test_an_object_is_the_same_userdata_every_time(void) {
    must_run("function corsac.load()\n"
             "    local e = corsac.scene.spawn{name = 'a', body = {shape = 'sphere'}}\n"
             "    assert(e == corsac.scene.find('a') and e:getBody():getEntity() == e)\n"
             "    local t = {[e] = 1, [e:getBody()] = 2}\n"
             "    collectgarbage()\n"
             "    assert(t[corsac.scene.find('a')] == 1 and t[e:getBody()] == 2)\n"
             "    assert(tostring(e) == 'Entity 1')\n"
             "end");
}

static void test_a_dead_object_never_becomes_another(void) {
    must_run("function corsac.load()\n"
             "    local old = corsac.scene.spawn{}\n"
             "    old:destroy()\n"
             "    local new = corsac.scene.spawn{}\n"
             "    assert(old ~= new and old:isDestroyed() and not new:isDestroyed())\n"
             "    assert(not pcall(old.getPosition, old))\n"
             "end");
}

static void test_objects_live_without_being_held(void) {
    must_run("function corsac.load() for i = 1, 50 do corsac.phys.newBody{shape = 'sphere'} end\n"
             "collectgarbage() assert(corsac.phys.getBodyCount() == 50) end");
}

static void test_two_states_share_a_world_and_nothing_else(void) {
    must_run("secret = 5 function corsac.load() corsac.scene.spawn{name = 'shared'} end");
    script_desc options = script_desc_default();
    options.scene = w.scene;
    options.headless = true;
    script *other = script_create(&options);
    TEST_ASSERT_NOT_NULL(other);
    script *first = w.script;
    w.script = other;
    w.L = other->L;
    must_hold("assert(secret == nil and corsac.scene.find('shared'):getName() == 'shared')");
    must_hold("corsac.scene.spawn{name = 'second'}");
    TEST_ASSERT_NOT_EQUAL(0, strlen(world_error(&w, BIND_FIXED, "error('here')")));
    w.script = first;
    w.L = first->L;
    must_hold("assert(corsac.scene.find('second') and corsac.scene.getCount() == 2)");
    TEST_ASSERT_EQUAL_INT(0, script_error_count(first));
    script_destroy(other);
}

static void test_exit_and_run_reach_the_program(void) {
    must_hold("corsac.exit(4)");
    TEST_ASSERT_EQUAL_INT(4, w.exit_code);
    must_hold("corsac.run('next.lua', {level = 2, names = {'a', 'b'}})");
    TEST_ASSERT_EQUAL_STRING("next.lua", w.run_path);
    TEST_ASSERT_EQUAL_STRING("{\"level\":2,\"names\":[\"a\",\"b\"]}", script_run_data(w.script));
}

static void test_expectations_fall_short_one_by_one(void) {
    must_run("corsac.expect('accuracy.nan', '==', 0)\n"
             "function corsac.load() corsac.metrics.set('score', 3)\n"
             "corsac.expect('user.score', '>', 2) corsac.expect('user.score', '<', 2)\n"
             "corsac.expect('user.score', '~=', 3) corsac.expect.now('user.score', '>=', 9)\n"
             "corsac.metrics.set('score', 10) end");
    TEST_ASSERT_EQUAL_INT(2, script_check_expectations(w.script));
}

static void test_json_comes_back_as_it_went(void) {
    static const char *const texts[] = {"[]", "[1,2.5,-3e-7,true,null]",
                                        "{\"a\":{\"b\":[\"x\\\"y\\n\"]}}", "\"caf\\u00e9\"", "0.1"};
    for (size_t i = 0; i < CORE_COUNT_OF(texts); i++) {
        TEST_ASSERT_TRUE_MESSAGE(script_json_read(w.L, texts[i], strlen(texts[i])), texts[i]);
        char *again = script_json_write(w.L, -1, "value");
        TEST_ASSERT_TRUE(script_json_read(w.L, again, strlen(again)));
        char *third = script_json_write(w.L, -1, "value");
        TEST_ASSERT_EQUAL_STRING(again, third);
        core_free(again);
        core_free(third);
        lua_settop(w.L, 0);
    }
    static const char *const wrong[] = {"", "{", "[1,]", "{\"a\" 1}", "[1] 2", "nul", "\"\\x\""};
    for (size_t i = 0; i < CORE_COUNT_OF(wrong); i++) {
        TEST_ASSERT_FALSE_MESSAGE(script_json_read(w.L, wrong[i], strlen(wrong[i])), wrong[i]);
    }
}

static void test_random_numbers_of_the_view_leave_the_simulation_alone(void) {
    must_hold("A = math.random()");
    TEST_ASSERT_EQUAL_STRING("",
                             world_error(&w, BIND_UPDATE, "for i = 1, 50 do math.random() end"));
    must_hold("B = math.random()");
    world other;
    world_open(&other);
    TEST_ASSERT_EQUAL_STRING(
        "", world_error(&other, BIND_FIXED, "A = math.random() B = math.random()"));
    lua_getglobal(w.L, "B");
    lua_getglobal(other.L, "B");
    TEST_ASSERT_EQUAL_DOUBLE(lua_tonumber(other.L, -1), lua_tonumber(w.L, -1));
    world_close(&other);
}

static void test_callbacks_leave_no_garbage(void) {
    must_run("local n = 0 function corsac.fixed(dt) n = n + dt end function corsac.update() end");
    for (int i = 0; i < 3000; i++) { // the compiler has its say first
        script_fixed(w.script, 1.0f / 60);
        script_update(w.script, 1.0 / 60);
    }
    lua_gc(w.L, LUA_GCCOLLECT, 0);
    lua_gc(w.L, LUA_GCSTOP, 0);
    size_t before = script_bytes(w.script);
    for (int i = 0; i < 1000; i++) {
        script_fixed(w.script, 1.0f / 60);
        script_update(w.script, 1.0 / 60);
    }
    TEST_ASSERT_EQUAL_UINT64(before, script_bytes(w.script));
}

static void test_bad_descriptions_are_refused(void) {
    script_desc options = {0};
    TEST_ASSERT_NULL(script_create(&options));
    options = script_desc_default();
    TEST_ASSERT_NULL(script_create(&options));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "desc.scene is NULL"));
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_conf_says_what_it_was_told);
    RUN_TEST(test_parameters_take_the_type_of_their_default);
    RUN_TEST(test_an_object_is_the_same_userdata_every_time);
    RUN_TEST(test_a_dead_object_never_becomes_another);
    RUN_TEST(test_objects_live_without_being_held);
    RUN_TEST(test_two_states_share_a_world_and_nothing_else);
    RUN_TEST(test_exit_and_run_reach_the_program);
    RUN_TEST(test_expectations_fall_short_one_by_one);
    RUN_TEST(test_json_comes_back_as_it_went);
    RUN_TEST(test_random_numbers_of_the_view_leave_the_simulation_alone);
    RUN_TEST(test_callbacks_leave_no_garbage);
    RUN_TEST(test_bad_descriptions_are_refused);
    return UNITY_END();
}
