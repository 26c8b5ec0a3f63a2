// Escapes: attempts of mods to get out, to take for ever, to take everything, or to leave a trace
// in a call that failed. Each must fail, and the game's hash must be the hash without the mod.
#include "core/clock.h"
#include "script/mod.h"
#include "script/world.h"

#include "unity.h"

static world w;
static bool escaped;

static void listen(void *ctx, core_log_level level, const char *text) {
    (void)ctx;
    (void)level;
    escaped = escaped || strstr(text, "ESCAPED");
}

static const char game[] =
    "local ball, score = nil, 0\n"
    "corsac.mods.export('bank', {\n"
    "    add = function(n) score = score + n return score end,\n"
    "    ring = function() corsac.emit('ring') end,\n"
    "    fail = function() error('no') end })\n"
    "function corsac.load()\n"
    "    ball = corsac.phys.newBody{shape = 'sphere', position = {0, 5, 0}}\n"
    "    corsac.scene.spawn{name = 'door', position = {1, 2, 3}, body = {shape = 'box'}}\n"
    "end\n"
    "function corsac.fixed()\n"
    "    corsac.emit('ball', ball, {list = {1, 2}})\n"
    "    corsac.phys.newBody{shape = 'sphere', position = {corsac.getStep() * 3, 9, 0}}\n"
    "end\n";

void setUp(void) {}
void tearDown(void) {}

static void write(const char *path, const char *text) {
    TEST_ASSERT_TRUE(core_vfs_write(w.vfs, path, text, strlen(text)));
}

static void step_hook(void *ctx, float dt) { script_fixed(ctx, dt); }
static void events_hook(void *ctx) { script_step_events(ctx); }

// Hash of six steps of the game with a mod of that code (NULL: without one).
static uint64_t play(const char *code) {
    uint64_t hash = 0;
    world_open(&w);
    core_log_add_sink(listen, NULL);
    escaped = false;
    if (code) {
        write("mods/bad/mod.lua", "return {name = 'bad'}");
        write("mods/bad/main.lua", code);
        TEST_ASSERT_TRUE_MESSAGE(script_add_mod(w.script, "build/test-tmp/script/mods/bad"),
                                 core_last_error());
    }
    scene_hooks hooks = {.ctx = w.script, .fixed = step_hook, .events = events_hook};
    scene_set_hooks(w.scene, &hooks);
    TEST_ASSERT_TRUE(world_run(&w, game));
    for (int i = 0; i < 6; i++) {
        scene_step(w.scene);
        script_update(w.script, 1.0 / 60);
    }
    hash = scene_hash(w.scene);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, script_error_count(w.script), script_last_error(w.script));
    return hash;
}

static void stop(void) {
    core_log_remove_sink(listen, NULL);
    world_close(&w);
}

// ---- things that must not be there ----

static const char *const absent[] = {"dofile",
                                     "loadfile",
                                     "load",
                                     "loadstring",
                                     "require",
                                     "module",
                                     "collectgarbage",
                                     "gcinfo",
                                     "newproxy",
                                     "getfenv",
                                     "setfenv",
                                     "xpcall",
                                     "rawget",
                                     "rawset",
                                     "rawequal",
                                     "coroutine",
                                     "package",
                                     "io",
                                     "os",
                                     "debug",
                                     "jit",
                                     "ffi",
                                     "string.dump",
                                     "table.foreach",
                                     "table.foreachi",
                                     "math.randomseed",
                                     "_G.io",
                                     "_G._G.os",
                                     "string.gfind"};
static const char *const absent_bindings[] = {"corsac.run",
                                              "corsac.exit",
                                              "corsac.set",
                                              "corsac.save.write",
                                              "corsac.save.read",
                                              "corsac.readFile",
                                              "corsac.mods.setEnabled",
                                              "corsac.mods.export",
                                              "corsac.param",
                                              "corsac.expect",
                                              "corsac.metrics.set",
                                              "corsac.setPaused",
                                              "corsac.input.isDown",
                                              "corsac.persist",
                                              "corsac.phys.columns",
                                              "corsac.nothing"};

// ---- code that must fail ----

