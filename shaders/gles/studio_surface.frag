// SPDX-License-Identifier: Apache-2.0
// Albedo × folds × lights + highlight, in sRGB-encoded values. Opaque: coverage becomes alpha by multisampling.
uniform sampler2D albedo;
uniform vec3 eye;
uniform vec4 shading;  // wrinkles, specular, shading, unused; 0…1 each
uniform vec2 motion;  // motion in 0…1, phase 0…1
in vec2 v_uv;
in vec3 v_world, v_normal, v_rest;
out vec4 color;

const float TAU = 6.2831853;
const vec3 KEY_LIGHT = vec3(0.35, 0.80, 0.49);

// Ridges about 6 cm apart that wander over the cloth with the motion; mean 0.
float folds(vec3 p) {
  float shift = 0.8 * motion.x + 0.15 * sin(TAU * motion.y);
  float bend = sin(9.0 * p.x + 3.0 * p.z);
  float ridge = 0.5 + 0.5 * sin(TAU * (p.y / 0.062 + 0.6 * p.x / 0.062 + 0.25 * bend + shift));
  float here = 0.5 + 0.5 * sin(7.0 * p.y + 5.0 * p.x * p.x + 2.0);
  return here * (ridge * ridge * ridge - 0.3125);
}

void main() {
  vec3 to_eye = normalize(eye - v_world);
  vec3 n = normalize(v_normal);
  if (dot(n, to_eye) < 0.0) n = -n;
  float light = 0.62 + 0.38 * (0.5 + 0.5 * dot(n, KEY_LIGHT));
  float highlight = pow(max(dot(n, normalize(KEY_LIGHT + to_eye)), 0.0), 40.0);
  vec3 c = texture(albedo, v_uv).rgb;
  c *= 1.0 + 0.6 * shading.x * folds(v_rest);
  c *= mix(1.0, light, shading.z);
  color = vec4(clamp(c + shading.y * highlight, 0.0, 1.0), 1.0);
}
