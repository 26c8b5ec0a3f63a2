// Blocks of growing arrays: what each tile of a surface owns. A block that becomes too small is
// given back and the smallest free one that suffices is taken.
#include "nav/nav_internal.h"

static void give_back(nav_blocks *b, nav_block block) {
    if (block.room == 0) {
        return;
    }
    if (b->free_count == b->free_room) {
        uint32_t wanted = CORE_MAX(b->free_room * 2, 32u);
        b->free = core_realloc(b->free, b->free_room * sizeof *b->free, wanted * sizeof *b->free);
        b->free_room = wanted;
    }
    b->free[b->free_count++] = block;
}

void nav_block_fit(nav_blocks *b, nav_block *block, uint32_t count, bool spare) {
    b->count += count - block->count;
    if (count <= block->room) {
        block->count = count;
        return;
    }
    give_back(b, *block);
    uint32_t best = NAV_NONE;
    for (uint32_t i = 0; i < b->free_count; i++) {
        uint32_t room = b->free[i].room;
        if (room >= count && (best == NAV_NONE || room < b->free[best].room)) {
            best = i;
        }
    }
    if (best != NAV_NONE) {
        *block = b->free[best];
        b->free[best] = b->free[--b->free_count];
    } else {
        *block = (nav_block){.first = b->end, .room = spare ? count + count / 4 + 16 : count};
        b->end += block->room;
    }
    block->count = count;
}

void nav_blocks_release(nav_blocks *b) {
    core_free(b->free);
    *b = (nav_blocks){0};
}

void *nav_buffer_fit(nav_buffer *b, size_t bytes) {
    if (bytes > b->bytes) {
        size_t wanted = CORE_MAX(bytes, b->bytes + b->bytes / 2);
        b->data = core_realloc(b->data, b->bytes, wanted);
        b->bytes = wanted;
    }
    return b->data;
}
