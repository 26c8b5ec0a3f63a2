// State machines: traces of states and callbacks, fades, interruption, time at the edges.
#include "anim/fixture.h"

static fixture f;
static anim_machine latest; // made by spawn
static anim_clip slow, fast, hit;
static char trace[1024];

static void note(const char *what, anim_world *w, anim_instance i) {
    snprintf(trace + strlen(trace), sizeof trace - strlen(trace), "%s[%s] ", what,
             anim_instance_state(w, i));
}
static void enter(void *ctx, anim_world *w, anim_instance i) {
    char text[64];
    snprintf(text, sizeof text, "+%s", (const char *)ctx);
    note(text, w, i);
}
static void leave(void *ctx, anim_world *w, anim_instance i) {
    char text[64];
    snprintf(text, sizeof text, "-%s", (const char *)ctx);
    note(text, w, i);
}

void setUp(void) {
    f = fix_make();
    trace[0] = 0;
    slow = fix_clip(&f, (fix_clip_desc){.name = "slow", .duration = 2, .to = 1, .bone = 1});
    fast = fix_clip(
        &f, (fix_clip_desc){.name = "fast", .duration = 1, .from = 2, .to = 2.5f, .bone = 1});
    hit = fix_clip(
        &f, (fix_clip_desc){.name = "hit", .duration = 0.5f, .from = -1, .to = -2, .bone = 1});
}
void tearDown(void) { anim_world_destroy(f.world); }

static anim_state_desc state(const char *name, anim_clip clip, anim_loop loop) {
    return (anim_state_desc){.name = name,
                             .clip = clip,
                             .loop = loop,
                             .on_enter = enter,
                             .on_exit = leave,
                             .ctx = (void *)(uintptr_t)name};
}

static anim_instance spawn(const anim_machine_desc *d) {
    anim_machine m = anim_machine_create(f.world, d);
    TEST_ASSERT_FALSE_MESSAGE(core_handle_is_null(m), core_last_error());
    latest = m;
    anim_instance_desc desc = anim_instance_desc_default();
    desc.skeleton = f.skeleton;
    desc.machine = m;
    return anim_instance_create(f.world, &desc);
}

static anim_instance spawn_three(const anim_transition_desc *t, uint32_t count) {
    static anim_state_desc s[3];
    static const anim_parameter_desc p[] = {{"speed", 0}};
    s[0] = state("idle", slow, ANIM_LOOP);
    s[1] = state("run", fast, ANIM_LOOP);
    s[2] = state("hit", hit, ANIM_ONCE);
    anim_machine_desc d = anim_machine_desc_default();
    d.state = s;
    d.state_count = 3;
    d.transition = t;
    d.transition_count = count;
    d.parameter = p;
    d.parameter_count = 1;
    return spawn(&d);
}

static void run(float dt, int steps) {
    for (int i = 0; i < steps; i++) {
        TEST_ASSERT_TRUE(anim_world_update(f.world, dt));
    }
}

static void test_parameter_event_and_finish(void) {
    const anim_transition_desc t[] = {
        {.from = "idle",
         .to = "run",
         .when = ANIM_WHEN_PARAMETER,
         .parameter = "speed",
         .compare = ANIM_GREATER,
         .value = 1,
         .length = 0.25f},
        {.to = "hit", .when = ANIM_WHEN_EVENT, .event = "hit", .length = 0},
        {.from = "hit", .to = "idle", .when = ANIM_WHEN_FINISHED, .length = 0.125f},
    };
    anim_instance i = spawn_three(t, 3);
    run(0.0625f, 4);
    TEST_ASSERT_EQUAL_STRING("idle", anim_instance_state(f.world, i));
    TEST_ASSERT_TRUE(anim_instance_set_parameter(f.world, i, "speed", 2));
    run(0.0625f, 1);
    TEST_ASSERT_EQUAL_STRING("run", anim_instance_state(f.world, i));
    run(0.0625f, 4);
    anim_instance_set_parameter(f.world, i, "speed", 0);
    anim_instance_send(f.world, i, "hit");
    run(0.0625f, 1);
    TEST_ASSERT_EQUAL_STRING("hit", anim_instance_state(f.world, i));
    // 0.5 s of clip less 0.125 s of fade: six steps of 1/16 s on.
    run(0.0625f, 5);
    TEST_ASSERT_EQUAL_STRING("hit", anim_instance_state(f.world, i));
    run(0.0625f, 1);
    TEST_ASSERT_EQUAL_STRING("idle", anim_instance_state(f.world, i));
    run(0.0625f, 2);
    TEST_ASSERT_EQUAL_STRING("+run[run] -idle[run] -run[hit] +hit[hit] +idle[idle] -hit[idle] ",
                             trace);
}

