// Jump point search where corners may not be cut. Going straight, only cells matter at which a
// blocked cell beside the line ends: scans find them in words of 64 cells. Diagonal runs queue no
// turning points; what their straight scans find is reached from the run's origin.
#include "nav/nav_internal.h"

#define NOTHING UINT32_MAX

typedef nav_grid_search_args search;

// 64 bits of a line from bit `at` on.
static uint64_t bits_from(const uint64_t *line, uint32_t at) {
    uint32_t word = at / 64, shift = at % 64;
    return shift ? line[word] >> shift | line[word + 1] << (64 - shift) : line[word];
}
// 64 bits of a line up to bit `at`, which comes highest; bits before the line are set.
static uint64_t bits_to(const uint64_t *line, uint32_t at) {
    if (at >= 63) {
        return bits_from(line, at - 63);
    }
    return line[0] << (63 - at) | ((1ull << (63 - at)) - 1);
}

// Scans a line of cells (bits: blocked) from `at` upwards; `before` and `after` are the lines
// beside it. Stops at the goal's place, or where a blocked cell beside the line was passed; NOTHING
// when the line is blocked first.
static uint32_t scan_up(const uint64_t *before, const uint64_t *line, const uint64_t *after,
                        uint32_t at, uint32_t goal) {
    for (;;) {
        // Bit i stands for cell at + 1 + i; turning there needs at + i blocked beside the line.
        uint64_t b = bits_from(before, at), a = bits_from(after, at);
        uint64_t turn = ((b & ~(b >> 1)) | (a & ~(a >> 1))) & ~(1ull << 63);
        uint64_t wall = bits_from(line, at + 1);
        uint64_t stop = turn | wall;
        uint32_t run = stop ? (uint32_t)__builtin_ctzll(stop) : 63;
        uint32_t to_goal = goal - at - 1; // huge when there is none
        if (to_goal < run || (to_goal == run && run < 63 && !(wall >> run & 1))) {
            return goal;
        }
        if (run < 63) {
            return wall >> run & 1 ? NOTHING : at + 1 + run;
        }
        at += 63; // bit 63 of `turn` needs a cell beyond the word: begin there
    }
}

// The same downwards.
static uint32_t scan_down(const uint64_t *before, const uint64_t *line, const uint64_t *after,
                          uint32_t at, uint32_t goal) {
    for (;;) {
        // Bit 63 - i stands for cell at - 1 - i.
        uint64_t b = bits_to(before, at), a = bits_to(after, at);
        uint64_t turn = ((b & ~(b << 1)) | (a & ~(a << 1))) & ~1ull;
        uint64_t wall = bits_to(line, at - 1);
        uint64_t stop = turn | wall;
        uint32_t run = stop ? (uint32_t)__builtin_clzll(stop) : 63;
        uint32_t to_goal = at - 1 - goal; // wraps when the goal lies behind
        if (to_goal < run || (to_goal == run && run < 63 && !(wall << run >> 63))) {
            return goal;
        }
        if (run < 63) {
            return wall << run >> 63 ? NOTHING : at - 1 - run;
        }
        at -= 63;
    }
}

// Place along the line where a straight run in direction d (even) from (x, y) has a jump point.
static uint32_t straight(const search *q, uint32_t x, uint32_t y, uint32_t d) {
    const nav_grid_data *g = q->g;
    bool flat = d == 0 || d == 4;
    uint32_t words = flat ? g->row_words : g->column_words;
    const uint64_t *line = flat ? g->row + (size_t)y * words : g->column + (size_t)x * words;
    uint32_t at = flat ? x : y;
    uint32_t across = flat ? y : x, goal_across = flat ? q->goal_y : q->goal_x;
    uint32_t goal = across == goal_across ? (flat ? q->goal_x : q->goal_y) : NOTHING;
    bool up = d == 0 || d == 2;
    if (goal != NOTHING && (up ? goal <= at : goal >= at)) {
        goal = NOTHING;
    }
    return up ? scan_up(line - words, line, line + words, at, goal)
              : scan_down(line - words, line, line + words, at, goal);
}

// ---- open list: a binary heap of f << 32 | cell, indexed through the records ----

typedef struct queue {
    nav_grid_scratch *s;
    uint32_t count;
} queue;

static void put(queue *o, uint32_t place, uint64_t key) {
    o->s->heap[place] = key;
    o->s->record[(uint32_t)key].next = place;
}
static void sift_up(queue *o, uint32_t place, uint64_t key) {
    while (place > 0 && key < o->s->heap[(place - 1) / 2]) {
        put(o, place, o->s->heap[(place - 1) / 2]);
        place = (place - 1) / 2;
    }
    put(o, place, key);
}
static uint32_t pop(queue *o) {
    uint32_t cell = (uint32_t)o->s->heap[0];
    uint64_t key = o->s->heap[--o->count];
    uint32_t place = 0;
    for (uint32_t child = 1; child < o->count; child = 2 * place + 1) {
        child += child + 1 < o->count && o->s->heap[child + 1] < o->s->heap[child];
        if (key <= o->s->heap[child]) {
            break;
        }
        put(o, place, o->s->heap[child]);
        place = child;
    }
    if (o->count) {
        put(o, place, key);
    }
    o->s->record[cell].next = NOTHING;
    return cell;
}

