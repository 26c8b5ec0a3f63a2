// Textures by virtual path. Images are read and halved by a thread of their own when the device
// loads in the background, and go to the GPU a few rows a frame.
#include "gfx/gfx_device_internal.h"

#include "core/log.h"

#include <pthread.h>
#include <stdio.h>
#include <string.h>

// ---- the thread that reads ----

typedef struct job {
    struct job *next;
    char path[CORE_NAME_MAX];
    bool srgb, ok;
    gfx_mips image;
} job;
typedef struct queue {
    job *first, **end;
} queue;

struct gfx_loader {
    pthread_t thread;
    pthread_mutex_t lock;
    pthread_cond_t work;
    bool quit;
    core_vfs *vfs;
    queue todo, done;
};

static void push(queue *q, job *j) {
    j->next = NULL;
    *q->end = j;
    q->end = &j->next;
}

static job *pop(queue *q) {
    job *j = q->first;
    if (j) {
        q->first = j->next;
        q->end = q->first ? q->end : &q->first;
    }
    return j;
}

static void *load_images(void *ctx) {
    gfx_loader *l = ctx;
    pthread_mutex_lock(&l->lock);
    while (!l->quit) {
        job *j = pop(&l->todo);
        if (!j) {
            pthread_cond_wait(&l->work, &l->lock);
            continue;
        }
        pthread_mutex_unlock(&l->lock);
        j->ok = gfx_mips_load(l->vfs, j->path, j->srgb, &j->image);
        pthread_mutex_lock(&l->lock);
        push(&l->done, j);
    }
    pthread_mutex_unlock(&l->lock);
    return NULL;
}

// NULL when no thread can be had: images are then read at once.
static gfx_loader *make_loader(core_vfs *vfs) {
    gfx_loader *l = core_alloc(sizeof *l);
    l->vfs = vfs;
    l->todo.end = &l->todo.first, l->done.end = &l->done.first;
    pthread_mutex_init(&l->lock, NULL);
    pthread_cond_init(&l->work, NULL);
    if (pthread_create(&l->thread, NULL, load_images, l) != 0) {
        pthread_cond_destroy(&l->work);
        pthread_mutex_destroy(&l->lock);
        core_free(l);
        return NULL;
    }
    return l;
}

static void drop_jobs(queue *q) {
    for (job *j; (j = pop(q)) != NULL;) {
        gfx_mips_release(&j->image);
        core_free(j);
    }
}

static void release_loader(gfx_loader *l) {
    if (!l) {
        return;
    }
    pthread_mutex_lock(&l->lock);
    l->quit = true;
    pthread_cond_signal(&l->work);
    pthread_mutex_unlock(&l->lock);
    pthread_join(l->thread, NULL);
    drop_jobs(&l->todo);
    drop_jobs(&l->done);
    pthread_cond_destroy(&l->work);
    pthread_mutex_destroy(&l->lock);
    core_free(l);
}

static bool ask(gfx_device *d, const gfx_texture *t) {
    gfx_textures *all = &d->textures;
    all->loader = all->loader ? all->loader : make_loader(d->vfs);
    if (!all->loader) {
        return false;
    }
    job *j = core_alloc(sizeof *j);
    memcpy(j->path, t->path, sizeof j->path);
    j->srgb = t->srgb;
    pthread_mutex_lock(&all->loader->lock);
    push(&all->loader->todo, j);
    pthread_cond_signal(&all->loader->work);
    pthread_mutex_unlock(&all->loader->lock);
    return true;
}

// ---- to the GPU ----

static GLuint make_storage(const gfx_mips *image) {
    GLuint name;
    GLenum format = image->hdr ? GL_RGBA16F : image->srgb ? GL_SRGB8_ALPHA8 : GL_RGBA8;
    glCreateTextures(GL_TEXTURE_2D, 1, &name);
    glTextureStorage2D(name, (GLsizei)image->levels, format, (GLsizei)image->width,
                       (GLsizei)image->height);
    glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTextureParameterf(name, GL_TEXTURE_MAX_ANISOTROPY_EXT, 8.0f);
    return name;
}

