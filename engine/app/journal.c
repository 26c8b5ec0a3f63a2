// The writing half of journal.h, and the layout both halves share.
#include "app/journal.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "app/journal_layout.h"

struct app_recorder {
    FILE *file;  // until it begins, memory:
    char *early; // [early_size] blocks that will follow the header
    size_t early_size;
    bool begun;
    char path[512];
    bool failed;
    uint16_t *row_hash; // [capacity] grows by doubling
    uint32_t capacity;
};

static void put(app_recorder *r, const void *data, size_t size) {
    r->failed |= size && fwrite(data, 1, size, r->file) != size;
}

static void put_u32(app_recorder *r, uint32_t value) { put(r, &value, sizeof value); }
static void put_u64(app_recorder *r, uint64_t value) { put(r, &value, sizeof value); }

static void put_text(app_recorder *r, const char *text) {
    put_u32(r, (uint32_t)strlen(text));
    put(r, text, strlen(text));
}

static void put_header(app_recorder *r, const app_journal_header *h) {
    put_u32(r, JOURNAL_MAGIC);
    put_text(r, h->scene);
    put_u64(r, h->seed);
    put(r, &h->dt, sizeof h->dt);
    put_u32(r, h->width);
    put_u32(r, h->height);
    put_u32(r, h->headless);
    put_u32(r, h->set_count);
    for (uint32_t i = 0; i < h->set_count; i++) {
        put_text(r, h->set[i].name);
        put_text(r, h->set[i].value);
    }
    put_u32(r, h->argument_count);
    for (uint32_t i = 0; i < h->argument_count; i++) {
        put_text(r, h->argument[i]);
    }
    put_u32(r, h->file_count);
    for (uint32_t i = 0; i < h->file_count; i++) {
        put_text(r, h->file[i].name);
        put_u64(r, h->file[i].hash);
    }
}

app_recorder *app_recorder_create(void) {
    app_recorder *r = core_alloc(sizeof *r);
    r->file = open_memstream(&r->early, &r->early_size);
    r->failed = r->file == NULL;
    return r;
}

bool app_recorder_begin(app_recorder *r, const char *path, const app_journal_header *header) {
    bool kept = r->file && fclose(r->file) == 0 && !r->failed;
    r->file = fopen(path, "wb");
    r->begun = kept && r->file;
    if (!r->begun) {
        return core_fail("cannot write '%s': %s", path, strerror(errno));
    }
    snprintf(r->path, sizeof r->path, "%s", path);
    put_header(r, header);
    put(r, r->early, r->early_size);
    return true;
}

uint32_t app_journal_columns(const core_columns *set, uint32_t *out) {
    uint32_t count = 0;
    for (uint32_t c = 0; c < set->column_count; c++) {
        if (set->column[c].flags & CORE_COLUMN_STATE) {
            if (out) {
                out[count] = c;
            }
            count++;
        }
    }
    return count;
}

static void put_set(app_recorder *r, const core_columns *set) {
    uint64_t column[CORE_COLUMNS_MAX];
    uint32_t rows = core_columns_count(set);
    if (rows > r->capacity) {
        uint32_t grown = CORE_MAX(rows, CORE_MAX(1024u, r->capacity * 2));
        r->row_hash = core_realloc(r->row_hash, r->capacity * sizeof *r->row_hash,
                                   grown * sizeof *r->row_hash);
        r->capacity = grown;
    }
    put_text(r, set->name);
    put_u32(r, app_journal_columns(set, NULL));
    put_u32(r, rows);
    core_columns_hash(set, column);
    for (uint32_t c = 0; c < set->column_count; c++) {
        if (set->column[c].flags & CORE_COLUMN_STATE) {
            put_u64(r, column[c]);
        }
    }
    if (rows) {
        core_columns_row_hash(set, r->row_hash);
        put(r, r->row_hash, rows * sizeof *r->row_hash);
    }
}

void app_recorder_step(app_recorder *r, const gfx_event *event, uint32_t count, const scene *s) {
    const core_columns *set[JOURNAL_MAX_SETS];
    uint32_t sets = (uint32_t)CORE_MIN(scene_state(s, set, JOURNAL_MAX_SETS), JOURNAL_MAX_SETS);
    put_u32(r, JOURNAL_STEP);
    put_u32(r, count);
    put(r, event, count * sizeof *event);
    put_u32(r, sets);
    for (uint32_t i = 0; i < sets; i++) {
        put_set(r, set[i]);
    }
}

void app_recorder_saved(app_recorder *r, const char *name, const char *text, size_t size) {
    put_u32(r, JOURNAL_READ);
    put_text(r, name);
    put_u32(r, text != NULL);
    put_u32(r, (uint32_t)size);
    put(r, text, size);
}

bool app_recorder_close(app_recorder *r, uint64_t hash) {
    if (r->begun) {
        put_u32(r, JOURNAL_DONE);
        put_u64(r, hash);
    }
    bool ok = !r->file || (fclose(r->file) == 0 && !r->failed);
    if (!ok) {
        core_fail("cannot write '%s': %s", r->path, strerror(errno));
    }
    free(r->early);
    core_free(r->row_hash);
    core_free(r);
    return ok || !r->begun;
}
