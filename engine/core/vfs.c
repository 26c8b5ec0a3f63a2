#include "core/vfs.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/file_at.h"
#include "core/hash.h"

typedef struct mount {
    int folder; // open for as long as the mount: the folder may be renamed or replaced meanwhile
    bool writable;
    char at[CORE_VFS_PATH_MAX]; // normal form, "" = root
    char dir[PATH_MAX];         // real path
} mount;

typedef struct watched {
    char path[CORE_VFS_PATH_MAX];
    uint64_t stamp;
} watched;

struct core_vfs {
    mount *mounts;
    size_t count;
    bool watches;
    pthread_mutex_t lock; // of the list below: images are read by other threads
    watched *seen;
    size_t seen_count, seen_capacity;
};

core_vfs *core_vfs_create(void) {
    core_vfs *vfs = core_alloc(sizeof *vfs);
    pthread_mutex_init(&vfs->lock, NULL);
    return vfs;
}

void core_vfs_destroy(core_vfs *vfs) {
    if (!vfs) {
        return;
    }
    for (size_t i = 0; i < vfs->count; ++i) {
        close(vfs->mounts[i].folder);
    }
    pthread_mutex_destroy(&vfs->lock);
    core_free(vfs->seen);
    core_free(vfs->mounts);
    core_free(vfs);
}

// Why a path cannot be a virtual one, NULL when it can.
static const char *objection(const char *path) {
    if (path[0] == '/') {
        return "is absolute, expected one inside the mounted folders";
    }
    if (strlen(path) >= CORE_VFS_PATH_MAX) {
        return "is too long";
    }
    for (const char *part = path; *part;) {
        size_t bytes = strcspn(part, "/");
        if (bytes == 2 && part[0] == '.' && part[1] == '.') {
            return "contains '..', which could leave the mounted folders";
        }
        if (bytes >= CORE_FILE_NAME_MAX) {
            return "has a part that is too long";
        }
        part += bytes + (part[bytes] == '/');
    }
    return NULL;
}

// Normal form: parts joined by single slashes, no ".", no slash at the ends.
static void tidy(const char *path, char out[CORE_VFS_PATH_MAX]) {
    size_t length = 0;
    for (const char *part = path; *part;) {
        size_t bytes = strcspn(part, "/");
        bool skipped = bytes == 0 || (bytes == 1 && part[0] == '.');
        if (!skipped) {
            if (length) {
                out[length++] = '/';
            }
            memcpy(out + length, part, bytes);
            length += bytes;
        }
        part += bytes + (part[bytes] == '/');
    }
    out[length] = '\0';
}

static bool normalise(const char *path, char out[CORE_VFS_PATH_MAX]) {
    const char *why = objection(path);
    if (why) {
        return core_fail("path '%.128s' %s", path, why);
    }
    tidy(path, out);
    return true;
}

