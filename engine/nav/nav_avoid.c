// Agents keep out of each other's way: van den Berg, Guy, Lin, Manocha, "Reciprocal n-body
// collision avoidance" (ISRR 2009). Each neighbour forbids a half-plane of velocities; the velocity
// nearest to the wanted one that all allow is found by linear programming in the plane (de Berg et
// al., "Computational Geometry", ch. 4), and where none is allowed, the one that breaks the rules
// least.
//
// Every agent reads positions and velocities of the last step and writes its own velocity, so the
// result does not depend on the number of threads.
#include "nav/nav_internal.h"

#define NEIGHBOURS NAV_NEIGHBOURS
#define HORIZON    2.0f  // s that velocities must stay free of collisions
#define LOOK       1.0f  // s of both agents' way within which neighbours count
#define STOREY     2.0f  // m of height that part agents
#define KEEP_RIGHT 0.03f // rad; who must give way does so to the same side, or all would wait
#define WRIGGLE    0.8f  // rad for each second without progress, times a share of its own
#define MARGIN     0.1f  // of the radius kept free, since velocities change only so fast
#define WALLS      4u
#define WALL_TIME  0.2f // s within which a velocity must not lead off the surface
#define PARALLEL   1e-6f
#define PUSHES     3 // sweeps that part those who touch

typedef struct flat {
    float x, z;
} flat;
static flat sub(flat a, flat b) { return (flat){a.x - b.x, a.z - b.z}; }
static flat mad(flat a, flat b, float s) { return (flat){a.x + b.x * s, a.z + b.z * s}; }
static float dot(flat a, flat b) { return a.x * b.x + a.z * b.z; }
static float det(flat a, flat b) { return a.x * b.z - a.z * b.x; }

typedef struct half_plane { // allowed: left of the line through `point` along `way` (unit)
    flat point, way;
} half_plane;

// ---- linear programming ----

// Narrows [low, high], an interval of places along `line`, by one more half-plane.
static bool cut(const half_plane *line, const half_plane *by, float *low, float *high) {
    float across = det(line->way, by->way), offset = det(by->way, sub(line->point, by->point));
    if (core_absf(across) <= PARALLEL) {
        return offset >= 0.0f;
    }
    float t = offset / across;
    if (across >= 0.0f) {
        *high = CORE_MIN(*high, t);
    } else {
        *low = CORE_MAX(*low, t);
    }
    return *low <= *high;
}

// Best velocity on the border of plane i within the others before it and the speed limit. `along`:
// `aim` is a direction to go far in, else a velocity to come near to.
static bool best_on_line(const half_plane *plane, uint32_t i, float speed, flat aim, bool along,
                         flat *out) {
    const half_plane *line = &plane[i];
    float middle = dot(line->point, line->way);
    float room = middle * middle + speed * speed - dot(line->point, line->point);
    if (room < 0.0f) {
        return false; // slower than the speed limit nothing on this line is
    }
    float reach = core_sqrtf(room), low = -middle - reach, high = -middle + reach;
    for (uint32_t k = 0; k < i; k++) {
        if (!cut(line, &plane[k], &low, &high)) {
            return false;
        }
    }
    float t = along ? (dot(aim, line->way) > 0.0f ? high : low)
                    : CORE_CLAMP(dot(line->way, sub(aim, line->point)), low, high);
    *out = mad(line->point, line->way, t);
    return true;
}

// Velocity that all planes allow. Returns how many planes could be kept.
static uint32_t best_velocity(const half_plane *plane, uint32_t count, float speed, flat aim,
                              bool along, flat *out) {
    float size = core_sqrtf(dot(aim, aim));
    *out = along || size > speed ? (flat){aim.x / size * speed, aim.z / size * speed} : aim;
    for (uint32_t i = 0; i < count; i++) {
        if (det(plane[i].way, sub(plane[i].point, *out)) > 0.0f) {
            flat before = *out;
            if (!best_on_line(plane, i, speed, aim, along, out)) {
                *out = before;
                return i;
            }
        }
    }
    return count;
}

