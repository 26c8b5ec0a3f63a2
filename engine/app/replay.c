// The reading half of journal.h. A recording may come from anybody: the whole file is walked and
// every length checked against what is left before any of it is used.
#include <math.h>
#include <string.h>

#include "app/journal.h"
#include "app/journal_layout.h"
#include "core/file.h"
#include "core/json.h"

typedef struct cursor {
    const uint8_t *data;
    size_t size, at;
    bool bad;
} cursor;

typedef struct saved_read {
    char name[80];
    const uint8_t *text; // NULL: there was no such file
    uint32_t size;
    bool used;
} saved_read;

struct app_replay {
    char path[512];
    uint8_t *data;
    cursor next; // the next step's block
    app_journal_header header;
    uint64_t steps, done;
    uint16_t *row_hash; // [capacity]
    uint32_t capacity;
    saved_read *read;
    uint32_t read_count, read_capacity;
};

static const void *take(cursor *c, size_t size) {
    if (c->bad || c->size - c->at < size) {
        c->bad = true;
        return NULL;
    }
    const void *p = c->data + c->at;
    c->at += size;
    return p;
}

static uint32_t take_u32(cursor *c) {
    uint32_t value = 0;
    const void *p = take(c, sizeof value);
    if (p) {
        memcpy(&value, p, sizeof value);
    }
    return value;
}

static uint64_t take_u64(cursor *c) {
    uint64_t value = 0;
    const void *p = take(c, sizeof value);
    if (p) {
        memcpy(&value, p, sizeof value);
    }
    return value;
}

static uint32_t take_count(cursor *c, uint32_t most) {
    uint32_t count = take_u32(c);
    c->bad |= count > most;
    return c->bad ? 0 : count;
}

// Texts end up in messages: UTF-8 without control characters.
static bool text_ok(const char *s, size_t length) {
    for (size_t i = 0, step; i < length; i += step) {
        step = core_utf8_length(s + i);
        if (!step || (uint8_t)s[i] < 32 || s[i] == 127) {
            return false;
        }
    }
    return true;
}

static void take_text(cursor *c, char *out, size_t size) {
    uint32_t length = take_count(c, (uint32_t)size - 1);
    const void *p = take(c, length);
    if (p) {
        memcpy(out, p, length);
        out[length] = 0;
        c->bad |= !text_ok(out, length);
    }
}

static void take_header(cursor *c, app_journal_header *h) {
    take_text(c, h->scene, sizeof h->scene);
    h->seed = take_u64(c);
    const void *dt = take(c, sizeof h->dt);
    if (dt) {
        memcpy(&h->dt, dt, sizeof h->dt);
        c->bad |= !(h->dt >= 0.0 && h->dt <= 1.0);
    }
    h->width = take_count(c, 16384);
    h->height = take_count(c, 16384);
    h->headless = take_count(c, 1) != 0;
    h->set_count = take_count(c, APP_MAX_SETS);
    for (uint32_t i = 0; i < h->set_count && !c->bad; i++) {
        take_text(c, h->set[i].name, sizeof h->set[i].name);
        take_text(c, h->set[i].value, sizeof h->set[i].value);
    }
    h->argument_count = take_count(c, CORE_COUNT_OF(h->argument));
    for (uint32_t i = 0; i < h->argument_count && !c->bad; i++) {
        take_text(c, h->argument[i], sizeof h->argument[i]);
    }
    h->file_count = take_count(c, APP_MAX_FILES);
    for (uint32_t i = 0; i < h->file_count && !c->bad; i++) {
        take_text(c, h->file[i].name, sizeof h->file[i].name);
        h->file[i].hash = take_u64(c);
    }
}

typedef struct set_block { // one column set after one step
    char name[64];
    uint32_t columns, rows;
    const uint8_t *column_hash, *row_hash; // unaligned u64s, u16s
} set_block;