bool core_vfs_mount(core_vfs *vfs, const char *dir, const char *at, bool writable) {
    mount m = {.writable = writable};
    if (!normalise(at ? at : "", m.at)) {
        return false;
    }
    m.folder = open(dir, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (m.folder < 0) {
        return core_fail("cannot mount '%s': %s, expected a folder", dir, strerror(errno));
    }
    if (!realpath(dir, m.dir)) {
        close(m.folder);
        return core_fail("cannot mount '%s': %s", dir, strerror(errno));
    }
    vfs->mounts = core_realloc(vfs->mounts, vfs->count * sizeof m, (vfs->count + 1) * sizeof m);
    vfs->mounts[vfs->count++] = m;
    return true;
}

// The part of a normal path below a mount point, NULL when the mount does not hold it.
static const char *below(const mount *m, const char *path) {
    size_t length = strlen(m->at);
    if (length == 0) {
        return path;
    }
    if (strncmp(path, m->at, length) != 0 || (path[length] != '/' && path[length] != '\0')) {
        return NULL;
    }
    return path + length + (path[length] == '/');
}

// Opens the folders of `inner` as far as they exist; *rest is what lies below the folder returned:
// one part (or none, for the mount's own folder) when all did. One part at a time and never through
// a symbolic link: each step starts from an open folder, so nothing that is swapped on disk
// meanwhile can lead out.
static int open_toward(const mount *m, const char *inner, bool make, const char **rest) {
    *rest = inner;
    int folder = openat(m->folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    for (const char *slash; folder >= 0 && (slash = strchr(*rest, '/')); *rest = slash + 1) {
        char part[CORE_FILE_NAME_MAX];
        snprintf(part, sizeof part, "%.*s", (int)(slash - *rest), *rest);
        if (make) {
            mkdirat(folder, part, 0777); // what may be in the way shows when it is opened
        }
        int next = openat(folder, part, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
        if (next < 0) {
            break;
        }
        close(folder);
        folder = next;
    }
    return folder;
}

// A file or folder behind a virtual path.
typedef struct found {
    const mount *mount;
    const char *inner; // path below the mount
    int folder;        // that holds it, open
    const char *name;  // in that folder
    struct stat info;
} found;

// Later mounts first. Links are not found. On success the caller closes f->folder.
static bool find(const core_vfs *vfs, const char *normal, found *f) {
    for (size_t i = vfs->count; i-- > 0;) {
        f->mount = &vfs->mounts[i];
        f->inner = below(f->mount, normal);
        f->folder = f->inner ? open_toward(f->mount, f->inner, false, &f->name) : -1;
        if (f->folder < 0) {
            continue;
        }
        if (f->name[0] == '\0') {
            f->name = ".";
        }
        if (!strchr(f->name, '/') &&
            fstatat(f->folder, f->name, &f->info, AT_SYMLINK_NOFOLLOW) == 0 &&
            (S_ISREG(f->info.st_mode) || S_ISDIR(f->info.st_mode))) {
            return true;
        }
        close(f->folder);
    }
    return false;
}

static bool is_link(int folder, const char *name) {
    struct stat info;
    return fstatat(folder, name, &info, AT_SYMLINK_NOFOLLOW) == 0 && S_ISLNK(info.st_mode);
}

// Says why a path leads nowhere in one mount: a link, or the nearest name to the first part that is
// missing. False when there is nothing to say.
static bool explain(const mount *m, const char *normal, char *out, size_t size) {
    const char *inner = below(m, normal), *rest;
    int folder = inner ? open_toward(m, inner, false, &rest) : -1;
    if (folder < 0) {
        return false;
    }
    char part[CORE_FILE_NAME_MAX], nearest[CORE_FILE_NAME_MAX];
    snprintf(part, sizeof part, "%.*s", (int)strcspn(rest, "/"), rest);
    int before = (int)(rest - normal);
    bool said = true;
    if (is_link(folder, part)) {
        snprintf(out, size, "; '%.*s%s' is a symbolic link, which is not followed", before, normal,
                 part);
    } else if (core_folder_nearest(folder, false, part, nearest)) {
        snprintf(out, size, "; did you mean '%.*s%s'?", before, normal, nearest);
    } else {
        said = false;
    }
    close(folder);
    return said;
}

static void fail_absent(const core_vfs *vfs, const char *normal) {
    char mounts[1024] = "", hint[CORE_VFS_PATH_MAX + 64] = "";
    size_t length = 0;
    for (size_t i = vfs->count; i-- > 0;) {
        const mount *m = &vfs->mounts[i];
        if (!hint[0]) {
            explain(m, normal, hint, sizeof hint);
        }
        if (length < sizeof mounts) {
            length += (size_t)snprintf(mounts + length, sizeof mounts - length, "%s%s%s%s",
                                       length ? ", " : "", m->at, m->at[0] ? "=" : "", m->dir);
        }
    }
    core_fail("no file '%s' in the mounted folders (%s)%s", normal, mounts, hint);
}

// A normal path and what it leads to; complains when there is nothing.
static bool require(const core_vfs *vfs, const char *path, char normal[CORE_VFS_PATH_MAX],
                    found *f) {
    if (!normalise(path, normal)) {
        return false;
    }
    if (!find(vfs, normal, f)) {
        fail_absent(vfs, normal);
        return false;
    }
    return true;
}

// The same without a word.
static bool locate(const core_vfs *vfs, const char *path, char normal[CORE_VFS_PATH_MAX],
                   found *f) {
    if (objection(path)) {
        return false;
    }
    tidy(path, normal);
    return find(vfs, normal, f);
}

static uint64_t stamp_of(const struct stat *info) {
    const uint64_t facts[] = {(uint64_t)info->st_mtim.tv_sec, (uint64_t)info->st_mtim.tv_nsec,
                              (uint64_t)info->st_size, info->st_ino, info->st_dev};
    uint64_t stamp = core_hash(facts, sizeof facts, 0);
    return stamp ? stamp : 1;
}

static void note_read(core_vfs *vfs, const char *normal, const struct stat *info) {
    pthread_mutex_lock(&vfs->lock);
    size_t i = 0;
    while (i < vfs->seen_count && strcmp(vfs->seen[i].path, normal) != 0) {
        i++;
    }
    if (i == vfs->seen_capacity) {
        size_t grown = CORE_MAX(16u, vfs->seen_capacity * 2);
        vfs->seen = core_realloc(vfs->seen, vfs->seen_capacity * sizeof *vfs->seen,
                                 grown * sizeof *vfs->seen);
        vfs->seen_capacity = grown;
    }
    vfs->seen_count = CORE_MAX(vfs->seen_count, i + 1);
    strcpy(vfs->seen[i].path, normal);
    vfs->seen[i].stamp = stamp_of(info);
    pthread_mutex_unlock(&vfs->lock);
}

void core_vfs_watch(core_vfs *vfs) { vfs->watches = true; }

bool core_vfs_changed(core_vfs *vfs, char out[CORE_VFS_PATH_MAX]) {
    bool changed = false;
    pthread_mutex_lock(&vfs->lock);
    for (size_t i = 0; i < vfs->seen_count && !changed; i++) {
        watched *w = &vfs->seen[i];
        uint64_t stamp = core_vfs_stamp(vfs, w->path);
        changed = stamp && stamp != w->stamp; // a file that is gone may be about to come back
        if (changed) {
            w->stamp = stamp;
            strcpy(out, w->path);
        }
    }
    pthread_mutex_unlock(&vfs->lock);
    return changed;
}

void *core_vfs_read(core_vfs *vfs, const char *path, size_t *size) {
    char normal[CORE_VFS_PATH_MAX];
    found f;
    if (!require(vfs, path, normal, &f)) {
        return NULL;
    }
    if (vfs->watches) {
        note_read(vfs, normal, &f.info);
    }
    void *data = core_file_read_at(f.folder, f.name, false, normal, size);
    close(f.folder);
    return data;
}

bool core_vfs_exists(core_vfs *vfs, const char *path) {
    char normal[CORE_VFS_PATH_MAX];
    found f;
    if (!locate(vfs, path, normal, &f)) {
        return false;
    }
    close(f.folder);
    return true;
}

uint64_t core_vfs_stamp(core_vfs *vfs, const char *path) {
    char normal[CORE_VFS_PATH_MAX];
    found f;
    if (!locate(vfs, path, normal, &f)) {
        return 0;
    }
    close(f.folder);
    return stamp_of(&f.info);
}

bool core_vfs_resolve(core_vfs *vfs, const char *path, char *out, size_t out_size) {
    char normal[CORE_VFS_PATH_MAX];
    found f;
    if (!require(vfs, path, normal, &f)) {
        return false;
    }
    close(f.folder);
    int length = snprintf(out, out_size, "%s%s%s", f.mount->dir, f.inner[0] ? "/" : "", f.inner);
    if (length < 0 || (size_t)length >= out_size) {
        return core_fail("the real path of '%s' needs %d bytes, expected less than %zu", normal,
                         length, out_size);
    }
    return true;
}

static const mount *writable_mount(const core_vfs *vfs, const char *normal) {
    for (size_t i = vfs->count; i-- > 0;) {
        const char *inner = below(&vfs->mounts[i], normal);
        if (vfs->mounts[i].writable && inner && inner[0]) {
            return &vfs->mounts[i];
        }
    }
    return NULL;
}

bool core_vfs_write(core_vfs *vfs, const char *path, const void *data, size_t size) {
    char normal[CORE_VFS_PATH_MAX];
    if (!normalise(path, normal)) {
        return false;
    }
    const mount *m = writable_mount(vfs, normal);
    if (!m) {
        return core_fail("cannot write '%s': no folder is mounted writable there", normal);
    }
    const char *name;
    int folder = open_toward(m, below(m, normal), true, &name);
    bool written = false;
    if (folder < 0 || strchr(name, '/')) {
        core_fail("cannot write '%s': its folder cannot be made (a file or link is in the way?)",
                  normal);
    } else {
        written = core_file_write_at(folder, name, normal, data, size);
    }
    if (folder >= 0) {
        close(folder);
    }
    return written;
}

typedef struct name_list {
    char **names;
    size_t count, capacity, bytes;
} name_list;

static void add_name(void *ctx, const char *name) {
    name_list *list = ctx;
    if (list->count == list->capacity) {
        size_t capacity = CORE_MAX(list->capacity * 2, 16);
        list->names = core_realloc(list->names, list->capacity * sizeof *list->names,
                                   capacity * sizeof *list->names);
        list->capacity = capacity;
    }
    size_t bytes = strlen(name) + 1;
    list->names[list->count] = core_alloc(bytes);
    memcpy(list->names[list->count++], name, bytes);
    list->bytes += bytes;
}

// A mount below the folder shows as a name in it: "mods" lists "a" when something is mounted at
// "mods/a".
static void add_mount_point(name_list *list, const mount *m, const char *normal) {
    size_t length = strlen(normal);
    bool beneath = length == 0 || (strncmp(m->at, normal, length) == 0 && m->at[length] == '/');
    const char *rest = m->at + length + (length > 0);
    if (!beneath || m->at[0] == '\0') {
        return;
    }
    char part[CORE_FILE_NAME_MAX];
    snprintf(part, sizeof part, "%.*s", (int)strcspn(rest, "/"), rest);
    add_name(list, part);
}

// True when the folder exists in this mount.
static bool add_folder(name_list *list, const mount *m, const char *normal) {
    const char *inner = below(m, normal), *name;
    int parent = inner ? open_toward(m, inner, false, &name) : -1;
    if (parent < 0) {
        return false;
    }
    int folder = strchr(name, '/') ? -1
                                   : openat(parent, name[0] ? name : ".",
                                            O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    close(parent);
    if (folder < 0) {
        return false;
    }
    core_folder_walk(folder, false, add_name, list);
    close(folder);
    return true;
}

static int compare_names(const void *a, const void *b) {
    return strcmp(*(char *const *)a, *(char *const *)b);
}

// Sorts, drops doubles, joins by newlines, frees the names.
static char *join_names(name_list *list) {
    char *text = core_alloc(list->bytes + 1), *end = text;
    if (list->count) {
        qsort(list->names, list->count, sizeof *list->names, compare_names);
    }
    for (size_t i = 0; i < list->count; ++i) {
        if (i + 1 == list->count || strcmp(list->names[i], list->names[i + 1]) != 0) {
            end = stpcpy(end, list->names[i]);
            *end++ = '\n';
        }
        core_free(list->names[i]);
    }
    if (end > text) {
        end[-1] = '\0';
    }
    core_free(list->names);
    return text;
}

char *core_vfs_list(core_vfs *vfs, const char *path) {
    char normal[CORE_VFS_PATH_MAX];
    if (!normalise(path, normal)) {
        return NULL;
    }
    name_list list = {0};
    bool exists = normal[0] == '\0';
    for (size_t i = 0; i < vfs->count; ++i) {
        exists |= add_folder(&list, &vfs->mounts[i], normal);
        add_mount_point(&list, &vfs->mounts[i], normal);
    }
    exists |= list.count > 0;
    if (!exists) {
        fail_absent(vfs, normal);
        return NULL;
    }
    return join_names(&list);
}
