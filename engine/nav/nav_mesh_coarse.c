// Ways that choose among links and areas of different cost. A* over a few points on every border
// between polygons (Steiner points: Lanthier, Maheshwari, Sack, SoCG 1997) and over the ends of
// links. Where areas differ, each point is then moved along its border to where the cost of the two
// pieces beside it is least; that is a convex problem, so sweeps lead to the best way through the
// same borders.
#include <math.h>
#include <string.h>

#include "nav/nav_internal.h"

#define SWEEPS 40

typedef struct link_end { // a link in one direction
    uint32_t link;
    nav_place from, to;
} link_end;

typedef struct search {
    nav_world *w;
    const nav_mesh_data *m;
    nav_coarse_scratch *s;
    const float *cost; // [NAV_AREAS]
    nav_ends *ends;
    double scale;    // least cost of a cell, for the heuristic
    uint32_t points; // records of points on edges; links, then start and goal follow
    link_end *link;
    uint32_t links;
    nav_place best; // nearest to the goal
    double best_square, best_g;
    uint32_t best_record; // from which it is reached
} search;

static double length(nav_point a, nav_point b) {
    double dx = b.x - a.x, dz = b.z - a.z;
    return core_sqrt(dx * dx + dz * dz);
}

static double cost_of(const search *q, uint32_t polygon) {
    return (double)q->cost[q->m->span.area[q->m->polygon.shape[polygon].span]];
}

// ---- records ----

static uint32_t goal_record(const search *q) { return q->points + q->links + 1; }
static uint32_t start_record(const search *q) { return q->points + q->links; }

static nav_point corner(const nav_mesh_data *m, uint32_t edge) {
    return (nav_point){m->edge[edge].x, m->edge[edge].z};
}
static uint32_t next_edge(const nav_mesh_data *m, uint32_t polygon, uint32_t edge) {
    return edge + 1 == m->polygon.edges[polygon].end ? m->polygon.edges[polygon].first : edge + 1;
}

// Point number i of an edge: evenly between its ends, which are drawn in a little so that they
// belong to both polygons.
static nav_point sample(const nav_mesh_data *m, uint32_t polygon, uint32_t edge, uint32_t i) {
    nav_point a = corner(m, edge), b = corner(m, next_edge(m, polygon, edge));
    double t = CORE_CLAMP((double)i / (NAV_SAMPLES - 1), 0.0, 1.0);
    double inset = 1e-3 / CORE_MAX(length(a, b), 1.0);
    t = CORE_CLAMP(t, inset, 1.0 - inset);
    return (nav_point){a.x + (b.x - a.x) * t, a.z + (b.z - a.z) * t};
}

static nav_point place_of(const search *q, uint32_t record, uint32_t polygon) {
    if (record < q->points) {
        return sample(q->m, polygon, record / NAV_SAMPLES, record % NAV_SAMPLES);
    }
    if (record == start_record(q)) {
        return q->ends->start.at;
    }
    return record == goal_record(q) ? q->ends->goal.at : q->link[record - q->points].to.at;
}

// ---- open list ----

// A total order, and one that does not depend on how tiles are numbered as far as costs differ.
static bool before(const nav_heap_entry *a, const nav_heap_entry *b) {
    return a->f != b->f ? a->f < b->f : a->node < b->node;
}

static void push(search *q, nav_heap_entry e) {
    nav_coarse_scratch *s = q->s;
    if ((s->open + 1) * sizeof e > s->heap.bytes) {
        nav_buffer_fit(&s->heap, (s->open + 1024) * sizeof e);
    }
    nav_heap_entry *heap = s->heap.data;
    uint32_t place = s->open++;
    while (place > 0 && before(&e, &heap[(place - 1) / 2])) {
        heap[place] = heap[(place - 1) / 2];
        place = (place - 1) / 2;
    }
    heap[place] = e;
}

