// Uniform grids: what is blocked, kept as a mask of moves a cell (for A*) and as bits by row and by
// column (for jump point search).
#include <string.h>

#include "core/hash.h"
#include "nav/nav_internal.h"

#define NAV_GRID_COOKIE 0x4e41560eu

CORE_COLUMNS_DEFINE(nav_grids, NAV_GRID_COLUMNS)

const int8_t nav_dir_x[NAV_DIRECTIONS] = {1, 1, 0, -1, -1, -1, 0, 1};
const int8_t nav_dir_y[NAV_DIRECTIONS] = {0, 1, 1, 1, 0, -1, -1, -1};

nav_grid_desc nav_grid_desc_default(void) { return (nav_grid_desc){.cookie = NAV_GRID_COOKIE}; }

static uint32_t cell_count(const nav_grid_data *g) { return g->stride * (g->height + 2); }
static uint32_t cell_at(const nav_grid_data *g, uint32_t x, uint32_t y) {
    return (y + 1) * g->stride + x + 1;
}
static bool bit(const uint64_t *line, uint32_t at) { return line[at / 64] >> (at % 64) & 1; }
static bool is_blocked(const nav_grid_data *g, uint32_t x, uint32_t y) { // padded coordinates
    return bit(g->row + (size_t)y * g->row_words, x);
}

// The moves from a free cell; padded coordinates.
static uint8_t moves_from(const nav_grid_data *g, uint32_t x, uint32_t y) {
    uint8_t moves = 0;
    for (int d = 0; d < NAV_DIRECTIONS; d++) {
        uint32_t to_x = x + (uint32_t)nav_dir_x[d], to_y = y + (uint32_t)nav_dir_y[d];
        bool free_way =
            !is_blocked(g, to_x, to_y) && !is_blocked(g, x, to_y) && !is_blocked(g, to_x, y);
        moves |= (uint8_t)(free_way << d);
    }
    return moves;
}

static void refresh_moves(nav_grid_data *g, uint32_t x, uint32_t y) {
    bool inside = x >= 1 && x <= g->width && y >= 1 && y <= g->height;
    if (inside) {
        g->moves[y * g->stride + x] = is_blocked(g, x, y) ? 0 : moves_from(g, x, y);
    }
}

static void put_bit(uint64_t *line, uint32_t at, bool on) {
    uint64_t mask = 1ull << (at % 64);
    line[at / 64] = on ? line[at / 64] | mask : line[at / 64] & ~mask;
}
static void put_blocked(nav_grid_data *g, uint32_t x, uint32_t y, bool blocked) { // padded
    put_bit(g->row + (size_t)y * g->row_words, x, blocked);
    put_bit(g->column + (size_t)x * g->column_words, y, blocked);
}

static void fill(nav_grid_data *g, const uint8_t *blocked) {
    memset(g->row, 0xff, sizeof(uint64_t) * g->row_words * (g->height + 2));
    memset(g->column, 0xff, sizeof(uint64_t) * g->column_words * (g->width + 2));
    for (uint32_t y = 0; y < g->height; y++) {
        for (uint32_t x = 0; x < g->width; x++) {
            put_blocked(g, x + 1, y + 1, blocked && blocked[(size_t)y * g->width + x]);
        }
    }
    for (uint32_t y = 1; y <= g->height; y++) {
        for (uint32_t x = 1; x <= g->width; x++) {
            refresh_moves(g, x, y);
        }
    }
}

static void fit_scratch(nav_world *w, uint32_t cells) {
    if (!w->grid_scratch) {
        w->grid_scratch = core_alloc(sizeof *w->grid_scratch);
    }
    nav_grid_scratch *s = w->grid_scratch;
    if (cells > s->capacity) {
        s->record =
            core_realloc(s->record, s->capacity * sizeof *s->record, cells * sizeof *s->record);
        s->heap = core_realloc(s->heap, s->capacity * sizeof *s->heap, cells * sizeof *s->heap);
        s->capacity = cells;
    }
}

