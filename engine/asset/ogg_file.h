// Ogg Vorbis (ogg_file.c), for sound_file.c.
#ifndef ASSET_OGG_FILE_H
#define ASSET_OGG_FILE_H

#include "core/data.h"

core_sound_data *asset_ogg_decode(const void *bytes, size_t size, const char *path);

#endif
