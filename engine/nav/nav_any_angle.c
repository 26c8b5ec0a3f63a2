// Shortest ways over polygons: Cui, Harabor, Grastien, "Compromise-free pathfinding on a navigation
// mesh" (Polyanya), IJCAI 2017. A search node is a view: a root, and an interval of an edge that is
// seen from it. Behind the edge, what the view shows keeps the root; what lies beside it is reached
// by a bend at the end of the interval, where that is a turning point.
//
// Plane coordinates in cells, doubles: borders lie on whole numbers, so side tests are exact but
// for the ends of clipped intervals.
#include <math.h>
#include <string.h>

#include "nav/nav_internal.h"

#define EPS 1e-9

typedef nav_point point;

static double cross(point o, point a, point b) { // > 0: b lies left of the ray from o through a
    return (a.x - o.x) * (b.z - o.z) - (a.z - o.z) * (b.x - o.x);
}
static double distance(point a, point b) {
    double dx = b.x - a.x, dz = b.z - a.z;
    return core_sqrt(dx * dx + dz * dz);
}
static point between(point a, point b, double t) {
    return (point){a.x + (b.x - a.x) * t, a.z + (b.z - a.z) * t};
}

typedef struct search {
    const nav_mesh_data *m;
    nav_view_scratch *s;
    point goal;
    uint32_t goal_polygon;
    bool flood; // no goal: everything that can be reached, nearest first
} search;

static point corner(const nav_mesh_data *m, uint32_t edge) {
    return (point){m->edge[edge].x, m->edge[edge].z};
}
static uint32_t next_edge(const nav_mesh_data *m, uint32_t polygon, uint32_t edge) {
    return edge + 1 == m->polygon.edges[polygon].end ? m->polygon.edges[polygon].first : edge + 1;
}

// ---- open list: binary heap of views by f; of equals the larger g, then the younger ----

static bool before(const nav_view_scratch *s, uint32_t a, uint32_t b) {
    const nav_view *va = &s->view[a], *vb = &s->view[b];
    if (va->f != vb->f) {
        return va->f < vb->f;
    }
    return va->g != vb->g ? va->g > vb->g : a > b;
}

static void push(nav_view_scratch *s, const nav_view *view) {
    if (s->count == s->capacity) {
        uint32_t wanted = CORE_MAX(s->capacity * 2, 1024u);
        s->view = core_realloc(s->view, s->capacity * sizeof *s->view, wanted * sizeof *s->view);
        s->heap = core_realloc(s->heap, s->capacity * sizeof *s->heap, wanted * sizeof *s->heap);
        s->capacity = wanted;
    }
    uint32_t number = s->count++, place = s->open++;
    s->view[number] = *view;
    while (place > 0 && before(s, number, s->heap[(place - 1) / 2])) {
        s->heap[place] = s->heap[(place - 1) / 2];
        place = (place - 1) / 2;
    }
    s->heap[place] = number;
}

static uint32_t pop(nav_view_scratch *s) {
    uint32_t top = s->heap[0], moved = s->heap[--s->open], place = 0;
    for (uint32_t child = 1; child < s->open; child = 2 * place + 1) {
        child += child + 1 < s->open && before(s, s->heap[child + 1], s->heap[child]);
        if (!before(s, s->heap[child], moved)) {
            break;
        }
        s->heap[place] = s->heap[child];
        place = child;
    }
    s->heap[place] = moved;
    return top;
}

// ---- estimates ----

static double distance_to_piece(point p, point a, point b) {
    double dx = b.x - a.x, dz = b.z - a.z, square = dx * dx + dz * dz;
    double t = ((p.x - a.x) * dx + (p.z - a.z) * dz) / square;
    return distance(p, between(a, b, CORE_CLAMP(t, 0.0, 1.0)));
}

