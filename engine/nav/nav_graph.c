// Waypoint graphs: nodes and links as columns. A node's links are contiguous and keep their order;
// blocks of links grow by doubling and freed blocks are used again, so editing never rebuilds.
#include <stdarg.h>
#include <stdio.h>

#include "nav/nav_internal.h"

CORE_COLUMNS_DEFINE(nav_nodes, NAV_NODE_COLUMNS)
CORE_COLUMNS_DEFINE(nav_links, NAV_LINK_COLUMNS)
CORE_COLUMNS_DEFINE(nav_graphs, NAV_GRAPH_COLUMNS)

#define DEFAULT_NODES (1u << 20)
#define MOST_NODES    (1u << 27)

static bool finite_point(core_vec3 p) {
    return p.x - p.x == 0.0f && p.y - p.y == 0.0f && p.z - p.z == 0.0f;
}

nav_graph_desc nav_graph_desc_default(void) {
    return (nav_graph_desc){.name = "graph",
                            .max_nodes = DEFAULT_NODES,
                            .max_links = NAV_MAX_LINKS,
                            .cookie = NAV_GRAPH_COOKIE};
}

nav_graph nav_graph_create(nav_world *w, const nav_graph_desc *desc) {
    if (!desc || desc->cookie != NAV_GRAPH_COOKIE) {
        core_fail("nav_graph_create: the description was not made by nav_graph_desc_default()");
        return CORE_NULL_HANDLE;
    }
    uint32_t nodes = desc->max_nodes ? desc->max_nodes : DEFAULT_NODES;
    uint32_t links = desc->max_links ? desc->max_links : NAV_MAX_LINKS;
    if (nodes > MOST_NODES || links > NAV_MAX_LINKS) {
        core_fail("nav_graph_create: max_nodes %u, max_links %u, expected at most %u and %u", nodes,
                  links, MOST_NODES, NAV_MAX_LINKS);
        return CORE_NULL_HANDLE;
    }
    nav_graph handle = core_columns_add(&w->graph.set);
    if (core_handle_is_null(handle)) {
        return handle;
    }
    nav_graph_data *g = core_alloc(sizeof *g);
    snprintf(g->name, sizeof g->name, "%s", desc->name ? desc->name : "graph");
    uint32_t row = core_columns_row(&w->graph.set, handle);
    w->graph.data[row] = g;
    w->graph.head[row].max_links = links;
    w->graph.head[row].ratio[NAV_EUCLID] = w->graph.head[row].ratio[NAV_OCTILE] = 1.0;
    if (!nav_nodes_init(&g->node, "nav.nodes", nodes) ||
        !nav_links_init(&g->link, "nav.links", CORE_MAX(nodes, 64u) * 16u)) {
        nav_graph_destroy(w, handle);
        return CORE_NULL_HANDLE;
    }
    return handle;
}

bool nav_graph_destroy(nav_world *w, nav_graph graph) {
    uint32_t row = nav_graph_row(w, graph);
    if (row == CORE_NO_ROW) {
        return false;
    }
    nav_graph_data *g = w->graph.data[row];
    nav_cells_release(&g->cells);
    core_columns_release(&g->node.set);
    core_columns_release(&g->link.set);
    core_free(g);
    return core_columns_remove(&w->graph.set, graph, NULL, NULL);
}

bool nav_graph_alive(const nav_world *w, nav_graph graph) {
    return core_columns_row(&w->graph.set, graph) != CORE_NO_ROW;
}

uint32_t nav_graph_row(const nav_world *w, nav_graph graph) {
    uint32_t row = core_columns_row(&w->graph.set, graph);
    if (row == CORE_NO_ROW) {
        core_fail("this nav graph does not exist (index %u, generation %u): it is null or was "
                  "destroyed",
                  graph.index, graph.generation);
    }
    return row;
}