static bool always(void *ctx, anim_world *w, anim_instance i) {
    (void)w;
    (void)i;
    return *(bool *)ctx;
}

static void test_first_declared_transition_wins(void) {
    bool yes = true;
    const anim_transition_desc t[] = {
        {.from = "idle",
         .to = "hit",
         .when = ANIM_WHEN_CONDITION,
         .condition = always,
         .ctx = &yes,
         .length = 1},
        {.from = "idle",
         .to = "run",
         .when = ANIM_WHEN_CONDITION,
         .condition = always,
         .ctx = &yes,
         .length = 1},
    };
    anim_instance i = spawn_three(t, 2);
    const char *to[4];
    TEST_ASSERT_EQUAL_UINT32(2, anim_instance_transitions(f.world, i, to, 4));
    TEST_ASSERT_EQUAL_STRING("hit", to[0]);
    TEST_ASSERT_EQUAL_STRING("run", to[1]);
    run(0.1f, 1);
    TEST_ASSERT_EQUAL_STRING("hit", anim_instance_state(f.world, i));
}

// Pose change a step during fades and at interruptions is bounded by the clips' own motion plus the
// fade's slope: nothing pops.
static void test_interruption_does_not_pop(void) {
    const anim_transition_desc t[] = {
        {.from = "idle",
         .to = "run",
         .when = ANIM_WHEN_EVENT,
         .event = "go",
         .length = 0.5f,
         .fade = ANIM_FADE_SMOOTH},
        {.from = "run",
         .to = "idle",
         .when = ANIM_WHEN_EVENT,
         .event = "stop",
         .length = 0.5f,
         .fade = ANIM_FADE_SMOOTH},
    };
    anim_instance i = spawn_three(t, 2);
    double before = fix_angle(&f, i, 1), worst = 0;
    for (int n = 0; n < 240; n++) {
        if (n % 17 == 0) {
            anim_instance_send(f.world, i, n % 34 ? "stop" : "go");
        }
        run(1.0f / 120, 1);
        double now = fix_angle(&f, i, 1);
        worst = fmax(worst, fabs(now - before));
        before = now;
    }
    // 2.5 rad apart at most, smooth slope 1.5 / 0.5 s, clips 0.5 rad/s, plus the idle clip's wrap.
    TEST_ASSERT_TRUE(worst < (2.5 * 3 + 0.5) / 120 * 1.05);
    TEST_ASSERT_TRUE(worst > 0.01);
}

