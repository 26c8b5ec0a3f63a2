// Saved scenes of scripts (scene_file.c).
#ifndef SCRIPT_SCENE_FILE_H
#define SCRIPT_SCENE_FILE_H

#include "script/bind.h"

extern const bind_fn bind_scene_file_functions[];
void script_scene_file_release(script *s);

#endif
