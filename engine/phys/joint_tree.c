// Trees of joints, solved exactly in time linear in their number. The matrix J M^-1 J^T of a tree
// has a block LDL^T without fill when leaves are eliminated first (Baraff, SIGGRAPH 1996). It is
// kept by bodies instead of by pairs of joints: phi, a body's velocity answer to an impulse with
// the joints below it in place, takes one update of the joint's rank each (Woodbury), so that a
// hub with many joints costs no more than a chain. In double precision: a chain of 50 with an end
// of 1000 times the mass loses six digits on the way.
#include "phys/joint_solve.h"

#include <string.h>

// Part of a row's free answer added to the diagonal: joints that say the same twice stay solvable.
#define REGULAR 1e-9

typedef struct edge {
    uint32_t other, work;
} edge;

static uint32_t find_root(uint32_t *parent, uint32_t i) {
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

// Marks the joints that trees are made of. A group of bodies with many loops is left to iteration
// whole: exact pieces of a net gain nothing.
void joint_tree_choose(soft_joints *s) {
    core_arena *arena = &s->world->scratch;
    size_t mark = core_arena_mark(arena);
    uint32_t n = s->body_count;
    uint32_t *parent = CORE_ARENA_ARRAY(arena, uint32_t, n);
    uint32_t *loops = CORE_ARENA_ARRAY(arena, uint32_t, n);
    uint32_t *edges = CORE_ARENA_ARRAY(arena, uint32_t, n);
    bool *held = CORE_ARENA_ARRAY(arena, bool, n);
    for (uint32_t i = 0; i < n; i++) {
        parent[i] = i;
        loops[i] = edges[i] = 0;
        held[i] = false;
    }
    for (uint32_t i = 0; i < s->count; i++) {
        joint_work *k = &s->work[i];
        bool ma = s->body[k->a].mobile, mb = s->body[k->b].mobile;
        if (k->hard == 0) {
            continue;
        }
        if (ma && mb) {
            uint32_t a = find_root(parent, k->a), b = find_root(parent, k->b);
            k->direct = a != b;
            parent[CORE_MAX(a, b)] = CORE_MIN(a, b);
        } else {
            uint32_t only = ma ? k->a : k->b;
            k->direct = !held[only];
            held[only] = true;
        }
    }
    for (uint32_t i = 0; i < s->count; i++) {
        const joint_work *k = &s->work[i];
        uint32_t root = find_root(parent, s->body[k->a].mobile ? k->a : k->b);
        edges[root] += k->direct;
        loops[root] += k->hard != 0 && !k->direct;
    }
    for (uint32_t i = 0; i < s->count; i++) {
        joint_work *k = &s->work[i];
        uint32_t root = find_root(parent, s->body[k->a].mobile ? k->a : k->b);
        k->direct &= loops[root] * 4 <= edges[root];
    }
    core_arena_rewind(arena, mark);
}

// Lists of each body's joints in trees; those to what does not move name JOINT_NONE.
static void list_edges(const soft_joints *s, uint32_t *start, edge *list) {
    memset(start, 0, (s->body_count + 2) * sizeof *start);
    uint32_t *fill = start + 1;
    for (int pass = 0; pass < 2; pass++) {
        for (uint32_t i = 0; i < s->count; i++) {
            const joint_work *k = &s->work[i];
            bool ma = s->body[k->a].mobile, mb = s->body[k->b].mobile;
            if (!k->direct) {
                continue;
            }
            for (int side = 0; side < 2; side++) {
                uint32_t me = side ? k->b : k->a, other = side ? k->a : k->b;
                if (!(side ? mb : ma)) {
                    continue;
                }
                if (pass == 0) {
                    start[me + 2]++;
                } else {
                    list[fill[me]++] = (edge){(side ? ma : mb) ? other : JOINT_NONE, i};
                }
            }
        }
        for (uint32_t i = 0; pass == 0 && i < s->body_count; i++) {
            start[i + 2] += start[i + 1];
        }
    }
}

// Search from the root: order[], with each body's joint to its parent in up[].
static uint32_t search(uint32_t root, const uint32_t *start, const edge *list, uint32_t *order,
                       edge *up, bool *seen) {
    uint32_t count = 0;
    seen[root] = true;
    up[root] = (edge){JOINT_NONE, JOINT_NONE};
    order[count++] = root;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t body = order[i];
        for (uint32_t e = start[body]; e < start[body + 1]; e++) {
            uint32_t o = list[e].other;
            if (o != JOINT_NONE && !seen[o]) {
                seen[o] = true;
                up[o] = (edge){body, list[e].work};
                order[count++] = o;
            }
        }
    }
    return count;
}