// A smooth fade between clips that stand still starts and ends at rest: its speed grows from zero,
// so that the first and last of n steps move by 3/n^2 of the way, not by 1/n as a linear fade's do.
static void check_fade_ends(anim_fade fade, float first_step) {
    anim_clip a = fix_clip(&f, (fix_clip_desc){.name = "a", .duration = 1, .bone = 1, .keys = 1});
    anim_clip b = fix_clip(
        &f, (fix_clip_desc){
                .name = "b", .duration = 1, .move = 1, .bone = 1, .keys = 2, .last = 0.001f});
    anim_instance_desc desc = anim_instance_desc_default();
    desc.skeleton = f.skeleton;
    desc.clip = a;
    anim_instance i = anim_instance_create(f.world, &desc);
    anim_instance_play(f.world, i, b, ANIM_ONCE, 1, fade);
    float before = 0, speed = 0, jump = 0;
    for (int n = 1; n <= 130; n++) {
        fix_pose p;
        run(1.0f / 128, 1);
        anim_instance_pose(f.world, i, fix_view(&p));
        float step = p.t[1].x - before;
        if (n == 1 || n == 128) {
            TEST_ASSERT_FLOAT_WITHIN(2e-6f, first_step, step);
        }
        jump = fmaxf(jump, fabsf(step - speed)); // change of speed from step to step
        speed = step;
        before = p.t[1].x;
    }
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 1, before);
    // 3s^2 - 2s^3 changes its slope by 6 / n^2 a step at most.
    TEST_ASSERT_TRUE(fade == ANIM_FADE_SMOOTH ? jump < 6.1f / (128 * 128) : jump > 0.9f / 128);
}
static void test_smooth_fade_is_continuous_in_velocity(void) {
    check_fade_ends(ANIM_FADE_SMOOTH, (3 - 2.0f / 128) / (128 * 128));
    check_fade_ends(ANIM_FADE_LINEAR, 1.0f / 128);
}

static void test_interruption_callbacks(void) {
    const anim_transition_desc t[] = {
        {.from = "idle", .to = "run", .when = ANIM_WHEN_EVENT, .event = "go", .length = 0.5f},
        {.from = "run", .to = "hit", .when = ANIM_WHEN_EVENT, .event = "hit", .length = 0.25f},
    };
    anim_instance i = spawn_three(t, 2);
    anim_instance_send(f.world, i, "go");
    run(0.125f, 2);
    const char *from;
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.25f, anim_instance_fade(f.world, i, &from));
    TEST_ASSERT_EQUAL_STRING("idle", from);
    anim_instance_send(f.world, i, "hit");
    run(0.125f, 1);
    run(0.125f, 3);
    TEST_ASSERT_EQUAL_STRING("+run[run] -idle[run] +hit[hit] -run[hit] ", trace);
    TEST_ASSERT_FLOAT_WITHIN(0, 1, anim_instance_fade(f.world, i, NULL));
}

static void test_uninterruptible(void) {
    const anim_transition_desc t[] = {
        {.from = "idle",
         .to = "run",
         .when = ANIM_WHEN_EVENT,
         .event = "go",
         .length = 0.5f,
         .uninterruptible = true},
        {.from = "run", .to = "hit", .when = ANIM_WHEN_EVENT, .event = "hit", .length = 0.25f},
    };
    anim_instance i = spawn_three(t, 2);
    anim_instance_send(f.world, i, "go");
    run(0.125f, 1);
    anim_instance_send(f.world, i, "hit");
    run(0.125f, 1);
    TEST_ASSERT_EQUAL_STRING("run", anim_instance_state(f.world, i));
    run(0.125f, 3);
    anim_instance_send(f.world, i, "hit");
    run(0.125f, 1);
    TEST_ASSERT_EQUAL_STRING("hit", anim_instance_state(f.world, i));
}

// Linear fade: the angle between the two clips' values by the exact weight; smooth: 3s^2 - 2s^3.
static void check_fade_curve(anim_fade fade) {
    anim_clip zero =
        fix_clip(&f, (fix_clip_desc){.name = "zero", .duration = 1, .bone = 1, .keys = 1});
    anim_clip moved = fix_clip(&f, (fix_clip_desc){.name = "moved",
                                                   .duration = 1,
                                                   .move = 1,
                                                   .bone = 1,
                                                   .keys = 2,
                                                   .first = 0,
                                                   .last = 0.001f});
    anim_instance_desc desc = anim_instance_desc_default();
    desc.skeleton = f.skeleton;
    desc.clip = zero;
    anim_instance i = anim_instance_create(f.world, &desc);
    anim_instance_play(f.world, i, moved, ANIM_ONCE, 1, fade);
    for (int n = 1; n < 32; n++) {
        run(1.0f / 32, 1);
        double s = n / 32.0, w = fade == ANIM_FADE_SMOOTH ? s * s * (3 - 2 * s) : s;
        fix_pose p;
        anim_instance_pose(f.world, i, fix_view(&p));
        TEST_ASSERT_FLOAT_WITHIN(1e-6f, (float)w, p.t[1].x);
    }
    run(1.0f / 32, 1);
    TEST_ASSERT_FLOAT_WITHIN(0, 1, anim_instance_fade(f.world, i, NULL));
}
static void test_linear_fade_curve(void) { check_fade_curve(ANIM_FADE_LINEAR); }
static void test_smooth_fade_curve(void) { check_fade_curve(ANIM_FADE_SMOOTH); }