// The graph's data and head; NULL + core_fail when the graph is gone.
static nav_graph_data *find(const nav_world *w, nav_graph graph, nav_graph_head **head) {
    uint32_t row = nav_graph_row(w, graph);
    if (row == CORE_NO_ROW) {
        return NULL;
    }
    *head = &w->graph.head[row];
    return w->graph.data[row];
}

static bool exists(const nav_graph_data *g, uint32_t node) {
    return node < core_columns_count(&g->node.set) && g->node.exists[node];
}

static bool need_node(const nav_graph_data *g, uint32_t node) {
    return exists(g, node) ||
           core_fail("nav graph '%s': there is no node %u, ids are 0..%u and some may be removed",
                     g->name, node, core_columns_count(&g->node.set) - 1);
}

static nav_graph_data *find_node(const nav_world *w, nav_graph graph, uint32_t node) {
    nav_graph_head *head;
    nav_graph_data *g = find(w, graph, &head);
    return g && need_node(g, node) ? g : NULL;
}

// ---- nodes ----

uint32_t nav_graph_add_node(nav_world *w, nav_graph graph, core_vec3 p) {
    nav_graph_head *head;
    nav_graph_data *g = find(w, graph, &head);
    if (!g) {
        return NAV_NO_NODE;
    }
    if (!finite_point(p)) {
        core_fail("nav graph '%s': a node at (%g, %g, %g), expected finite numbers", g->name,
                  (double)p.x, (double)p.y, (double)p.z);
        return NAV_NO_NODE;
    }
    if (core_handle_is_null(core_columns_add(&g->node.set))) {
        return NAV_NO_NODE;
    }
    uint32_t node = core_columns_count(&g->node.set) - 1;
    g->node.px[node] = p.x, g->node.py[node] = p.y, g->node.pz[node] = p.z;
    g->node.exists[node] = 1;
    head->nodes++;
    head->version++;
    nav_cells_add(g, node);
    nav_scratch_fit(&w->scratch, node + 1);
    return node;
}

static void take_link_out(nav_graph_data *g, uint32_t node, uint32_t place) {
    nav_links *l = &g->link;
    uint32_t last = g->node.first[node] + --g->node.links[node];
    for (uint32_t i = place; i < last; i++) {
        l->to[i] = l->to[i + 1];
        l->cost[i] = l->cost[i + 1];
        l->open[i] = l->open[i + 1];
    }
    l->to[last] = 0, l->cost[last] = 0.0f, l->open[last] = 0;
}

// Place of the link in the link set, NAV_NO_NODE when there is none.
static uint32_t link_place(const nav_graph_data *g, uint32_t from, uint32_t to) {
    uint32_t first = g->node.first[from], end = first + g->node.links[from];
    for (uint32_t i = first; i < end; i++) {
        if (g->link.to[i] == to) {
            return i;
        }
    }
    return NAV_NO_NODE;
}

static void free_block(nav_graph_head *head, nav_graph_data *g, uint32_t node) {
    if (g->node.room[node]) {
        int size = __builtin_ctz(g->node.room[node]);
        g->link.to[g->node.first[node]] = head->free_block[size];
        head->free_block[size] = g->node.first[node] + 1;
        g->node.first[node] = g->node.room[node] = 0;
    }
}

bool nav_graph_remove_node(nav_world *w, nav_graph graph, uint32_t node) {
    nav_graph_head *head;
    nav_graph_data *g = find(w, graph, &head);
    if (!g || !need_node(g, node)) {
        return false;
    }
    for (uint32_t other = 0; other < core_columns_count(&g->node.set); other++) {
        uint32_t place = link_place(g, other, node);
        if (place != NAV_NO_NODE) {
            take_link_out(g, other, place);
        }
    }
    while (g->node.links[node]) {
        take_link_out(g, node, g->node.first[node] + g->node.links[node] - 1);
    }
    free_block(head, g, node);
    nav_cells_remove(g, node);
    g->node.exists[node] = 0;
    head->nodes--;
    head->version++;
    return true;
}

// ---- links ----

