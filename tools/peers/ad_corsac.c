/* Corsac behind the peers' interface (pe.h). Default settings; PE_BEST and PE_FINE double and
 * quadruple the substeps. Groups are layers whose members do not collide with each other. */
#include "core/simd.h"
#include "pe.h"
#include "phys/phys.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct pe_world {
    phys_world *w;
    core_jobs *jobs;
    phys_body *body;
    double *mass;
    int n, cap;
};

const char *pe_name(void) { return "corsac"; }

static core_vec3 vec(const double p[3]) { return core_v3((float)p[0], (float)p[1], (float)p[2]); }

// CORSAC_SIMD=sse2|avx2|avx512 forces a set (speed only: the bits are the same).
static void choose_set(void) {
    const char *wanted = getenv("CORSAC_SIMD");
    for (int s = 0; wanted && s < CORE_SIMD_SETS; s++) {
        if (strcmp(wanted, core_simd_name((core_simd_set)s)) == 0) {
            core_simd_use((core_simd_set)s);
        }
    }
}

pe_world *pe_create(const pe_world_def *d) {
    choose_set();
    pe_world *p = calloc(1, sizeof *p);
    phys_world_desc wd = phys_world_desc_default();
    p->jobs = d->threads > 1 ? core_jobs_create(d->threads) : NULL;
    wd.jobs = p->jobs;
    wd.gravity = vec(d->gravity);
    wd.zero_gravity = d->gravity[0] == 0 && d->gravity[1] == 0 && d->gravity[2] == 0;
    wd.max_bodies = (uint32_t)d->max_bodies + 64;
    const char *substeps = getenv("CORSAC_SUBSTEPS"); // settings between the presets
    wd.substeps = d->preset == PE_DEFAULT ? 0 : 8 << d->preset;
    wd.substeps = substeps && *substeps ? atoi(substeps) : wd.substeps;
    p->w = phys_world_create(&wd);
    phys_world_set(p->w, "sleep", d->sleep ? "on" : "off");
    p->cap = d->max_bodies + 64;
    p->body = calloc((size_t)p->cap, sizeof *p->body);
    return p;
}

void pe_destroy(pe_world *p) {
    phys_world_destroy(p->w);
    core_jobs_destroy(p->jobs);
    free(p->body);
    free(p);
}

int pe_add(pe_world *p, const pe_body_def *d) {
    if (p->n >= p->cap || d->group > 31) {
        return -1;
    }
    phys_body_desc bd = phys_body_desc_default();
    bd.type = d->dynamic ? PHYS_DYNAMIC : PHYS_STATIC;
    bd.position = vec(d->pos);
    bd.rotation =
        (core_quat){(float)d->rot[0], (float)d->rot[1], (float)d->rot[2], (float)d->rot[3]};
    bd.velocity = vec(d->vel);
    bd.angular_velocity = vec(d->ang);
    bd.layer = (uint32_t)d->group;
    if (d->group != 0) {
        phys_world_set_rule(p->w, bd.layer, bd.layer, false);
    }
    static const phys_shape_type kind[] = {PHYS_SPHERE, PHYS_BOX, PHYS_HULL};
    phys_shape_desc sd = phys_shape_desc_default(kind[d->kind]);
    sd.radius = (float)d->r;
    sd.half = vec(d->h);
    sd.density = (float)d->density;
    sd.friction = (float)d->friction;
    sd.restitution = (float)d->restitution;
    float points[64 * 3];
    for (int i = 0; i < 3 * d->npts && i < 64 * 3; i++) {
        points[i] = (float)d->pts[i];
    }
    sd.points = points;
    sd.point_count = (uint32_t)d->npts;
    phys_body b = phys_body_create(p->w, &bd, &sd, 1);
    if (core_handle_is_null(b)) {
        return -1;
    }
    p->body[p->n] = b;
    return p->n++;
}

static int join(pe_world *p, phys_joint_desc *d, int a, int b) {
    d->a = p->body[a];
    d->b = b < 0 ? CORE_NULL_HANDLE : p->body[b];
    return !core_handle_is_null(phys_joint_create(p->w, d));
}

int pe_ball(pe_world *p, int a, int b, const double at[3]) {
    phys_joint_desc d = phys_joint_desc_default(PHYS_JOINT_BALL);
    d.anchor = vec(at);
    return join(p, &d, a, b);
}

int pe_dist(pe_world *p, int a, int b, const double pa[3], const double pb[3]) {
    phys_joint_desc d = phys_joint_desc_default(PHYS_JOINT_DISTANCE);
    d.anchor_a = vec(pa);
    d.anchor_b = vec(pb);
    return join(p, &d, a, b);
}

void pe_ready(pe_world *p) { (void)p; }
void pe_step(pe_world *p, double dt) { phys_world_step(p->w, (float)dt); }

void pe_get(pe_world *p, int i, double pos[3], double rot[4], double vel[3], double ang[3]) {
    uint32_t r = phys_body_row(p->w, p->body[i]);
    phys_pose_view v = phys_world_poses(p->w);
    pos[0] = v.px[r], pos[1] = v.py[r], pos[2] = v.pz[r];
    rot[0] = v.qx[r], rot[1] = v.qy[r], rot[2] = v.qz[r], rot[3] = v.qw[r];
    vel[0] = v.vx[r], vel[1] = v.vy[r], vel[2] = v.vz[r];
    ang[0] = v.wx[r], ang[1] = v.wy[r], ang[2] = v.wz[r];
}

int pe_awake(pe_world *p) {
    core_metrics *m = core_metrics_create();
    phys_world_counts(p->w, m);
    int n = (int)core_metrics_get(m, CORE_COUNT_AWAKE);
    core_metrics_destroy(m);
    return n;
}

double pe_com(pe_world *p, int i, double com[3]) {
    com[0] = com[1] = com[2] = 0;
    return phys_body_mass(p->w, p->body[i]);
}