// Defects 2 and 3: clips of different lengths fade by their own times, and a source that ends
// during the fade holds its last pose. Halfway the fade's nlerp is exact.
static void test_fade_over_ended_clips(void) {
    const anim_transition_desc t[] = {
        {.from = "hit", .to = "run", .when = ANIM_WHEN_EVENT, .event = "go", .length = 2},
    };
    anim_instance i = spawn_three(t, 1);
    anim_instance_go(f.world, i, "hit", 0, ANIM_FADE_LINEAR);
    run(0.25f, 1);
    anim_instance_send(f.world, i, "go");
    run(0.25f, 1);
    TEST_ASSERT_EQUAL_STRING("run", anim_instance_state(f.world, i));
    run(0.25f, 4);
    const double target = 2.5, source = -2; // one second into "run", "hit" over long ago
    double halfway = source + remainder(target - source, 2 * CORE_PI) / 2;
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0, remainder(fix_angle(&f, i, 1) - halfway, 2 * CORE_PI));
    run(0.25f, 4);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5, 0, remainder(fix_angle(&f, i, 1) - 2.5, 2 * CORE_PI));
}

static void test_loop_time_is_exact_over_long_steps(void) {
    anim_instance_desc desc = anim_instance_desc_default();
    desc.skeleton = f.skeleton;
    desc.clip = fast;
    anim_instance i = anim_instance_create(f.world, &desc);
    run(7.25f, 1);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.25f, anim_instance_time(f.world, i));
    run(1000000, 1);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.25f, anim_instance_time(f.world, i));
    anim_instance_set_speed(f.world, i, -1);
    run(0.5f, 1);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.75f, anim_instance_time(f.world, i));
}

static void test_once_and_ping_pong(void) {
    anim_instance_desc desc = anim_instance_desc_default();
    desc.skeleton = f.skeleton;
    desc.clip = fast;
    desc.loop = ANIM_ONCE;
    anim_instance once = anim_instance_create(f.world, &desc);
    desc.loop = ANIM_PING_PONG;
    anim_instance swing = anim_instance_create(f.world, &desc);
    run(0.75f, 1);
    TEST_ASSERT_FALSE(anim_instance_finished(f.world, once));
    run(0.75f, 1);
    TEST_ASSERT_TRUE(anim_instance_finished(f.world, once));
    TEST_ASSERT_FLOAT_WITHIN(0, 1, anim_instance_time(f.world, once));
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.5f, anim_instance_time(f.world, swing));
    run(0.75f, 1); // 2.25: on the way up again
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.25f, anim_instance_time(f.world, swing));
}

static float double_speed(void *ctx, anim_world *w, anim_instance i, float phase) {
    (void)w;
    (void)i;
    return phase < 0.5f ? 2 : *(float *)ctx;
}

// The speed callback's factor is integrated to the right phase: 2 below half way, then 0.5.
static void test_speed_callback(void) {
    float late = 0.5f;
    anim_state_desc s = {
        .name = "s", .clip = fast, .loop = ANIM_ONCE, .speed_fn = double_speed, .ctx = &late};
    anim_machine_desc d = anim_machine_desc_default();
    d.state = &s;
    d.state_count = 1;
    anim_instance i = spawn(&d);
    run(0.125f, 2);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.5f, anim_instance_time(f.world, i));
    run(0.125f, 2);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.625f, anim_instance_time(f.world, i));
    late = NAN;
    run(0.125f, 1);
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.75f, anim_instance_time(f.world, i));
}

