#version 450
// The whole picture in one pass: colour (sRGB, alpha 0 where nothing is), SAPIEN's ids, and depth, which the engine
// keeps as GbufferDepth. Nothing is computed that our worlds do not have: no light from an environment map (for which
// SAPIEN's own packs integrate a table, seconds before the first picture of a process), no normal maps, nothing that
// is seen through. Colours are those of SAPIEN's `default` pack within two of 255 levels, but for the edges of shadows.
#include "camera.glsl"
#include "object.glsl"
#include "material.glsl"
#include "scene.glsl"
#include "light.glsl"

layout(location = 0) in vec3 inPoint;
layout(location = 1) in vec3 inNormal;
layout(location = 2) in vec2 inUV;
layout(location = 3) in flat uvec4 inIds;

layout(location = 0) out vec4 outColor;
layout(location = 1) out uvec4 outSegmentation;

void main() {
  vec3 to_camera = normalize(camera.viewMatrixInverse[3].xyz - inPoint);
  vec3 normal = normalize(faceforward(inNormal, -to_camera, inNormal));  // a sheet is seen from both sides
  vec3 light = lit(surface_at(inUV), inPoint, normal, to_camera);
  outColor = vec4(pow(light, vec3(1.0 / 2.2)), 1.0);
  outSegmentation = inIds;
}
