// Compressed clips: the stated bound holds at every joint, shell point and time, by an evaluation
// of its own here; hostile bytes are refused or keep the rules.
#include "anim/crowd.h"
#include "anim/pack.h"

static crowd c;

void setUp(void) {
    crowd_skeleton(&c);
    crowd_clip(&c, "walk", 4.0f / 3, 0.6f);
}
void tearDown(void) {}

static void sample_keys(uint32_t bone, double time, double t[3], double q[4], double s[3]) {
    const core_clip_track *track = NULL;
    for (uint32_t i = 0; i < c.clip.track_count; i++) {
        track = c.clip.track[i].bone == bone ? &c.clip.track[i] : track;
    }
    core_key rest = {0, c.translation[bone], c.rotation[bone], c.scale[bone]};
    const core_key *a = &rest, *b = &rest;
    double u = 0;
    if (track) {
        uint32_t k = 0;
        while (k + 2 < track->key_count && (double)track->key[k + 1].time <= time) {
            k++;
        }
        a = &track->key[k];
        b = &track->key[k + 1];
        u = (time - (double)a->time) / ((double)b->time - (double)a->time);
        u = u < 0 ? 0 : u > 1 ? 1 : u;
    }
    const float *ta = &a->translation.x, *tb = &b->translation.x, *sa = &a->scale.x,
                *sb = &b->scale.x, *qa = &a->rotation.x, *qb = &b->rotation.x;
    double dot = 0, angle, n = 0;
    for (int i = 0; i < 4; i++) {
        dot += (double)qa[i] * (double)qb[i];
        if (i < 3) {
            t[i] = (double)ta[i] * (1 - u) + (double)tb[i] * u;
            s[i] = (double)sa[i] * (1 - u) + (double)sb[i] * u;
        }
    }
    angle = acos(fmin(1, fabs(dot)));
    for (int i = 0; i < 4; i++) {
        double wa = angle > 1e-9 ? sin((1 - u) * angle) / sin(angle) : 1 - u;
        double wb = angle > 1e-9 ? sin(u * angle) / sin(angle) : u;
        q[i] = (double)qa[i] * wa + (double)qb[i] * wb * (dot < 0 ? -1 : 1);
        n += q[i] * q[i];
    }
    for (int i = 0; i < 4; i++) {
        q[i] /= sqrt(n);
    }
}

static void rotate(const double q[4], const double v[3], double out[3]) {
    double t[3] = {2 * (q[1] * v[2] - q[2] * v[1]), 2 * (q[2] * v[0] - q[0] * v[2]),
                   2 * (q[0] * v[1] - q[1] * v[0])};
    out[0] = v[0] + q[3] * t[0] + q[1] * t[2] - q[2] * t[1];
    out[1] = v[1] + q[3] * t[1] + q[2] * t[0] - q[0] * t[2];
    out[2] = v[2] + q[3] * t[2] + q[0] * t[1] - q[1] * t[0];
}

// A point of a bone carried up the chain to model space, one transform at a time.
static void to_model(double (*t)[3], double (*q)[4], double (*s)[3], uint32_t bone,
                     const double local[3], double out[3]) {
    double p[3] = {local[0], local[1], local[2]};
    for (int32_t b = (int32_t)bone; b >= 0; b = c.parent[b]) {
        double scaled[3] = {p[0] * s[b][0], p[1] * s[b][1], p[2] * s[b][2]};
        rotate(q[b], scaled, p);
        for (int i = 0; i < 3; i++) {
            p[i] += t[b][i];
        }
    }
    memcpy(out, p, sizeof p);
}

static double worst_distance(const anim_pack *pack, double shell) {
    static double t[2][CROWD_BONES][3], q[2][CROWD_BONES][4], s[2][CROWD_BONES][3];
    static float columns[10 * CROWD_BONES];
    double worst = 0;
    for (int k = 0; k <= 250; k++) {
        float time = c.clip.duration * (float)k / 250;
        for (uint32_t b = 0; b < CROWD_BONES; b++) {
            sample_keys(b, (double)time, t[0][b], q[0][b], s[0][b]);
            const float *parts[] = {&c.translation[b].x, &c.rotation[b].x, &c.scale[b].x};
            for (uint32_t i = 0; i < 10; i++) {
                columns[i * CROWD_BONES + b] = i < 3   ? parts[0][i]
                                               : i < 7 ? parts[1][i - 3]
                                                       : parts[2][i - 7];
            }
        }
        anim_pack_sample(pack, time, CROWD_BONES, columns);
        for (uint32_t b = 0; b < CROWD_BONES; b++) {
            for (uint32_t i = 0; i < 10; i++) {
                double v = (double)columns[i * CROWD_BONES + b];
                *(i < 3 ? &t[1][b][i] : i < 7 ? &q[1][b][i - 3] : &s[1][b][i - 7]) = v;
            }
        }
        for (uint32_t b = 0; b < CROWD_BONES; b++) {
            for (int point = 0; point < 4; point++) {
                double local[3] = {point == 1 ? shell : 0, point == 2 ? shell : 0,
                                   point == 3 ? shell : 0};
                double x[3], y[3];
                to_model(t[0], q[0], s[0], b, local, x);
                to_model(t[1], q[1], s[1], b, local, y);
                worst = fmax(worst,
                             sqrt(pow(x[0] - y[0], 2) + pow(x[1] - y[1], 2) + pow(x[2] - y[2], 2)));
            }
        }
    }
    return worst;
}