// Uploads rows from where `u` stands, up to `budget` bytes, one row at least; true when all are
// there. *spent grows by what was uploaded.
static bool upload_rows(gfx_upload *u, size_t budget, size_t *spent) {
    const gfx_mips *image = &u->image;
    size_t texel = image->hdr ? 16 : 4;
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    while (u->level < image->levels && *spent < budget) {
        uint32_t width = gfx_mips_level_size(image->width, u->level);
        uint32_t height = gfx_mips_level_size(image->height, u->level);
        size_t row = width * texel;
        if (*spent && budget - *spent < row) {
            return false;
        }
        uint32_t rows = (uint32_t)CORE_CLAMP((budget - *spent) / row, 1, height - u->row);
        const uint8_t *from = image->texels + image->first[u->level] + u->row * row;
        glTextureSubImage2D(u->name, (GLint)u->level, 0, (GLint)u->row, (GLsizei)width,
                            (GLsizei)rows, GL_RGBA, image->hdr ? GL_FLOAT : GL_UNSIGNED_BYTE, from);
        *spent += rows * row;
        u->row += rows;
        if (u->row == height) {
            u->row = 0;
            u->level++;
        }
    }
    return u->level == image->levels;
}

static gfx_texture *find(gfx_textures *all, const char *path, bool srgb) {
    gfx_texture *t = all->all.data;
    for (size_t i = 0; i < all->all.count; ++i) {
        if (t[i].srgb == srgb && strcmp(t[i].path, path) == 0) {
            return &t[i];
        }
    }
    return NULL;
}

// The texture becomes the image that was uploaded.
static void replace(gfx_textures *all, gfx_texture *t, const gfx_upload *u) {
    glDeleteTextures(1, &t->own);
    t->name = t->own = u->name;
    t->width = u->image.width, t->height = u->image.height;
    t->state = GFX_TEXTURE_READY;
    all->version++;
}

static void fail(gfx_textures *all, gfx_texture *t) {
    if (t->own) { // it was read before: what was good stays
        t->state = GFX_TEXTURE_READY;
        return;
    }
    const gfx_texture *checker = find(all, GFX_TEXTURE_CHECKER, true);
    t->name = checker->name;
    t->width = checker->width, t->height = checker->height;
    t->state = GFX_TEXTURE_MISSING;
    all->version++;
}

static void load_now(gfx_device *d, gfx_texture *t) {
    gfx_upload u = {0};
    size_t spent = 0;
    if (gfx_mips_load(d->vfs, t->path, t->srgb, &u.image)) {
        u.name = make_storage(&u.image);
        upload_rows(&u, SIZE_MAX, &spent);
        replace(&d->textures, t, &u);
    } else {
        fail(&d->textures, t);
    }
    gfx_mips_release(&u.image);
}

static void load(gfx_device *d, gfx_texture *t) {
    if (strncmp(t->path, "target:", 7) == 0) {
        core_log(CORE_LOG_WARN, "%s: no view draws to this target", t->path);
        fail(&d->textures, t);
        return;
    }
    t->stamp = d->vfs ? core_vfs_stamp(d->vfs, t->path) : 0;
    t->state = GFX_TEXTURE_LOADING;
    if (!d->background || !ask(d, t)) {
        load_now(d, t);
    }
}

static bool take_job(gfx_textures *all) {
    pthread_mutex_lock(&all->loader->lock);
    job *j = pop(&all->loader->done);
    pthread_mutex_unlock(&all->loader->lock);
    if (!j) {
        return false;
    }
    gfx_texture *t = find(all, j->path, j->srgb);
    if (j->ok) {
        all->upload = (gfx_upload){.image = j->image, .name = make_storage(&j->image)};
        all->uploading = (uint32_t)(t - (gfx_texture *)all->all.data);
    } else {
        fail(all, t);
    }
    core_free(j);
    return true;
}

void gfx_textures_update(gfx_device *d, const gfx_world *world) {
    gfx_textures *all = &d->textures;
    size_t budget = (size_t)(world->settings.upload_budget * 1048576.0f);
    all->uploaded = 0;
    while (all->loader && (all->upload.name || take_job(all))) {
        if (all->upload.name) {
            if (!upload_rows(&all->upload, budget, &all->uploaded)) {
                return;
            }
            replace(all, (gfx_texture *)all->all.data + all->uploading, &all->upload);
            gfx_mips_release(&all->upload.image);
            all->upload = (gfx_upload){0};
        }
    }
}

// ---- by name ----

static void add_plain(gfx_textures *all, const char *path, const uint8_t *rgba, uint32_t size,
                      bool srgb) {
    gfx_texture *t = gfx_grow(&all->all, sizeof *t, 1);
    gfx_upload u = {0};
    size_t spent = 0;
    *t = (gfx_texture){.srgb = srgb};
    snprintf(t->path, sizeof t->path, "%s", path);
    gfx_mips_from_bytes(rgba, size, size, srgb, &u.image);
    u.name = make_storage(&u.image);
    upload_rows(&u, SIZE_MAX, &spent);
    replace(all, t, &u);
    gfx_mips_release(&u.image);
}

