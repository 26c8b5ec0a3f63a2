// Depth alone; with an alpha mask, of what the mask leaves.
#ifdef USE_ALPHA_MASK
#include "material.glsl"

void main() {
    if (baseColor(materials[v_material]).a < materials[v_material].params.w) {
        discard;
    }
}
#else
void main() {}
#endif
