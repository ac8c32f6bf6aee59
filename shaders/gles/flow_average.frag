// SPDX-License-Identifier: Apache-2.0
// Averages Farnebäck's equations along x.
layout(location = 0) out vec4 o_first;
layout(location = 1) out vec2 o_second;
#include "flow_box.glsl"

void main() { average(o_first, o_second.x); }