// No velocity is allowed from plane `first` on: the largest distance beyond any plane is made as
// small as it can be, which is a linear program over the lines where two planes are broken alike.
// The first `walls` planes are kept all the same.
static void least_broken(const half_plane *plane, uint32_t count, uint32_t first, uint32_t walls,
                         float speed, flat *out) {
    float broken = 0.0f;
    for (uint32_t i = CORE_MAX(first, walls); i < count; i++) {
        if (det(plane[i].way, sub(plane[i].point, *out)) <= broken) {
            continue;
        }
        half_plane alike[NEIGHBOURS + WALLS];
        uint32_t n = 0;
        for (; n < walls; n++) {
            alike[n] = plane[n];
        }
        for (uint32_t k = walls; k < i; k++) {
            float across = det(plane[i].way, plane[k].way);
            half_plane line;
            if (core_absf(across) <= PARALLEL) {
                if (dot(plane[i].way, plane[k].way) > 0.0f) {
                    continue;
                }
                line.point = mad(plane[i].point, sub(plane[k].point, plane[i].point), 0.5f);
            } else {
                float t = det(plane[k].way, sub(plane[i].point, plane[k].point)) / across;
                line.point = mad(plane[i].point, plane[i].way, t);
            }
            line.way = sub(plane[k].way, plane[i].way);
            float size = core_sqrtf(dot(line.way, line.way));
            if (size > 0.0f) {
                line.way = (flat){line.way.x / size, line.way.z / size};
                alike[n++] = line;
            }
        }
        flat before = *out;
        flat inwards = {-plane[i].way.z, plane[i].way.x};
        if (best_velocity(alike, n, speed, inwards, true, out) < n) {
            *out = before; // rounding only: the present result satisfies all of them
        }
        broken = det(plane[i].way, sub(plane[i].point, *out));
    }
}

// ---- neighbours ----

typedef struct near_list {
    float square[NEIGHBOURS];
    uint32_t slot[NEIGHBOURS]; // into the sorted arrays
    uint32_t count;
} near_list;

// Keeps the nearest; of equals the one with the smaller handle row, so that the order of the sort
// does not matter.
static void offer(near_list *list, const nav_crowd *c, float square, uint32_t slot) {
    uint32_t at = list->count;
    while (at > 0 &&
           (square < list->square[at - 1] ||
            (square == list->square[at - 1] && c->row[slot] < c->row[list->slot[at - 1]]))) {
        at--;
    }
    if (at == NEIGHBOURS) {
        return;
    }
    list->count += list->count < NEIGHBOURS;
    for (uint32_t i = list->count - 1; i > at; i--) {
        list->square[i] = list->square[i - 1];
        list->slot[i] = list->slot[i - 1];
    }
    list->square[at] = square;
    list->slot[at] = slot;
}

static int32_t cell_of(const nav_crowd *c, float x) {
    return (int32_t)CORE_CLAMP(core_floor((double)x * (double)c->per_cell), -1e9, 1e9);
}
static uint32_t bucket(const nav_crowd *c, int32_t x, int32_t z) {
    uint32_t h = (uint32_t)x * 0x9e3779b1u + (uint32_t)z * 0x85ebca77u;
    return (h ^ h >> 15) & (c->buckets - 1);
}

static void find_near(const nav_crowd *c, const nav_agents *a, uint32_t row, near_list *list) {
    int32_t x = cell_of(c, a->px[row]), z = cell_of(c, a->pz[row]);
    for (int32_t k = 0; k < 9; k++) {
        int32_t cx = x + k % 3 - 1, cz = z + k / 3 - 1;
        uint32_t b = bucket(c, cx, cz);
        for (uint32_t i = c->start[b]; i < c->start[b + 1]; i++) {
            if (c->cell_x[i] != cx || c->cell_z[i] != cz || c->row[i] == row) {
                continue;
            }
            float dx = c->px[i] - a->px[row], dz = c->pz[i] - a->pz[row];
            float square = dx * dx + dz * dz;
            if (square < c->range * c->range && core_absf(c->py[i] - a->py[row]) < STOREY) {
                offer(list, c, square, i);
            }
        }
    }
}

// ---- the half-plane of one neighbour ----