// Shortest way from the view's root through its interval to the goal, were all beyond it free. A
// goal on the root's side of the edge is mirrored to the other.
static double estimate(const search *q, const nav_view *v) {
    if (q->flood) {
        return distance_to_piece(v->root, v->right, v->left);
    }
    point goal = q->goal, a = v->right, b = v->left;
    double root_side = cross(a, b, v->root), goal_side = cross(a, b, goal);
    if (root_side * goal_side > 0.0) {
        double dx = b.x - a.x, dz = b.z - a.z, t = 2.0 * goal_side / (dx * dx + dz * dz);
        goal = (point){goal.x + dz * t, goal.z - dx * t};
    }
    if (root_side > -EPS && root_side < EPS) { // on the edge's line: by its nearest point
        double to_left = distance(v->root, v->left), to_right = distance(v->root, v->right);
        double size = distance(a, b);
        if (to_left <= size && to_right <= size) {
            return distance(v->root, goal);
        }
        return to_left < to_right ? to_left + distance(v->left, goal)
                                  : to_right + distance(v->right, goal);
    }
    if (cross(v->root, v->right, goal) < 0.0) {
        return distance(v->root, v->right) + distance(v->right, goal);
    }
    if (cross(v->root, v->left, goal) > 0.0) {
        return distance(v->root, v->left) + distance(v->left, goal);
    }
    return distance(v->root, goal);
}

// Whether a way with this root is still the cheapest known one to it.
static bool root_is_best(nav_view_scratch *s, uint32_t turn, double g) {
    if (turn == NAV_NONE) {
        return true; // the start
    }
    if (s->stamp[turn] == s->query && s->best[turn] < g - EPS) {
        return false;
    }
    if (s->stamp[turn] != s->query || g < s->best[turn]) {
        s->stamp[turn] = s->query;
        s->best[turn] = g;
    }
    return true;
}

// A way is taut at a bend when the closed cell there lies on the side to which it bends. `side` 1:
// to the left, -1: to the right.
static bool bends_taut(const nav_mesh_data *m, point from, point at, uint32_t turn, double side) {
    static const double dir_x[4] = {1, 0, -1, 0}, dir_z[4] = {0, 1, 0, -1};
    if (turn == NAV_NONE) {
        return false;
    }
    double x = at.x - from.x, z = at.z - from.z;
    for (int k = 0; k < 2; k++) {
        int d = (m->turn_closed[turn] + k) % 4;
        if (side * (x * dir_z[d] - z * dir_x[d]) < -EPS) {
            return false;
        }
    }
    return true;
}

// ---- successors ----

// The part from p to q of an edge of the polygon, seen from a root, becomes a view into the polygon
// beyond it. Counter-clockwise: p is its right end, q its left end.
static void add_view(search *s, uint32_t edge, uint32_t polygon, point p, point q, point root,
                     uint32_t root_turn, double g, uint32_t parent) {
    const nav_mesh_data *m = s->m;
    uint32_t beyond = m->edge[edge].beyond, next = next_edge(m, polygon, edge);
    if (beyond == NAV_NONE || !root_is_best(s->s, root_turn, g)) {
        return;
    }
    point a = corner(m, edge), b = corner(m, next);
    if (distance(p, q) < EPS) {
        return;
    }
    nav_view v = {.root = root,
                  .left = q,
                  .right = p,
                  .g = g,
                  .root_turn = root_turn,
                  .polygon = beyond,
                  .parent = parent};
    uint32_t at_p = m->edge[edge].turn, at_q = m->edge[next].turn;
    bool p_bends = distance(p, a) < EPS && bends_taut(m, root, p, at_p, -1.0);
    bool q_bends = distance(q, b) < EPS && bends_taut(m, root, q, at_q, 1.0);
    v.right_turn = p_bends ? at_p : NAV_NONE;
    v.left_turn = q_bends ? at_q : NAV_NONE;
    // The edge over which it is entered: the one of the other polygon that comes back.
    v.entered = NAV_NONE;
    for (uint32_t e = m->polygon.edges[beyond].first; e < m->polygon.edges[beyond].end; e++) {
        point c = corner(m, e), d = corner(m, next_edge(m, beyond, e));
        if (m->edge[e].beyond == polygon && c.x == b.x && c.z == b.z && d.x == a.x && d.z == a.z) {
            v.entered = e;
        }
    }
    v.f = g + estimate(s, &v);
    push(s->s, &v);
}

// All edges but the entered one, from a root that sees all of the polygon.
static void add_all(search *s, const nav_view *v, point root, uint32_t turn, double g,
                    uint32_t parent) {
    const nav_mesh_data *m = s->m;
    nav_range edges = m->polygon.edges[v->polygon];
    for (uint32_t e = edges.first; e < edges.end; e++) {
        if (e != v->entered) {
            add_view(s, e, v->polygon, corner(m, e), corner(m, next_edge(m, v->polygon, e)), root,
                     turn, g, parent);
        }
    }
}

