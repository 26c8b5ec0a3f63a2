#include "core/columns.h"

#include <string.h>

#include "core/hash.h"
#include "core/memory.h"

#define COLUMNS_MAGIC 0x314c4343u // "CCL1"
#define FIRST_ROWS    256u
#define PAGE          4096u

static size_t round_up(size_t n, size_t unit) { return (n + unit - 1) / unit * unit; }

// Columns start one cache line apart within their pages: kernels walk many columns at one row, and
// equal page offsets would put all those streams into the same few cache sets.
static size_t stagger(uint32_t column) { return (size_t)column * CORE_ALIGN % PAGE; }

static size_t column_range(const core_columns *set, uint32_t column) {
    size_t rows = round_up(set->pool.capacity, CORE_LANES);
    return round_up(stagger(column) + rows * set->column[column].size, PAGE);
}

static size_t set_range(const core_columns *set) {
    size_t bytes = 0;
    for (uint32_t c = 0; c < set->column_count; ++c) {
        bytes += column_range(set, c);
    }
    return bytes;
}

bool core_columns_init(core_columns *set, const char *name, const core_column *column,
                       uint32_t column_count, uint32_t capacity) {
    *set = (core_columns){.name = name, .column = column, .column_count = column_count};
    if (column_count == 0 || column_count > CORE_COLUMNS_MAX) {
        return core_fail("columns '%s': %u columns, expected 1 to %d", name, column_count,
                         CORE_COLUMNS_MAX);
    }
    if (!core_pool_init(&set->pool, capacity)) {
        return false;
    }
    uint8_t *at = core_reserve(set_range(set));
    if (!at) {
        core_pool_release(&set->pool);
        return false;
    }
    set->base = at;
    for (uint32_t c = 0; c < column_count; ++c) {
        set->data[c] = at + stagger(c);
        at += column_range(set, c);
    }
    return true;
}

void core_columns_release(core_columns *set) {
    if (set->base) {
        core_unreserve(set->base, set_range(set));
    }
    core_pool_release(&set->pool);
    *set = (core_columns){0};
}

// Rows are committed in whole lane blocks, so that a kernel may touch the padding.
static bool commit_rows(core_columns *set, uint32_t rows) {
    if (rows <= set->committed) {
        return true;
    }
    size_t limit = round_up(set->pool.capacity, CORE_LANES);
    // By an eighth: the range never moves, so that growing copies nothing.
    size_t wanted = CORE_MAX(round_up((size_t)set->committed / 8 * 9, CORE_LANES), FIRST_ROWS);
    wanted = CORE_MIN(CORE_MAX(wanted, round_up(rows, CORE_LANES)), limit);
    for (uint32_t c = 0; c < set->column_count; ++c) {
        if (!core_commit(set->data[c], wanted * set->column[c].size)) {
            return false;
        }
    }
    set->committed = (uint32_t)wanted;
    return true;
}

static void *cell(const core_columns *set, uint32_t column, uint32_t row) {
    return (uint8_t *)set->data[column] + (size_t)row * set->column[column].size;
}

static void zero_rows(core_columns *set, uint32_t column, uint32_t begin, uint32_t end) {
    if (begin < end) {
        memset(cell(set, column, begin), 0, (size_t)(end - begin) * set->column[column].size);
    }
}

core_handle core_columns_add(core_columns *set) {
    uint32_t row = set->pool.count;
    if (row == set->pool.capacity) {
        core_fail("%s: full (%u), raise the capacity", set->name, set->pool.capacity);
        return CORE_NULL_HANDLE;
    }
    if (!commit_rows(set, row + 1)) {
        return CORE_NULL_HANDLE;
    }
    core_handle h = core_pool_add(&set->pool);
    if (core_handle_is_null(h)) {
        core_fail("%s: no handle left of %u", set->name, set->pool.capacity);
        return h;
    }
    for (uint32_t c = 0; c < set->column_count; ++c) {
        zero_rows(set, c, row, row + 1); // a kernel may have written into the padding
    }
    return h;
}

