// A* on graphs: an indexed 4-ary heap and one record a node, both as large as the largest graph, so
// that a query allocates nothing; records of earlier queries are told apart by a stamp.
#include <string.h>

#include "nav/nav_internal.h"

void nav_scratch_fit(nav_scratch *s, uint32_t nodes) {
    if (nodes <= s->capacity) {
        return;
    }
    uint32_t wanted = CORE_MAX(s->capacity * 2, CORE_MAX(nodes, 256u));
    s->record =
        core_realloc(s->record, s->capacity * sizeof *s->record, wanted * sizeof *s->record);
    s->heap = core_realloc(s->heap, s->capacity * sizeof *s->heap, wanted * sizeof *s->heap);
    s->capacity = wanted;
}

void nav_scratch_release(nav_scratch *s) {
    core_free(s->record);
    core_free(s->heap);
    *s = (nav_scratch){0};
}

const char *nav_status_name(nav_status status) {
    static const char *const names[] = {"invalid", "found", "partial",
                                        "no path", "limit", "pending"};
    return (unsigned)status < CORE_COUNT_OF(names) ? names[status] : "unknown";
}

nav_query nav_query_default(void) {
    return (nav_query){.heuristic = NAV_EUCLID, .weight = 1.0f, .cookie = NAV_QUERY_COOKIE};
}

// Length of a way along the axes and diagonals of the ground plane, heights added as they are. A
// norm, so scaled to the least cost per length it is a consistent heuristic on any graph.
double nav_octile(double dx, double dy, double dz) {
    dx = dx < 0.0 ? -dx : dx, dy = dy < 0.0 ? -dy : dy, dz = dz < 0.0 ? -dz : dz;
    double longer = CORE_MAX(dx, dz), shorter = CORE_MIN(dx, dz);
    double flat = longer + 0.41421356237309515 * shorter;
    return CORE_MAX(flat, dy);
}

typedef struct search {
    const nav_graph_data *g;
    nav_scratch *s;
    nav_heuristic heuristic;
    double scale, weight; // of the heuristic: keeps it consistent; how far it may overestimate
    float gx, gy, gz;
    uint32_t open; // entries of the heap
    uint32_t nearest;
    double nearest_square; // of its distance to the goal
    bool reopen, partial;
    uint32_t expanded;
} search;

static double estimate(const search *q, uint32_t node) {
    double dx = (double)q->g->node.px[node] - q->gx, dy = (double)q->g->node.py[node] - q->gy;
    double dz = (double)q->g->node.pz[node] - q->gz;
    switch (q->heuristic) {
    case NAV_EUCLID:
        return q->scale * core_sqrt(dx * dx + dy * dy + dz * dz);
    case NAV_OCTILE:
        return q->scale * nav_octile(dx, dy, dz);
    default:
        return 0.0;
    }
}

// Smaller f first; of equals the one nearer to the goal, then the smaller id: a total order, so the
// way found does not depend on how the heap is built.
static bool before(const search *q, nav_heap_entry a, nav_heap_entry b) {
    if (a.f != b.f) {
        return a.f < b.f;
    }
    double ha = q->s->record[a.node].h, hb = q->s->record[b.node].h;
    return ha != hb ? ha < hb : a.node < b.node;
}

static void put(search *q, uint32_t place, nav_heap_entry e) {
    q->s->heap[place] = e;
    q->s->record[e.node].place = place;
}

static void sift_up(search *q, uint32_t place, nav_heap_entry e) {
    while (place > 0) {
        uint32_t parent = (place - 1) / 4;
        if (!before(q, e, q->s->heap[parent])) {
            break;
        }
        put(q, place, q->s->heap[parent]);
        place = parent;
    }
    put(q, place, e);
}

static void sift_down(search *q, nav_heap_entry e) {
    uint32_t place = 0;
    for (;;) {
        uint32_t child = 4 * place + 1, end = CORE_MIN(child + 4, q->open);
        if (child >= end) {
            break;
        }
        for (uint32_t c = child + 1; c < end; c++) {
            child = before(q, q->s->heap[c], q->s->heap[child]) ? c : child;
        }
        if (!before(q, q->s->heap[child], e)) {
            break;
        }
        put(q, place, q->s->heap[child]);
        place = child;
    }
    put(q, place, e);
}

static uint32_t pop(search *q) {
    uint32_t node = q->s->heap[0].node;
    if (--q->open) {
        sift_down(q, q->s->heap[q->open]);
    }
    q->s->record[node].place = NAV_NO_NODE;
    return node;
}

// A way of cost g to a node by way of `parent` has been found.
static void reach(search *q, uint32_t node, uint32_t parent, double g) {
    nav_record *r = &q->s->record[node];
    bool seen = r->stamp == q->s->stamp;
    if (seen && (g >= r->g || (r->place == NAV_NO_NODE && !q->reopen))) {
        return;
    }
    if (!seen) {
        r->stamp = q->s->stamp;
        r->h = estimate(q, node);
        r->place = NAV_NO_NODE;
    }
    r->g = g;
    r->parent = parent;
    uint32_t place = r->place == NAV_NO_NODE ? q->open++ : r->place;
    sift_up(q, place, (nav_heap_entry){g + q->weight * r->h, node, 0});
}