// The smallest change of the relative velocity v that leaves the velocities which collide within
// the horizon: onto the rounded end of their cone, or onto one of its sides.
static half_plane plane_for(flat x, flat v, float radius, float dt, bool first) {
    float square = dot(x, x), r2 = radius * radius;
    half_plane p;
    bool apart = square > r2;
    float per_time = 1.0f / (apart ? HORIZON : dt);
    flat w = mad(v, x, -per_time);
    float w2 = dot(w, w), wx = dot(w, x);
    if (!apart || (wx < 0.0f && wx * wx > r2 * w2)) {
        float size = core_sqrtf(w2);
        flat out = size > 0.0f ? (flat){w.x / size, w.z / size} : (flat){first ? 1.0f : -1.0f, 0};
        p.way = (flat){out.z, -out.x};
        float change = radius * per_time - size;
        p.point = (flat){out.x * change, out.z * change};
        return p;
    }
    float leg = core_sqrtf(square - r2);
    if (det(x, w) > 0.0f) {
        p.way = (flat){(x.x * leg - x.z * radius) / square, (x.x * radius + x.z * leg) / square};
    } else {
        p.way = (flat){-(x.x * leg + x.z * radius) / square, (x.x * radius - x.z * leg) / square};
    }
    float along = dot(v, p.way);
    p.point = (flat){along * p.way.x - v.x, along * p.way.z - v.z};
    return p;
}

// Who has arrived steps aside for others and comes back; who idles is not moved.
static bool stands(const nav_agents *a, uint32_t row) { return a->state[row] == NAV_AGENT_IDLE; }

// Perfect symmetry locks (a ring of agents that all want through its middle), so the wanted
// velocity is turned aside: a little always, and more for each in its own measure while it waits.
static flat aside(const nav_agents *a, uint32_t row, flat want) {
    uint32_t h = (row + 1) * 0x9e3779b1u;
    float own = (float)(h >> 8) * 0x1p-24f; // mostly to the right, never nearly 0
    own = own < 0.25f ? -0.25f - 3.0f * own : own;
    float rate = a->state[row] == NAV_AGENT_STUCK ? 2.0f * WRIGGLE : WRIGGLE; // turns back, too
    float angle = KEEP_RIGHT + rate * a->stalled[row] * own, s, c;
    core_sincosf(angle, &s, &c);
    return (flat){want.x * c - want.z * s, want.z * c + want.x * s};
}

// Half-planes that keep an agent on the surface it crosses.
static uint32_t wall_planes(const nav_world *w, uint32_t row, half_plane *out) {
    static const flat towards[4] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    const nav_agents *a = &w->agent;
    uint32_t path = core_columns_row(&w->path.set, a->path[row]), n = 0;
    if (path == CORE_NO_ROW || core_handle_is_null(w->path.head[path].mesh)) {
        return 0;
    }
    float room[4];
    core_vec3 p = {a->px[row], a->py[row], a->pz[row]};
    nav_mesh_room(w, w->path.head[path].mesh, p, WALL_TIME * a->max_speed[row], room);
    for (int d = 0; d < 4; d++) {
        if (room[d] < WALL_TIME * a->max_speed[row]) {
            float fastest = room[d] / WALL_TIME;
            out[n++] = (half_plane){{towards[d].x * fastest, towards[d].z * fastest},
                                    {-towards[d].z, towards[d].x}};
        }
    }
    return n;
}

