// What vertices and fragments of terrain share.
layout(std140, binding = GFX_UBO_TERRAIN) uniform TerrainBlock { gfx_terrain_block u_terrain; };