static set_block take_set(cursor *c) {
    set_block b = {0};
    take_text(c, b.name, sizeof b.name);
    b.columns = take_count(c, CORE_COLUMNS_MAX);
    b.rows = take_u32(c);
    b.column_hash = take(c, b.columns * sizeof(uint64_t));
    b.row_hash = take(c, (size_t)b.rows * sizeof(uint16_t));
    return b;
}

static bool event_ok(const gfx_event *e) {
    return (unsigned)e->type <= GFX_EVENT_PAD_AXIS && isfinite(e->x) && isfinite(e->y);
}

static void walk_step(cursor *c) {
    uint32_t events = take_count(c, APP_MAX_EVENTS);
    for (uint32_t i = 0; i < events && !c->bad; i++) {
        gfx_event e;
        const void *p = take(c, sizeof e);
        if (p) {
            memcpy(&e, p, sizeof e);
            c->bad |= !event_ok(&e);
        }
    }
    uint32_t sets = take_count(c, JOURNAL_MAX_SETS);
    for (uint32_t i = 0; i < sets && !c->bad; i++) {
        take_set(c);
    }
}

static saved_read take_read(cursor *c) {
    saved_read read = {0};
    take_text(c, read.name, sizeof read.name);
    bool there = take_count(c, 1) != 0;
    read.size = take_count(c, JOURNAL_SAVE_MAX);
    const uint8_t *text = take(c, read.size);
    read.text = there ? text : NULL;
    return read;
}

static void keep_read(app_replay *r, const saved_read *read) {
    if (r->read_count == r->read_capacity) {
        uint32_t grown = CORE_MAX(16u, r->read_capacity * 2);
        r->read = core_realloc(r->read, r->read_capacity * sizeof *read, grown * sizeof *read);
        r->read_capacity = grown;
    }
    r->read[r->read_count++] = *read;
}

// Counts the steps and lists the reads; every block is walked once.
static void walk(app_replay *r, cursor *c) {
    while (!c->bad) {
        uint32_t mark = take_u32(c);
        if (mark == JOURNAL_DONE) {
            take_u64(c);
            c->bad |= c->at != c->size;
            return;
        }
        if (mark == JOURNAL_READ) {
            saved_read read = take_read(c);
            keep_read(r, &read);
            continue;
        }
        c->bad |= mark != JOURNAL_STEP;
        walk_step(c);
        r->steps += !c->bad;
    }
}

app_replay *app_replay_open(const char *path) {
    size_t size;
    uint8_t *data = core_file_read(path, &size);
    if (!data) {
        return NULL;
    }
    app_replay *r = core_alloc(sizeof *r);
    snprintf(r->path, sizeof r->path, "%s", path);
    r->data = data;
    cursor c = {.data = data, .size = size};
    if (take_u32(&c) != JOURNAL_MAGIC) {
        core_fail("'%s' is no recording of corsac (its first bytes are not CRR1)", path);
        app_replay_close(r);
        return NULL;
    }
    take_header(&c, &r->header);
    r->next = c;
    if (!c.bad) {
        walk(r, &c);
    }
    if (c.bad) {
        core_fail("recording '%s' is cut or damaged at byte %zu of %zu, after %llu whole steps; "
                  "record the run again",
                  path, c.at, size, (unsigned long long)r->steps);
        app_replay_close(r);
        return NULL;
    }
    return r;
}

void app_replay_close(app_replay *r) {
    if (r) {
        core_free(r->data);
        core_free(r->row_hash);
        core_free(r->read);
        core_free(r);
    }
}

const char *app_replay_saved(app_replay *r, const char *name, size_t *size) {
    saved_read *found = NULL;
    for (uint32_t i = 0; i < r->read_count && !(found && !found->used); i++) {
        found = strcmp(r->read[i].name, name) == 0 ? &r->read[i] : found;
    }
    if (!found) {
        return NULL;
    }
    found->used = true;
    *size = found->size;
    return (const char *)found->text;
}

const app_journal_header *app_replay_header(const app_replay *r) { return &r->header; }
uint64_t app_replay_steps(const app_replay *r) { return r->steps; }

