// The light that a surface sends to the camera. All vectors are of the world and have length 1.
//
// Matt: Lambert. Shining: the microfacet model of B. Karis, "Real Shading in Unreal Engine 4", SIGGRAPH 2013
// (https://blog.selfshadow.com/publications/s2013-shading-course/): GGX distribution with alpha = roughness²,
// Schlick's shadowing with k = (roughness + 1)² / 8, and his approximation of Fresnel's term.

const float PI = 3.14159265;

// The share of a square of 3 × 3 texels of the shadow map, around the point, that the key light reaches there.
//
// The square lies between texels: the 16 it touches count fully inside and by the share that it covers at the edges.
// A gather fetches four of them, so that four do.
float reached(vec3 point) {
  LightView view = views.directionalLightBuffers[0];
  vec4 seen = view.projectionMatrix * (view.viewMatrix * vec4(point, 1.0));
  vec2 size = vec2(textureSize(samplerDirectionalLightDepths[0], 0));
  vec2 texel = (0.5 * seen.xy + 0.5) * size - 0.5;
  vec2 corner = floor(texel), over = fract(texel);
  float sum = 0.0;
  for (int row = 0; row < 2; row++) {
    vec2 y = row == 0 ? vec2(1.0 - over.y, 1.0) : vec2(1.0, over.y);
    for (int column = 0; column < 2; column++) {
      vec2 x = column == 0 ? vec2(1.0 - over.x, 1.0) : vec2(1.0, over.x);
      vec2 between = corner + vec2(2 * column, 2 * row);
      vec4 depth = textureGather(samplerDirectionalLightDepths[0], between / size);
      vec4 free = step(vec4(seen.z), depth);  // (left, upper), (right, upper), (right, lower), (left, lower)
      sum += dot(x, free.wz) * y.x + dot(x, free.xy) * y.y;
    }
  }
  return sum / 9.0;
}

// The share of a light, its emission 1: what is matt and what shines.
vec3 reflected(Surface s, vec3 normal, vec3 to_light, vec3 to_camera) {
  vec3 between = normalize(to_light + to_camera);
  float light = max(dot(normal, to_light), 0.0);
  float sight = clamp(dot(normal, to_camera), 1e-6, 1.0);
  float facet = clamp(dot(normal, between), 1e-6, 1.0);
  float tilt = clamp(dot(to_camera, between), 1e-6, 1.0);

  float alpha2 = pow(s.roughness, 4.0);
  float spread = facet * facet * (alpha2 - 1.0) + 1.0;
  float k = (s.roughness + 1.0) * (s.roughness + 1.0) / 8.0;
  float hidden = mix(light, 1.0, k) * mix(sight, 1.0, k);
  vec3 straight = mix(vec3(s.fresnel), s.base, s.metallic);
  vec3 fresnel = straight + (1.0 - straight) * exp2((-5.55473 * tilt - 6.98316) * tilt);

  vec3 matt = (1.0 - s.metallic) * s.base / PI;
  return light * (matt + fresnel * alpha2 / clamp(4.0 * PI * spread * spread * hidden, 1e-6, 4.0 * PI));
}

vec3 lit(Surface s, vec3 point, vec3 normal, vec3 to_camera) {
  vec3 to_light = -scene.directionalLights[0].direction.xyz;
  vec3 key = scene.directionalLights[0].emission.rgb * reflected(s, normal, to_light, to_camera);
  if (NUM_DIRECTIONAL_LIGHT_SHADOWS > 0 && dot(normal, to_light) > 0.0) key *= reached(point);
  vec3 sum = s.emission + scene.ambientLight.rgb * s.base + key;
  for (int i = 1; i < NUM_DIRECTIONAL_LIGHTS; i++) {
    DirectionalLight other = scene.directionalLights[i];
    sum += other.emission.rgb * reflected(s, normal, -other.direction.xyz, to_camera);
  }
  return sum;
}