static joint_op *add_op(const soft_joints *s, joint_op *op, uint32_t work, uint32_t child,
                        uint32_t parent) {
    op->work = work;
    op->child = child;
    op->parent = parent;
    op->flip = s->work[work].b == parent;
    return op + 1;
}

void joint_tree_build(soft_joints *s) {
    core_arena *arena = &s->world->scratch;
    joint_tree *t = &s->tree;
    uint32_t n = s->body_count;
    t->op = CORE_ARENA_ARRAY(arena, joint_op, s->count + 1);
    t->state = CORE_ARENA_ARRAY(arena, joint_state, n);
    t->first = CORE_ARENA_ARRAY(arena, uint32_t, n + 1);
    t->first_body = CORE_ARENA_ARRAY(arena, uint32_t, n + 1);
    t->body = CORE_ARENA_ARRAY(arena, uint32_t, n + 1);
    size_t mark = core_arena_mark(arena);
    uint32_t *start = CORE_ARENA_ARRAY(arena, uint32_t, n + 2);
    edge *list = CORE_ARENA_ARRAY(arena, edge, 2 * (size_t)s->count + 1);
    edge *up = CORE_ARENA_ARRAY(arena, edge, n);
    bool *seen = CORE_ARENA_ARRAY(arena, bool, n);
    memset(seen, 0, n * sizeof *seen);
    list_edges(s, start, list);
    joint_op *op = t->op;
    uint32_t placed = 0;
    t->trees = 0;
    for (uint32_t root = 1; root < n; root++) {
        if (seen[root] || start[root] == start[root + 1]) {
            continue;
        }
        t->first[t->trees] = (uint32_t)(op - t->op);
        t->first_body[t->trees++] = placed;
        uint32_t *order = t->body + placed;
        uint32_t count = search(root, start, list, order, up, seen);
        placed += count;
        for (uint32_t i = count; i-- > 0;) {
            uint32_t body = order[i];
            for (uint32_t e = start[body]; e < start[body + 1]; e++) {
                if (list[e].other == JOINT_NONE) {
                    op = add_op(s, op, list[e].work, JOINT_NONE, body);
                }
            }
            if (up[body].work != JOINT_NONE) {
                op = add_op(s, op, up[body].work, body, up[body].other);
            }
        }
    }
    t->first[t->trees] = (uint32_t)(op - t->op);
    t->first_body[t->trees] = placed;
    core_arena_rewind(arena, mark);
}

// Gauss-Jordan without pivoting: the matrix is symmetric and positive.
void joint_invert(double a[6][6], uint32_t n) {
    for (uint32_t k = 0; k < n; k++) {
        double pivot = a[k][k] > 0.0 ? 1.0 / a[k][k] : 0.0;
        a[k][k] = 1.0;
        for (uint32_t c = 0; c < n; c++) {
            a[k][c] *= pivot;
        }
        for (uint32_t r = 0; r < n; r++) {
            if (r != k) {
                double f = a[r][k];
                a[r][k] = 0.0;
                for (uint32_t c = 0; c < n; c++) {
                    a[r][c] -= f * a[k][c];
                }
            }
        }
    }
}

