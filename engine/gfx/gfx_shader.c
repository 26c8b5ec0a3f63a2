#include "gfx/gfx_shader.h"

#include "core/hash.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---- one source text from a file and what it includes ----

typedef struct text {
    char *data;
    size_t length, capacity;
} text;

// From `first`, lines of the whole text are those of a file from `line` on. Drivers disagree on,
// and get wrong, the source numbers of #line, so errors are placed by this map instead.
typedef struct span {
    int first, file, line;
} span;

enum { MAX_SPANS = 4 * GFX_SHADER_FILES };

typedef struct source {
    core_vfs *vfs;
    text out;
    int lines; // in out so far
    char file[GFX_SHADER_FILES][GFX_SHADER_PATH];
    int files;
    const char *hook; // path that the name HOOK stands for
    int hook_file;    // its number, -1: not there yet
    span span[MAX_SPANS];
    int spans;
    uint64_t stamp; // of all files together
} source;

static void append(text *t, const char *data, size_t length) {
    if (t->length + length + 1 > t->capacity) {
        size_t capacity = (t->length + length + 1) * 2;
        t->data = core_realloc(t->data, t->capacity, capacity);
        t->capacity = capacity;
    }
    memcpy(t->data + t->length, data, length);
    t->length += length;
    t->data[t->length] = '\0';
}

static void append_line(source *s, const char *data, size_t length) {
    append(&s->out, data, length);
    if (length == 0 || data[length - 1] != '\n') {
        append(&s->out, "\n", 1);
    }
    s->lines++;
}

static bool begin_span(source *s, int file, int line) {
    if (s->spans == MAX_SPANS) {
        return core_fail_quiet("more than %d #includes in one shader", MAX_SPANS);
    }
    s->span[s->spans++] = (span){s->lines + 1, file, line};
    return true;
}

// The quoted name of an #include line, or false.
static bool include_name(const char *line, char *name, size_t size) {
    while (*line == ' ' || *line == '\t') {
        ++line;
    }
    if (strncmp(line, "#include", 8) != 0) {
        return false;
    }
    const char *open = strchr(line, '"'), *end = strchr(line, '\n');
    const char *close = open ? strchr(open + 1, '"') : NULL;
    if (!close || (end && close > end) || (size_t)(close - open) > size) {
        return false;
    }
    memcpy(name, open + 1, (size_t)(close - open - 1));
    name[close - open - 1] = '\0';
    return true;
}

static bool add_file(source *s, const char *name);

// Copies lines; an #include is replaced by the file's text.
static bool add_lines(source *s, const char *at, int file) {
    bool ok = begin_span(s, file, 1);
    for (int line = 1; *at && ok; ++line) {
        const char *end = strchr(at, '\n');
        size_t length = end ? (size_t)(end - at) + 1 : strlen(at);
        char name[GFX_SHADER_PATH];
        if (!include_name(at, name, sizeof name)) {
            append_line(s, at, length);
        } else if (!add_file(s, name) || !begin_span(s, file, line + 1)) {
            ok = core_fail_quiet("%s:%d: %s", s->file[file], line, core_last_error());
        }
        at += length;
    }
    return ok;
}

// Each file enters once, so headers need no guards and cycles end.
static bool add_file(source *s, const char *name) {
    for (int i = 0; i < s->files; ++i) {
        if (strcmp(s->file[i], name) == 0) {
            return true;
        }
    }
    if (s->files == GFX_SHADER_FILES) {
        return core_fail_quiet("more than %d files in one shader", GFX_SHADER_FILES);
    }
    char path[GFX_SHADER_PATH + 16];
    bool hook = strcmp(name, "HOOK") == 0;
    if (hook && !s->hook[0]) {
        return true; // includes know no #ifdef
    }
    snprintf(path, sizeof path, "%s%s", hook ? "" : "shaders/", hook ? s->hook : name);
    char *data = core_vfs_read(s->vfs, path, NULL);
    if (!data) {
        return false;
    }
    s->stamp = core_hash_mix(s->stamp, core_vfs_stamp(s->vfs, path));
    int file = s->files++;
    s->hook_file = hook ? file : s->hook_file;
    snprintf(s->file[file], sizeof s->file[file], "%s", hook ? s->hook : name);
    bool ok = add_lines(s, data, file);
    core_free(data);
    return ok;
}

