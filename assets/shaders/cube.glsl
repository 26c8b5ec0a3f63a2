// Faces of a cube map: +x -x +y -y +z -z, as OpenGL lays them out.
layout(location = GFX_U_FACE) uniform int u_face;
layout(location = GFX_U_SIZE) uniform float u_size; // texels a side

vec3 faceDirection() {
    vec2 p = gl_FragCoord.xy / u_size * 2.0 - 1.0;
    vec3 d = u_face == 0   ? vec3(1.0, -p.y, -p.x)
             : u_face == 1 ? vec3(-1.0, -p.y, p.x)
             : u_face == 2 ? vec3(p.x, 1.0, p.y)
             : u_face == 3 ? vec3(p.x, -1.0, -p.y)
             : u_face == 4 ? vec3(p.x, -p.y, 1.0)
                           : vec3(-p.x, -p.y, -1.0);
    return normalize(d);
}
