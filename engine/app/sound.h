// What a run makes heard: a sound card in a window, a WAV file with --audio, nothing otherwise.
#ifndef APP_SOUND_H
#define APP_SOUND_H

#include <stdio.h>

#include "scene/scene.h"

#define APP_SOUND_RATE 48000

typedef struct app_sound {
    audio_device *device;
    bool tried;      // a device was looked for, once
    FILE *wav;       // 32-bit float, stereo
    uint64_t frames; // written so far
    float *buffer;   // [buffer_frames * 2]
    uint32_t buffer_frames;
} app_sound;

// Opens the WAV file. False + core_fail.
bool app_sound_open_file(app_sound *a, const char *path);
// After a step: plays the world's voices; with a file, renders one step of them. `seconds`: step
// time since the start of the run, this step included. False + core_fail: the file, or OpenAL for
// it.
bool app_sound_step(app_sound *a, const scene *s, double seconds, bool window);
// The sounds of a scene that ends fall silent; a file goes on with the next scene.
void app_sound_leave_scene(app_sound *a);
// False + core_fail when the file could not be written.
bool app_sound_close(app_sound *a);

#endif
