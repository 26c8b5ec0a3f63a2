// The ghost in the window (F2): the same scene, seed and input once more at the reference settings,
// drawn in blue inside the live bodies, so that what sticks out is error.
#ifndef APP_LAB_GHOST_H
#define APP_LAB_GHOST_H

#include "app/run.h"

typedef struct app_ghost app_ghost;

// For a live run at its first step. NULL + core_fail when the reference cannot be made.
app_ghost *app_ghost_create(const app_run *live);
// Ends the ghost; its instances go from the live scene's drawing when that still exists.
void app_ghost_destroy(app_ghost *ghost);
// After a step of the live run: the same step with the same input. live_ns: what the live one took.
void app_ghost_step(app_ghost *ghost, const gfx_event *event, uint32_t events, uint64_t live_ns);
// Before a frame of the live run: places the blue bodies. Gives the line to show: mm and ms.
const char *app_ghost_draw(app_ghost *ghost);

#endif
