#include "core/file.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/file_at.h"
#include "core/nearest.h"

static void *read_all(int fd, size_t expected, const char *shown, size_t *size) {
    char *data = core_alloc(expected + 1);
    size_t length = 0;
    while (length < expected) {
        ssize_t got = read(fd, data + length, expected - length);
        if (got < 0 && errno == EINTR) {
            continue;
        }
        if (got < 0) {
            core_fail("cannot read '%s': %s", shown, strerror(errno));
            core_free(data);
            return NULL;
        }
        if (got == 0) {
            break; // became shorter meanwhile
        }
        length += (size_t)got;
    }
    data[length] = '\0';
    if (size) {
        *size = length;
    }
    return data;
}

void *core_file_read_at(int folder, const char *name, bool follow, const char *shown,
                        size_t *size) {
    // O_NONBLOCK: opening a pipe must not wait for its other end.
    int flags = O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY | (follow ? 0 : O_NOFOLLOW);
    int fd = openat(folder, name, flags);
    if (fd < 0) {
        core_fail("cannot open '%s': %s", shown,
                  errno == ELOOP ? "symbolic links are not followed here" : strerror(errno));
        return NULL;
    }
    struct stat info;
    void *data = NULL;
    if (fstat(fd, &info) != 0) {
        core_fail("cannot open '%s': %s", shown, strerror(errno));
    } else if (!S_ISREG(info.st_mode)) {
        core_fail("cannot read '%s': it is %s, expected a file", shown,
                  S_ISDIR(info.st_mode) ? "a folder" : "no regular file");
    } else if ((uint64_t)info.st_size > CORE_FILE_MAX) {
        core_fail("cannot read '%s': %lld bytes exceed the limit of %zu", shown,
                  (long long)info.st_size, CORE_FILE_MAX);
    } else {
        data = read_all(fd, (size_t)info.st_size, shown, size);
    }
    close(fd);
    return data;
}

static bool write_all(int fd, const char *data, size_t size) {
    while (size) {
        ssize_t put = write(fd, data, size);
        if (put < 0 && errno == EINTR) {
            continue;
        }
        if (put <= 0) {
            return false;
        }
        data += put;
        size -= (size_t)put;
    }
    return true;
}

bool core_file_write_at(int folder, const char *name, const char *shown, const void *data,
                        size_t size) {
    // Beside the target, so that the rename stays within one file system. The thread's number keeps
    // writers apart; a file of that name can only be what a killed process left.
    char temporary[64];
    snprintf(temporary, sizeof temporary, ".corsac-%ld.tmp", (long)gettid());
    unlinkat(folder, temporary, 0);
    int fd = openat(folder, temporary, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (fd < 0) {
        return core_fail("cannot write '%s': %s", shown, strerror(errno));
    }
    bool written = write_all(fd, data, size);
    written = close(fd) == 0 && written;
    if (!written || renameat(folder, temporary, folder, name) != 0) {
        int error = errno;
        unlinkat(folder, temporary, 0);
        return core_fail("cannot write '%s': %s", shown, strerror(error));
    }
    return true;
}

bool core_folder_walk(int folder, bool follow, core_folder_fn *fn, void *ctx) {
    int own = openat(folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    DIR *dir = own >= 0 ? fdopendir(own) : NULL;
    if (!dir) {
        if (own >= 0) {
            close(own);
        }
        return false;
    }
    for (struct dirent *entry; (entry = readdir(dir)) != NULL;) {
        struct stat info;
        const char *name = entry->d_name;
        if (name[0] == '.' || strchr(name, '\n') ||
            fstatat(folder, name, &info, AT_SYMLINK_NOFOLLOW) != 0 ||
            (S_ISLNK(info.st_mode) && !follow)) {
            continue;
        }
        fn(ctx, name);
    }
    closedir(dir);
    return true;
}

typedef struct nearest_search {
    const char *name;
    char best[CORE_FILE_NAME_MAX];
} nearest_search;

// Keeps the nearer of two; of equally near ones the first in the alphabet, as folders have no
// order.
static void offer_name(void *ctx, const char *name) {
    nearest_search *search = ctx;
    const char *pair[2] = {search->best, name};
    if (!search->best[0] || strcmp(name, search->best) < 0) {
        pair[0] = name;
        pair[1] = search->best;
    }
    const char *nearest = core_nearest(search->name, pair, search->best[0] ? 2 : 1);
    if (nearest && nearest != search->best) {
        snprintf(search->best, sizeof search->best, "%s", nearest);
    }
}

bool core_folder_nearest(int folder, bool follow, const char *name, char out[CORE_FILE_NAME_MAX]) {
    nearest_search search = {.name = name};
    core_folder_walk(folder, follow, offer_name, &search);
    memcpy(out, search.best, CORE_FILE_NAME_MAX);
    return out[0] != '\0';
}

// Splits a real path into an open folder and the name in it. -1 when there is no such folder.
static int open_parent(const char *path, const char **name) {
    const char *slash = strrchr(path, '/');
    *name = slash ? slash + 1 : path;
    char folder[PATH_MAX];
    int length = slash == path ? 1 : slash ? (int)(slash - path) : 0;
    if (length >= (int)sizeof folder) {
        errno = ENAMETOOLONG;
        return -1;
    }
    snprintf(folder, sizeof folder, "%.*s", length ? length : 1, length ? path : ".");
    return open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
}

static void fail_missing(const char *path) {
    const char *name;
    char nearest[CORE_FILE_NAME_MAX];
    int folder = open_parent(path, &name);
    if (folder < 0) {
        core_fail("cannot open '%s': its folder does not exist", path);
        return;
    }
    if (core_folder_nearest(folder, true, name, nearest)) {
        core_fail("cannot open '%s': no such file, did you mean '%.*s%s'?", path,
                  (int)(name - path), path, nearest);
    } else {
        core_fail("cannot open '%s': no such file", path);
    }
    close(folder);
}

void *core_file_read(const char *path, size_t *size) {
    if (access(path, F_OK) != 0 && errno == ENOENT) {
        fail_missing(path);
        return NULL;
    }
    return core_file_read_at(AT_FDCWD, path, true, path, size);
}

bool core_file_write(const char *path, const void *data, size_t size) {
    if (!core_make_parents(path)) {
        return false;
    }
    const char *name;
    int folder = open_parent(path, &name);
    if (folder < 0) {
        return core_fail("cannot write '%s': %s", path, strerror(errno));
    }
    bool written = core_file_write_at(folder, name, path, data, size);
    close(folder);
    return written;
}

bool core_make_parents(const char *path) {
    char part[PATH_MAX];
    size_t length = strlen(path);
    if (length >= sizeof part) {
        return core_fail("path of %zu bytes is too long, expected at most %d", length,
                         PATH_MAX - 1);
    }
    memcpy(part, path, length + 1);
    for (char *slash = strchr(part + 1, '/'); length && slash; slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        if (mkdir(part, 0777) != 0 && errno != EEXIST) {
            return core_fail("cannot make folder '%s': %s", part, strerror(errno));
        }
        *slash = '/';
    }
    return true;
}
