// Real files of the machine, named by the user (not by scripts: those go through vfs.h).
#ifndef CORE_FILE_H
#define CORE_FILE_H

#include "core/base.h"

// Larger files are refused: a size is never trusted enough to exhaust memory.
#define CORE_FILE_MAX ((size_t)1 << 30)

// Reads a whole regular file; core_free the result; *size (may be NULL) excludes the added
// terminating zero. NULL + core_fail; a missing file's error names the nearest file of its folder.
void *core_file_read(const char *path, size_t *size);
// Writes atomically: readers see the old or the new content, never a part (temporary file in the
// same folder, then rename). Makes missing parent folders. False + core_fail.
bool core_file_write(const char *path, const void *data, size_t size);
// Makes the folders that lead to `path` (not its last part). False + core_fail.
bool core_make_parents(const char *path);

#endif