static void add_head(source *s, uint32_t features) {
#define NAME_(id, name) name,
    static const char *const names[] = {GFX_FEATURES(NAME_)};
#undef NAME_
    static const char version[] = "#version 450 core";
    static const char draw[] = "#extension GL_ARB_shader_draw_parameters : enable";
    append_line(s, version, sizeof version - 1);
    append_line(s, draw, sizeof draw - 1);
    for (int i = 0; i < GFX_FEATURE_COUNT; ++i) {
        if (features >> i & 1u) {
            char line[64];
            int n = snprintf(line, sizeof line, "#define %s 1", names[i]);
            append_line(s, line, (size_t)n);
        }
    }
}

// ---- errors ----

// Rewrites the first line of a driver's log: Mesa and Intel write "0:LINE(COLUMN): why", NVIDIA
// "0(LINE) : why", others with "ERROR: " before.
static void fail_with_log(const source *s, const char *log) {
    const char *at = log;
    while (*at && !isdigit((unsigned char)*at)) {
        ++at;
    }
    int number = 0, line = 0, used = 0, at_span = -1;
    if (sscanf(at, "%d:%d%n", &number, &line, &used) == 2 ||
        sscanf(at, "%d(%d)%n", &number, &line, &used) == 2) {
        while (at_span + 1 < s->spans && s->span[at_span + 1].first <= line) {
            at_span++;
        }
    }
    if (at_span < 0) {
        core_fail("shader %s: %s", s->file[0], log);
        return;
    }
    const span *in = &s->span[at_span];
    const char *why = at + used;
    if (*why == '(') { // column
        const char *close = strchr(why, ')');
        why = close ? close + 1 : why;
    }
    why += strspn(why, ": ");
    core_fail("%s%s:%d: %.*s", in->file == s->hook_file ? "" : "shaders/", s->file[in->file],
              in->line + line - in->first, (int)strcspn(why, "\n"), why);
}

static GLuint compile(core_vfs *vfs, GLenum stage, const char *name, const gfx_program *p,
                      uint64_t *stamp) {
    source s = {.vfs = vfs, .stamp = *stamp, .hook = p->hook, .hook_file = -1};
    add_head(&s, p->features);
    GLuint shader = 0;
    if (!add_file(&s, name)) {
        core_fail("shader %s: %s", name, core_last_error());
    } else {
        shader = glCreateShader(stage);
        const char *data = s.out.data;
        glShaderSource(shader, 1, &data, NULL);
        glCompileShader(shader);
        GLint ok = 0;
        glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
        if (!ok) {
            char log[2048] = "";
            glGetShaderInfoLog(shader, sizeof log, NULL, log);
            fail_with_log(&s, log);
            glDeleteShader(shader);
            shader = 0;
        }
    }
    *stamp = s.stamp;
    core_free(s.out.data);
    return shader;
}

static bool link_program(const gfx_program *p, GLuint name) {
    glLinkProgram(name);
    GLint ok = 0;
    glGetProgramiv(name, GL_LINK_STATUS, &ok);
    if (!ok) {
        char log[2048] = "";
        glGetProgramInfoLog(name, sizeof log, NULL, log);
        core_fail("shaders %s and %s do not link: %s", p->vertex ? p->vertex : p->compute,
                  p->fragment ? p->fragment : "none", log);
    }
    return ok;
}