static void avoid_one(nav_world *w, uint32_t row, float dt) {
    const nav_crowd *c = &w->crowd;
    nav_agents *a = &w->agent;
    flat want = {a->wx[row], a->wz[row]}, now = {a->vx[row], a->vz[row]};
    a->nx[row] = want.x, a->nz[row] = want.z;
    c->near_count[row] = 0;
    if (stands(a, row) || nav_agent_row_link(w, row) != NAV_NO_LINK) {
        return; // others go round it; and on a link there is no other way
    }
    near_list list = {.count = 0};
    find_near(c, a, row, &list);
    for (uint32_t i = 0; i < list.count; i++) {
        if (c->row[list.slot[i]] < c->agents) {
            c->near[row * NEIGHBOURS + c->near_count[row]++] = c->row[list.slot[i]];
        }
    }
    if (list.count == 0) {
        return;
    }
    half_plane plane[WALLS + NEIGHBOURS];
    uint32_t walls = wall_planes(w, row, plane), planes = walls;
    for (uint32_t i = 0; i < list.count; i++) {
        uint32_t k = list.slot[i], other = c->row[k];
        flat x = {c->px[k] - a->px[row], c->pz[k] - a->pz[row]};
        // Who has arrived makes room for where others want to go, though they cannot go there yet.
        bool yields = a->state[row] == NAV_AGENT_ARRIVED;
        bool agent = other < c->agents;
        flat theirs =
            yields && agent ? (flat){a->wx[other], a->wz[other]} : (flat){c->vx[k], c->vz[k]};
        flat v = sub(now, theirs);
        half_plane *p = &plane[planes++];
        *p = plane_for(x, v, (1.0f + MARGIN) * (a->radius[row] + c->radius[k]), dt, row < other);
        // Who stands does not help, nor does what is no agent.
        float share = !agent || stands(a, other) ? 1.0f : 0.5f;
        p->point = mad(now, p->point, share);
    }
    flat aim = aside(a, row, want);
    flat out;
    uint32_t kept = best_velocity(plane, planes, a->max_speed[row], aim, false, &out);
    if (kept < planes) {
        least_broken(plane, planes, kept, walls, a->max_speed[row], &out);
    }
    float speed = core_sqrtf(dot(out, out)), most = a->max_speed[row];
    float scale = speed > most ? most / speed : 1.0f; // lines that all but coincide cross far off
    a->nx[row] = out.x * scale, a->nz[row] = out.z * scale;
}

// ---- the crowd: agents sorted by cell ----

static void fit(nav_crowd *c, uint32_t count) {
    if (count <= c->capacity) {
        return;
    }
    uint32_t wanted = CORE_MAX(64u, c->capacity * 2);
    while (wanted < count) {
        wanted *= 2;
    }
    nav_crowd_release(c);
    size_t arrays = sizeof(float) * 9 * wanted +
                    sizeof(uint32_t) * ((2ull + NEIGHBOURS) * wanted + 2ull * wanted + 1);
    c->block = core_alloc(arrays);
    c->px = (float *)c->block;
    c->py = c->px + wanted, c->pz = c->py + wanted;
    c->vx = c->pz + wanted, c->vz = c->vx + wanted, c->radius = c->vz + wanted;
    c->cell_x = (int32_t *)(c->radius + wanted), c->cell_z = c->cell_x + wanted;
    c->row = (uint32_t *)(c->cell_z + wanted), c->key = c->row + wanted;
    c->near_count = c->key + wanted, c->near = c->near_count + wanted;
    c->start = c->near + NEIGHBOURS * wanted;
    c->capacity = wanted;
    c->buckets = 2 * wanted;
}

void nav_crowd_release(nav_crowd *c) {
    core_free(c->block);
    *c = (nav_crowd){0};
}

static const nav_obstacle *obstacles(const nav_world *w) { return w->obstacles.data; }

static void measure(nav_crowd *c, const nav_world *w) {
    const nav_agents *a = &w->agent;
    float radius = 0.0f, speed = 0.0f;
    for (uint32_t row = 0; row < c->agents; row++) {
        radius = CORE_MAX(radius, a->radius[row]);
        speed = CORE_MAX(speed, a->max_speed[row]);
    }
    for (uint32_t i = 0; i < w->obstacle_count; i++) {
        radius = CORE_MAX(radius, obstacles(w)[i].radius);
    }
    c->range = 2.0f * (radius + LOOK * speed);
    c->per_cell = 1.0f / c->range;
}

// Agents first, then obstacles, as if their rows went on.
static nav_obstacle disc(const nav_crowd *c, const nav_world *w, uint32_t row) {
    const nav_agents *a = &w->agent;
    if (row >= c->agents) {
        return obstacles(w)[row - c->agents];
    }
    return (nav_obstacle){
        {a->px[row], a->py[row], a->pz[row]}, {a->vx[row], 0.0f, a->vz[row]}, a->radius[row]};
}