static void test_bound_holds_everywhere(void) {
    static const float bounds[] = {0.005f, 0.0005f, 0.0001f};
    size_t last = SIZE_MAX;
    for (size_t i = CORE_COUNT_OF(bounds); i > 0; i--) {
        size_t size = 0;
        void *bytes = anim_pack_encode(&c.skeleton, &c.clip, bounds[i - 1], 0.1f, 0, &size);
        TEST_ASSERT_NOT_NULL_MESSAGE(bytes, core_last_error());
        anim_pack *pack = anim_pack_decode(bytes, size, "p");
        TEST_ASSERT_NOT_NULL(pack);
        TEST_ASSERT_TRUE(pack->error > 0 && pack->error <= bounds[i - 1]);
        double worst = worst_distance(pack, 0.1);
        // Times between those the encoder looked at may be worse by a curve's second difference.
        TEST_ASSERT_TRUE_MESSAGE(worst <= (double)bounds[i - 1] * 1.02, "beyond the bound");
        TEST_ASSERT_TRUE(worst >= (double)pack->error * 0.5); // the statement is no empty one
        TEST_ASSERT_TRUE(size < last);                        // a looser bound is never larger
        last = size;
        core_free(pack);
        core_free(bytes);
    }
}

static void test_a_spinning_bone_is_refused(void) {
    for (uint32_t k = 0; k < CROWD_KEYS; k++) {
        c.key[1][k].rotation = core_quat_axis_angle(core_v3(0, 1, 0), 6.0f * (float)k / CROWD_KEYS);
    }
    size_t size = 0;
    TEST_ASSERT_NULL(anim_pack_encode(&c.skeleton, &c.clip, 0.0005f, 0.1f, 0, &size));
    TEST_ASSERT_NOT_NULL(strstr(core_last_error(), "bone1"));
    // A world that compresses keeps such a clip as keys.
    anim_world_desc desc = anim_world_desc_default();
    anim_world *w = anim_world_create(&desc);
    anim_world_set(w, "pack", "0.0005");
    anim_clip clip = crowd_clip_create(w, anim_skeleton_create(w, &c.skeleton), &c);
    float error;
    TEST_ASSERT_FALSE(anim_clip_packed(w, clip, &error, &size));
    uint32_t keys;
    TEST_ASSERT_NOT_NULL(anim_clip_keys(w, clip, 1, &keys));
    anim_world_destroy(w);
}

static void test_same_bytes_twice(void) {
    size_t a = 0, b = 0;
    void *first = anim_pack_encode(&c.skeleton, &c.clip, 0.0005f, 0.1f, 0, &a);
    void *second = anim_pack_encode(&c.skeleton, &c.clip, 0.0005f, 0.1f, 0, &b);
    TEST_ASSERT_EQUAL_UINT64(a, b);
    TEST_ASSERT_EQUAL_MEMORY(first, second, a);
    core_free(first);
    core_free(second);
}

static void test_hostile_bytes(void) {
    size_t size = 0;
    uint8_t *file = anim_pack_encode(&c.skeleton, &c.clip, 0.001f, 0.1f, 0, &size);
    for (size_t n = 0; n < size; n += n < 400 ? 1 : 37) {
        uint8_t *cut = malloc(n ? n : 1);
        memcpy(cut, file, n);
        core_clear_error();
        TEST_ASSERT_NULL(anim_pack_decode(cut, n, "f"));
        TEST_ASSERT_TRUE(strncmp(core_last_error(), "f: ", 3) == 0);
        free(cut);
    }
    core_rng rng = core_rng_make(3, 1);
    uint8_t *bad = malloc(size);
    float *columns = calloc(10 * CROWD_BONES, sizeof *columns);
    int refused = 0;
    for (int n = 0; n < 3000; n++) {
        memcpy(bad, file, size);
        uint32_t range = n % 2 ? 600 : (uint32_t)size; // half of them in the heads
        bad[core_rng_below(&rng, range)] ^= (uint8_t)(1u << core_rng_below(&rng, 8));
        anim_pack *pack = anim_pack_decode(bad, size, "f");
        refused += pack == NULL;
        if (pack && pack->bones == CROWD_BONES) {
            anim_pack_sample(pack, pack->duration * 0.7f, CROWD_BONES, columns);
            for (uint32_t i = 0; i < 10 * CROWD_BONES; i++) {
                TEST_ASSERT_TRUE(isfinite(columns[i]));
            }
        }
        core_free(pack);
    }
    TEST_ASSERT_TRUE(refused > 100);
    free(columns);
    free(bad);
    core_free(file);
}

int main(void) {
    UNITY_BEGIN();
    RUN_TEST(test_bound_holds_everywhere);
    RUN_TEST(test_a_spinning_bone_is_refused);
    RUN_TEST(test_same_bytes_twice);
    RUN_TEST(test_hostile_bytes);
    return UNITY_END();
}
