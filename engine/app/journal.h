// Record and replay. A recording holds what a run needs to happen again (seed, dt, settings,
// parameters, arguments, hashes of the scene's files and mods), the input events of every step, and
// after every step the hash of each state column and a checksum of each row, so that a run that
// goes another way is caught at its first step, object and column. It names no file to open.
//
// Layout, little-endian: "CRR1"; a header; then per step a block "STEP", before it a block "READ"
// for each file of saved data that was read; last a block "DONE". Texts are a u32 length and bytes.
#ifndef APP_JOURNAL_H
#define APP_JOURNAL_H

#include <stdio.h>

#include "app/input.h"
#include "app/options.h"
#include "scene/scene.h"

#define APP_MAX_FILES 64

typedef struct app_file_hash { // of a file that the run was made from
    char name[128];
    uint64_t hash;
} app_file_hash;

// What a run was started with.
typedef struct app_journal_header {
    char scene[256]; // for people: never opened
    uint64_t seed;
    double dt; // s, 0: the scene's own
    uint32_t width, height;
    bool headless; // as the script saw it
    app_set set[APP_MAX_SETS];
    uint32_t set_count;
    char argument[16][128];
    uint32_t argument_count;
    app_file_hash file[APP_MAX_FILES];
    uint32_t file_count;
} app_journal_header;

// ---- writing ----
typedef struct app_recorder app_recorder;
// Made before the scene's files run, which may read saved data; begin opens the file, when it is
// known what the run starts with. False + core_fail when the file cannot be written.
app_recorder *app_recorder_create(void);
bool app_recorder_begin(app_recorder *r, const char *path, const app_journal_header *header);
// After a step: the events it began with, then the state it ended in.
void app_recorder_step(app_recorder *r, const gfx_event *event, uint32_t count, const scene *s);
// Saved data that the script read (NULL: there was none): it is no part of the game's files.
void app_recorder_saved(app_recorder *r, const char *name, const char *text, size_t size);
// Writes the end, closes, frees. False + core_fail when any write failed; true when it never began.
bool app_recorder_close(app_recorder *r, uint64_t hash);

// ---- reading ----
typedef struct app_replay app_replay;
// Reads and checks the whole file before anything is used. NULL + core_fail: what is wrong and
// where.
app_replay *app_replay_open(const char *path);
void app_replay_close(app_replay *r);
const app_journal_header *app_replay_header(const app_replay *r);
uint64_t app_replay_steps(const app_replay *r);
// Events of the next step (copied to out[APP_MAX_EVENTS]); returns how many.
uint32_t app_replay_events(app_replay *r, gfx_event *out);
// What the next read of saved data `name` gave when the run was recorded: text[size], NULL when
// there was no such file. Reads beyond those recorded give the last again.
const char *app_replay_saved(app_replay *r, const char *name, size_t *size);
// Compares the state after the step whose events were read last, and moves on. False + core_fail
// with first object and column on divergence.
bool app_replay_check(app_replay *r, const scene *s);

#endif