// The root lies on the line of the entered edge: inside the interval it sees everything, outside it
// everything lies behind a bend at the nearer end.
static void expand_flat(search *s, const nav_view *v, uint32_t number) {
    double to_left = distance(v->root, v->left), to_right = distance(v->root, v->right);
    double size = distance(v->left, v->right);
    if (to_left <= size + EPS && to_right <= size + EPS) {
        add_all(s, v, v->root, v->root_turn, v->g, number);
    } else if (to_left < to_right && v->left_turn != NAV_NONE) {
        add_all(s, v, v->left, v->left_turn, v->g + to_left, number);
    } else if (to_right < to_left && v->right_turn != NAV_NONE) {
        add_all(s, v, v->right, v->right_turn, v->g + to_right, number);
    }
}

// One edge p..q behind the interval: the part right of the view, the part in it, the part left of
// it.
static void add_parts(search *s, const nav_view *v, uint32_t number, uint32_t edge, point p,
                      point q) {
    double p_right = cross(v->root, v->right, p), q_right = cross(v->root, v->right, q);
    if (p_right < -EPS || q_right < -EPS) {
        point m = q_right <= EPS ? q : between(p, q, p_right / (p_right - q_right));
        if (v->right_turn != NAV_NONE) {
            add_view(s, edge, v->polygon, p, m, v->right, v->right_turn,
                     v->g + distance(v->root, v->right), number);
        }
        if (q_right <= EPS) {
            return;
        }
        p = m;
    }
    double p_left = cross(v->root, v->left, p), q_left = cross(v->root, v->left, q);
    if (p_left > EPS || q_left > EPS) {
        point m = p_left >= -EPS ? p : between(p, q, p_left / (p_left - q_left));
        if (v->left_turn != NAV_NONE) {
            add_view(s, edge, v->polygon, m, q, v->left, v->left_turn,
                     v->g + distance(v->root, v->left), number);
        }
        if (p_left >= -EPS) {
            return;
        }
        q = m;
    }
    add_view(s, edge, v->polygon, p, q, v->root, v->root_turn, v->g, number);
}

static void expand(search *s, uint32_t number) {
    nav_view v = s->s->view[number]; // the array may move
    const nav_mesh_data *m = s->m;
    double side = cross(v.right, v.left, v.root);
    if (side > -EPS && side < EPS) {
        expand_flat(s, &v, number);
        return;
    }
    for (uint32_t e = next_edge(m, v.polygon, v.entered); e != v.entered;
         e = next_edge(m, v.polygon, e)) {
        if (m->edge[e].beyond != NAV_NONE) {
            point q = corner(m, next_edge(m, v.polygon, e));
            add_parts(s, &v, number, e, corner(m, e), q);
        }
    }
}

// In the goal's polygon: the goal is seen, or lies behind a bend at an end of the interval. A bend
// where no way turns is no way. Gives the view that ends the way, NAV_NONE when there is none.
static uint32_t reaches(const search *s, uint32_t number) {
    nav_view v = s->s->view[number];
    if (v.f <= v.g + distance(v.root, s->goal) + EPS) {
        return number;
    }
    double left = v.g + distance(v.root, v.left) + distance(v.left, s->goal);
    bool by_left = v.f >= left - EPS;
    uint32_t turn = by_left ? v.left_turn : v.right_turn;
    if (turn == NAV_NONE) {
        return NAV_NONE;
    }
    point bend = by_left ? v.left : v.right;
    v.g += distance(v.root, bend);
    v.root = bend;
    v.root_turn = turn;
    v.parent = number;
    push(s->s, &v);
    return s->s->count - 1;
}

static void begin(nav_view_scratch *s, uint32_t turns) {
    if (turns > s->turns) {
        s->best = core_realloc(s->best, s->turns * sizeof *s->best, turns * sizeof *s->best);
        s->stamp = core_realloc(s->stamp, s->turns * sizeof *s->stamp, turns * sizeof *s->stamp);
        s->turns = turns;
    }
    if (++s->query == 0) {
        memset(s->stamp, 0, s->turns * sizeof *s->stamp);
        s->query = 1;
    }
    s->count = s->open = 0;
}

