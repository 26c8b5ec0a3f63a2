// Motion under constant acceleration g and linear drag k towards a wind w, from p with velocity v:
//   x(t) = p + w t + (v - w) f + g h,   f = (1 - exp(-k t)) / k,   h = (t - f) / k
#include "gfx/gfx_particles.h"

#include "core/simd_math.h"

// f and h = (t - f) / k. Where k t stays small, their series in x = k t, as the differences above
// would cancel: h = t^2 / 2 (1 - x/3 (1 - x/4 (1 - x/5 (1 - x/6)))), to 2e-5 at x = 1/2.
static inline void ways(float k, bool small, vf t, vf *f, vf *h) {
    const vf one = vf_set1(1.0f), drag = vf_set1(k);
    vf x = vf_mul(drag, t);
    if (small) {
        vf q = one;
        for (int i = 6; i >= 3; --i) {
            q = vf_sub(one, vf_mul(vf_div(x, vf_set1((float)i)), q));
        }
        *h = vf_mul(vf_mul(vf_mul(t, t), vf_set1(0.5f)), q);
        *f = vf_sub(t, vf_mul(drag, *h));
        return;
    }
    *f = vf_div(vf_sub(one, vf_exp(vf_neg(x))), drag);
    *h = vf_div(vf_sub(t, *f), drag);
}

static inline vf along(vf p, vf v, float w, float g, vf t, vf f, vf h) {
    vf drift = vf_mad(vf_set1(w), t, vf_mul(vf_set1(g), h));
    return vf_add(p, vf_mad(vf_sub(v, vf_set1(w)), f, drift));
}

uint32_t CORE_SIMD_NAME(gfx_particles_at)(const gfx_emitter_store *e, int32_t step, float part,
                                          float dt, const gfx_particle_view *out) {
    const gfx_emitter_desc *d = &e->desc;
    bool small = d->drag * d->life[1] < 0.5f;
    uint32_t kept = 0;
    for (uint32_t i = 0; i < e->used; i += CORE_SIMD_WIDTH) {
        vf steps = vf_from_i(vi_sub(vi_set1(step), vi_load(e->born + i)));
        vf t = vf_mul(vf_add(steps, vf_sub(vf_set1(part), vf_load(e->share + i))), vf_set1(dt));
        vf life = vf_load(e->life + i), f, h;
        vm alive =
            vm_and(vm_first((int)(e->used - i)), vm_and(vf_ge(t, vf_set1(0.0f)), vf_lt(t, life)));
        if (!vm_any(alive)) {
            continue;
        }
        ways(d->drag, small, t, &f, &h);
        float lane[5][CORE_SIMD_WIDTH];
        vf_storeu(lane[0], along(vf_load(e->px + i), vf_load(e->vx + i), d->wind.x,
                                 d->acceleration.x, t, f, h));
        vf_storeu(lane[1], along(vf_load(e->py + i), vf_load(e->vy + i), d->wind.y,
                                 d->acceleration.y, t, f, h));
        vf_storeu(lane[2], along(vf_load(e->pz + i), vf_load(e->vz + i), d->wind.z,
                                 d->acceleration.z, t, f, h));
        vf_storeu(lane[3], vf_div(t, life));
        vf_storeu(lane[4], vf_mad(vf_load(e->spin + i), t, vf_load(e->angle + i)));
        for (uint32_t bits = vm_bits(alive); bits; bits &= bits - 1, ++kept) {
            uint32_t k = (uint32_t)__builtin_ctz(bits);
            out->x[kept] = lane[0][k], out->y[kept] = lane[1][k], out->z[kept] = lane[2][k];
            out->u[kept] = lane[3][k], out->angle[kept] = lane[4][k];
            out->row[kept] = i + k;
        }
    }
    return kept;
}
