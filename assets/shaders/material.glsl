// Set 2 of the picture's pass: what a surface is made of (glTF's metallic-roughness model).
layout(set = 2, binding = 0) uniform MaterialBuffer {
  vec4 emission;
  vec4 baseColor;
  float fresnel;
  float roughness;
  float metallic;
  float transmission;
  float ior;
  float transmissionRoughness;
  int textureMask;  // which textures there are, a bit each in the order below
  int padding1;
  vec4 textureTransforms[6];  // offset, scale
} material;

layout(set = 2, binding = 1) uniform sampler2D colorTexture;
layout(set = 2, binding = 2) uniform sampler2D roughnessTexture;
layout(set = 2, binding = 3) uniform sampler2D normalTexture;
layout(set = 2, binding = 4) uniform sampler2D metallicTexture;
layout(set = 2, binding = 5) uniform sampler2D emissionTexture;
layout(set = 2, binding = 6) uniform sampler2D transmissionTexture;

struct Surface {
  vec3 base;       // linear RGB
  vec3 emission;   // light of its own, linear RGB
  float roughness;
  float metallic;
  float fresnel;   // what it reflects straight ahead where it is no metal
};

vec2 in_texture(int which, vec2 uv) {
  return uv * material.textureTransforms[which].zw + material.textureTransforms[which].xy;
}

Surface surface_at(vec2 uv) {
  Surface s;
  s.base = material.baseColor.rgb;
  if ((material.textureMask & 1) != 0) s.base = texture(colorTexture, in_texture(0, uv)).rgb;
  s.roughness = material.roughness;
  if ((material.textureMask & 2) != 0) s.roughness = texture(roughnessTexture, in_texture(1, uv)).r;
  s.metallic = material.metallic;
  if ((material.textureMask & 8) != 0) s.metallic = texture(metallicTexture, in_texture(3, uv)).r;
  s.emission = material.emission.rgb * material.emission.a;
  if ((material.textureMask & 16) != 0) s.emission *= texture(emissionTexture, in_texture(4, uv)).rgb;
  s.fresnel = 0.08 * material.fresnel;  // the engine's unit: 0.5 is 4 %, which glTF gives everything that is no metal
  return s;
}