// Goes on until the way is known or so many views have been expanded.
nav_progress nav_mesh_any_angle_run(nav_any_angle *q, uint32_t most) {
    search s = {q->mesh, q->scratch, q->goal, q->goal_polygon, false};
    nav_view_scratch *scratch = q->scratch;
    for (uint32_t n = 0; scratch->open;) {
        if (n == most) {
            return NAV_GOES_ON;
        }
        uint32_t number = pop(scratch);
        nav_view *v = &scratch->view[number];
        if (!root_is_best(scratch, v->root_turn, v->g)) {
            continue;
        }
        if (v->polygon == q->goal_polygon) {
            q->last = reaches(&s, number);
            if (q->last != NAV_NONE) {
                return NAV_IS_FOUND;
            }
        }
        expand(&s, number);
        q->expanded++;
        n++;
    }
    return NAV_IS_NOT_THERE;
}

void nav_mesh_any_angle_begin(nav_any_angle *q, nav_point start, uint32_t start_polygon) {
    search s = {q->mesh, q->scratch, q->goal, q->goal_polygon, false};
    begin(q->scratch, q->mesh->turn_blocks.end);
    nav_view all = {.root = start,
                    .root_turn = NAV_NONE,
                    .polygon = start_polygon,
                    .entered = NAV_NONE,
                    .parent = NAV_NONE};
    q->expanded = 0;
    q->last = NAV_NONE;
    if (start_polygon == q->goal_polygon) {
        all.f = distance(start, q->goal); // the first to be taken, and it reaches
        push(q->scratch, &all);
        return;
    }
    add_all(&s, &all, start, NAV_NONE, 0.0, NAV_NONE);
}

uint32_t nav_mesh_any_angle(const nav_mesh_data *m, nav_view_scratch *scratch, nav_point start,
                            uint32_t start_polygon, nav_point goal, uint32_t goal_polygon,
                            uint32_t *expanded) {
    nav_any_angle q = {m, scratch, goal, goal_polygon, 0, NAV_NONE};
    nav_mesh_any_angle_begin(&q, start, start_polygon);
    nav_mesh_any_angle_run(&q, UINT32_MAX);
    *expanded = q.expanded;
    return q.last;
}

void nav_mesh_flood(const nav_mesh_data *m, nav_view_scratch *scratch, nav_point start,
                    uint32_t polygon) {
    search s = {m, scratch, start, NAV_NONE, true};
    begin(scratch, m->turn_blocks.end);
    nav_view all = {.root = start,
                    .root_turn = NAV_NONE,
                    .polygon = polygon,
                    .entered = NAV_NONE,
                    .parent = NAV_NONE};
    add_all(&s, &all, start, NAV_NONE, 0.0, NAV_NONE);
    while (scratch->open) {
        uint32_t number = pop(scratch);
        const nav_view *v = &scratch->view[number];
        if (root_is_best(scratch, v->root_turn, v->g)) {
            expand(&s, number);
        }
    }
}

double nav_view_reach(const nav_view *v, nav_point p, nav_point *bend, uint32_t *turn) {
    *turn = NAV_NONE;
    double side = cross(v->right, v->left, v->root);
    double to_left = distance(v->root, v->left), to_right = distance(v->root, v->right);
    bool flat = side > -EPS && side < EPS, inside;
    if (flat) { // the root on the line of the interval
        double size = distance(v->left, v->right) + EPS;
        inside = to_left <= size && to_right <= size;
    } else {
        inside = cross(v->root, v->right, p) >= -EPS && cross(v->root, v->left, p) <= EPS;
    }
    if (inside) {
        return v->g + distance(v->root, p);
    }
    bool by_left = flat ? to_left < to_right : cross(v->root, v->left, p) > 0.0;
    *turn = by_left ? v->left_turn : v->right_turn;
    *bend = by_left ? v->left : v->right;
    if (*turn == NAV_NONE) {
        return (double)INFINITY;
    }
    return v->g + (by_left ? to_left : to_right) + distance(*bend, p);
}

void nav_view_scratch_release(nav_view_scratch *s) {
    core_free(s->view);
    core_free(s->heap);
    core_free(s->best);
    core_free(s->stamp);
    *s = (nav_view_scratch){0};
}
