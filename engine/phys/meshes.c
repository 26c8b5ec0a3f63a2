// The triangle meshes of a world: built once for equal soups, counted, and shared by shapes.
#include "phys/mesh_internal.h"

#include "core/hash.h"

typedef struct phys_mesh_entry {
    phys_mesh mesh;
    uint64_t hash; // of the soup it was made from
    uint32_t users;
} phys_mesh_entry;

static uint64_t hash_soup(const phys_shape_desc *d) {
    if (d->heights != NULL) {
        uint64_t h = phys_heights_hash(d);
        return core_hash(d->materials, d->material_count * sizeof *d->materials, h);
    }
    const core_soup_data *s = d->mesh;
    uint64_t h = core_hash(s->position, 3 * (size_t)s->vertex_count * sizeof(float), d->one_sided);
    h = core_hash(s->index, 3 * (size_t)s->triangle_count * sizeof(uint32_t), h);
    if (s->area != NULL && d->material_count != 0) {
        h = core_hash(s->area, s->triangle_count, h);
        h = core_hash(d->materials, d->material_count * sizeof *d->materials, h);
    }
    return h;
}

uint32_t phys_mesh_share(phys_world *w, const phys_shape_desc *d) {
    if (!phys_mesh_check(d)) {
        return 0;
    }
    uint64_t hash = hash_soup(d);
    uint32_t at = w->mesh_count;
    for (uint32_t i = 0; i < w->mesh_count; i++) {
        if (w->meshes[i].users == 0) {
            at = i;
        } else if (w->meshes[i].hash == hash) {
            w->meshes[i].users++;
            return i + 1;
        }
    }
    phys_mesh mesh;
    if (!phys_mesh_build(&mesh, d)) {
        return 0;
    }
    if (at == w->mesh_capacity) {
        uint32_t grown = w->mesh_capacity ? w->mesh_capacity * 2 : 4;
        w->meshes = core_realloc(w->meshes, w->mesh_capacity * sizeof *w->meshes,
                                 grown * sizeof *w->meshes);
        w->mesh_capacity = grown;
    }
    w->mesh_count = CORE_MAX(w->mesh_count, at + 1);
    w->meshes[at] = (phys_mesh_entry){mesh, hash, 1};
    return at + 1;
}

void phys_mesh_leave(phys_world *w, uint32_t number) {
    if (number != 0 && --w->meshes[number - 1].users == 0) {
        phys_mesh_release(&w->meshes[number - 1].mesh);
    }
}

void phys_meshes_release(phys_world *w) {
    for (uint32_t i = 0; i < w->mesh_count; i++) {
        if (w->meshes[i].users != 0) {
            phys_mesh_release(&w->meshes[i].mesh);
        }
    }
    core_free(w->meshes);
}

size_t phys_meshes_bytes(const phys_world *w) {
    size_t bytes = w->mesh_capacity * sizeof *w->meshes;
    for (uint32_t i = 0; i < w->mesh_count; i++) {
        bytes += w->meshes[i].users != 0 ? phys_mesh_bytes(&w->meshes[i].mesh) : 0;
    }
    return bytes;
}

const phys_mesh *phys_mesh_at(const phys_world *w, uint32_t number) {
    return &w->meshes[number - 1].mesh;
}

bool phys_mesh_stands(const phys_world *w, uint32_t number) {
    return number - 1 < w->mesh_count && w->meshes[number - 1].users != 0;
}

void phys_meshes_recount(phys_world *w) {
    for (uint32_t i = 0; i < w->mesh_count; i++) {
        w->meshes[i].users = w->meshes[i].users != 0; // kept alive, as hulls are
    }
    for (uint32_t i = 0; i < core_columns_count(&w->shapes.set); i++) {
        if (w->shapes.type[i] == PHYS_MESH) {
            w->meshes[w->shapes.hull[i] - 1].users++;
        }
    }
}
