// Marks and limits of a recording, for its writer and its reader.
#ifndef APP_JOURNAL_LAYOUT_H
#define APP_JOURNAL_LAYOUT_H

#include "core/columns.h"

#define JOURNAL_MAGIC    0x31525243u // "CRR1"
#define JOURNAL_STEP     0x50455453u // "STEP"
#define JOURNAL_READ     0x44414552u // "READ"
#define JOURNAL_DONE     0x454e4f44u // "DONE"
#define JOURNAL_MAX_SETS 64
#define JOURNAL_SAVE_MAX (16u << 20) // bytes of a file of saved data

// State columns of a set, in order: out[CORE_COLUMNS_MAX] gets their numbers (may be NULL). Returns
// how many: only these are recorded.
uint32_t app_journal_columns(const core_columns *set, uint32_t *out);

#endif
