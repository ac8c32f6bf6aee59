// SPDX-License-Identifier: Apache-2.0
// Soft visibility (FT Eq. 8), second pass: exact distance to the nearest hidden pixel, over the radius, at most 1,
// times the camera's weight.
uniform sampler2D u_across;   // output of camera_soft_across.frag
uniform sampler2D u_weights;  // a channel per camera
uniform float u_radius;       // pixels
out vec4 o_weights;

void main() {
  ivec2 here = ivec2(gl_FragCoord.xy);
  vec4 weights = texelFetch(u_weights, here, 0);
  if (weights == vec4(0.0)) {
    o_weights = weights;
    return;
  }
  int reach = int(u_radius), last = textureSize(u_across, 0).y - 1;
  vec4 square = vec4(u_radius * u_radius);
  for (int y = max(here.y - reach, 0); y <= min(here.y + reach, last); ++y) {
    vec4 across = floor(texelFetch(u_across, ivec2(here.x, y), 0) * 255.0 + 0.5);
    float down = float(y - here.y);
    square = min(square, mix(across * across + down * down, vec4(u_radius * u_radius), step(254.5, across)));
  }
  o_weights = weights * sqrt(square) / u_radius;
}
