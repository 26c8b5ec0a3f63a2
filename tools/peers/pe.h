/* pe.h - the one interface every physics peer implements.
 * Units: metre, kilogram, second, radian.  Quaternions are x,y,z,w.
 * Friction and restitution are the values the CONTACT must have between two bodies that carry
 * the same number: an adapter undoes its engine's own mixing rule. */
#ifndef PE_H
#define PE_H
#ifdef __cplusplus
extern "C" {
#endif

typedef struct pe_world pe_world;

enum { PE_SPHERE, PE_BOX, PE_HULL };
enum {
    PE_DEFAULT,
    PE_BEST,
    PE_FINE
}; /* engine defaults / for hard scenes, about 2x the cost / about 4x */

typedef struct {
    double gravity[3];
    int threads, preset, max_bodies;
    int sleep; /* 0: bodies never sleep */
} pe_world_def;

typedef struct {
    int dynamic, kind;
    double r;    /* PE_SPHERE */
    double h[3]; /* PE_BOX: half extents */
    const double *pts;
    int npts;    /* PE_HULL: points about the body origin ... */
    int hull_id; /* ... equal ids carry equal points: share the shape */
    double pos[3], rot[4], vel[3], ang[3];
    double density, friction, restitution;
    int bullet; /* ask for continuous collision on this body */
    int group;  /* nonzero: bodies of one group do not collide */
} pe_body_def;

const char *pe_name(void);
pe_world *pe_create(const pe_world_def *);
void pe_destroy(pe_world *);
int pe_add(pe_world *, const pe_body_def *);               /* body index 0,1,2...; -1: cannot */
int pe_ball(pe_world *, int a, int b, const double at[3]); /* b == -1: world; 0: cannot */
int pe_dist(pe_world *, int a, int b, const double pa[3], const double pb[3]); /* rigid rod */
void pe_ready(pe_world *); /* all bodies are in */
void pe_step(pe_world *, double dt);
void pe_get(pe_world *, int body, double pos[3], double rot[4], double vel[3], double ang[3]);
int pe_awake(pe_world *);                           /* dynamic bodies awake; -1: unknown */
double pe_com(pe_world *, int body, double com[3]); /* mass; centre in body frame */

#ifdef __cplusplus
}
#endif
#endif