typedef struct attempt {
    const char *name, *code;
} attempt;
// `hook` of each runs after corsac.load, in a phase in which the world could be changed.
static const attempt attempts[] = {
    // for ever
    {"loop", "while true do end"},
    {"repeat loop", "repeat until false"},
    {"numeric loop", "for i = 1, 1e15 do end"},
    {"call loop", "local function f() end while true do f() end"},
    {"tail calls", "local function f() return f() end f()"},
    {"recursion", "local function f() f() end f()"},
    {"loop inside pcall", "while true do pcall(function() while true do end end) end"},
    {"pcall as loop body", "while true do pcall(error) end"},
    {"pcall swallows the kill", "pcall(function() while true do end end) corsac.log('ESCAPED')"},
    {"pcall nests", "local function f() pcall(f) end while true do f() end"},
    {"pcall of pcall", "local f f = function() return pcall(pcall, f) end while true do f() end"},
    {"metamethod loop",
     "local t = setmetatable({}, {__index = function(t, k) return t[k] end}) local x = t.x"},
    {"index chain", "local t = {} setmetatable(t, {__index = t}) local x = t.x"},
    {"newindex chain", "local t = {} setmetatable(t, {__newindex = t}) t.x = 1 error('end')"},
    {"lt loop",
     "local m = {} m.__lt = function(a, b) return a < b end local a = setmetatable({}, m) "
     "local b = setmetatable({}, m) return a < b"},
    {"concat metamethod", "local m = {} m.__concat = function(a, b) return a .. b end "
                          "local a = setmetatable({}, m) return a .. a"},
    {"tostring loops",
     "tostring(setmetatable({}, {__tostring = function() while true do end end}))"},
    {"format loops",
     "string.format('%s', setmetatable({}, {__tostring = function() while true do end end}))"},
    {"format recursion",
     "local t t = setmetatable({}, {__tostring = function() return string.format('%s', t) end}) "
     "string.format('%s', t)"},
    {"tostring recursion",
     "local t t = setmetatable({}, {__tostring = function() return tostring(t) end}) tostring(t)"},
    {"gsub recursion", "local function f() return (('x'):gsub('x', f)) end f()"},
    {"gsub callback loops", "('x'):gsub('x', function() while true do end end)"},
    {"gsub table recursion",
     "local t t = setmetatable({}, {__index = function() return ('x'):gsub('x', t) end}) "
     "('x'):gsub('x', t)"},
    {"gmatch for ever", "while true do for _ in ('abc'):gmatch('.') do end end"},
    {"sort callback loops", "table.sort({3, 2, 1}, function() while true do end end)"},
    {"sort recursion",
     "local function f(a, b) table.sort({2, 1}, f) return a < b end table.sort({2, 1}, f)"},
    {"sort with a lie", "local t = {} for i = 1, 5000 do t[i] = i end while true do "
                        "pcall(table.sort, t, function() return true end) end"},
    {"sort of a big table",
     "local t = {} for i = 1, 20000 do t[i] = -i end while true do table.sort(t) t[1] = 1 end"},
    {"insert in front", "local t = {} while true do table.insert(t, 1, 1) end"},
    {"insert far away", "table.insert({}, -1e9, 1)"},
    {"remove far away", "table.remove({}, -1e9)"},
    {"concat again and again",
     "local t = {} for i = 1, 20000 do t[i] = 'x' end while true do table.concat(t) end"},
    {"compare long strings",
     "local a = ('x'):rep(9e5) local b, c = a .. 'y', a .. 'z' while true do local x = b < c end"},
    {"number from a long string", "local a = ('1'):rep(9e5) while true do tonumber(a) end"},
    {"pairs loop",
     "local t = {} for i = 1, 3e4 do t[i] = i end while true do for k in pairs(t) do end end"},
    {"next loop", "local t = {a = 1} while true do next(t) end"},
    // patterns
    {"quantifiers", "(('a'):rep(40)):find(('a*'):rep(30) .. 'b')"},
    {"lazy quantifier", "(('x'):rep(200000)):find('.-b')"},
    {"many lazy ones", "(('a'):rep(300)):match('(.-)(.-)(.-)(.-)b')"},
    {"balanced", "(('('):rep(200000)):find('%b()')"},
    {"plain search", "(('a'):rep(500000)):find(('a'):rep(250000) .. 'b', 1, true)"},
    {"pattern without magic", "(('a'):rep(500000)):find(('a'):rep(900) .. 'b')"},
    {"back references", "(('a'):rep(5000)):find('(a*)%1%1%1b')"},
    {"gsub with quantifiers", "(('a'):rep(5000)):gsub('a*a*a*b', '')"},
    {"gmatch with quantifiers", "for _ in (('a'):rep(5000)):gmatch('a*a*a*b') do end"},
    {"deep captures", "('a'):find(('('):rep(100) .. 'a' .. (')'):rep(100))"},
    // memory
    {"table bomb", "local t = {} while true do t[#t + 1] = {} end"},
    {"array bomb", "local t = {} for i = 1, 1e9 do t[i] = i end"},
    {"string rep", "local s = ('x'):rep(1e9)"},
    {"empty string rep", "local s = (''):rep(1e9) error('end')"},
    {"negative rep", "local s = ('x'):rep(-1) error('end')"},
    {"doubling", "local s = 'x' while true do s = s .. s end"},
    {"doubling inside pcall",
     "while true do pcall(function() local s = 'x' while true do s = s .. s end end) end"},
    {"kept strings", "local t = {} while true do t[#t + 1] = ('x'):rep(1000) .. #t end"},
    {"string flood", "local i = 0 while true do i = i + 1 local s = 'k' .. i end"},
    {"closures", "local t = {} while true do t[#t + 1] = function() return t end end"},
    {"gsub growth", "local s = ('x'):rep(1000) while true do s = s:gsub('x', 'xx') end"},
    {"format growth", "local s = '' while true do s = string.format('%s%s', s, s) .. 'x' end"},
    {"unpack", "unpack({}, 1, 1e8)"},
    {"vararg", "local function f(...) return f(1, ...) end f()"},
    {"select", "select(-1e9, 1)"},
    {"string.byte", "(('x'):rep(9e5)):byte(1, -1)"},
    {"string.char", "string.char(unpack({}, 1, 1e7))"},
    {"table.concat range", "table.concat({}, '', 1, 1e9)"},
    // metatables and objects
    {"string metatable", "getmetatable('').__index = nil"},
    {"string metatable again", "local m = getmetatable('') assert(m) m.__index = {}"},
    {"object metatable",
     "corsac.mod.getData('x') getmetatable(corsac.scene.find('door')).__index = nil"},
    {"object field", "corsac.scene.find('door').x = 1"},
    {"setmetatable on an object", "setmetatable(corsac.scene.find('door'), {})"},
    {"method of another class", "local e = corsac.scene.find('door') e.getPosition(e:getBody())"},
    {"method of a number", "corsac.scene.find('door').getPosition(3)"},
    {"weak table", "setmetatable({}, {__mode = 'k'})"},
    {"finaliser", "setmetatable({}, {__gc = function() corsac.log('ESCAPED') end})"},
    {"address in a text", "string.format('%p', {})"},
    {"addresses by tostring", "assert(tostring({}):find('0x')) corsac.log('ESCAPED')"},
    {"replace the API", "corsac.phys.setGravity = function() end error('end')"},
    {"API metatable", "getmetatable(corsac.phys).__index = nil"},
    // the world
    {"NaN", "corsac.scene.find('door'):setPosition(0/0, 0, 0)"},
    {"infinity", "corsac.scene.find('door'):setPosition(1/0, 0, 0)"},
    {"far away", "corsac.scene.find('door'):setPosition(1e300, 0, 0)"},
    {"many bodies", "while true do corsac.phys.newBody{shape = 'sphere'} end"},
    {"many entities", "for i = 1, 1e6 do corsac.scene.spawn{} end"},
    {"many lights", "for i = 1, 1e6 do corsac.gfx.newLight{} end"},
    {"many log lines", "while true do corsac.log('x') end"},
    {"many log lines by print", "while true do print('x') end"},
    {"many hooks", "while true do corsac.mod.after('fixed', function() end) end"},
    {"many timers", "while true do corsac.after(1, function() end) end"},
    {"huge hull", "local p = {} for i = 1, 3e5 do p[i] = i % 7 end corsac.phys.newBody{shape = "
                  "'hull', points = p}"},
    {"spawn, then fail", "corsac.scene.spawn{body = {shape = 'sphere'}} error('end')"},
    {"body, then fail", "corsac.phys.newBody{shape = 'box', size = {9, 9, 9}} error('end')"},
    {"push, then fail", "corsac.scene.find('door'):getBody():applyImpulse(100, 0, 0) error('end')"},
    {"gravity, then fail", "corsac.phys.setGravity(0, 100, 0) error('end')"},
    {"destroy, then fail", "corsac.scene.find('door'):destroy() error('end')"},
    {"move, then loop", "corsac.scene.find('door'):setPosition(9, 9, 9) while true do end"},
    {"spawn, then loop", "corsac.scene.spawn{body = {shape = 'sphere'}} while true do end"},
    {"collision rule, then fail", "corsac.phys.setCollisionRule('a', 'b', false) error('end')"},
    {"random of the simulation", "for i = 1, 100 do math.random() end error('end')"},
    // services and data
    {"closure to a service", "corsac.mod.call('bank.add', function() end)"},
    {"table in itself", "local t = {} t.t = t corsac.mod.call('bank.add', t)"},
    {"big data",
     "local t = {} for i = 1, 3e4 do t[i] = ('x'):rep(100) end corsac.mod.call('bank.add', t)"},
    {"coroutine-free yield", "corsac.wait(1)"},
    {"unknown service", "corsac.mod.call('bank.nothing')"},
    {"service by metatable", "corsac.mod.call('bank.__index')"},
    {"service fails", "corsac.mod.call('bank.fail')"},
    {"service wants a number", "corsac.mod.call('bank.add', {})"},
    {"event recursion", "corsac.mod.after('ring', function() corsac.mod.call('bank.ring') end) "
                        "corsac.mod.call('bank.ring') error('end')"},
    {"raise a table", "error({1, 2})"},
    {"raise nil", "error(nil)"},
    {"raise an object", "error(corsac.scene.find('door'))"},
    {"error in tostring of the error",
     "error(setmetatable({}, {__tostring = function() while true do end end}))"},
    {"cloth without end",
     "corsac.phys.newCloth{columns = 4096, rows = 4096, across = {1, 0, 0}, down = {0, 0, 1}}"},
    {"many cloths",
     "for i = 1, 99 do corsac.phys.newCloth{columns = 30, rows = 30, across = {1, 0, 0}, "
     "down = {0, 0, 1}} end"},
    {"rope without end", "corsac.phys.newRope{count = 65536, from = {0, 0, 0}, to = {9, 0, 0}}"},
    {"particles without end", "corsac.gfx.newEmitter{rate = 1e6, life = {9, 9}}"},
    {"a crowd of particles", "corsac.gfx.newEmitter{capacity = 1048576}"},
    {"machine without end",
     "local m = corsac.scene.find('door') for i = 1, 999 do corsac.anim.newMachine{} end"},
    {"broken filter", "corsac.mod.filter('x', function() while true do end end) error('end')"},
};

