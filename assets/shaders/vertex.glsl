// The vertices of a mesh. The engine wants one layout for all packs of a process, so that this is SAPIEN's own;
// tangents are for normal maps, which none of our objects has.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 uv;
layout(location = 3) in vec3 tangent;
layout(location = 4) in vec3 bitangent;