static void test_root_motion_sums_to_displacement(void) {
    anim_clip_desc base = anim_clip_desc_default();
    base.root_motion = true;
    anim_clip walk =
        fix_clip_with(&f, (fix_clip_desc){.name = "walk", .duration = 0.9f, .move = 1.5f}, &base);
    anim_instance_desc desc = anim_instance_desc_default();
    desc.skeleton = f.skeleton;
    desc.clip = walk;
    anim_instance i = anim_instance_create(f.world, &desc);
    double sum = 0;
    for (int n = 0; n < 600; n++) {
        run(0.0171f, 1);
        core_vec3 d;
        anim_instance_root_motion(f.world, i, &d);
        sum += d.x;
        fix_pose p;
        anim_instance_pose(f.world, i, fix_view(&p));
        TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0, p.t[0].x); // the pose stays in place
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 600 * 0.0171 / 0.9 * 1.5, sum);
}

static void test_clip_events(void) {
    const anim_clip_event e[] = {{0.75f, "right"}, {0.25f, "left"}, {0, "start"}};
    anim_clip_desc base = anim_clip_desc_default();
    base.event = e;
    base.event_count = 3;
    anim_clip step =
        fix_clip_with(&f, (fix_clip_desc){.name = "step", .duration = 1, .bone = 1}, &base);
    anim_instance_desc desc = anim_instance_desc_default();
    desc.skeleton = f.skeleton;
    desc.clip = step;
    anim_instance i = anim_instance_create(f.world, &desc);
    char seen[256] = "";
    const struct {
        float dt, speed;
    } steps[] = {{0.25f, 1}, {0.125f, 1}, {2, 1}, {0.5f, -1}, {0, 1}};
    for (size_t n = 0; n < CORE_COUNT_OF(steps); n++) {
        anim_instance_set_speed(f.world, i, steps[n].speed);
        run(steps[n].dt, 1);
        const anim_event *events;
        uint32_t count = anim_world_events(f.world, &events);
        for (uint32_t k = 0; k < count; k++) {
            strcat(strcat(seen, events[k].name), " ");
        }
        strcat(seen, "| ");
    }
    TEST_ASSERT_EQUAL_STRING("start | left | right start left right start left | left start | | ",
                             seen);
}

static void destroy_self(void *ctx, anim_world *w, anim_instance i) {
    (void)ctx;
    anim_instance_destroy(w, i);
}

static void test_destroy_from_a_callback(void) {
    anim_state_desc s[2] = {state("idle", slow, ANIM_LOOP), state("run", fast, ANIM_LOOP)};
    s[1].on_enter = destroy_self;
    const anim_transition_desc t = {
        .to = "run", .when = ANIM_WHEN_EVENT, .event = "go", .length = 1};
    anim_machine_desc d = anim_machine_desc_default();
    d.state = s;
    d.state_count = 2;
    d.transition = &t;
    d.transition_count = 1;
    anim_instance a = spawn(&d), b = spawn(&d);
    anim_instance_send(f.world, a, "go");
    run(0.1f, 1);
    TEST_ASSERT_FALSE(anim_instance_alive(f.world, a));
    TEST_ASSERT_TRUE(anim_instance_alive(f.world, b));
    TEST_ASSERT_EQUAL_UINT32(1, anim_instance_count(f.world));
    TEST_ASSERT_FLOAT_WITHIN(1e-6f, 0.1f, anim_instance_time(f.world, b));
    TEST_ASSERT_FALSE(anim_instance_send(f.world, a, "go"));
}