static void test_attempts_fail_and_leave_no_trace(void) {
    uint64_t alone = play(NULL);
    stop();
    int failed = 0;
    for (size_t i = 0; i < CORE_COUNT_OF(attempts); i++) {
        char code[2048], note[256];
        snprintf(code, sizeof code, "corsac.mod.after('load', function()\n%s\nend)",
                 attempts[i].code);
        uint64_t start = core_clock_ns();
        uint64_t hash = play(code);
        uint64_t ms = (core_clock_ns() - start) / 1000000;
        script_mod *m = w.script->mods[0];
        snprintf(note, sizeof note, "%s: errors %d, escaped %d, same hash %d, %u ms",
                 attempts[i].name, m->errors, escaped, hash == alone, (unsigned)ms);
        bool good = m->errors >= 1 && !escaped && hash == alone && m->guard.peak <= GUARD_MEMORY &&
                    !m->guard.overtime;
        if (!good) {
            printf("%s\n", note);
            failed++;
        }
        stop();
    }
    TEST_ASSERT_EQUAL_INT(0, failed);
    TEST_ASSERT_GREATER_THAN_INT(79, (int)CORE_COUNT_OF(attempts));
}

static void test_what_could_open_a_door_is_not_there(void) {
    char code[512];
    for (size_t i = 0; i < CORE_COUNT_OF(absent); i++) {
        snprintf(code, sizeof code, "if %s ~= nil then corsac.log('ESCAPED') end", absent[i]);
        play(code);
        TEST_ASSERT_FALSE_MESSAGE(escaped, absent[i]);
        TEST_ASSERT_EQUAL_INT_MESSAGE(0, w.script->mods[0]->errors, absent[i]);
        stop();
    }
    for (size_t i = 0; i < CORE_COUNT_OF(absent_bindings); i++) {
        snprintf(code, sizeof code, "local x = %s corsac.log('ESCAPED')", absent_bindings[i]);
        play(code);
        TEST_ASSERT_FALSE_MESSAGE(escaped, absent_bindings[i]);
        TEST_ASSERT_EQUAL_INT_MESSAGE(1, w.script->mods[0]->errors, absent_bindings[i]);
        stop();
    }
}

