#include "core/nearest.h"

#include <string.h>
#include <strings.h>

#define MOST 63

static unsigned char lower(char c) {
    return (unsigned char)(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
}

uint32_t core_name_distance(const char *a, const char *b) {
    size_t n = strnlen(a, MOST), m = strnlen(b, MOST);
    uint8_t rows[3][MOST + 1]; // the two rows above and the present one, used in turn
    for (size_t j = 0; j <= m; j++) {
        rows[0][j] = (uint8_t)j;
    }
    for (size_t i = 1; i <= n; i++) {
        uint8_t *now = rows[i % 3];
        const uint8_t *up = rows[(i + 2) % 3], *up2 = rows[(i + 1) % 3];
        now[0] = (uint8_t)i;
        for (size_t j = 1; j <= m; j++) {
            bool same = lower(a[i - 1]) == lower(b[j - 1]);
            int best = CORE_MIN(up[j] + 1, now[j - 1] + 1);
            best = CORE_MIN(best, up[j - 1] + !same);
            if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) &&
                lower(a[i - 2]) == lower(b[j - 1])) {
                best = CORE_MIN(best, up2[j - 2] + 1);
            }
            now[j] = (uint8_t)best;
        }
    }
    return rows[n % 3][m];
}

// The first name that goes on where this one stops: people stop typing early.
static const char *completion(const char *name, const char *const *names, size_t count) {
    size_t length = strlen(name);
    for (size_t i = 0; length >= 3 && i < count && names[i]; i++) {
        if (strncasecmp(name, names[i], length) == 0) {
            return names[i];
        }
    }
    return NULL;
}

const char *core_nearest(const char *name, const char *const *names, size_t count) {
    const char *best = NULL;
    uint32_t least = UINT32_MAX;
    for (size_t i = 0; i < count && names[i]; i++) {
        uint32_t d = core_name_distance(name, names[i]);
        if (d < least) {
            least = d;
            best = names[i];
        }
    }
    size_t longer = best ? CORE_MAX(strlen(name), strlen(best)) : 0;
    bool near = best && (least <= 2 || least * 3 <= longer) && least < longer;
    return near ? best : completion(name, names, count);
}