static void start_state(const soft_joints *s, uint32_t i) {
    const joint_body *b = &s->body[i];
    const float *m = s->bodies->inertia + (size_t)b->place * 8;
    double(*phi)[6] = s->tree.state[i].phi;
    memset(phi, 0, sizeof s->tree.state[i].phi);
    for (int k = 0; k < 3; k++) {
        phi[k][k] = b->im;
        phi[3 + k][3 + k] = m[k];
    }
    phi[3][4] = phi[4][3] = m[4];
    phi[3][5] = phi[5][3] = m[5];
    phi[4][5] = phi[5][4] = m[6];
}

// phi is symmetric: its rows are summed instead of its columns, six sums side by side. Rows of
// points and hinges are half empty.
static void answer(double phi[6][6], const float *row, double out[6]) {
    double sum[6] = {0};
    for (int k = 0; k < 6; k++) {
        if (row[k] != 0.0f) {
            for (int i = 0; i < 6; i++) {
                sum[i] += phi[k][i] * (double)row[k];
            }
        }
    }
    memcpy(out, sum, sizeof sum);
}

static double along(const float *row, const double v[6]) {
    double sum = 0.0;
    for (int k = 0; k < 6; k++) {
        sum += (double)row[k] * v[k];
    }
    return sum;
}

static void factor(soft_joints *s, joint_op *op) {
    const joint_work *k = &s->work[op->work];
    uint32_t n = k->hard, at = op->flip ? 6 : 0;
    joint_state *state = s->tree.state;
    double child[6][6] = {{0}};
    for (uint32_t r = 0; r < n; r++) {
        answer(state[op->parent].phi, k->row[r].j + at, op->g[r]);
        if (op->child != JOINT_NONE) {
            answer(state[op->child].phi, k->row[r].j + 6 - at, child[r]);
        }
    }
    for (uint32_t r = 0; r < n; r++) {
        for (uint32_t c = 0; c <= r; c++) {
            double v = along(k->row[r].j + at, op->g[c]) + along(k->row[r].j + 6 - at, child[c]);
            op->inverse[r][c] = op->inverse[c][r] = v;
        }
    }
    for (uint32_t r = 0; r < n; r++) {
        op->inverse[r][r] += op->inverse[r][r] * REGULAR + 1e-30;
    }
    joint_invert(op->inverse, n);
    double(*phi)[6] = state[op->parent].phi;
    for (uint32_t r = 0; r < n; r++) {
        for (int i = 0; i < 6; i++) {
            double sum = 0.0;
            for (uint32_t c = 0; c < n; c++) {
                sum += op->inverse[r][c] * op->g[c][i];
            }
            op->t[r][i] = sum;
        }
    }
    for (uint32_t r = 0; r < n; r++) {
        for (int i = 0; i < 6; i++) {
            for (int c = 0; c < 6; c++) {
                phi[i][c] -= op->g[r][i] * op->t[r][c];
            }
        }
    }
}

void joint_tree_factor(soft_joints *s, uint32_t tree) {
    const joint_tree *t = &s->tree;
    for (uint32_t i = t->first_body[tree]; i < t->first_body[tree + 1]; i++) {
        start_state(s, t->body[i]);
    }
    for (uint32_t i = t->first[tree]; i < t->first[tree + 1]; i++) {
        factor(s, &t->op[i]);
    }
}

static double speed_of(const soft_joints *s, const joint_work *k, const joint_row *r) {
    double sum = 0.0;
    for (int side = 0; side < 2; side++) {
        const float *v = s->bodies->velocity + (size_t)s->body[side ? k->b : k->a].place * 8;
        const float *j = r->j + side * 6;
        for (int i = 0; i < 3; i++) {
            sum += (double)j[i] * (double)v[i] + (double)j[3 + i] * (double)v[4 + i];
        }
    }
    return sum;
}