static void reach(search *q, queue *o, uint32_t x, uint32_t y, uint32_t d, uint32_t g,
                  uint32_t from) {
    uint32_t cell = y * q->g->stride + x;
    nav_grid_record *r = &q->s->record[cell];
    bool seen = r->mark >> 4 == q->s->query;
    if (seen && g >= r->g) {
        return;
    }
    uint32_t place = seen && r->next != NOTHING ? r->next : o->count++;
    r->g = g;
    r->back = from;
    r->mark = q->s->query << 4 | d;
    uint64_t f = g + nav_grid_octile(x, y, q->goal_x, q->goal_y);
    sift_up(o, place, f << 32 | cell);
}

// ---- successors ----

// A straight run from (x, y), which lies `g` from the start on the way from `from`.
static void run_straight(search *q, queue *o, uint32_t x, uint32_t y, uint32_t d, uint32_t g,
                         uint32_t from) {
    uint32_t end = straight(q, x, y, d);
    if (end == NOTHING) {
        return;
    }
    if (d == 0 || d == 4) {
        uint32_t length = end > x ? end - x : x - end;
        reach(q, o, end, y, d, g + length * NAV_STRAIGHT, from);
    } else {
        uint32_t length = end > y ? end - y : y - end;
        reach(q, o, x, end, d, g + length * NAV_STRAIGHT, from);
    }
}

static void run_diagonal(search *q, queue *o, uint32_t x, uint32_t y, uint32_t d, uint32_t g,
                         uint32_t from) {
    uint32_t flat = nav_dir_x[d] > 0 ? 0 : 4, steep = nav_dir_y[d] > 0 ? 2 : 6;
    while (q->g->moves[y * q->g->stride + x] >> d & 1) {
        x += (uint32_t)nav_dir_x[d];
        y += (uint32_t)nav_dir_y[d];
        g += NAV_DIAGONAL;
        if (x == q->goal_x && y == q->goal_y) {
            reach(q, o, x, y, d, g, from);
            return;
        }
        run_straight(q, o, x, y, flat, g, from);
        run_straight(q, o, x, y, steep, g, from);
    }
}

static bool blocked(const nav_grid_data *g, uint32_t x, uint32_t y) {
    return g->row[(size_t)y * g->row_words + x / 64] >> (x % 64) & 1;
}

// Directions that may continue a shortest way which came to (x, y) in direction d: straight on, and
// around a blocked cell that was just passed.
static uint32_t directions_after(const search *q, uint32_t x, uint32_t y, uint32_t d) {
    if (d == NAV_DIRECTIONS) {
        return 0xff;
    }
    if (d & 1) { // only the goal is reached diagonally
        return 0;
    }
    uint32_t result = 1u << d;
    for (uint32_t side = 2; side <= 6; side += 4) {
        uint32_t turn = (d + side) % 8, half = (d + side / 2 + (side == 6 ? 4 : 0)) % 8;
        uint32_t beside_x = x + (uint32_t)nav_dir_x[turn], beside_y = y + (uint32_t)nav_dir_y[turn];
        uint32_t behind_x = beside_x - (uint32_t)nav_dir_x[d];
        uint32_t behind_y = beside_y - (uint32_t)nav_dir_y[d];
        if (!blocked(q->g, beside_x, beside_y) && blocked(q->g, behind_x, behind_y)) {
            result |= 1u << turn | 1u << half;
        }
    }
    return result;
}

static void expand(search *q, queue *o, uint32_t cell) {
    uint32_t x = cell % q->g->stride, y = cell / q->g->stride;
    const nav_grid_record *r = &q->s->record[cell];
    uint32_t g = r->g;
    for (uint32_t left = directions_after(q, x, y, r->mark & 15); left; left &= left - 1) {
        uint32_t d = (uint32_t)__builtin_ctz(left);
        if (d & 1) {
            run_diagonal(q, o, x, y, d, g, cell);
        } else {
            run_straight(q, o, x, y, d, g, cell);
        }
    }
    q->expanded++;
}

bool nav_grid_jump(nav_grid_search_args *q) {
    queue o = {q->s, 0};
    uint32_t stride = q->g->stride;
    reach(q, &o, q->start % stride, q->start / stride, NAV_DIRECTIONS, 0, q->start);
    while (o.count) {
        uint32_t cell = pop(&o);
        if (cell == q->goal) {
            return true;
        }
        expand(q, &o, cell);
    }
    return false;
}
