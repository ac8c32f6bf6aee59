// SPDX-License-Identifier: Apache-2.0
// Averages Farnebäck's equations along y, and solves them.
out vec2 o_flow;
#include "flow_box.glsl"
const float kRegular = 1e-3 / 256.0;  // OpenCV's value, times the square of flow_matrices' scale

void main() {
  vec4 g;  // G11, G12, G22, h1
  float h2;
  average(g, h2);
  o_flow = vec2(g.x * h2 - g.y * g.w, g.z * g.w - g.y * h2) / (g.x * g.z - g.y * g.y + kRegular);
}
