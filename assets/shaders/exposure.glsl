// State of the automatic exposure.
layout(std430, binding = GFX_SSBO_EXPOSURE) buffer ExposureBlock {
    float exposure; // of the last frame, 0: none yet
    uint count[GFX_EXPOSURE_BINS];
    uint part[GFX_EXPOSURE_BINS]; // sums of 1/64 of a bin
} u_exposure;
