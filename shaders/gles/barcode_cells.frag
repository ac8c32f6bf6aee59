// SPDX-License-Identifier: Apache-2.0
// Mean luma of each cell of a picture's barcode, both copies side by side, a pixel per cell. Samples the middle half of
// a cell at 4 × 4 points.
#include "decoded_picture.glsl"
uniform vec4 u_strip;  // x, y, side of a cell, height; texels, origin top left
out vec4 o_color;

void main() {
  vec2 cell = vec2(u_strip.z, u_strip.w);
  vec2 corner = u_strip.xy + vec2(floor(gl_FragCoord.x) * u_strip.z, 0.0) + 0.25 * cell;
  vec3 sum = vec3(0.0);
  for (int i = 0; i < 16; ++i)
    sum += texelFetch(u_picture_rgba, ivec2(corner + cell * vec2(i % 4, i / 4) / 8.0), 0).rgb;
  o_color = vec4(vec3(dot(sum, kLuma) / 16.0), 1.0);
}
