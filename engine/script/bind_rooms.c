// Every room's bindings, in the order of the reference page.
#include "script/bind.h"

extern const bind_room bind_core_room;
extern const bind_room bind_input_room;
extern const bind_room bind_tools_room;
extern const bind_room bind_mod_room;
extern const bind_room bind_scene_room;
extern const bind_room bind_phys_room;
extern const bind_room bind_gfx_room;
extern const bind_room bind_camera_room;
extern const bind_room bind_effect_room;
extern const bind_room bind_canvas_room;
extern const bind_room bind_marks_room;
extern const bind_room bind_emitter_room;
extern const bind_room bind_terrain_room;
extern const bind_room bind_anim_room;
extern const bind_room bind_nav_room;
extern const bind_room bind_audio_room;

const bind_room *const bind_rooms[] = {
    &bind_core_room,
    &bind_input_room,
    &bind_tools_room,
    &bind_mod_room,
    &bind_scene_room,
    &bind_phys_room,
    &bind_gfx_room,
    &bind_camera_room,
    &bind_effect_room,
    &bind_canvas_room,
    &bind_marks_room,
    &bind_emitter_room,
    &bind_terrain_room,
    &bind_anim_room,
    &bind_nav_room,
    &bind_audio_room,
    NULL,
};
