// Files relative to an open folder: what file.c and vfs.c share. Private to core.
#ifndef CORE_FILE_AT_H
#define CORE_FILE_AT_H

#include "core/base.h"

// `name` is a single part of a path (file.c: any path). `shown` is how messages call the file.
// Symbolic links are refused unless follow.
void *core_file_read_at(int folder, const char *name, bool follow, const char *shown, size_t *size);
bool core_file_write_at(int folder, const char *name, const char *shown, const void *data,
                        size_t size);

// Calls fn for each visible name (no leading '.') of a folder, in no order, links left out unless
// follow. Returns false when the folder cannot be read.
typedef void core_folder_fn(void *ctx, const char *name);
bool core_folder_walk(int folder, bool follow, core_folder_fn *fn, void *ctx);
// Nearest visible name to `name` in an open folder. False when none is near.
#define CORE_FILE_NAME_MAX 256
bool core_folder_nearest(int folder, bool follow, const char *name, char out[CORE_FILE_NAME_MAX]);

#endif
