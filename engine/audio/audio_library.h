// OpenAL Soft, loaded when the first device is made: a program that makes no sound pays nothing.
#ifndef AUDIO_AUDIO_LIBRARY_H
#define AUDIO_AUDIO_LIBRARY_H

#include "core/base.h"

#include <AL/al.h>
#include <AL/alc.h>
#include <AL/alext.h>
#include <AL/efx.h>

// Exported functions: pointer type, name.
#define AUDIO_LIBRARY(X)                                                                           \
    X(LPALCOPENDEVICE, alcOpenDevice)                                                              \
    X(LPALCCLOSEDEVICE, alcCloseDevice)                                                            \
    X(LPALCCREATECONTEXT, alcCreateContext)                                                        \
    X(LPALCDESTROYCONTEXT, alcDestroyContext)                                                      \
    X(LPALCGETINTEGERV, alcGetIntegerv)                                                            \
    X(LPALCGETSTRING, alcGetString)                                                                \
    X(LPALCGETPROCADDRESS, alcGetProcAddress)                                                      \
    X(LPALCISEXTENSIONPRESENT, alcIsExtensionPresent)                                              \
    X(LPALGENSOURCES, alGenSources)                                                                \
    X(LPALDELETESOURCES, alDeleteSources)                                                          \
    X(LPALSOURCEF, alSourcef)                                                                      \
    X(LPALSOURCE3F, alSource3f)                                                                    \
    X(LPALSOURCEI, alSourcei)                                                                      \
    X(LPALGETSOURCEI, alGetSourcei)                                                                \
    X(LPALSOURCEPLAY, alSourcePlay)                                                                \
    X(LPALSOURCESTOP, alSourceStop)                                                                \
    X(LPALGENBUFFERS, alGenBuffers)                                                                \
    X(LPALDELETEBUFFERS, alDeleteBuffers)                                                          \
    X(LPALBUFFERDATA, alBufferData)                                                                \
    X(LPALDISTANCEMODEL, alDistanceModel)                                                          \
    X(LPALGETERROR, alGetError)

// Extensions, found by alcGetProcAddress; NULL when this OpenAL has them not.
#define AUDIO_LIBRARY_EXTENSIONS(X)                                                                \
    X(PFNALCSETTHREADCONTEXTPROC, alcSetThreadContext)                                             \
    X(LPALCLOOPBACKOPENDEVICESOFT, alcLoopbackOpenDeviceSOFT)                                      \
    X(LPALCRENDERSAMPLESSOFT, alcRenderSamplesSOFT)                                                \
    X(LPALCRESETDEVICESOFT, alcResetDeviceSOFT)                                                    \
    X(LPALGENFILTERS, alGenFilters)                                                                \
    X(LPALDELETEFILTERS, alDeleteFilters)                                                          \
    X(LPALFILTERI, alFilteri)                                                                      \
    X(LPALFILTERF, alFilterf)

#define AUDIO_LIBRARY_FIELD_(type, name) type name;
typedef struct audio_library {
    void *handle;
    AUDIO_LIBRARY(AUDIO_LIBRARY_FIELD_)
    AUDIO_LIBRARY_EXTENSIONS(AUDIO_LIBRARY_FIELD_)
} audio_library;

// False + core_fail_quiet (what to install).
bool audio_library_open(audio_library *lib);
void audio_library_close(audio_library *lib);

#endif