static void test_names_are_checked(void) {
    const anim_transition_desc t = {.from = "idel", .to = "run", .when = ANIM_WHEN_FINISHED};
    anim_state_desc s[2] = {state("idle", slow, ANIM_LOOP), state("run", fast, ANIM_LOOP)};
    anim_machine_desc d = anim_machine_desc_default();
    d.state = s;
    d.state_count = 2;
    d.transition = &t;
    d.transition_count = 1;
    TEST_ASSERT_TRUE(core_handle_is_null(anim_machine_create(f.world, &d)));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "nearest is \"idle\""));
    d.transition_count = 0;
    anim_instance i = spawn(&d);
    TEST_ASSERT_FALSE(anim_instance_go(f.world, i, "rnu", 0, ANIM_FADE_LINEAR));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "nearest is \"run\""));
    TEST_ASSERT_EQUAL_STRING("idle", anim_instance_state(f.world, i));
    s[1].name = "idle";
    TEST_ASSERT_TRUE(core_handle_is_null(anim_machine_create(f.world, &d)));
}

static void test_resources_in_use_stay(void) {
    anim_state_desc s = state("idle", slow, ANIM_LOOP);
    anim_machine_desc d = anim_machine_desc_default();
    d.state = &s;
    d.state_count = 1;
    anim_instance i = spawn(&d);
    TEST_ASSERT_FALSE(anim_clip_destroy(f.world, slow));
    TEST_ASSERT_FALSE(anim_skeleton_destroy(f.world, f.skeleton));
    TEST_ASSERT_TRUE(anim_instance_destroy(f.world, i));
    TEST_ASSERT_TRUE(anim_clip_destroy(f.world, fast));
    TEST_ASSERT_FALSE(anim_clip_destroy(f.world, fast));
}

static void test_steps_do_not_allocate(void) {
    const anim_transition_desc t[] = {
        {.from = "idle", .to = "run", .when = ANIM_WHEN_EVENT, .event = "go", .length = 0.5f},
        {.from = "run", .to = "idle", .when = ANIM_WHEN_EVENT, .event = "stop", .length = 0.5f},
    };
    anim_instance i = spawn_three(t, 2);
    uint64_t before = 0;
    for (int n = 0; n < 200; n++) {
        before = n == 100 ? core_alloc_count() : before;
        anim_instance_send(f.world, i, n / 7 % 2 ? "stop" : "go");
        run(1.0f / 60, 1);
        anim_world_pose(f.world);
    }
    TEST_ASSERT_EQUAL_UINT64(before, core_alloc_count());
}

// A fight within a machine: idle, fight { windup, strike, taunt { wink } }.
static anim_instance spawn_fight(void) {
    static anim_state_desc s[6];
    static const anim_transition_desc t[] = {
        {.from = "fight", .to = "idle", .when = ANIM_WHEN_FINISHED, .length = 0.2f},
        {.from = "idle", .to = "fight", .when = ANIM_WHEN_EVENT, .event = "attack"},
        {.from = "fight", .to = "idle", .when = ANIM_WHEN_EVENT, .event = "stop"},
        {.from = "windup", .to = "strike", .when = ANIM_WHEN_FINISHED},
        {.from = "fight", .to = "taunt", .when = ANIM_WHEN_EVENT, .event = "mock"}};
    s[0] = state("idle", slow, ANIM_LOOP);
    s[1] = state("fight", CORE_NULL_HANDLE, ANIM_LOOP);
    s[2] = state("windup", hit, ANIM_ONCE);
    s[3] = state("strike", hit, ANIM_ONCE);
    s[4] = state("taunt", CORE_NULL_HANDLE, ANIM_LOOP);
    s[5] = state("wink", fast, ANIM_ONCE);
    s[2].within = s[3].within = s[4].within = "fight";
    s[5].within = "taunt";
    s[1].speed = 0.5f;
    anim_machine_desc d = anim_machine_desc_default();
    d.state = s;
    d.state_count = 6;
    d.transition = t;
    d.transition_count = 5;
    return spawn(&d);
}