void nav_grid_scratch_release(nav_world *w) {
    if (w->grid_scratch) {
        core_free(w->grid_scratch->record);
        core_free(w->grid_scratch->heap);
        core_free(w->grid_scratch);
    }
}

nav_grid nav_grid_create(nav_world *w, const nav_grid_desc *desc) {
    if (!desc || desc->cookie != NAV_GRID_COOKIE) {
        core_fail("nav_grid_create: the description was not made by nav_grid_desc_default()");
        return CORE_NULL_HANDLE;
    }
    if (desc->width - 1 >= NAV_GRID_MOST || desc->height - 1 >= NAV_GRID_MOST) {
        core_fail("nav_grid_create: %u by %u cells, expected 1 to %u each", desc->width,
                  desc->height, NAV_GRID_MOST);
        return CORE_NULL_HANDLE;
    }
    nav_grid handle = core_columns_add(&w->grid.set);
    uint32_t row = core_columns_row(&w->grid.set, handle);
    if (row == CORE_NO_ROW) {
        return handle;
    }
    nav_grid_data *g = core_alloc(sizeof *g);
    g->width = desc->width, g->height = desc->height, g->stride = desc->width + 2;
    g->row_words = (desc->width + 2 + 63) / 64 + 1; // one word more: scans read ahead
    g->column_words = (desc->height + 2 + 63) / 64 + 1;
    g->moves = core_alloc(cell_count(g));
    g->row = core_alloc(sizeof *g->row * g->row_words * (g->height + 2));
    g->column = core_alloc(sizeof *g->column * g->column_words * (g->width + 2));
    fill(g, desc->blocked);
    fit_scratch(w, cell_count(g));
    w->grid.data[row] = g;
    w->grid.head[row].content = core_hash(g->moves, cell_count(g), 0);
    return handle;
}

static nav_grid_data *find(const nav_world *w, nav_grid grid, uint32_t *row) {
    *row = core_columns_row(&w->grid.set, grid);
    if (*row == CORE_NO_ROW) {
        core_fail("this nav grid does not exist (index %u, generation %u): it is null or was "
                  "destroyed",
                  grid.index, grid.generation);
        return NULL;
    }
    return w->grid.data[*row];
}

bool nav_grid_destroy(nav_world *w, nav_grid grid) {
    uint32_t row;
    nav_grid_data *g = find(w, grid, &row);
    if (!g) {
        return false;
    }
    core_free(g->moves);
    core_free(g->row);
    core_free(g->column);
    core_free(g);
    return core_columns_remove(&w->grid.set, grid, NULL, NULL);
}

bool nav_grid_alive(const nav_world *w, nav_grid grid) {
    return core_columns_row(&w->grid.set, grid) != CORE_NO_ROW;
}

bool nav_grid_size(const nav_world *w, nav_grid grid, uint32_t *width, uint32_t *height) {
    uint32_t row;
    const nav_grid_data *g = find(w, grid, &row);
    if (g) {
        *width = g->width, *height = g->height;
    }
    return g != NULL;
}

static bool inside(const nav_grid_data *g, const char *what, uint32_t x, uint32_t y) {
    return (x < g->width && y < g->height) ||
           core_fail("nav grid: %s cell (%u, %u), the grid has %u by %u", what, x, y, g->width,
                     g->height);
}

bool nav_grid_set_blocked(nav_world *w, nav_grid grid, uint32_t x, uint32_t y, bool blocked) {
    uint32_t row;
    nav_grid_data *g = find(w, grid, &row);
    if (!g || !inside(g, "set", x, y)) {
        return false;
    }
    if (is_blocked(g, x + 1, y + 1) != blocked) {
        put_blocked(g, x + 1, y + 1, blocked);
        for (uint32_t ny = y; ny <= y + 2; ny++) {
            for (uint32_t nx = x; nx <= x + 2; nx++) {
                refresh_moves(g, nx, ny);
            }
        }
        nav_grid_head *head = &w->grid.head[row];
        head->version++;
        head->content = core_hash_mix(head->content, (uint64_t)cell_at(g, x, y) * 2 + blocked);
    }
    return true;
}

