// SPDX-License-Identifier: Apache-2.0
// One direction of a pyramid level as in OpenCV: Gaussian blur (borders mirrored), then linear resize; two lumas.
out vec4 o_luma;
uniform sampler2D u_from;
uniform int u_down;     // 0: along x, 1: along y
uniform vec3 u_blur;    // texels of u_from per texel, taps on each side, 1 / (2 sigma²)
uniform vec2 u_values;  // offset x is subtracted, then the factor y applied

float weight(int tap) { return abs(tap) <= int(u_blur.y) ? exp(-float(tap * tap) * u_blur.z) : 0.0; }

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  int last = textureSize(u_from, 0)[u_down] - 1;
  float centre = (float(at[u_down]) + 0.5) * u_blur.x - 0.5;
  int first = int(floor(centre));
  float part = centre - float(first);
  vec3 sum = vec3(0.0);
  for (int tap = -int(u_blur.y); tap <= int(u_blur.y) + 1; ++tap) {
    at[u_down] = last - abs(last - abs(first + tap));
    sum += mix(weight(tap), weight(tap - 1), part) * vec3(texelFetch(u_from, at, 0).xy, 1.0);
  }
  o_luma = vec4((sum.xy / sum.z - u_values.x) * u_values.y, 0.0, 1.0);
}