static double distance(const nav_graph_data *g, uint32_t a, uint32_t b, nav_heuristic metric) {
    double dx = (double)g->node.px[a] - g->node.px[b], dy = (double)g->node.py[a] - g->node.py[b];
    double dz = (double)g->node.pz[a] - g->node.pz[b];
    return metric == NAV_OCTILE ? nav_octile(dx, dy, dz) : core_sqrt(dx * dx + dy * dy + dz * dz);
}

// A heuristic of `ratio` times the distance is consistent: no link costs less than that.
static void lower_ratios(nav_graph_head *head, const nav_graph_data *g, uint32_t a, uint32_t b,
                         float cost) {
    for (int metric = NAV_EUCLID; metric <= NAV_OCTILE; metric++) {
        double length = distance(g, a, b, (nav_heuristic)metric);
        if (length > 0.0 && (double)cost < head->ratio[metric] * length) {
            head->ratio[metric] = (double)cost / length;
        }
    }
}

// Room for one more link of the node. False + core_fail when it has none.
static bool make_room(nav_graph_head *head, nav_graph_data *g, uint32_t node) {
    uint32_t links = g->node.links[node], room = g->node.room[node];
    if (links >= head->max_links) {
        return core_fail("nav graph '%s': node %u has %u links, the most it may have (max_links)",
                         g->name, node, links);
    }
    if (links < room) {
        return true;
    }
    uint32_t wanted = room ? room * 2 : 4;
    int size = __builtin_ctz(wanted);
    uint32_t first = core_columns_count(&g->link.set);
    if (head->free_block[size]) {
        first = head->free_block[size] - 1;
        head->free_block[size] = g->link.to[first];
        g->link.to[first] = 0;
    } else {
        for (uint32_t i = 0; i < wanted; i++) {
            if (core_handle_is_null(core_columns_add(&g->link.set))) {
                return false;
            }
        }
    }
    uint32_t old = g->node.first[node];
    for (uint32_t i = 0; i < links; i++) {
        g->link.to[first + i] = g->link.to[old + i];
        g->link.cost[first + i] = g->link.cost[old + i];
        g->link.open[first + i] = g->link.open[old + i];
        g->link.to[old + i] = 0, g->link.cost[old + i] = 0.0f, g->link.open[old + i] = 0;
    }
    free_block(head, g, node);
    g->node.first[node] = first;
    g->node.room[node] = wanted;
    return true;
}

static void append(nav_graph_head *head, nav_graph_data *g, uint32_t from, uint32_t to,
                   float cost) {
    uint32_t place = g->node.first[from] + g->node.links[from]++;
    g->link.to[place] = to;
    g->link.cost[place] = cost;
    g->link.open[place] = 1;
    lower_ratios(head, g, from, to, cost);
    head->version++;
}

static bool may_link(const nav_graph_data *g, uint32_t from, uint32_t to) {
    if (!need_node(g, from) || !need_node(g, to)) {
        return false;
    }
    if (from == to) {
        return core_fail("nav graph '%s': a link from node %u to itself", g->name, from);
    }
    if (link_place(g, from, to) != NAV_NO_NODE) {
        return core_fail("nav graph '%s': node %u is linked to %u already", g->name, from, to);
    }
    return true;
}

static bool good_cost(const nav_graph_data *g, uint32_t from, uint32_t to, float cost) {
    return (cost >= 0.0f && cost <= __FLT_MAX__) ||
           core_fail("nav graph '%s': link %u to %u costs %g, expected a finite number >= 0",
                     g->name, from, to, (double)cost);
}

bool nav_graph_link(nav_world *w, nav_graph graph, uint32_t from, uint32_t to, float cost) {
    nav_graph_head *head;
    nav_graph_data *g = find(w, graph, &head);
    if (!g || !may_link(g, from, to) || !good_cost(g, from, to, cost) ||
        !make_room(head, g, from)) {
        return false;
    }
    append(head, g, from, to, cost);
    return true;
}