static nav_heap_entry pop(search *q) {
    nav_heap_entry *heap = q->s->heap.data, top = heap[0], moved = heap[--q->s->open];
    uint32_t place = 0;
    for (uint32_t child = 1; child < q->s->open; child = 2 * place + 1) {
        child += child + 1 < q->s->open && before(&heap[child + 1], &heap[child]);
        if (!before(&heap[child], &moved)) {
            break;
        }
        heap[place] = heap[child];
        place = child;
    }
    heap[place] = moved;
    return top;
}

static void reach(search *q, uint32_t record, uint32_t parent, nav_point at, double g) {
    nav_coarse_record *r = &q->s->record[record];
    if (r->stamp == q->s->stamp && (r->done || g >= r->g)) {
        return;
    }
    *r = (nav_coarse_record){.g = g, .parent = parent, .stamp = q->s->stamp};
    push(q, (nav_heap_entry){g + q->scale * length(at, q->ends->goal.at), record, 0});
}

// ---- expansion ----

// The polygon in which a record's way goes on, and the one it comes from (of points on edges).
static uint32_t polygon_from(const search *q, uint32_t record, uint32_t *from) {
    if (record < q->points) {
        const nav_mesh_data *m = q->m;
        uint32_t edge = record / NAV_SAMPLES;
        *from = m->edge_owner[edge];
        return m->edge[edge].beyond;
    }
    *from = NAV_NONE;
    nav_place at = record == start_record(q) ? q->ends->start : q->link[record - q->points].to;
    return q->m->span.polygon[at.span];
}

static void note_nearest(search *q, uint32_t polygon, uint32_t record, double g) {
    nav_place at = nav_mesh_nearest_in(q->m, polygon, q->ends->wanted);
    double up = at.height / (double)q->m->cell_size, square = at.square + up * up;
    if (square < q->best_square || (square == q->best_square && g < q->best_g)) {
        q->best = at;
        q->best_square = square;
        q->best_g = g;
        q->best_record = record;
    }
}

static void expand(search *q, uint32_t record, bool partial) {
    const nav_mesh_data *m = q->m;
    uint32_t from, polygon = polygon_from(q, record, &from);
    double g = q->s->record[record].g, each = cost_of(q, polygon);
    nav_point at = place_of(q, record, from);
    if (partial) {
        note_nearest(q, polygon, record, g);
    }
    if (polygon == m->span.polygon[q->ends->goal.span]) {
        nav_point goal = q->ends->goal.at;
        reach(q, goal_record(q), record, goal, g + each * length(at, goal));
    }
    for (uint32_t i = 0; i < q->links; i++) {
        const link_end *l = &q->link[i];
        if (m->span.polygon[l->from.span] == polygon) {
            double own = nav_mesh_link_cost(m, l->link) / (double)m->cell_size;
            reach(q, q->points + i, record, l->to.at, g + each * length(at, l->from.at) + own);
        }
    }
    for (uint32_t e = m->polygon.edges[polygon].first; e < m->polygon.edges[polygon].end; e++) {
        uint32_t beyond = m->edge[e].beyond;
        if (beyond == NAV_NONE || beyond == from || cost_of(q, beyond) == (double)INFINITY) {
            continue;
        }
        for (uint32_t i = 0; i < NAV_SAMPLES; i++) {
            nav_point to = sample(m, polygon, e, i);
            reach(q, e * NAV_SAMPLES + i, record, to, g + each * length(at, to));
        }
    }
}

// ---- links ----

static void add_link(search *q, uint32_t link, core_vec3 from, core_vec3 to) {
    link_end l = {link, nav_mesh_locate(q->m, from, 2.0), nav_mesh_locate(q->m, to, 2.0)};
    if (l.from.span == NAV_NONE || l.to.span == NAV_NONE ||
        cost_of(q, q->m->span.polygon[l.to.span]) == (double)INFINITY) {
        return;
    }
    q->link[q->links++] = l;
    double apart = length(l.from.at, l.to.at);
    if (apart > 0.0) {
        double own = nav_mesh_link_cost(q->m, link) / (double)q->m->cell_size;
        q->scale = CORE_MIN(q->scale, own / apart);
    }
}

