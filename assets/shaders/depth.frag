// Depth alone; with an alpha mask, of what the mask leaves.
#ifdef USE_ALPHA_MASK
#include "material.glsl"

void main() {
    if (baseColor(v_material).a < v_material.params.w) {
        discard;
    }
}
#else
void main() {}
#endif