bool nav_graph_connect(nav_world *w, nav_graph graph, uint32_t a, uint32_t b) {
    nav_graph_head *head;
    nav_graph_data *g = find(w, graph, &head);
    if (!g || !may_link(g, a, b) || !may_link(g, b, a)) {
        return false;
    }
    float cost = (float)distance(g, a, b, NAV_EUCLID);
    if (!good_cost(g, a, b, cost) || !make_room(head, g, a) || !make_room(head, g, b)) {
        return false;
    }
    append(head, g, a, b, cost);
    append(head, g, b, a, cost);
    return true;
}

static bool no_link(const nav_graph_data *g, uint32_t from, uint32_t to) {
    return core_fail("nav graph '%s': there is no link from node %u to %u", g->name, from, to);
}

bool nav_graph_unlink(nav_world *w, nav_graph graph, uint32_t from, uint32_t to) {
    nav_graph_head *head;
    nav_graph_data *g = find(w, graph, &head);
    if (!g || !need_node(g, from) || !need_node(g, to)) {
        return false;
    }
    uint32_t place = link_place(g, from, to);
    if (place == NAV_NO_NODE) {
        return no_link(g, from, to);
    }
    take_link_out(g, from, place);
    head->version++;
    return true;
}

bool nav_graph_disconnect(nav_world *w, nav_graph graph, uint32_t a, uint32_t b) {
    nav_graph_head *head;
    nav_graph_data *g = find(w, graph, &head);
    if (!g || !need_node(g, a) || !need_node(g, b)) {
        return false;
    }
    uint32_t there = link_place(g, a, b), back = link_place(g, b, a);
    if (there == NAV_NO_NODE && back == NAV_NO_NODE) {
        return no_link(g, a, b);
    }
    if (there != NAV_NO_NODE) {
        take_link_out(g, a, there);
    }
    if (back != NAV_NO_NODE) {
        take_link_out(g, b, back);
    }
    head->version++;
    return true;
}

// Place of an existing link, NAV_NO_NODE + core_fail for others.
static uint32_t find_link(const nav_world *w, nav_graph graph, uint32_t from, uint32_t to,
                          nav_graph_head **head, nav_graph_data **g) {
    *g = find(w, graph, head);
    if (!*g || !need_node(*g, from) || !need_node(*g, to)) {
        return NAV_NO_NODE;
    }
    uint32_t place = link_place(*g, from, to);
    if (place == NAV_NO_NODE) {
        no_link(*g, from, to);
    }
    return place;
}

bool nav_graph_set_cost(nav_world *w, nav_graph graph, uint32_t from, uint32_t to, float cost) {
    nav_graph_head *head;
    nav_graph_data *g;
    uint32_t place = find_link(w, graph, from, to, &head, &g);
    if (place == NAV_NO_NODE || !good_cost(g, from, to, cost)) {
        return false;
    }
    g->link.cost[place] = cost;
    lower_ratios(head, g, from, to, cost);
    head->version++;
    return true;
}

bool nav_graph_set_open(nav_world *w, nav_graph graph, uint32_t from, uint32_t to, bool open) {
    nav_graph_head *head;
    nav_graph_data *g;
    uint32_t place = find_link(w, graph, from, to, &head, &g);
    if (place == NAV_NO_NODE) {
        return false;
    }
    if (g->link.open[place] != (uint32_t)open) {
        g->link.open[place] = open;
        head->version++;
    }
    return true;
}

