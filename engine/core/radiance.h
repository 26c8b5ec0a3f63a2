// Radiance pictures (.hdr) before a decoder is given them: versions of stb_image before 2.29 never
// return from a packed row that is cut off.
#ifndef CORE_RADIANCE_H
#define CORE_RADIANCE_H

#include "core/base.h"

// Whether all rows of a picture of width x height are there, packed or plain (Ward 1991, "Real
// pixels"). Silent.
bool core_radiance_complete(const void *file, size_t size, uint32_t width, uint32_t height);

#endif