// Entered under names that no file can have.
static void add_all_plain(gfx_textures *all) {
    enum { SIDE = 64, SQUARE = 8 };
    static const uint8_t white[4] = {255, 255, 255, 255}, flat[4] = {128, 128, 255, 255};
    static const uint8_t loading[4] = {128, 128, 128, 255};
    static const uint8_t ink[2][4] = {{255, 0, 255, 255}, {20, 20, 20, 255}};
    uint8_t checker[SIDE * SIDE * 4];
    for (int i = 0; i < SIDE * SIDE; ++i) {
        memcpy(checker + 4 * i, ink[(i % SIDE / SQUARE + i / SIDE / SQUARE) % 2], 4);
    }
    add_plain(all, GFX_TEXTURE_CHECKER, checker, SIDE, true);
    add_plain(all, GFX_TEXTURE_WHITE, white, 1, true);
    add_plain(all, GFX_TEXTURE_WHITE, white, 1, false);
    add_plain(all, GFX_TEXTURE_FLAT, flat, 1, false);
    add_plain(all, GFX_TEXTURE_GREY, loading, 1, true);
}

const gfx_texture *gfx_texture_get(gfx_device *d, const char *path, bool srgb) {
    gfx_textures *all = &d->textures;
    if (all->all.count == 0) {
        add_all_plain(all);
    }
    gfx_texture *t = find(all, path, srgb);
    if (!t) {
        GLuint grey = find(all, GFX_TEXTURE_GREY, true)->name;
        t = gfx_grow(&all->all, sizeof *t, 1);
        *t = (gfx_texture){.srgb = srgb, .name = grey, .width = 1, .height = 1};
        snprintf(t->path, sizeof t->path, "%s", path);
        load(d, t);
    }
    return t;
}

void gfx_texture_enter(gfx_device *d, const char *path, bool srgb, GLuint name, uint32_t width,
                       uint32_t height) {
    gfx_textures *all = &d->textures;
    if (all->all.count == 0) {
        add_all_plain(all);
    }
    gfx_texture *t = find(all, path, srgb);
    if (!t) {
        t = gfx_grow(&all->all, sizeof *t, 1);
        *t = (gfx_texture){.srgb = srgb};
        snprintf(t->path, sizeof t->path, "%s", path);
    }
    if (!name) {
        fail(all, t);
    } else if (t->name != name) {
        t->name = name;
        t->width = width, t->height = height;
        t->state = GFX_TEXTURE_READY;
        all->version++;
    }
}

bool gfx_textures_reload(gfx_device *d) {
    gfx_texture *t = d->textures.all.data;
    bool ok = true;
    for (size_t i = 0; d->vfs && i < d->textures.all.count; ++i) {
        bool plain = strncmp(t[i].path, "//", 2) == 0 || strncmp(t[i].path, "target:", 7) == 0;
        uint64_t stamp = plain ? t[i].stamp : core_vfs_stamp(d->vfs, t[i].path);
        if (stamp != t[i].stamp && t[i].state != GFX_TEXTURE_LOADING) {
            bool had = t[i].own != 0;
            GLuint before = t[i].own;
            t[i].stamp = stamp;
            load_now(d, &t[i]);
            ok &= t[i].own != before;
            if (had && t[i].own == before) {
                core_log(CORE_LOG_WARN, "%s: the last good picture stays", t[i].path);
            } else {
                core_log(CORE_LOG_INFO, "%s changed: loaded again", t[i].path);
            }
        }
    }
    return ok;
}

uint32_t gfx_textures_loading(const gfx_textures *all) {
    const gfx_texture *t = all->all.data;
    uint32_t loading = 0;
    for (size_t i = 0; i < all->all.count; ++i) {
        loading += t[i].state == GFX_TEXTURE_LOADING;
    }
    return loading;
}

void gfx_textures_release(gfx_textures *all) {
    release_loader(all->loader);
    gfx_texture *t = all->all.data;
    for (size_t i = 0; i < all->all.count; ++i) {
        glDeleteTextures(1, &t[i].own);
    }
    glDeleteTextures(1, &all->upload.name);
    gfx_mips_release(&all->upload.image);
    gfx_growing_release(&all->all);
}
