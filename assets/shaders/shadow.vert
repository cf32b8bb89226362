#version 450
// The shadow map: how far the key light reaches. Depth is all, so that there is nothing to compute for a pixel.
#include "object.glsl"
#include "vertex.glsl"

layout(set = 0, binding = 0) uniform LightBuffer {
  mat4 viewMatrix;
  mat4 viewMatrixInverse;
  mat4 projectionMatrix;
  mat4 projectionMatrixInverse;
  int width;
  int height;
} light;

void main() {
  gl_Position = light.projectionMatrix * (light.viewMatrix * (placed.modelMatrix * vec4(position, 1.0)));
}
