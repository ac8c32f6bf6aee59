// SPDX-License-Identifier: Apache-2.0
// Soft visibility (FT Eq. 8), first of two passes: distance along the row to the nearest hidden pixel.
uniform sampler2D u_hidden;  // a channel per camera: 1 hidden
uniform float u_radius;      // pixels, below 255
out vec4 o_across;           // pixels / 255; 1: none within the radius

void main() {
  ivec2 here = ivec2(gl_FragCoord.xy);
  int reach = int(u_radius), last = textureSize(u_hidden, 0).x - 1;
  vec4 least = vec4(255.0);
  for (int x = max(here.x - reach, 0); x <= min(here.x + reach, last); ++x) {
    vec4 hidden = step(0.5, texelFetch(u_hidden, ivec2(x, here.y), 0));
    least = min(least, mix(vec4(255.0), vec4(abs(x - here.x)), hidden));
  }
  o_across = least / 255.0;
}
