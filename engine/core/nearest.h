// "Did you mean ...": the nearest known name to one that was not found.
#ifndef CORE_NEAREST_H
#define CORE_NEAREST_H

#include "core/base.h"

// Edits (insert, delete, replace, swap of neighbours) that turn a into b, letter case ignored; only
// the first 63 bytes of each count. Optimal string alignment: Damerau 1964, Wagner, Fischer 1974.
uint32_t core_name_distance(const char *a, const char *b);

// Nearest of names[count] (NULL entries end the list early), the first among equals. When none is
// near enough to be a misspelling (more than 2 edits and more than a third of the longer name): the
// first that begins with `name` (of 3 letters or more), else NULL.
const char *core_nearest(const char *name, const char *const *names, size_t count);

#endif