bool core_columns_remove(core_columns *set, core_handle h, uint32_t *hole, uint32_t *last) {
    uint32_t to, from;
    if (!core_pool_remove(&set->pool, h, &to, &from)) {
        return core_fail("%s: handle %u (generation %u) is stale or foreign", set->name, h.index,
                         h.generation);
    }
    for (uint32_t c = 0; c < set->column_count; ++c) {
        if (to != from) {
            memcpy(cell(set, c, to), cell(set, c, from), set->column[c].size);
        }
        zero_rows(set, c, from, from + 1);
    }
    if (hole) {
        *hole = to;
    }
    if (last) {
        *last = from;
    }
    return true;
}

uint32_t core_columns_row(const core_columns *set, core_handle h) {
    return core_pool_row(&set->pool, h);
}

core_handle core_columns_handle(const core_columns *set, uint32_t row) {
    return core_pool_handle(&set->pool, row);
}

void core_columns_clear(core_columns *set) {
    for (uint32_t c = 0; c < set->column_count; ++c) {
        zero_rows(set, c, 0, set->pool.count);
    }
    core_pool_clear(&set->pool);
}

size_t core_columns_bytes(const core_columns *set) {
    size_t bytes = (size_t)set->pool.committed * sizeof(uint32_t) * 3;
    for (uint32_t c = 0; c < set->column_count; ++c) {
        bytes += (size_t)set->committed * set->column[c].size;
    }
    return bytes;
}

static bool is_state(const core_columns *set, uint32_t column) {
    return set->column[column].flags & CORE_COLUMN_STATE;
}

static size_t used_bytes(const core_columns *set, uint32_t column, uint32_t rows) {
    return (size_t)rows * set->column[column].size;
}

void core_columns_hash(const core_columns *set, uint64_t *out) {
    for (uint32_t c = 0; c < set->column_count; ++c) {
        out[c] =
            is_state(set, c) ? core_hash(set->data[c], used_bytes(set, c, set->pool.count), c) : 0;
    }
}

static uint64_t cell_bits(const uint8_t *at, uint32_t size) {
    uint64_t bits = 0;
    if (size > sizeof bits) {
        return core_hash(at, size, 0);
    }
    memcpy(&bits, at, size);
    return bits;
}

// Mixes a block of cells into one sum per row. The loop over 4 bytes is the common one, and the
// constant size lets the compiler see through it.
static void mix_cells(const uint8_t *at, uint32_t size, uint32_t rows, uint64_t *sums) {
    if (size == sizeof(uint32_t)) {
        for (uint32_t i = 0; i < rows; ++i) {
            sums[i] = core_hash_mix(sums[i], cell_bits(at + (size_t)i * 4, 4));
        }
        return;
    }
    for (uint32_t i = 0; i < rows; ++i) {
        sums[i] = core_hash_mix(sums[i], cell_bits(at + (size_t)i * size, size));
    }
}

void core_columns_row_hash(const core_columns *set, uint16_t *out) {
    enum { BLOCK = 256 };
    for (uint32_t begin = 0; begin < set->pool.count; begin += BLOCK) {
        uint64_t sums[BLOCK] = {0};
        uint32_t rows = CORE_MIN(set->pool.count - begin, (uint32_t)BLOCK);
        for (uint32_t c = 0; c < set->column_count; ++c) {
            if (is_state(set, c)) {
                mix_cells(cell(set, c, begin), set->column[c].size, rows, sums);
            }
        }
        for (uint32_t i = 0; i < rows; ++i) {
            out[begin + i] = (uint16_t)sums[i];
        }
    }
}

// The save: this header, the STATE columns in order, then the pool's own save (which carries and
// checks its own size).
typedef struct columns_header {
    uint32_t magic, count;
    uint64_t layout;   // names and sizes of the STATE columns: another build's save is refused
    uint64_t checksum; // of the columns
} columns_header;

static uint64_t layout_hash(const core_columns *set) {
    uint64_t h = core_hash_string(set->name);
    for (uint32_t c = 0; c < set->column_count; ++c) {
        if (is_state(set, c)) {
            h = core_hash_mix(h, core_hash_string(set->column[c].name));
            h = core_hash_mix(h, set->column[c].size);
        }
    }
    return h;
}