static void test_a_mod_that_goes_over_its_budget_again_and_again_is_switched_off(void) {
    play("corsac.mod.after('fixed', function() while true do end end)");
    TEST_ASSERT_FALSE(w.script->mods[0]->enabled);
    TEST_ASSERT_EQUAL_INT(MOD_STRIKES, w.script->mods[0]->errors);
    stop();
    play("corsac.mod.after('fixed', function() error('each time') end)");
    TEST_ASSERT_TRUE(w.script->mods[0]->enabled);
    TEST_ASSERT_EQUAL_INT(6, w.script->mods[0]->errors);
    stop();
}

static void test_a_quota_counts_what_lives(void) {
    play("local made = 0\n"
         "corsac.mod.before('fixed', function()\n"
         "    local bodies = {}\n"
         "    for i = 1, 90 do bodies[i] = corsac.scene.spawn{} made = made + 1 end\n"
         "    for i = 1, 90 do bodies[i]:destroy() end\n"
         "end)\n"
         "corsac.mod.after('fixed', function() if made == 540 then corsac.log('ESCAPED') end end)\n"
         "for i = 1, 8 do corsac.mod.after('load', function()\n"
         "    for i = 1, 120 do corsac.scene.spawn{}:destroy() end end) end");
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, w.script->mods[0]->errors, "1,500 made, few at a time");
    TEST_ASSERT_TRUE(escaped);
    stop();
}