uint32_t app_replay_events(app_replay *r, gfx_event *out) {
    if (r->done >= r->steps) {
        return 0;
    }
    while (take_u32(&r->next) == JOURNAL_READ) {
        take_read(&r->next);
    }
    uint32_t count = take_count(&r->next, APP_MAX_EVENTS);
    const void *p = take(&r->next, count * sizeof *out);
    if (p) {
        memcpy(out, p, count * sizeof *out);
    }
    return count;
}

// First row whose checksum differs; the count of rows when none does (the file's column hash is
// then the only thing that differs).
static uint32_t first_row(app_replay *r, const set_block *b, const core_columns *set) {
    if (b->rows > r->capacity) {
        r->row_hash = core_realloc(r->row_hash, r->capacity * sizeof *r->row_hash,
                                   b->rows * sizeof *r->row_hash);
        r->capacity = b->rows;
    }
    core_columns_row_hash(set, r->row_hash);
    for (uint32_t i = 0; i < b->rows; i++) {
        uint16_t was;
        memcpy(&was, b->row_hash + i * sizeof was, sizeof was);
        if (was != r->row_hash[i]) {
            return i;
        }
    }
    return b->rows;
}

static bool check_shape(const app_replay *r, const set_block *b, const core_columns *set) {
    unsigned long long step = r->done + 1;
    uint32_t columns = app_journal_columns(set, NULL);
    if (strcmp(b->name, set->name) != 0 || b->columns != columns) {
        return core_fail(
            "replay diverged at step %llu: the recording has '%s' with %u columns, this "
            "run '%s' with %u",
            step, b->name, b->columns, set->name, columns);
    }
    if (b->rows != core_columns_count(set)) {
        return core_fail("replay diverged at step %llu: %s has %u rows, the recording %u", step,
                         set->name, core_columns_count(set), b->rows);
    }
    return true;
}

static bool check_columns(app_replay *r, const set_block *b, const core_columns *set,
                          const scene *s) {
    uint64_t column[CORE_COLUMNS_MAX];
    uint32_t number[CORE_COLUMNS_MAX], columns = app_journal_columns(set, number);
    core_columns_hash(set, column);
    for (uint32_t i = 0; i < columns; i++) {
        uint64_t was;
        memcpy(&was, b->column_hash + i * sizeof was, sizeof was);
        if (was != column[number[i]]) {
            char object[192];
            scene_describe_row(s, set, first_row(r, b, set), object, sizeof object);
            return core_fail("replay diverged at step %llu: %s, column %s",
                             (unsigned long long)r->done + 1, object, set->column[number[i]].name);
        }
    }
    return true;
}

// Objects that came or went explain more than the values that follow from it: all shapes first.
static bool check_sets(app_replay *r, const set_block *block, uint32_t recorded,
                       const core_columns *const *set, uint32_t sets, const scene *s) {
    for (uint32_t i = 0; i < CORE_MIN(recorded, sets); i++) {
        if (!check_shape(r, &block[i], set[i])) {
            return false;
        }
    }
    if (recorded != sets) {
        return core_fail(
            "replay diverged at step %llu: this run has %u column sets, the recording %u",
            (unsigned long long)r->done + 1, sets, recorded);
    }
    for (uint32_t i = 0; i < sets; i++) {
        if (!check_columns(r, &block[i], set[i], s)) {
            return false;
        }
    }
    return true;
}

bool app_replay_check(app_replay *r, const scene *s) {
    const core_columns *set[JOURNAL_MAX_SETS];
    set_block block[JOURNAL_MAX_SETS];
    uint32_t sets = (uint32_t)CORE_MIN(scene_state(s, set, JOURNAL_MAX_SETS), JOURNAL_MAX_SETS);
    uint32_t recorded = take_count(&r->next, JOURNAL_MAX_SETS);
    for (uint32_t i = 0; i < recorded; i++) {
        block[i] = take_set(&r->next);
    }
    bool ok = check_sets(r, block, recorded, set, sets, s);
    r->done++;
    return ok;
}
