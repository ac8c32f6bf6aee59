// SPDX-License-Identifier: Apache-2.0
// Stippling (M4D 6.1) with two lookups: the picture, and a one-sample blur of it at a random position near each dot,
// lifted towards white by a random amount. Colour dodge with the inverted blur gives white where both agree and darkens
// the dark sides of edges; where the blur is lifted, a dot is as dark as the picture. The surroundings of the figure
// count as white paper, which yields an outline.
#include "style_shown.glsl"
uniform int u_grain;    // side of a dot, pixels
uniform float u_reach;  // radius of the blur, pixels
uniform vec2 u_origin;  // view pixel at the target's corner

const float kContrast = 2.0;

const float kLifted = 0.25;  // share of lifted dots, with a soft transition

// Returns noise in 0..1 that depends on the dot's position only (integer arithmetic, equal on every GPU).
vec3 noiseAt(ivec2 dot) {
  uint n = uint(dot.x) * 1597334677u ^ uint(dot.y) * 3812015801u;
  n = (n ^ (n >> 15)) * 2246822519u;
  n = (n ^ (n >> 13)) * 3266489917u;
  n ^= n >> 16;
  return vec3(n & 1023u, (n >> 10) & 1023u, (n >> 20) & 1023u) / 1023.0;
}

void main() {
  ivec2 here = ivec2(gl_FragCoord.xy);
  vec4 shown = shownAt(here);
  vec3 noise = noiseAt((here + ivec2(u_origin)) / u_grain);
  float turn = 6.2831853 * noise.x;
  vec4 beside = shownAt(here + ivec2(round(u_reach * sqrt(noise.y) * vec2(cos(turn), sin(turn)))));
  float lift = smoothstep(1.0 - kLifted, 1.0, noise.z);
  vec3 inverted = (1.0 - lift) * (beside.a - beside.rgb);  // inverse of the blur over white
  vec3 dodged = min(straight(shown) / max(1.0 - inverted, 1.0 / 255.0), 1.0);
  float grey = pow(dot(dodged, vec3(0.2126, 0.7152, 0.0722)), kContrast);
  show(shown, vec3(grey));
}