bool nav_grid_blocked(const nav_world *w, nav_grid grid, uint32_t x, uint32_t y) {
    uint32_t row;
    const nav_grid_data *g = find(w, grid, &row);
    return !g || x >= g->width || y >= g->height || is_blocked(g, x + 1, y + 1);
}

// ---- search ----

// The cell before this one on the way, and the direction from there to here. A jump goes diagonally
// first, then straight, so seen from its end: straight while one difference is larger.
static uint32_t step_back(const nav_grid_data *g, uint32_t cell, uint32_t from) {
    int32_t x = (int32_t)(cell % g->stride), y = (int32_t)(cell / g->stride);
    int32_t dx = (int32_t)(from % g->stride) - x, dy = (int32_t)(from / g->stride) - y;
    int32_t ax = dx < 0 ? -dx : dx, ay = dy < 0 ? -dy : dy;
    x += ax >= ay ? (dx > 0) - (dx < 0) : 0;
    y += ay >= ax ? (dy > 0) - (dy < 0) : 0;
    return (uint32_t)y * g->stride + (uint32_t)x;
}

// Walks the way back from the goal; writes cells when `count` is known. Returns how many there are.
static uint32_t trace(const nav_grid_search_args *q, nav_grid_method method, uint32_t count,
                      nav_cell *out, uint32_t capacity) {
    const nav_grid_data *g = q->g;
    uint32_t cell = q->goal, turn = q->goal, steps = 0;
    for (;;) {
        if (count && count - 1 - steps < capacity) {
            out[count - 1 - steps] = (nav_cell){cell % g->stride - 1, cell / g->stride - 1};
        }
        steps++;
        if (cell == q->start) {
            return steps;
        }
        if (method == NAV_GRID_ASTAR) {
            uint32_t d = q->s->record[cell].mark & 15;
            cell -= (uint32_t)(nav_dir_y[d] * (int32_t)g->stride + nav_dir_x[d]);
            continue;
        }
        turn = cell == turn ? q->s->record[cell].back : turn;
        cell = step_back(g, cell, turn);
    }
}

static void next_query(nav_grid_scratch *s) {
    if (++s->query == 1u << 28) {
        memset(s->record, 0, s->capacity * sizeof *s->record);
        s->query = 1;
    }
}

bool nav_grid_search(nav_world *w, nav_grid grid, nav_grid_method method, nav_cell start,
                     nav_cell goal, nav_result *result, nav_cell *out, uint32_t capacity) {
    *result = (nav_result){.status = NAV_INVALID, .reached = NAV_NO_NODE};
    uint32_t row;
    const nav_grid_data *g = find(w, grid, &row);
    if (!g || !inside(g, "start", start.x, start.y) || !inside(g, "goal", goal.x, goal.y)) {
        return false;
    }
    nav_grid_search_args q = {.g = g,
                              .s = w->grid_scratch,
                              .start = cell_at(g, start.x, start.y),
                              .goal = cell_at(g, goal.x, goal.y),
                              .goal_x = goal.x + 1,
                              .goal_y = goal.y + 1};
    result->status = NAV_NO_PATH;
    if (is_blocked(g, start.x + 1, start.y + 1) || is_blocked(g, goal.x + 1, goal.y + 1)) {
        return true;
    }
    next_query(q.s);
    bool found = method == NAV_GRID_ASTAR ? nav_grid_astar(&q) : nav_grid_jump(&q);
    result->expanded = q.expanded;
    if (found) {
        result->status = NAV_FOUND;
        result->reached = goal.y * g->width + goal.x;
        result->count = trace(&q, method, 0, NULL, 0);
        // Cell by cell the way has d diagonal and s straight steps: s + d = count - 1.
        uint32_t steps = result->count - 1, cost = q.s->record[q.goal].g;
        uint32_t diagonal = (cost - steps * NAV_STRAIGHT) / (NAV_DIAGONAL - NAV_STRAIGHT);
        result->cost = (steps - diagonal) + diagonal * 1.4142135623730951;
        if (out) {
            trace(&q, method, result->count, out, capacity);
        }
    }
    return true;
}
