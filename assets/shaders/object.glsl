// Set 1 of every pass: where an object stands, and its numbers (SAPIEN's ids of shape and entity first).
layout(set = 1, binding = 0) uniform ObjectTransformBuffer {
  mat4 modelMatrix;
} placed;

layout(set = 1, binding = 1) uniform ObjectDataBuffer {
  uvec4 segmentation;
  float transparency;
  int shadeFlat;
} object;