static void test_the_kill_falls_at_the_same_instruction_in_every_run(void) {
    uint64_t instructions[2];
    for (int i = 0; i < 2; i++) {
        play("corsac.mod.after('load', function() local n = 0 while true do n = n + 1 "
             "corsac.mod.call('bank.add', 1) end end)");
        instructions[i] = w.script->mods[0]->instructions;
        lua_getglobal(w.L, "corsac");
        stop();
    }
    TEST_ASSERT_EQUAL_UINT64(instructions[0], instructions[1]);
}

static void test_a_room_calls_a_mod_back_behind_the_guard(void) {
    play("corsac.mod.after('load', function()\n"
         "    corsac.phys.newTrigger{size = {99, 99, 99}, onEnter = function()\n"
         "        corsac.phys.setGravity(0, 50, 0) while true do end end}\n"
         "end)");
    TEST_ASSERT_EQUAL_INT(MOD_STRIKES, w.script->mods[0]->errors);
    TEST_ASSERT_FALSE(w.script->mods[0]->enabled);
    TEST_ASSERT_EQUAL_FLOAT(-9.81f, phys_world_gravity(scene_phys(w.scene)).y);
    stop();
}

static void test_code_that_is_no_text_and_broken_manifests_are_left_out(void) {
    static const char *const manifests[] = {"return 3",
                                            "return {}",
                                            "return {name = 'A B'}",
                                            "return {name = 5}",
                                            "syntax error (",
                                            "while true do end",
                                            "return {name = 'x', nmae = 'y'}",
                                            "\033LJ\2",
                                            "return setmetatable({}, {})",
                                            "return {name = 'x', dependencies = {5, {}}}"};
    world_open(&w);
    for (size_t i = 0; i < CORE_COUNT_OF(manifests); i++) {
        write("mods/bad/mod.lua", manifests[i]);
        write("mods/bad/main.lua", "");
        TEST_ASSERT_FALSE_MESSAGE(script_add_mod(w.script, "build/test-tmp/script/mods/bad"),
                                  manifests[i]);
    }
    TEST_ASSERT_FALSE(script_add_mod(w.script, "build/test-tmp/script/mods/none"));
    world_close(&w);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_attempts_fail_and_leave_no_trace);
    RUN_TEST(test_what_could_open_a_door_is_not_there);
    RUN_TEST(test_a_mod_that_goes_over_its_budget_again_and_again_is_switched_off);
    RUN_TEST(test_a_quota_counts_what_lives);
    RUN_TEST(test_the_kill_falls_at_the_same_instruction_in_every_run);
    RUN_TEST(test_a_room_calls_a_mod_back_behind_the_guard);
    RUN_TEST(test_code_that_is_no_text_and_broken_manifests_are_left_out);
    return UNITY_END();
}
