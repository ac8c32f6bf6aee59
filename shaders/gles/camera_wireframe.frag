// SPDX-License-Identifier: Apache-2.0
// Edges of the surface, a pixel wide, on plain shading.
centroid in vec3 v_point;
centroid in vec3 v_normal;
in vec3 v_corner;  // barycentric
uniform vec3 u_eye;
out vec4 o_color;

void main() {
  vec3 pixels = v_corner / max(fwidth(v_corner), vec3(1e-6));
  float line = 1.0 - smoothstep(0.3, 1.0, min(pixels.x, min(pixels.y, pixels.z)));
  float facing = abs(dot(normalize(v_normal), normalize(u_eye - v_point)));
  o_color = vec4(mix(vec3(0.55 + 0.4 * facing), vec3(0.1, 0.2, 0.35), line), 1.0);
}