static void expand(search *q, uint32_t node) {
    const nav_graph_data *g = q->g;
    double cost = q->s->record[node].g;
    uint32_t first = g->node.first[node], end = first + g->node.links[node];
    for (uint32_t i = first; i < end; i++) {
        if (g->link.open[i]) {
            reach(q, g->link.to[i], node, cost + (double)g->link.cost[i]);
        }
    }
    q->expanded++;
}

// Where to turn to when there is no way: nearest to the goal, of equals the cheapest to reach.
static void note_nearest(search *q, uint32_t node) {
    double dx = (double)q->g->node.px[node] - q->gx, dy = (double)q->g->node.py[node] - q->gy;
    double dz = (double)q->g->node.pz[node] - q->gz;
    double square = dx * dx + dy * dy + dz * dz;
    double g = q->s->record[node].g, best_g = q->s->record[q->nearest].g;
    bool equal = square == q->nearest_square;
    if (square < q->nearest_square ||
        (equal && (g < best_g || (g == best_g && node < q->nearest)))) {
        q->nearest = node;
        q->nearest_square = square;
    }
}

static bool run(search *q, uint32_t start, uint32_t goal, uint32_t limit, nav_status *status) {
    reach(q, start, start, 0.0);
    while (q->open) {
        uint32_t node = pop(q);
        if (node == goal) {
            *status = NAV_FOUND;
            return true;
        }
        if (limit && q->expanded == limit) {
            *status = NAV_LIMIT;
            return false;
        }
        expand(q, node);
        if (q->partial) {
            note_nearest(q, node);
        }
    }
    *status = NAV_NO_PATH;
    return false;
}

static void next_stamp(nav_scratch *s) {
    if (++s->stamp == 0) {
        memset(s->record, 0, s->capacity * sizeof *s->record);
        s->stamp = 1;
    }
}

void nav_last_path(const nav_world *w, const nav_result *result, uint32_t *out, uint32_t capacity) {
    uint32_t n = result->reached;
    for (uint32_t i = result->count; i-- > 0; n = w->scratch.record[n].parent) {
        if (i < capacity) {
            out[i] = n;
        }
    }
}

static void measure_path(const search *q, uint32_t start, uint32_t end, nav_result *result) {
    result->count = 1;
    for (uint32_t n = end; n != start; n = q->s->record[n].parent) {
        result->count++;
    }
    result->cost = q->s->record[end].g;
    result->reached = end;
}

static bool check(const nav_world *w, const nav_query *query, nav_result *result) {
    *result = (nav_result){.status = NAV_INVALID, .reached = NAV_NO_NODE};
    if (!query || query->cookie != NAV_QUERY_COOKIE) {
        return core_fail("nav_graph_search: the query was not made by nav_query_default()");
    }
    uint32_t row = nav_graph_row(w, query->graph);
    if (row == CORE_NO_ROW) {
        return false;
    }
    const uint32_t ends[] = {query->start, query->goal};
    for (int i = 0; i < 2; i++) {
        if (!nav_graph_node_exists(w, query->graph, ends[i])) {
            return core_fail("nav graph '%s': there is no node %u to search %s",
                             w->graph.data[row]->name, ends[i], i ? "to" : "from");
        }
    }
    if ((unsigned)query->heuristic > NAV_ZERO ||
        !(query->weight == 0.0f || (query->weight >= 1.0f && query->weight <= 1000.0f))) {
        return core_fail("nav graph '%s': a search with heuristic %d, weight %g; expected 0..2 and "
                         "1..1000",
                         w->graph.data[row]->name, (int)query->heuristic, (double)query->weight);
    }
    return true;
}

bool nav_graph_search(nav_world *w, const nav_query *query, nav_result *result, uint32_t *out,
                      uint32_t capacity) {
    if (!check(w, query, result)) {
        return false;
    }
    uint32_t row = nav_graph_row(w, query->graph);
    const nav_graph_head *head = &w->graph.head[row];
    nav_graph_data *g = w->graph.data[row];
    double weight = query->weight == 0.0f ? 1.0 : (double)query->weight;
    search q = {.g = g,
                .s = &w->scratch,
                .heuristic = query->heuristic,
                .scale = query->heuristic == NAV_ZERO ? 0.0 : head->ratio[query->heuristic],
                .weight = weight,
                .gx = g->node.px[query->goal],
                .gy = g->node.py[query->goal],
                .gz = g->node.pz[query->goal],
                .nearest = query->start,
                .nearest_square = __DBL_MAX__,
                .partial = query->partial,
                // Rounding can make the heuristic inconsistent by an ULP, so an expanded node may
                // still improve. With a weight the bound holds without (Likhachev et al., "ARA*",
                // NIPS 2003).
                .reopen = weight == 1.0};
    next_stamp(q.s);
    bool found = run(&q, query->start, query->goal, query->max_expansions, &result->status);
    result->expanded = q.expanded;
    if (found || query->partial) {
        measure_path(&q, query->start, found ? query->goal : q.nearest, result);
        nav_last_path(w, result, out, out ? capacity : 0);
        if (!found && result->status == NAV_NO_PATH) {
            result->status = NAV_PARTIAL;
        }
    }
    return true;
}
