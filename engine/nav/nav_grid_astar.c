// A* on a uniform grid with a bucket for each value of f in a ring: f never falls and grows by less
// than the ring in one step, so the ring holds all open cells apart. A cell stands in one bucket at
// most, linked through its record: nothing is allocated and nothing stale is popped.
#include <string.h>

#include "nav/nav_internal.h"

typedef nav_grid_search_args search;

static void take_out(nav_grid_scratch *s, uint32_t cell, uint32_t f) {
    nav_grid_record *r = &s->record[cell];
    uint32_t b = f % NAV_BUCKETS;
    if (r->next) {
        s->record[r->next].back = r->back;
    }
    if (r->back) {
        s->record[r->back].next = r->next;
    } else {
        s->bucket[b] = r->next;
        if (!r->next) {
            s->filled[b / 64] &= ~(1ull << (b % 64));
        }
    }
}

// Last in, first out: of equal f the cell found last is nearest to the goal more often than not.
static void put_in(nav_grid_scratch *s, uint32_t cell, uint32_t f) {
    nav_grid_record *r = &s->record[cell];
    uint32_t b = f % NAV_BUCKETS;
    r->next = s->bucket[b];
    r->back = 0;
    if (r->next) {
        s->record[r->next].back = cell;
    }
    s->bucket[b] = cell;
    s->filled[b / 64] |= 1ull << (b % 64);
}

// The smallest f >= `from` that has a cell, UINT32_MAX when all buckets are empty.
static uint32_t next_filled(const nav_grid_scratch *s, uint32_t from) {
    uint32_t word = from % NAV_BUCKETS / 64, at = from % 64;
    uint64_t bits = s->filled[word] >> at;
    if (bits) {
        return from + (uint32_t)__builtin_ctzll(bits);
    }
    uint32_t skipped = 64 - at;
    for (uint32_t i = 0; i < NAV_BUCKETS / 64; i++) {
        word = (word + 1) % (NAV_BUCKETS / 64);
        if (s->filled[word]) {
            return from + skipped + (uint32_t)__builtin_ctzll(s->filled[word]);
        }
        skipped += 64;
    }
    return UINT32_MAX;
}

static void expand(search *q, uint32_t cell) {
    nav_grid_scratch *s = q->s;
    uint32_t stride = q->g->stride, x = cell % stride, y = cell / stride;
    uint32_t here = s->record[cell].g;
    for (uint32_t moves = q->g->moves[cell]; moves; moves &= moves - 1) {
        uint32_t d = (uint32_t)__builtin_ctz(moves);
        uint32_t to_x = x + (uint32_t)nav_dir_x[d], to_y = y + (uint32_t)nav_dir_y[d];
        uint32_t to = to_y * stride + to_x;
        uint32_t g = here + (d & 1 ? NAV_DIAGONAL : NAV_STRAIGHT);
        nav_grid_record *r = &s->record[to];
        bool seen = r->mark >> 4 == s->query;
        if (seen && g >= r->g) {
            continue; // expanded cells too: the heuristic is consistent in whole numbers
        }
        uint32_t h = nav_grid_octile(to_x, to_y, q->goal_x, q->goal_y);
        if (seen) {
            take_out(s, to, r->g + h);
        }
        r->g = g;
        r->mark = s->query << 4 | d;
        put_in(s, to, g + h);
    }
    q->expanded++;
}

bool nav_grid_astar(nav_grid_search_args *q) {
    nav_grid_scratch *s = q->s;
    memset(s->bucket, 0, sizeof s->bucket);
    memset(s->filled, 0, sizeof s->filled);
    uint32_t stride = q->g->stride;
    uint32_t f = nav_grid_octile(q->start % stride, q->start / stride, q->goal_x, q->goal_y);
    s->record[q->start] = (nav_grid_record){.g = 0, .mark = s->query << 4 | NAV_DIRECTIONS};
    put_in(s, q->start, f);
    while ((f = next_filled(s, f)) != UINT32_MAX) {
        uint32_t cell = s->bucket[f % NAV_BUCKETS];
        take_out(s, cell, f);
        if (cell == q->goal) {
            return true;
        }
        expand(q, cell);
    }
    return false;
}