static void collect_links(search *q) {
    const nav_mesh_data *m = q->m;
    q->link = nav_buffer_fit(&q->s->links, (2 * (size_t)m->links + 1) * sizeof *q->link);
    for (uint32_t i = 0; i < m->links; i++) {
        const nav_mesh_link_desc *d = &m->link[i].desc;
        if (m->link[i].exists && !d->closed) {
            add_link(q, i, d->start, d->end);
            if (d->both_ways) {
                add_link(q, i, d->end, d->start);
            }
        }
    }
}

// ---- the way ----

uint32_t nav_mesh_span_under(const nav_mesh_data *m, uint32_t polygon, nav_point at) {
    nav_rectangle r = m->polygon.shape[polygon];
    uint32_t span = r.span;
    for (double x = m->span.x[r.span] + 1.0; x < at.x; x += 1.0) {
        uint32_t next = m->span.link[span][0];
        span = next != NAV_NONE && m->span.polygon[next] == polygon ? next : span;
    }
    for (double z = m->span.z[r.span] + 1.0; z < at.z; z += 1.0) {
        uint32_t next = m->span.link[span][1];
        span = next != NAV_NONE && m->span.polygon[next] == polygon ? next : span;
    }
    return span;
}

static void put(search *q, nav_waypoint p) {
    nav_waypoint *way = nav_buffer_fit(&q->s->way, ((size_t)q->s->count + 1) * sizeof *way);
    way[q->s->count++] = p;
}

// From the goal back, then turned round. A link gives two points: where it is left, where it leads.
static void write_way(search *q, uint32_t last) {
    const nav_mesh_data *m = q->m;
    nav_place goal = q->ends->goal;
    q->s->count = 0;
    put(q, (nav_waypoint){goal.at, goal.span, NAV_NONE, m->span.polygon[goal.span], NAV_NO_LINK});
    for (uint32_t r = last;; r = q->s->record[r].parent) {
        uint32_t from, polygon = polygon_from(q, r, &from);
        if (r == start_record(q)) {
            nav_place s = q->ends->start;
            put(q, (nav_waypoint){s.at, s.span, NAV_NONE, polygon, NAV_NO_LINK});
            break;
        }
        if (r < q->points) {
            nav_point at = place_of(q, r, from);
            put(q, (nav_waypoint){at, nav_mesh_span_under(m, polygon, at), r / NAV_SAMPLES, polygon,
                                  NAV_NO_LINK});
            continue;
        }
        const link_end *l = &q->link[r - q->points];
        put(q, (nav_waypoint){l->to.at, l->to.span, NAV_NONE, polygon, NAV_NO_LINK});
        put(q, (nav_waypoint){l->from.at, l->from.span, NAV_NONE, m->span.polygon[l->from.span],
                              l->link});
    }
    nav_waypoint *way = q->s->way.data;
    for (uint32_t i = 0, k = q->s->count; i + 1 < k; i++) {
        nav_waypoint swap = way[i];
        way[i] = way[--k];
        way[k] = swap;
    }
}

// ---- moving points along their borders ----

static double piece_cost(const search *q, const nav_waypoint *a, const nav_waypoint *b) {
    return a->link != NAV_NO_LINK ? nav_mesh_link_cost(q->m, a->link) / (double)q->m->cell_size
                                  : cost_of(q, a->polygon) * length(a->at, b->at);
}

// The best place of b on its edge between a and c: the cost is convex, so thirds are cut off.
static void relax(const search *q, const nav_waypoint *a, nav_waypoint *b, const nav_waypoint *c) {
    const nav_mesh_data *m = q->m;
    uint32_t owner = m->edge_owner[b->edge];
    nav_point from = sample(m, owner, b->edge, 0), to = sample(m, owner, b->edge, NAV_SAMPLES - 1);
    double before_cost = cost_of(q, a->polygon), after = cost_of(q, b->polygon);
    double low = 0.0, high = 1.0;
    for (int i = 0; i < 24; i++) {
        double t[2] = {low + (high - low) * 0.4, low + (high - low) * 0.6}, f[2];
        for (int k = 0; k < 2; k++) {
            nav_point p = {from.x + (to.x - from.x) * t[k], from.z + (to.z - from.z) * t[k]};
            f[k] = before_cost * length(a->at, p) + after * length(p, c->at);
        }
        low = f[0] <= f[1] ? low : t[0];
        high = f[0] <= f[1] ? t[1] : high;
    }
    double t = 0.5 * (low + high);
    nav_point p = {from.x + (to.x - from.x) * t, from.z + (to.z - from.z) * t};
    double was = before_cost * length(a->at, b->at) + after * length(b->at, c->at);
    if (before_cost * length(a->at, p) + after * length(p, c->at) < was) {
        b->at = p;
    }
}