// 0 + core_fail on error; p->stamp is set in any case.
static GLuint build(core_vfs *vfs, gfx_program *p) {
    const GLenum stage[3] = {GL_VERTEX_SHADER, GL_FRAGMENT_SHADER, GL_COMPUTE_SHADER};
    const char *const file[3] = {p->vertex, p->fragment, p->compute};
    GLuint name = glCreateProgram();
    bool ok = true;
    p->stamp = 0;
    for (int i = 0; i < 3; ++i) {
        if (file[i] && ok) {
            GLuint shader = compile(vfs, stage[i], file[i], p, &p->stamp);
            ok = shader != 0;
            if (ok) {
                glAttachShader(name, shader);
                glDeleteShader(shader);
            }
        }
    }
    if (!ok || !link_program(p, name)) {
        glDeleteProgram(name);
        return 0;
    }
    return name;
}

// What build() would leave in p->stamp now, without compiling.
static uint64_t stamp_of(core_vfs *vfs, const gfx_program *p) {
    const char *const file[3] = {p->vertex, p->fragment, p->compute};
    uint64_t stamp = 0;
    for (int i = 0; i < 3; ++i) {
        if (file[i]) {
            source s = {.vfs = vfs, .stamp = stamp, .hook = p->hook, .hook_file = -1};
            add_file(&s, file[i]);
            stamp = s.stamp;
            core_free(s.out.data);
        }
    }
    return stamp;
}

// ---- variants ----

static bool same(const char *a, const char *b) { return a == b || (a && b && !strcmp(a, b)); }

static GLuint get(gfx_shaders *shaders, const gfx_program *want) {
    for (uint32_t i = 0; i < shaders->count; ++i) {
        const gfx_program *p = &shaders->program[i];
        if (p->features == want->features && same(p->vertex, want->vertex) &&
            same(p->fragment, want->fragment) && same(p->compute, want->compute) &&
            strcmp(p->hook, want->hook) == 0) {
            return p->name ? p->name
                           : (core_fail_quiet("shader %s did not build",
                                              p->vertex ? p->vertex : p->compute),
                              0u);
        }
    }
    if (shaders->count == GFX_PROGRAM_VARIANTS) {
        core_fail("more than %d shader variants", GFX_PROGRAM_VARIANTS);
        return 0;
    }
    gfx_program *p = &shaders->program[shaders->count++];
    *p = *want;
    p->name = build(shaders->vfs, p);
    return p->name;
}

GLuint gfx_shaders_get(gfx_shaders *shaders, const char *vertex, const char *fragment,
                       uint32_t features) {
    gfx_program want = {.vertex = vertex, .fragment = fragment, .features = features};
    return get(shaders, &want);
}

GLuint gfx_shaders_get_hooked(gfx_shaders *shaders, const char *vertex, const char *fragment,
                              uint32_t features, const char *hook) {
    gfx_program want = {
        .vertex = vertex, .fragment = fragment, .features = features | GFX_FEATURE_HOOK};
    snprintf(want.hook, sizeof want.hook, "%s", hook);
    return get(shaders, &want);
}

GLuint gfx_shaders_compute(gfx_shaders *shaders, const char *compute, uint32_t features) {
    gfx_program want = {.compute = compute, .features = features};
    return get(shaders, &want);
}

bool gfx_shaders_reload(gfx_shaders *shaders) {
    bool ok = true;
    for (uint32_t i = 0; i < shaders->count; ++i) {
        gfx_program *p = &shaders->program[i];
        if (stamp_of(shaders->vfs, p) == p->stamp) {
            continue;
        }
        GLuint name = build(shaders->vfs, p);
        if (name) {
            glDeleteProgram(p->name);
            p->name = name;
        }
        ok = ok && name;
    }
    return ok;
}

void gfx_shaders_release(gfx_shaders *shaders) {
    for (uint32_t i = 0; i < shaders->count; ++i) {
        glDeleteProgram(shaders->program[i].name);
    }
    shaders->count = 0;
}