static void sort_by_cell(nav_crowd *c, const nav_world *w, uint32_t count) {
    for (uint32_t b = 0; b <= c->buckets; b++) {
        c->start[b] = 0;
    }
    for (uint32_t row = 0; row < count; row++) {
        nav_obstacle d = disc(c, w, row);
        c->key[row] = bucket(c, cell_of(c, d.position.x), cell_of(c, d.position.z));
        c->start[c->key[row] + 1]++;
    }
    for (uint32_t b = 0; b < c->buckets; b++) {
        c->start[b + 1] += c->start[b];
    }
    for (uint32_t row = count; row-- > 0;) {
        // Filled from the end, so that start[b + 1] ends as the begin of bucket b.
        uint32_t i = --c->start[c->key[row] + 1];
        nav_obstacle d = disc(c, w, row);
        c->row[i] = row;
        c->px[i] = d.position.x, c->py[i] = d.position.y, c->pz[i] = d.position.z;
        c->vx[i] = d.velocity.x, c->vz[i] = d.velocity.z, c->radius[i] = d.radius;
        c->cell_x[i] = cell_of(c, d.position.x), c->cell_z[i] = cell_of(c, d.position.z);
    }
    for (uint32_t b = 0; b < c->buckets; b++) {
        c->start[b] = c->start[b + 1];
    }
    c->start[c->buckets] = count;
}

// ---- what is left: those who touch all the same are moved apart ----

// Where no velocity was free of collisions, or walls and limits kept an agent from it. Reads the
// places of all, writes its own push.
static void push_one(nav_world *w, uint32_t row) {
    const nav_crowd *c = &w->crowd;
    nav_agents *a = &w->agent;
    flat push = {0, 0};
    for (uint32_t i = 0; i < c->near_count[row]; i++) {
        uint32_t other = c->near[row * NEIGHBOURS + i];
        flat d = {a->px[row] - a->px[other], a->pz[row] - a->pz[other]};
        float apart = a->radius[row] + a->radius[other], square = dot(d, d);
        if (square < apart * apart && square > 0.0f) {
            float size = core_sqrtf(square), share = stands(a, other) ? 1.0f : 0.5f;
            push = mad(push, d, share * (apart - size) / size);
        }
    }
    a->nx[row] = push.x, a->nz[row] = push.z;
}
static void push_some(void *ctx, uint32_t begin, uint32_t end, uint32_t chunk, uint32_t worker) {
    (void)chunk, (void)worker;
    for (uint32_t row = begin; row < end; row++) {
        push_one(ctx, row);
    }
}

void nav_crowd_part(nav_world *w) {
    nav_agents *a = &w->agent;
    uint32_t count = core_columns_count(&a->set);
    for (int sweep = 0; sweep < PUSHES; sweep++) {
        core_jobs_for(w->jobs, count, 256, push_some, w);
        for (uint32_t row = 0; row < count; row++) {
            bool pushed = a->nx[row] != 0.0f || a->nz[row] != 0.0f;
            if (pushed && !a->driven[row]) {
                a->px[row] += a->nx[row], a->pz[row] += a->nz[row];
                nav_agent_keep_on_surface(w, row); // who has a wall behind leaves it to the other
            }
        }
    }
}

typedef struct avoid_job {
    nav_world *world;
    float dt;
} avoid_job;
static void avoid_some(void *ctx, uint32_t begin, uint32_t end, uint32_t chunk, uint32_t worker) {
    (void)chunk, (void)worker;
    const avoid_job *job = ctx;
    for (uint32_t row = begin; row < end; row++) {
        avoid_one(job->world, row, job->dt);
    }
}

void nav_crowd_avoid(nav_world *w, float dt) {
    uint32_t count = core_columns_count(&w->agent.set);
    if (count == 0) {
        return;
    }
    fit(&w->crowd, count + w->obstacle_count);
    w->crowd.agents = count;
    measure(&w->crowd, w);
    sort_by_cell(&w->crowd, w, count + w->obstacle_count);
    avoid_job job = {w, dt};
    core_jobs_for(w->jobs, count, 128, avoid_some, &job);
}