static double total(const search *q) {
    const nav_waypoint *way = q->s->way.data;
    double sum = 0.0;
    for (uint32_t i = 0; i + 1 < q->s->count; i++) {
        sum += piece_cost(q, &way[i], &way[i + 1]);
    }
    return sum;
}

static void improve(search *q) {
    nav_waypoint *way = q->s->way.data;
    double cost = total(q);
    for (int sweep = 0; sweep < SWEEPS; sweep++) {
        for (uint32_t i = 1; i + 1 < q->s->count; i++) {
            if (way[i].edge != NAV_NONE && way[i - 1].link == NAV_NO_LINK) {
                relax(q, &way[i - 1], &way[i], &way[i + 1]);
            }
        }
        double now = total(q);
        if (now > cost * (1.0 - 1e-6)) {
            break;
        }
        cost = now;
    }
    for (uint32_t i = 1; i + 1 < q->s->count; i++) {
        way[i].span = way[i].edge == NAV_NONE
                          ? way[i].span
                          : nav_mesh_span_under(q->m, way[i].polygon, way[i].at);
    }
}

// ---- search ----

static void fit_records(nav_coarse_scratch *s, uint32_t records) {
    if (records > s->capacity) {
        s->record =
            core_realloc(s->record, s->capacity * sizeof *s->record, records * sizeof *s->record);
        s->capacity = records;
    }
    if (++s->stamp == 0) {
        memset(s->record, 0, s->capacity * sizeof *s->record);
        s->stamp = 1;
    }
    s->open = 0;
}

void nav_coarse_release(nav_coarse_scratch *s) {
    core_free(s->record);
    core_free(s->heap.data);
    core_free(s->way.data);
    core_free(s->links.data);
}

static bool run(search *q, bool partial, nav_result *result) {
    reach(q, start_record(q), start_record(q), q->ends->start.at, 0.0);
    while (q->s->open) {
        uint32_t record = pop(q).node;
        if (q->s->record[record].done) {
            continue;
        }
        q->s->record[record].done = 1;
        if (record == goal_record(q)) {
            return true;
        }
        expand(q, record, partial);
        result->expanded++;
    }
    return false;
}

static bool walked(const search *q, nav_place at) {
    return cost_of(q, q->m->span.polygon[at.span]) < (double)INFINITY;
}

nav_status nav_mesh_coarse(nav_world *w, const nav_mesh_data *m, nav_ends *ends, const float *cost,
                           bool partial, nav_result *result) {
    search q = {.w = w,
                .m = m,
                .s = &w->coarse,
                .cost = cost,
                .ends = ends,
                .scale = (double)INFINITY,
                .points = m->edge_blocks.end * NAV_SAMPLES,
                .best_square = (double)INFINITY};
    for (uint32_t i = 0; i < NAV_AREAS; i++) {
        q.scale = CORE_MIN(q.scale, (double)cost[i]);
    }
    collect_links(&q);
    fit_records(q.s, q.points + q.links + 2);
    if (!walked(&q, ends->start)) {
        return NAV_NO_PATH;
    }
    bool found = run(&q, partial, result);
    if (!found && (!partial || q.best_square == (double)INFINITY)) {
        return NAV_NO_PATH;
    }
    if (!found) {
        ends->goal = q.best;
    }
    write_way(&q, found ? q.s->record[goal_record(&q)].parent : q.best_record);
    improve(&q);
    result->cost = total(&q) * (double)m->cell_size;
    return found ? NAV_FOUND : NAV_PARTIAL;
}
