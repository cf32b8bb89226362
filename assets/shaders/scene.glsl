// Set 3 of the picture's pass: the light. Our worlds have light from everywhere, a key light, and up to two more that
// throw no shadows (sim.surroundings); of the kinds of light that they have not, the engine wants room for one each.
struct DirectionalLight {
  vec4 direction;  // in which it shines
  vec4 emission;
};

struct PointLight {
  vec4 position;
  vec4 emission;
};

struct SpotLight {
  vec4 position;
  vec4 direction;
  vec4 emission;
};

struct LightView {
  mat4 viewMatrix;
  mat4 viewMatrixInverse;
  mat4 projectionMatrix;
  mat4 projectionMatrixInverse;
  int width;
  int height;
};

layout(set = 3, binding = 0) uniform SceneBuffer {
  vec4 ambientLight;
  DirectionalLight directionalLights[3];  // the key light first
  PointLight pointLights[1];
  SpotLight spotLights[1];
  SpotLight texturedLights[1];
} scene;

layout(set = 3, binding = 1) uniform ShadowBuffer {
  LightView directionalLightBuffers[1];
  LightView pointLightBuffers[6];
  LightView spotLightBuffers[1];
  LightView texturedLightBuffers[1];
} views;

layout(set = 3, binding = 2) uniform sampler2D samplerDirectionalLightDepths[1];
layout(set = 3, binding = 3) uniform samplerCube samplerPointLightDepths[1];
layout(set = 3, binding = 4) uniform sampler2D samplerSpotLightDepths[1];
layout(set = 3, binding = 5) uniform sampler2D samplerTexturedLightDepths[1];
layout(set = 3, binding = 6) uniform sampler2D samplerTexturedLightTextures[1];

// How many lights there are, and how many of them throw shadows; the engine sets them.
layout(constant_id = 0) const int NUM_DIRECTIONAL_LIGHTS = 1;
layout(constant_id = 1) const int NUM_DIRECTIONAL_LIGHT_SHADOWS = 1;
layout(constant_id = 2) const int NUM_POINT_LIGHTS = 0;
layout(constant_id = 3) const int NUM_POINT_LIGHT_SHADOWS = 0;
layout(constant_id = 4) const int NUM_SPOT_LIGHTS = 0;
layout(constant_id = 5) const int NUM_SPOT_LIGHT_SHADOWS = 0;
layout(constant_id = 6) const int NUM_TEXTURED_LIGHT_SHADOWS = 0;
