/* Box3D.  Default: 4 substeps.  PE_BEST, PE_FINE: 8, 16 substeps, and contacts and joints stiffened
 * with them (without that, more substeps change nothing: the springs stay as soft as they were). */
#include "pe.h"
#include <box3d/box3d.h>
#include <stdlib.h>
#include <string.h>

struct pe_world {
    b3WorldId w;
    b3BodyId *b, fixed;
    int n, cap, sub;
    struct {
        int id;
        b3HullData *h;
    } hull[64];
    int hulls;
};

#ifndef PE_NAME
#define PE_NAME "box3d"
#endif
const char *pe_name(void) { return PE_NAME; }
static b3Vec3 V(const double p[3]) { return (b3Vec3){(float)p[0], (float)p[1], (float)p[2]}; }

pe_world *pe_create(const pe_world_def *d) {
    pe_world *w = calloc(1, sizeof *w);
    b3WorldDef wd = b3DefaultWorldDef();
    wd.gravity = V(d->gravity);
    wd.enableSleep = d->sleep;
    wd.workerCount = d->threads;
    wd.contactHertz *= (float)(1 << d->preset);
    wd.capacity.dynamicBodyCount = wd.capacity.dynamicShapeCount = d->max_bodies;
    wd.capacity.contactCount = 8 * d->max_bodies;
    w->w = b3CreateWorld(&wd);
    w->sub = 4 << d->preset;
    w->cap = d->max_bodies + 64;
    w->b = calloc(w->cap, sizeof *w->b);
    b3BodyDef bd = b3DefaultBodyDef();
    w->fixed = b3CreateBody(w->w, &bd);
    return w;
}
void pe_destroy(pe_world *w) { b3DestroyWorld(w->w), free(w->b), free(w); }
int pe_add(pe_world *w, const pe_body_def *d) {
    if (w->n >= w->cap)
        return -1;
    b3BodyDef bd = b3DefaultBodyDef();
    bd.type = d->dynamic ? b3_dynamicBody : b3_staticBody;
    bd.position.x = (float)d->pos[0], bd.position.y = (float)d->pos[1],
    bd.position.z = (float)d->pos[2];
    bd.rotation.v = V(d->rot), bd.rotation.s = (float)d->rot[3];
    bd.linearVelocity = V(d->vel), bd.angularVelocity = V(d->ang);
    bd.isBullet = d->bullet;
    b3BodyId id = b3CreateBody(w->w, &bd);
    b3ShapeDef sd = b3DefaultShapeDef();
    sd.density = (float)d->density;
    sd.baseMaterial.friction = (float)d->friction;
    sd.baseMaterial.restitution = (float)d->restitution;
    sd.filter.groupIndex = -d->group;
    if (d->kind == PE_SPHERE) {
        b3Sphere s = {{0, 0, 0}, (float)d->r};
        b3CreateSphereShape(id, &sd, &s);
    } else if (d->kind == PE_BOX) {
        b3BoxHull h = b3MakeBoxHull((float)d->h[0], (float)d->h[1], (float)d->h[2]);
        b3CreateHullShape(id, &sd, &h.base);
    } else {
        int k = 0;
        while (k < w->hulls && w->hull[k].id != d->hull_id)
            k++;
        if (k == w->hulls) {
            b3Vec3 p[64];
            for (int i = 0; i < d->npts; i++)
                p[i] = V(d->pts + 3 * i);
            w->hull[k].id = d->hull_id, w->hull[k].h = b3CreateHull(p, d->npts, d->npts),
            w->hulls++;
        }
        if (!w->hull[k].h)
            return -1;
        b3CreateHullShape(id, &sd, w->hull[k].h);
    }
    w->b[w->n] = id;
    return w->n++;
}
int pe_ball(pe_world *w, int a, int b, const double at[3]) {
    b3SphericalJointDef jd = b3DefaultSphericalJointDef();
    b3Pos p;
    p.x = (float)at[0], p.y = (float)at[1], p.z = (float)at[2];
    jd.base.constraintHertz *= (float)w->sub / 4;
    jd.base.bodyIdA = w->b[a], jd.base.bodyIdB = b < 0 ? w->fixed : w->b[b];
    jd.base.localFrameA.p = b3Body_GetLocalPoint(jd.base.bodyIdA, p);
    jd.base.localFrameB.p = b3Body_GetLocalPoint(jd.base.bodyIdB, p);
    b3CreateSphericalJoint(w->w, &jd);
    return 1;
}
int pe_dist(pe_world *w, int a, int b, const double pa[3], const double pb[3]) {
    b3DistanceJointDef jd = b3DefaultDistanceJointDef();
    b3Pos p, q;
    p.x = (float)pa[0], p.y = (float)pa[1], p.z = (float)pa[2];
    q.x = (float)pb[0], q.y = (float)pb[1], q.z = (float)pb[2];
    jd.base.constraintHertz *= (float)w->sub / 4;
    jd.base.bodyIdA = w->b[a], jd.base.bodyIdB = w->b[b];
    jd.base.localFrameA.p = b3Body_GetLocalPoint(w->b[a], p);
    jd.base.localFrameB.p = b3Body_GetLocalPoint(w->b[b], q);
    b3Vec3 d = {(float)(pb[0] - pa[0]), (float)(pb[1] - pa[1]), (float)(pb[2] - pa[2])};
    jd.length = b3Length(d);
    b3CreateDistanceJoint(w->w, &jd);
    return 1;
}
void pe_ready(pe_world *w) { b3World_RebuildStaticTree(w->w); }
void pe_step(pe_world *w, double dt) { b3World_Step(w->w, (float)dt, w->sub); }
void pe_get(pe_world *w, int i, double pos[3], double rot[4], double vel[3], double ang[3]) {
    b3Pos p = b3Body_GetPosition(w->b[i]);
    b3Quat q = b3Body_GetRotation(w->b[i]);
    b3Vec3 v = b3Body_GetLinearVelocity(w->b[i]), a = b3Body_GetAngularVelocity(w->b[i]);
    pos[0] = p.x, pos[1] = p.y, pos[2] = p.z;
    rot[0] = q.v.x, rot[1] = q.v.y, rot[2] = q.v.z, rot[3] = q.s;
    vel[0] = v.x, vel[1] = v.y, vel[2] = v.z;
    ang[0] = a.x, ang[1] = a.y, ang[2] = a.z;
}
int pe_awake(pe_world *w) { return b3World_GetAwakeBodyCount(w->w); }
double pe_com(pe_world *w, int i, double c[3]) {
    b3Vec3 l = b3Body_GetLocalCenter(w->b[i]);
    c[0] = l.x, c[1] = l.y, c[2] = l.z;
    return b3Body_GetMass(w->b[i]);
}