// What is missing at each joint when those below it have answered; how the parent then moves.
static void sweep_up(soft_joints *s, joint_op *op, bool correct) {
    const joint_work *k = &s->work[op->work];
    uint32_t n = k->hard, at = op->flip ? 6 : 0;
    joint_state *state = s->tree.state;
    double miss[6];
    for (uint32_t r = 0; r < n; r++) {
        const joint_row *row = &k->row[r];
        miss[r] = -speed_of(s, k, row) - (double)(correct ? row->bias : row->relax) -
                  along(row->j + at, state[op->parent].u);
        if (op->child != JOINT_NONE) {
            miss[r] -= along(row->j + 6 - at, state[op->child].u);
        }
    }
    for (uint32_t r = 0; r < n; r++) {
        double sum = 0.0;
        for (uint32_t c = 0; c < n; c++) {
            sum += op->inverse[r][c] * miss[c];
        }
        op->mu[r] = sum;
        for (int i = 0; i < 6; i++) {
            state[op->parent].u[i] += op->g[r][i] * sum;
        }
    }
}

// Impulses from the root down: what later joints do to the parent is taken back here.
static void sweep_down(soft_joints *s, joint_op *op, bool fresh) {
    joint_work *k = &s->work[op->work];
    uint32_t n = k->hard, at = op->flip ? 6 : 0;
    joint_state *state = s->tree.state;
    double impulse[6];
    for (uint32_t r = 0; r < n; r++) {
        double sum = op->mu[r];
        for (int i = 0; i < 6; i++) {
            sum -= op->t[r][i] * state[op->parent].f[i];
        }
        impulse[r] = sum;
    }
    for (uint32_t r = 0; r < n; r++) {
        k->row[r].impulse = (fresh ? 0.0f : k->row[r].impulse) + (float)impulse[r];
        for (int i = 0; i < 6; i++) {
            state[op->parent].f[i] += (double)k->row[r].j[at + (uint32_t)i] * impulse[r];
        }
        for (int i = 0; op->child != JOINT_NONE && i < 6; i++) {
            state[op->child].f[i] += (double)k->row[r].j[6 - at + (uint32_t)i] * impulse[r];
        }
    }
}

static void apply(const soft_joints *s, uint32_t i) {
    const joint_body *b = &s->body[i];
    const float *m = s->bodies->inertia + (size_t)b->place * 8;
    float *v = s->bodies->velocity + (size_t)b->place * 8;
    const double *f = s->tree.state[i].f;
    for (int k = 0; k < 3; k++) {
        v[k] = (float)((double)v[k] + (double)b->im * f[k]);
    }
    v[4] = (float)((double)v[4] + (double)m[0] * f[3] + (double)m[4] * f[4] + (double)m[5] * f[5]);
    v[5] = (float)((double)v[5] + (double)m[4] * f[3] + (double)m[1] * f[4] + (double)m[6] * f[5]);
    v[6] = (float)((double)v[6] + (double)m[5] * f[3] + (double)m[6] * f[4] + (double)m[2] * f[5]);
}

void joint_tree_solve(soft_joints *s, uint32_t tree, bool correct) {
    const joint_tree *t = &s->tree;
    for (uint32_t i = t->first_body[tree]; i < t->first_body[tree + 1]; i++) {
        joint_state *state = &t->state[t->body[i]];
        memset(state->u, 0, sizeof state->u);
        memset(state->f, 0, sizeof state->f);
    }
    for (uint32_t i = t->first[tree]; i < t->first[tree + 1]; i++) {
        sweep_up(s, &t->op[i], correct);
    }
    for (uint32_t i = t->first[tree + 1]; i-- > t->first[tree];) {
        sweep_down(s, &t->op[i], correct);
    }
    for (uint32_t i = t->first_body[tree]; i < t->first_body[tree + 1]; i++) {
        apply(s, t->body[i]);
    }
}
