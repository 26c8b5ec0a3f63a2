// F1: what the run does, for people. Pages turn with F1: stages over time and counts, settings that
// can be changed, log and Lua console. It costs nothing before it is first shown.
#ifndef APP_OVERLAY_H
#define APP_OVERLAY_H

#include "app/run.h"

typedef struct app_overlay app_overlay;

// The next page, or none; makes the overlay at first use.
void app_overlay_turn(app_run *r);
void app_overlay_destroy(app_overlay *overlay); // NULL is fine
// True: the event was for the overlay and the game does not hear it.
bool app_overlay_event(app_run *r, const gfx_event *event);
void app_overlay_step(app_run *r); // remembers what the step cost, runs what the console was told
void app_overlay_draw(app_run *r); // after the scene's own drawing
// overlay_machine.c: states and transitions of the animated skeleton nearest to the camera, live.
void app_overlay_machine(app_run *r);

#endif