// A moved node keeps what its links cost: only whoever linked them knows whether the distance was
// meant.
bool nav_graph_move_node(nav_world *w, nav_graph graph, uint32_t node, core_vec3 p) {
    nav_graph_head *head;
    nav_graph_data *g = find(w, graph, &head);
    if (!g || !need_node(g, node)) {
        return false;
    }
    if (!finite_point(p)) {
        return core_fail("nav graph '%s': node %u moved to (%g, %g, %g), expected finite numbers",
                         g->name, node, (double)p.x, (double)p.y, (double)p.z);
    }
    nav_cells_remove(g, node);
    g->node.px[node] = p.x, g->node.py[node] = p.y, g->node.pz[node] = p.z;
    nav_cells_add(g, node);
    for (uint32_t from = 0; from < core_columns_count(&g->node.set); from++) {
        uint32_t first = g->node.first[from], end = first + g->node.links[from];
        for (uint32_t i = first; i < end; i++) {
            if (from == node || g->link.to[i] == node) {
                lower_ratios(head, g, from, g->link.to[i], g->link.cost[i]);
            }
        }
    }
    head->version++;
    return true;
}

// ---- reading ----

uint32_t nav_graph_node_count(const nav_world *w, nav_graph graph) {
    nav_graph_head *head;
    return find(w, graph, &head) ? head->nodes : 0;
}
uint32_t nav_graph_id_end(const nav_world *w, nav_graph graph) {
    nav_graph_head *head;
    const nav_graph_data *g = find(w, graph, &head);
    return g ? core_columns_count(&g->node.set) : 0;
}
bool nav_graph_node_exists(const nav_world *w, nav_graph graph, uint32_t node) {
    nav_graph_head *head;
    const nav_graph_data *g = find(w, graph, &head);
    return g && exists(g, node);
}
bool nav_graph_position(const nav_world *w, nav_graph graph, uint32_t node, core_vec3 *out) {
    const nav_graph_data *g = find_node(w, graph, node);
    if (g) {
        *out = (core_vec3){g->node.px[node], g->node.py[node], g->node.pz[node]};
    }
    return g != NULL;
}
uint32_t nav_graph_link_count(const nav_world *w, nav_graph graph, uint32_t node) {
    const nav_graph_data *g = find_node(w, graph, node);
    return g ? g->node.links[node] : 0;
}
bool nav_graph_link_at(const nav_world *w, nav_graph graph, uint32_t node, uint32_t n,
                       nav_link *out) {
    const nav_graph_data *g = find_node(w, graph, node);
    if (!g) {
        return false;
    }
    if (n >= g->node.links[node]) {
        return core_fail("nav graph '%s': link %u of node %u, which has %u", g->name, n, node,
                         g->node.links[node]);
    }
    uint32_t place = g->node.first[node] + n;
    *out = (nav_link){g->link.to[place], g->link.cost[place], g->link.open[place] != 0};
    return true;
}
uint64_t nav_graph_version(const nav_world *w, nav_graph graph) {
    nav_graph_head *head;
    return find(w, graph, &head) ? head->version : 0;
}

typedef struct text {
    char *out;
    size_t size, length;
} text;
static CORE_PRINTF(2, 3) void put(text *t, const char *format, ...) {
    va_list args;
    va_start(args, format);
    size_t room = t->length < t->size ? t->size - t->length : 0;
    t->length += (size_t)vsnprintf(room ? t->out + t->length : NULL, room, format, args);
    va_end(args);
}

size_t nav_graph_print(const nav_world *w, nav_graph graph, char *out, size_t size) {
    nav_graph_head *head;
    const nav_graph_data *g = find(w, graph, &head);
    text t = {out, size, 0};
    if (!g) {
        return 0;
    }
    put(&t, "graph '%s': %u nodes\n", g->name, head->nodes);
    for (uint32_t node = 0; node < core_columns_count(&g->node.set); node++) {
        if (!g->node.exists[node]) {
            continue;
        }
        put(&t, "node %u (%.9g, %.9g, %.9g):", node, (double)g->node.px[node],
            (double)g->node.py[node], (double)g->node.pz[node]);
        for (uint32_t n = 0; n < g->node.links[node]; n++) {
            uint32_t place = g->node.first[node] + n;
            put(&t, " %u (%.9g%s)", g->link.to[place], (double)g->link.cost[place],
                g->link.open[place] ? "" : ", closed");
        }
        put(&t, "\n");
    }
    return t.length;
}
