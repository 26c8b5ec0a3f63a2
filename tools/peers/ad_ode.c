/* ODE (Debian libode-dev, double precision).  Default: quickstep with 20 iterations; PE_BEST: 100;
 * PE_FINE: 4 substeps of 20.
 * (Its exact "world step" gives up on box stacks: too many contacts for its LCP.) */
#include "pe.h"
#include <math.h>
#include <ode/ode.h>
#include <stdlib.h>

enum { MAXC = 8 };
struct pe_world {
    dWorldID w;
    dSpaceID s;
    dJointGroupID c;
    dBodyID *b;
    dGeomID *g;
    double (*fix)[7];
    struct surf {
        double mu, e;
        int group;
    } * m;
    int n, cap, sub;
};

const char *pe_name(void) { return "ode-0.16.2"; }
static void near_cb(void *data, dGeomID a, dGeomID b) {
    pe_world *w = data;
    dBodyID x = dGeomGetBody(a), y = dGeomGetBody(b);
    struct surf *p = dGeomGetData(a), *q = dGeomGetData(b);
    if (!x && !y)
        return;
    if (p->group && p->group == q->group)
        return;
    dContact c[MAXC];
    int n = dCollide(a, b, MAXC, &c[0].geom, sizeof *c);
    for (int i = 0; i < n; i++) {
        c[i].surface.mode = dContactApprox1 | (p->e > 0 ? dContactBounce : 0);
        c[i].surface.mu = p->mu;
        c[i].surface.bounce = p->e;
        c[i].surface.bounce_vel = 0.1;
        dJointAttach(dJointCreateContact(w->w, w->c, &c[i]), x, y);
    }
}
pe_world *pe_create(const pe_world_def *d) {
    static int once;
    if (!once++)
        dInitODE2(0), dAllocateODEDataForThread(dAllocateMaskAll);
    pe_world *w = calloc(1, sizeof *w);
    w->w = dWorldCreate();
    w->s = dHashSpaceCreate(0);
    dHashSpaceSetLevels(w->s, -2, 9);
    w->c = dJointGroupCreate(0);
    dWorldSetGravity(w->w, d->gravity[0], d->gravity[1], d->gravity[2]);
    dWorldSetAutoDisableFlag(w->w, d->sleep);
    dWorldSetQuickStepNumIterations(w->w, d->preset == PE_BEST ? 100 : 20);
    dWorldSetContactSurfaceLayer(w->w, 0.001); /* its manual's advice */
    dWorldSetContactMaxCorrectingVel(w->w, 3);
    w->cap = d->max_bodies + 64;
    w->sub = d->preset == PE_FINE ? 4 : 1;
    w->b = calloc(w->cap, sizeof *w->b);
    w->g = calloc(w->cap, sizeof *w->g);
    w->m = calloc(w->cap, sizeof *w->m);
    w->fix = calloc(w->cap, sizeof *w->fix);
    return w;
}
void pe_destroy(pe_world *w) { dJointGroupDestroy(w->c), dSpaceDestroy(w->s), dWorldDestroy(w->w); }
int pe_add(pe_world *w, const pe_body_def *d) {
    if (d->kind == PE_HULL || w->n >= w->cap)
        return -1; /* its convex wants hand-made face lists */
    int i = w->n++;
    dGeomID g = d->kind == PE_SPHERE ? dCreateSphere(w->s, d->r)
                                     : dCreateBox(w->s, 2 * d->h[0], 2 * d->h[1], 2 * d->h[2]);
    dQuaternion q = {d->rot[3], d->rot[0], d->rot[1], d->rot[2]};
    w->g[i] = g;
    w->m[i].mu = d->friction, w->m[i].e = d->restitution, w->m[i].group = d->group;
    dGeomSetData(g, &w->m[i]);
    for (int k = 0; k < 3; k++)
        w->fix[i][k] = d->pos[k];
    for (int k = 0; k < 4; k++)
        w->fix[i][3 + k] = d->rot[k];
    if (d->dynamic) {
        dBodyID b = w->b[i] = dBodyCreate(w->w);
        dMass m;
        if (d->kind == PE_SPHERE)
            dMassSetSphere(&m, d->density, d->r);
        else
            dMassSetBox(&m, d->density, 2 * d->h[0], 2 * d->h[1], 2 * d->h[2]);
        dBodySetMass(b, &m);
        dGeomSetBody(g, b);
        dBodySetPosition(b, d->pos[0], d->pos[1], d->pos[2]);
        dBodySetQuaternion(b, q);
        dBodySetLinearVel(b, d->vel[0], d->vel[1], d->vel[2]);
        dBodySetAngularVel(b, d->ang[0], d->ang[1], d->ang[2]);
    } else {
        dGeomSetPosition(g, d->pos[0], d->pos[1], d->pos[2]);
        dGeomSetQuaternion(g, q);
    }
    return i;
}
int pe_ball(pe_world *w, int a, int b, const double at[3]) {
    dJointID j = dJointCreateBall(w->w, 0);
    dJointAttach(j, w->b[a], b < 0 ? 0 : w->b[b]);
    dJointSetBallAnchor(j, at[0], at[1], at[2]);
    return 1;
}
int pe_dist(pe_world *w, int a, int b, const double pa[3], const double pb[3]) {
    dJointID j = dJointCreateDBall(w->w, 0);
    if (!w->b[a]) {
        int t = a;
        a = b, b = t;
        const double *p = pa;
        pa = pb, pb = p;
    }
    dJointAttach(j, w->b[a], w->b[b]);
    dJointSetDBallAnchor1(j, pa[0], pa[1], pa[2]);
    dJointSetDBallAnchor2(j, pb[0], pb[1], pb[2]);
    return 1;
}
void pe_ready(pe_world *w) { (void)w; }
void pe_step(pe_world *w, double dt) {
    for (int i = 0; i < w->sub; i++) {
        dSpaceCollide(w->s, w, near_cb);
        dWorldQuickStep(w->w, dt / w->sub);
        dJointGroupEmpty(w->c);
    }
}
void pe_get(pe_world *w, int i, double pos[3], double rot[4], double vel[3], double ang[3]) {
    dBodyID b = w->b[i];
    for (int k = 0; k < 3; k++) {
        pos[k] = b ? dBodyGetPosition(b)[k] : w->fix[i][k];
        vel[k] = b ? dBodyGetLinearVel(b)[k] : 0;
        ang[k] = b ? dBodyGetAngularVel(b)[k] : 0;
    }
    for (int k = 0; k < 4; k++)
        rot[k] = b ? dBodyGetQuaternion(b)[(k + 1) & 3] : w->fix[i][3 + k];
}
int pe_awake(pe_world *w) {
    int n = 0;
    for (int i = 0; i < w->n; i++)
        n += w->b[i] && dBodyIsEnabled(w->b[i]);
    return n;
}
double pe_com(pe_world *w, int i, double c[3]) {
    dMass m;
    c[0] = c[1] = c[2] = 0;
    if (!w->b[i])
        return 0;
    dBodyGetMass(w->b[i], &m);
    return m.mass;
}
