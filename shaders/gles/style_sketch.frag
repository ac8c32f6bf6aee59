// SPDX-License-Identifier: Apache-2.0
// Sketchy stippling (M4D 6.1) with two look-ups: the picture, and a blur of it that takes one random place nearby
// a dot and is lifted towards white by as much chance. Colour dodge with the inverted blur leaves white where both agree
// and darkens the dark sides of edges; where the blur is lifted, a dot is as dark as the picture. What lies round the figure
// counts as white paper, so that it gets an outline.
#include "style_shown.glsl"
uniform int u_grain;    // pixels: a dot's side
uniform float u_reach;  // pixels: how far the blur looks
uniform vec2 u_origin;  // pixel of the view that the target begins at

const float kContrast = 2.0;

const float kLifted = 0.25;  // of the dots, by and by

// Numbers of 0..1 by the dot's place alone (integers only, so that every GPU has the same).
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
  vec3 inverted = (1.0 - lift) * (beside.a - beside.rgb);  // of the blur on white
  vec3 dodged = min(straight(shown) / max(1.0 - inverted, 1.0 / 255.0), 1.0);
  float grey = pow(dot(dodged, vec3(0.2126, 0.7152, 0.0722)), kContrast);
  show(shown, vec3(grey));
}