static void test_a_machine_within_a_state(void) {
    static const struct {
        const char *send;
        float seconds;
        const char *state, *trace;
    } row[] = {
        {"attack", 0.1f, "windup", "-idle[windup] +fight[windup] +windup[windup] "},
        {NULL, 0.8f, "windup", ""}, // half a second of clip at half speed
        {NULL, 0.2f, "strike", "-windup[strike] +strike[strike] "},
        {NULL, 0.75f, "idle", "+idle[idle] "}, // 0.2 s before its end, as the fade is long
        {NULL, 0.3f, "idle", "-strike[idle] -fight[idle] "},
        {"attack", 0.1f, "windup", "-idle[windup] +fight[windup] +windup[windup] "},
        {"mock", 0.1f, "wink", "-windup[wink] +taunt[wink] +wink[wink] "},
        {"mock", 0.1f, "wink", ""}, // it is there already
        {"stop", 0.1f, "idle", "-wink[idle] -taunt[idle] -fight[idle] +idle[idle] "},
    };
    anim_instance who = spawn_fight();
    for (size_t i = 0; i < CORE_COUNT_OF(row); i++) {
        char text[16];
        snprintf(text, sizeof text, "row %zu", i);
        trace[0] = 0;
        if (row[i].send) {
            TEST_ASSERT_TRUE(anim_instance_send(f.world, who, row[i].send));
        }
        run(0.05f, (int)(row[i].seconds / 0.05f + 0.5f));
        TEST_ASSERT_EQUAL_STRING_MESSAGE(row[i].state, anim_instance_state(f.world, who), text);
        TEST_ASSERT_EQUAL_STRING_MESSAGE(row[i].trace, trace, text);
        bool fights = strcmp(row[i].state, "idle") != 0;
        TEST_ASSERT_EQUAL(fights, anim_instance_in(f.world, who, "fight"));
    }
    TEST_ASSERT_TRUE(anim_instance_go(f.world, who, "taunt", 0, ANIM_FADE_LINEAR));
    TEST_ASSERT_EQUAL_STRING("wink", anim_instance_state(f.world, who));
    const char *to[4];
    TEST_ASSERT_EQUAL_UINT32(2, anim_instance_transitions(f.world, who, to, 4));
    char *dot = anim_machine_dot(f.world, latest, who);
    TEST_ASSERT_NOT_NULL(strstr(dot, "subgraph cluster_1 {\n  label=\"fight\";\n"));
    TEST_ASSERT_NOT_NULL(
        strstr(dot, "\"windup\" -> \"idle\" [ltail=cluster_1, label=\"1: finished"));
    TEST_ASSERT_NOT_NULL(strstr(dot, "\"idle\" -> \"windup\" [lhead=cluster_1, "));
    core_free(dot);
}

static void test_a_machine_within_is_checked(void) {
    anim_state_desc s[2] = {state("a", slow, ANIM_LOOP), state("b", fast, ANIM_LOOP)};
    anim_machine_desc d = anim_machine_desc_default();
    d.state = s;
    d.state_count = 2;
    s[1].within = "a";
    TEST_ASSERT_TRUE(core_handle_is_null(anim_machine_create(f.world, &d)));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "\"a\" plays a clip, so it cannot hold \"b\""));
    s[1].within = "b";
    TEST_ASSERT_TRUE(core_handle_is_null(anim_machine_create(f.world, &d)));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "no state"));
    s[1].within = NULL;
    s[1].clip = CORE_NULL_HANDLE;
    TEST_ASSERT_TRUE(core_handle_is_null(anim_machine_create(f.world, &d)));
    TEST_ASSERT_NOT_NULL(
        strstr(core_last_error(), "\"b\" needs a clip that exists, or states within"));
}

