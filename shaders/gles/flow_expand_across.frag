// SPDX-License-Identifier: Apache-2.0
// Polynomial expansion, along x: coefficients of y, x, y², x² (a, b) and of xy (a's, b's).
layout(location = 0) out vec4 o_a;
layout(location = 1) out vec4 o_b;
layout(location = 2) out vec2 o_mixed;
uniform sampler2D u_a, u_b;
uniform vec4 u_taps[8];   // the uniform of flow_expand_down
uniform vec4 u_inverse;   // inverse moments: entries 11, 03, 33, 55
uniform int u_side;

// y, x, y², x²; then xy
void expand(sampler2D moments, out vec4 simple, out float mixed) {
  ivec2 at = ivec2(gl_FragCoord.xy);
  int last = textureSize(moments, 0).x - 1;
  vec3 own = texelFetch(moments, at, 0).xyz * u_taps[0].x;
  float b1 = own.x, b2 = 0.0, b3 = own.y, b4 = 0.0, b5 = own.z, b6 = 0.0;
  for (int k = 1; k <= u_side; ++k) {
    vec3 tap = u_taps[k].xyz;
    vec3 low = texelFetch(moments, ivec2(max(at.x - k, 0), at.y), 0).xyz;
    vec3 high = texelFetch(moments, ivec2(min(at.x + k, last), at.y), 0).xyz;
    vec3 sum = high + low;
    b1 += sum.x * tap.x;
    b2 += (high.x - low.x) * tap.y;
    b3 += sum.y * tap.x;
    b4 += sum.x * tap.z;
    b5 += sum.z * tap.x;
    b6 += (high.y - low.y) * tap.y;
  }
  simple = vec4(vec2(b3, b2) * u_inverse.x, b1 * u_inverse.y + vec2(b5, b4) * u_inverse.z);
  mixed = b6 * u_inverse.w;
}

void main() {
  expand(u_a, o_a, o_mixed.x);
  expand(u_b, o_b, o_mixed.y);
}
