#version 450
// Where each vertex of an object stands in the world and in the picture.
#include "camera.glsl"
#include "object.glsl"
#include "vertex.glsl"

layout(location = 0) out vec3 outPoint;
layout(location = 1) out vec3 outNormal;
layout(location = 2) out vec2 outUV;
layout(location = 3) out flat uvec4 outIds;

void main() {
  vec4 point = placed.modelMatrix * vec4(position, 1.0);
  gl_Position = camera.projectionMatrix * (camera.viewMatrix * point);
  // Normals turn with the cofactors, whatever the scale along each axis.
  mat3 m = mat3(placed.modelMatrix);
  outNormal = mat3(cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1])) * normal;
  outPoint = point.xyz;
  outUV = uv;
  outIds = object.segmentation;
}