static void test_a_machine_in_use_is_extended_and_trimmed(void) {
    static const anim_transition_desc none[] = {
        {.from = "idle", .to = "run", .when = ANIM_WHEN_EVENT, .event = "go"}};
    anim_instance who = spawn_three(none, 1);
    anim_machine m = latest;
    uint32_t states, transitions;
    anim_state_desc dance = state("dance", fast, ANIM_LOOP);
    anim_transition_desc to[] = {
        {.from = "idle", .to = "dance", .when = ANIM_WHEN_EVENT, .event = "party"},
        {.from = "dance", .to = "idle", .when = ANIM_WHEN_EVENT, .event = "go"}};
    anim_machine_desc more = anim_machine_desc_default();
    more.state = &dance;
    more.state_count = 1;
    more.transition = to;
    more.transition_count = 2;
    TEST_ASSERT_TRUE_MESSAGE(anim_machine_extend(f.world, m, &more), core_last_error());
    TEST_ASSERT_FALSE(anim_machine_extend(f.world, m, &more)); // all or nothing
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "two states are called \"dance\""));
    anim_machine_size(f.world, m, &states, &transitions);
    TEST_ASSERT_EQUAL(4, states);
    TEST_ASSERT_EQUAL(3, transitions);
    TEST_ASSERT_TRUE(anim_instance_send(f.world, who, "party"));
    anim_world_update(f.world, 0.1f);
    TEST_ASSERT_EQUAL_STRING("dance", anim_instance_state(f.world, who));
    TEST_ASSERT_FALSE(anim_machine_trim(f.world, m, 3, 1)); // it plays
    TEST_ASSERT_TRUE(anim_instance_send(f.world, who, "go"));
    anim_world_update(f.world, 0.1f);
    anim_world_update(f.world, 0.1f);
    TEST_ASSERT_FALSE(anim_machine_trim(f.world, m, 3, 2)); // a transition leads there
    TEST_ASSERT_TRUE_MESSAGE(anim_machine_trim(f.world, m, 3, 1), core_last_error());
    TEST_ASSERT_FALSE(anim_instance_send(f.world, who, "party"));
    TEST_ASSERT_TRUE(anim_machine_extend(f.world, m, &more));
}

static void test_dot(void) {
    const anim_transition_desc t[] = {
        {.to = "hit", .when = ANIM_WHEN_EVENT, .event = "hit", .length = 0.25f},
        {.from = "on\"ly", .to = "hit", .length = 0.5f, .fade = ANIM_FADE_SMOOTH},
    };
    const anim_state_desc s[] = {state("on\"ly", slow, ANIM_LOOP), state("hit", hit, ANIM_ONCE)};
    anim_machine_desc d = anim_machine_desc_default();
    d.state = s;
    d.state_count = 2;
    d.transition = t;
    d.transition_count = 2;
    anim_instance i = spawn(&d);
    anim_machine m = anim_machine_create(f.world, &d);
    char *text = anim_machine_dot(f.world, m, i);
    TEST_ASSERT_EQUAL_STRING(
        "digraph machine {\n  compound=true;\n  node [shape=box];\n"
        "  \"on\\\"ly\" [peripheries=2, style=filled];\n  \"hit\" [peripheries=1];\n"
        "  \"*\" -> \"hit\" [label=\"1: on hit\\n0.25 s\"];\n"
        "  \"on\\\"ly\" -> \"hit\" [label=\"2: finished\\n0.5 s smooth\"];\n}\n",
        text);
    core_free(text);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_parameter_event_and_finish);
    RUN_TEST(test_first_declared_transition_wins);
    RUN_TEST(test_interruption_does_not_pop);
    RUN_TEST(test_smooth_fade_is_continuous_in_velocity);
    RUN_TEST(test_interruption_callbacks);
    RUN_TEST(test_uninterruptible);
    RUN_TEST(test_linear_fade_curve);
    RUN_TEST(test_smooth_fade_curve);
    RUN_TEST(test_fade_over_ended_clips);
    RUN_TEST(test_loop_time_is_exact_over_long_steps);
    RUN_TEST(test_once_and_ping_pong);
    RUN_TEST(test_speed_callback);
    RUN_TEST(test_root_motion_sums_to_displacement);
    RUN_TEST(test_clip_events);
    RUN_TEST(test_destroy_from_a_callback);
    RUN_TEST(test_names_are_checked);
    RUN_TEST(test_resources_in_use_stay);
    RUN_TEST(test_steps_do_not_allocate);
    RUN_TEST(test_a_machine_within_a_state);
    RUN_TEST(test_a_machine_within_is_checked);
    RUN_TEST(test_a_machine_in_use_is_extended_and_trimmed);
    RUN_TEST(test_dot);
    return UNITY_END();
}
