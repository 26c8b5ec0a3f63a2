// Virtual files: folders mounted under one tree, read-only unless mounted writable. Virtual paths
// use '/', are relative, and cannot leave a mount: "..", absolute paths and symbolic links inside a
// mount are refused (the mounted folder itself may be reached through a link).
#ifndef CORE_VFS_H
#define CORE_VFS_H

#include "core/base.h"

#define CORE_VFS_PATH_MAX 1024 // bytes of a virtual path with its zero; parts: 255

// Mounting is for one thread at a time; everything else may run in parallel once mounted.
typedef struct core_vfs core_vfs;
core_vfs *core_vfs_create(void);
void core_vfs_destroy(core_vfs *vfs);

// Later mounts hide earlier ones. `at` "" mounts at the root. False + core_fail when dir is no
// folder.
bool core_vfs_mount(core_vfs *vfs, const char *dir, const char *at, bool writable);
// Reads a whole file; core_free the result; *size (may be NULL) excludes the added terminating
// zero. NULL + core_fail (naming the virtual path, the mounts searched and the nearest existing
// name).
void *core_vfs_read(core_vfs *vfs, const char *path, size_t *size);
// A file or a folder. Silent.
bool core_vfs_exists(core_vfs *vfs, const char *path);
// Writes atomically (temporary file + rename) into the last writable mount that holds the path;
// makes parent folders inside the mount. A link of that name is replaced, not followed.
bool core_vfs_write(core_vfs *vfs, const char *path, const void *data, size_t size);
// Names in a folder, mount points included, sorted by bytes, newline-separated; core_free the
// result. Left out: links and names that begin with '.' or hold a newline.
char *core_vfs_list(core_vfs *vfs, const char *path);
// Real path of an existing virtual file or folder, for libraries that open files themselves (they
// follow links that are made later: not for untrusted folders). False + core_fail when absent.
bool core_vfs_resolve(core_vfs *vfs, const char *path, char *out, size_t out_size);
// Modification stamp (changes when the file does), 0 when absent: hot reload polls it.
uint64_t core_vfs_stamp(core_vfs *vfs, const char *path);

// From here on remembers what is read, so that core_vfs_changed can tell which of it is another
// file now. Reads may come from several threads.
void core_vfs_watch(core_vfs *vfs);
// A file that changed since it was read or told last; its normal path goes to out. False: none.
bool core_vfs_changed(core_vfs *vfs, char out[CORE_VFS_PATH_MAX]);

#endif
