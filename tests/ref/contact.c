#include "contact.h"

#include <stdbool.h>

#include <math.h>
#include <string.h>

#define MARGIN 1e-3  // m: contacts are looked for within this distance
#define SLOW   1e-2  // m/s: slower approaches do not bounce
#define TIGHT  1e-13 // N s per kg: the sweeps end when no impulse changes by more
#define SWEEPS 20000

typedef struct contact {
    int a, b;
    ref_vec n, ra, rb;  // n: from a to b
    double gap, bounce; // m; m/s of separation wanted
    double friction, jn;
    ref_vec jt;
} contact;

static ref_vec vec(double x, double y, double z) { return (ref_vec){x, y, z}; }
static ref_vec add(ref_vec a, ref_vec b) { return vec(a.x + b.x, a.y + b.y, a.z + b.z); }
static ref_vec sub(ref_vec a, ref_vec b) { return vec(a.x - b.x, a.y - b.y, a.z - b.z); }
static ref_vec mul(ref_vec a, double s) { return vec(a.x * s, a.y * s, a.z * s); }
static double dot(ref_vec a, ref_vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static double len(ref_vec a) { return sqrt(dot(a, a)); }
static ref_vec cross(ref_vec a, ref_vec b) {
    return vec(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
static double at(ref_vec a, int i) { return i == 0 ? a.x : i == 1 ? a.y : a.z; }

static ref_vec turn(ref_quat q, ref_vec v) {
    ref_vec u = vec(q.x, q.y, q.z), t = mul(cross(u, v), 2);
    return add(add(v, mul(t, q.w)), cross(u, t));
}
static ref_vec turn_back(ref_quat q, ref_vec v) {
    return turn((ref_quat){-q.x, -q.y, -q.z, q.w}, v);
}
static ref_vec axis_of(const ref_body *b, int i) { return turn(b->q, vec(i == 0, i == 1, i == 2)); }

static ref_vec inverse_inertia(const ref_body *b, ref_vec v) {
    if (b->mass == 0) {
        return vec(0, 0, 0);
    }
    ref_vec l = turn_back(b->q, v);
    return turn(b->q, vec(l.x / b->inertia.x, l.y / b->inertia.y, l.z / b->inertia.z));
}

static ref_vec spin_momentum(const ref_body *b) {
    ref_vec l = turn_back(b->q, b->w);
    return turn(b->q, vec(l.x * b->inertia.x, l.y * b->inertia.y, l.z * b->inertia.z));
}

int ref_world_add(ref_world *world, ref_body b) {
    if (b.q.x == 0 && b.q.y == 0 && b.q.z == 0 && b.q.w == 0) {
        b.q.w = 1;
    }
    if (b.inertia.x == 0 && b.shape == REF_SPHERE) {
        double i = 0.4 * b.mass * b.radius * b.radius;
        b.inertia = vec(i, i, i);
    } else if (b.inertia.x == 0) {
        double x = b.half.x * b.half.x, y = b.half.y * b.half.y, z = b.half.z * b.half.z;
        b.inertia = mul(vec(y + z, x + z, x + y), b.mass / 3);
    }
    world->body[world->count] = b;
    return world->count++;
}

// ---- where bodies touch ----

typedef struct touch_list {
    ref_world *world;
    contact *contact;
    int count;
} touch_list;

// point: halfway between the surfaces.
static void touch(touch_list *l, int a, int b, ref_vec n, double gap, ref_vec point) {
    ref_body *x = &l->world->body[a], *y = &l->world->body[b];
    if (gap > MARGIN || l->count == REF_CONTACTS) {
        return;
    }
    contact c = {.a = a, .b = b, .n = n, .gap = gap};
    c.ra = sub(point, x->p);
    c.rb = sub(point, y->p);
    c.friction = sqrt(x->friction * y->friction);
    c.bounce = fmax(x->restitution, y->restitution);
    l->contact[l->count++] = c;
}

static ref_vec corner(const ref_body *b, int i) {
    ref_vec local = vec(i & 1 ? b->half.x : -b->half.x, i & 2 ? b->half.y : -b->half.y,
                        i & 4 ? b->half.z : -b->half.z);
    return add(b->p, turn(b->q, local));
}

static void plane_touch(touch_list *l, int plane, int other) {
    const ref_body *p = &l->world->body[plane], *b = &l->world->body[other];
    ref_vec n = axis_of(p, 1);
    if (b->shape == REF_SPHERE) {
        double gap = dot(sub(b->p, p->p), n) - b->radius;
        touch(l, plane, other, n, gap, sub(b->p, mul(n, b->radius + 0.5 * gap)));
        return;
    }
    for (int i = 0; i < 8; i++) {
        ref_vec c = corner(b, i);
        double gap = dot(sub(c, p->p), n);
        touch(l, plane, other, n, gap, sub(c, mul(n, 0.5 * gap)));
    }
}

static void ball_ball(touch_list *l, int i, int j) {
    const ref_body *a = &l->world->body[i], *b = &l->world->body[j];
    ref_vec d = sub(b->p, a->p), n = mul(d, 1 / len(d));
    double gap = len(d) - a->radius - b->radius;
    touch(l, i, j, n, gap, add(a->p, mul(n, a->radius + 0.5 * gap)));
}

// The sphere's centre is taken to stay outside the box: steps are small.
static void box_ball(touch_list *l, int box, int ball) {
    const ref_body *a = &l->world->body[box], *b = &l->world->body[ball];
    ref_vec c = turn_back(a->q, sub(b->p, a->p));
    ref_vec near =
        vec(fmin(fmax(c.x, -a->half.x), a->half.x), fmin(fmax(c.y, -a->half.y), a->half.y),
            fmin(fmax(c.z, -a->half.z), a->half.z));
    ref_vec d = sub(c, near);
    if (len(d) > 0) {
        ref_vec n = turn(a->q, mul(d, 1 / len(d)));
        double gap = len(d) - b->radius;
        touch(l, box, ball, n, gap, add(add(a->p, turn(a->q, near)), mul(n, 0.5 * gap)));
    }
}

static double reach(const ref_body *b, ref_vec n) {
    return b->half.x * fabs(dot(axis_of(b, 0), n)) + b->half.y * fabs(dot(axis_of(b, 1), n)) +
           b->half.z * fabs(dot(axis_of(b, 2), n));
}

// Cuts a polygon at the plane dot(x, n) <= d (Sutherland and Hodgman 1974).
static int cut(const ref_vec *in, int n_in, ref_vec n, double d, ref_vec *out) {
    int count = 0;
    for (int i = 0; i < n_in; i++) {
        ref_vec p = in[i], q = in[(i + 1) % n_in];
        double hp = dot(p, n) - d, hq = dot(q, n) - d;
        if (hp <= 0) {
            out[count++] = p;
        }
        if ((hp < 0 && hq > 0) || (hp > 0 && hq < 0)) {
            out[count++] = add(p, mul(sub(q, p), hp / (hp - hq)));
        }
    }
    return count;
}

// The face of b most against n, cut to the face of a whose outward normal is n.
static void face_touch(touch_list *l, int i, int j, int axis, ref_vec n, bool swapped) {
    const ref_body *a = &l->world->body[i], *b = &l->world->body[j];
    int side = 0;
    for (int k = 1; k < 3; k++) {
        side = fabs(dot(axis_of(b, k), n)) > fabs(dot(axis_of(b, side), n)) ? k : side;
    }
    double sign = dot(axis_of(b, side), n) > 0 ? -1 : 1;
    int u = (side + 1) % 3, v = (side + 2) % 3;
    ref_vec poly[16], next[16];
    ref_vec center = add(b->p, mul(axis_of(b, side), sign * at(b->half, side)));
    for (int k = 0; k < 4; k++) {
        double su = k == 0 || k == 3 ? -1 : 1, sv = k < 2 ? -1 : 1;
        poly[k] = add(center, add(mul(axis_of(b, u), su * at(b->half, u)),
                                  mul(axis_of(b, v), sv * at(b->half, v))));
    }
    int count = 4;
    for (int k = 1; k < 3; k++) {
        ref_vec e = axis_of(a, (axis + k) % 3);
        double d = at(a->half, (axis + k) % 3), mid = dot(a->p, e);
        count = cut(poly, count, e, mid + d + 1e-12, next);
        count = cut(next, count, mul(e, -1), -mid + d + 1e-12, poly);
    }
    double face = dot(a->p, n) + at(a->half, axis);
    for (int k = 0; k < count; k++) {
        double gap = dot(poly[k], n) - face;
        ref_vec point = sub(poly[k], mul(n, 0.5 * gap));
        touch(l, swapped ? j : i, swapped ? i : j, swapped ? mul(n, -1) : n, gap, point);
    }
}

// The edges that support along n and -n: their closest points.
static void edge_touch(touch_list *l, int i, int j, int ea, int eb, ref_vec n, double gap) {
    const ref_body *a = &l->world->body[i], *b = &l->world->body[j];
    ref_vec pa = a->p, pb = b->p;
    for (int k = 0; k < 3; k++) {
        ref_vec xa = axis_of(a, k), xb = axis_of(b, k);
        pa = k == ea ? pa : add(pa, mul(xa, dot(xa, n) > 0 ? at(a->half, k) : -at(a->half, k)));
        pb = k == eb ? pb : add(pb, mul(xb, dot(xb, n) > 0 ? -at(b->half, k) : at(b->half, k)));
    }
    ref_vec u = axis_of(a, ea), v = axis_of(b, eb), w = sub(pa, pb);
    double uv = dot(u, v), den = 1 - uv * uv;
    double s = (uv * dot(v, w) - dot(u, w)) / den, t = (dot(v, w) - uv * dot(u, w)) / den;
    touch(l, i, j, n, gap, mul(add(add(pa, mul(u, s)), add(pb, mul(v, t))), 0.5));
}

// Separating axes: the axis of least overlap says what touches (Gottschalk et al. 1996).
static void box_box(touch_list *l, int i, int j) {
    const ref_body *a = &l->world->body[i], *b = &l->world->body[j];
    ref_vec d = sub(b->p, a->p), n = vec(0, 1, 0);
    double best = -INFINITY;
    int kind = 0;
    for (int k = 0; k < 15; k++) {
        ref_vec x = k < 3   ? axis_of(a, k)
                    : k < 6 ? axis_of(b, k - 3)
                            : cross(axis_of(a, (k - 6) / 3), axis_of(b, (k - 6) % 3));
        if (len(x) < 1e-6) {
            continue;
        }
        x = mul(x, (dot(x, d) < 0 ? -1 : 1) / len(x));
        double gap = dot(d, x) - reach(a, x) - reach(b, x);
        if (gap > best + (k < 6 ? 1e-9 : 1e-6)) { // faces first: an edge must be clearly better
            best = gap;
            n = x;
            kind = k;
        }
    }
    if (best > MARGIN) {
        return;
    }
    if (kind < 3) {
        face_touch(l, i, j, kind, n, false);
    } else if (kind < 6) {
        face_touch(l, j, i, kind - 3, mul(n, -1), true);
    } else {
        edge_touch(l, i, j, (kind - 6) / 3, (kind - 6) % 3, n, best);
    }
}

static void find_touches(touch_list *l) {
    for (int i = 0; i < l->world->count; i++) {
        for (int j = i + 1; j < l->world->count; j++) {
            ref_body *a = &l->world->body[i], *b = &l->world->body[j];
            if (a->mass == 0 && b->mass == 0) {
                continue;
            }
            if (a->shape == REF_PLANE || b->shape == REF_PLANE) {
                plane_touch(l, a->shape == REF_PLANE ? i : j, a->shape == REF_PLANE ? j : i);
            } else if (a->shape == REF_SPHERE && b->shape == REF_SPHERE) {
                ball_ball(l, i, j);
            } else if (a->shape == REF_BOX && b->shape == REF_BOX) {
                box_box(l, i, j);
            } else {
                box_ball(l, a->shape == REF_BOX ? i : j, a->shape == REF_BOX ? j : i);
            }
        }
    }
}

// ---- impulses ----

static ref_vec velocity_at(const ref_body *b, ref_vec r) { return add(b->v, cross(b->w, r)); }

static ref_vec approach(const ref_world *w, const contact *c) {
    return sub(velocity_at(&w->body[c->b], c->rb), velocity_at(&w->body[c->a], c->ra));
}

static void push(ref_body *b, ref_vec r, ref_vec j) {
    if (b->mass > 0) {
        b->v = add(b->v, mul(j, 1 / b->mass));
        b->w = add(b->w, inverse_inertia(b, cross(r, j)));
    }
}

static void push_both(ref_world *w, const contact *c, ref_vec j) {
    push(&w->body[c->a], c->ra, mul(j, -1));
    push(&w->body[c->b], c->rb, j);
}

// Inverse of what a unit impulse along n does to the relative velocity along n.
static double mass_along(const ref_world *w, const contact *c, ref_vec n) {
    const ref_body *a = &w->body[c->a], *b = &w->body[c->b];
    double k = (a->mass > 0 ? 1 / a->mass : 0) + (b->mass > 0 ? 1 / b->mass : 0);
    k += dot(cross(inverse_inertia(a, cross(c->ra, n)), c->ra), n);
    k += dot(cross(inverse_inertia(b, cross(c->rb, n)), c->rb), n);
    return 1 / k;
}

// One projected Gauss-Seidel update; returns the change of impulse.
static double relax(ref_world *w, contact *c, double h) {
    double want = c->bounce > 0 ? c->bounce : -c->gap / h;
    double m = mass_along(w, c, c->n), before = c->jn;
    c->jn = fmax(0, c->jn + m * (want - dot(approach(w, c), c->n)));
    push_both(w, c, mul(c->n, c->jn - before));
    double change = fabs(c->jn - before);
    ref_vec v = approach(w, c), slip = sub(v, mul(c->n, dot(v, c->n)));
    double speed = len(slip);
    if (c->friction > 0 && speed > 0) {
        ref_vec t = mul(slip, 1 / speed), old = c->jt;
        ref_vec next = sub(old, mul(t, speed * mass_along(w, c, t)));
        double limit = c->friction * c->jn;
        c->jt = len(next) > limit ? mul(next, limit / len(next)) : next;
        push_both(w, c, sub(c->jt, old));
        change += len(sub(c->jt, old));
    } else if (len(c->jt) > c->friction * c->jn) {
        ref_vec next = mul(c->jt, c->friction * c->jn / len(c->jt));
        push_both(w, c, sub(next, c->jt));
        c->jt = next;
    }
    return change;
}

static void solve(ref_world *w, contact *c, int count, double h) {
    for (int i = 0; i < count; i++) {
        double speed = dot(approach(w, &c[i]), c[i].n);
        bool meets = c[i].gap + speed * h <= 0;
        c[i].bounce = meets && speed < -SLOW ? -c[i].bounce * speed : 0;
    }
    double scale = 0;
    for (int i = 0; i < w->count; i++) {
        scale = fmax(scale, w->body[i].mass);
    }
    w->residual = 0;
    for (int sweep = 0; sweep < SWEEPS; sweep++) {
        w->residual = 0;
        for (int i = 0; i < count; i++) {
            w->residual = fmax(w->residual, relax(w, &c[i], h));
        }
        if (w->residual <= TIGHT * scale) {
            return;
        }
    }
}

// ---- steps ----

static ref_quat turned(ref_quat q, ref_vec w, double h) {
    double angle = len(w) * h, s = angle > 0 ? sin(angle / 2) / len(w) : 0, c = cos(angle / 2);
    ref_vec r = mul(w, s), u = vec(q.x, q.y, q.z);
    ref_vec v = add(add(mul(u, c), mul(r, q.w)), cross(r, u));
    ref_quat out = {v.x, v.y, v.z, c * q.w - dot(r, u)};
    double n = sqrt(out.x * out.x + out.y * out.y + out.z * out.z + out.w * out.w);
    return (ref_quat){out.x / n, out.y / n, out.z / n, out.w / n};
}

// Free flight is exact: p + v h + g h^2 / 2. The spin keeps its angular momentum.
static void move(ref_world *w, const bool *touched, double h) {
    for (int i = 0; i < w->count; i++) {
        ref_body *b = &w->body[i];
        if (b->mass == 0) {
            continue;
        }
        ref_vec momentum = spin_momentum(b);
        b->p = add(b->p, mul(b->v, h));
        if (!touched[i]) {
            b->p = sub(b->p, mul(w->gravity, 0.5 * h * h));
        }
        b->q = turned(b->q, b->w, h);
        b->w = inverse_inertia(b, momentum);
    }
}

static void step(ref_world *w, double h, contact *last, int *last_count) {
    contact found[REF_CONTACTS];
    touch_list list = {w, found, 0};
    find_touches(&list);
    if (list.count == *last_count) { // the same contacts: start from their impulses
        for (int i = 0; i < list.count; i++) {
            bool same = found[i].a == last[i].a && found[i].b == last[i].b;
            found[i].jn = same ? last[i].jn : 0;
            found[i].jt = same ? last[i].jt : vec(0, 0, 0);
        }
    }
    for (int i = 0; i < w->count; i++) {
        if (w->body[i].mass > 0) {
            w->body[i].v = add(w->body[i].v, mul(w->gravity, h));
        }
    }
    bool touched[REF_BODIES] = {false};
    for (int i = 0; i < list.count; i++) {
        push_both(w, &found[i], add(mul(found[i].n, found[i].jn), found[i].jt));
    }
    solve(w, found, list.count, h);
    for (int i = 0; i < list.count; i++) {
        touched[found[i].a] |= found[i].jn > 0;
        touched[found[i].b] |= found[i].jn > 0;
    }
    move(w, touched, h);
    w->contacts = list.count;
    *last_count = list.count;
    memcpy(last, found, (size_t)list.count * sizeof *found);
}

void ref_world_run(ref_world *w, double t, int steps) {
    contact last[REF_CONTACTS];
    int count = 0;
    for (int i = 0; i < steps; i++) {
        step(w, t / steps, last, &count);
    }
}

double ref_world_energy(const ref_world *w) {
    double e = 0;
    for (int i = 0; i < w->count; i++) {
        const ref_body *b = &w->body[i];
        e += 0.5 * b->mass * dot(b->v, b->v) - b->mass * dot(w->gravity, b->p);
        e += b->mass > 0 ? 0.5 * dot(b->w, spin_momentum(b)) : 0;
    }
    return e;
}

ref_vec ref_world_momentum(const ref_world *w) {
    ref_vec sum = {0, 0, 0};
    for (int i = 0; i < w->count; i++) {
        sum = add(sum, mul(w->body[i].v, w->body[i].mass));
    }
    return sum;
}