static size_t state_bytes(const core_columns *set, uint32_t rows) {
    size_t bytes = 0;
    for (uint32_t c = 0; c < set->column_count; ++c) {
        bytes += is_state(set, c) ? used_bytes(set, c, rows) : 0;
    }
    return bytes;
}

size_t core_columns_save_size(const core_columns *set) {
    return sizeof(columns_header) + state_bytes(set, set->pool.count) +
           core_pool_save_size(&set->pool);
}

void core_columns_save(const core_columns *set, void *out) {
    columns_header header = {COLUMNS_MAGIC, set->pool.count, layout_hash(set), 0};
    uint8_t *payload = (uint8_t *)out + sizeof header, *at = payload;
    for (uint32_t c = 0; c < set->column_count; ++c) {
        size_t bytes = is_state(set, c) ? used_bytes(set, c, set->pool.count) : 0;
        memcpy(at, set->data[c], bytes);
        at += bytes;
    }
    header.checksum = core_hash(payload, (size_t)(at - payload), header.count);
    memcpy(out, &header, sizeof header);
    core_pool_save(&set->pool, at);
}

static bool header_fits(const core_columns *set, const columns_header *header, size_t size) {
    if (header->magic != COLUMNS_MAGIC) {
        return core_fail("%s: saved data is no column set (magic %08x, expected %08x)", set->name,
                         header->magic, COLUMNS_MAGIC);
    }
    if (header->layout != layout_hash(set)) {
        return core_fail("%s: saved by a build with other columns", set->name);
    }
    if (header->count > set->pool.capacity) {
        return core_fail("%s: %u saved rows exceed the capacity of %u", set->name, header->count,
                         set->pool.capacity);
    }
    if (size - sizeof *header < state_bytes(set, header->count)) {
        return core_fail("%s: saved data is truncated (%zu bytes for %u rows)", set->name, size,
                         header->count);
    }
    return true;
}

bool core_columns_restore(core_columns *set, const void *data, size_t size) {
    columns_header header;
    if (size < sizeof header) {
        return core_fail("%s: saved data is truncated (%zu bytes)", set->name, size);
    }
    memcpy(&header, data, sizeof header);
    if (!header_fits(set, &header, size)) {
        return false;
    }
    const uint8_t *at = (const uint8_t *)data + sizeof header;
    size_t bytes = state_bytes(set, header.count), pool_size = size - sizeof header - bytes;
    if (core_hash(at, bytes, header.count) != header.checksum) {
        return core_fail("%s: saved data is corrupt (checksum)", set->name);
    }
    // The pool's restore is the last that can fail, so the set changes as a whole or not at all.
    uint32_t former = set->pool.count;
    if (core_pool_saved_count(at + bytes, pool_size) != header.count) {
        return core_fail("%s: saved data is corrupt (%u rows, but other handles)", set->name,
                         header.count);
    }
    if (!commit_rows(set, header.count) || !core_pool_restore(&set->pool, at + bytes, pool_size)) {
        return false;
    }
    for (uint32_t c = 0; c < set->column_count; ++c) {
        size_t column_bytes = is_state(set, c) ? used_bytes(set, c, header.count) : 0;
        memcpy(set->data[c], at, column_bytes);
        at += column_bytes;
        zero_rows(set, c, is_state(set, c) ? header.count : 0, CORE_MAX(former, header.count));
    }
    return true;
}

const uint8_t *core_columns_saved(const core_columns *set, const void *data,
                                  core_columns_part *out) {
    columns_header header;
    memcpy(&header, data, sizeof header);
    out->count = header.count;
    out->handles_size = core_pool_save_size(&set->pool);
    return (const uint8_t *)data + sizeof header;
}

bool core_columns_restore_parts(core_columns *set, uint32_t count, const void *values,
                                const void *handles, size_t handles_size) {
    size_t bytes = state_bytes(set, count), size = sizeof(columns_header) + bytes + handles_size;
    columns_header header = {COLUMNS_MAGIC, count, layout_hash(set),
                             core_hash(values, bytes, count)};
    uint8_t *block = core_alloc(size);
    memcpy(block, &header, sizeof header);
    memcpy(block + sizeof header, values, bytes);
    memcpy(block + sizeof header + bytes, handles, handles_size);
    bool good = core_columns_restore(set, block, size);
    core_free(block);
    return good;
}
