// SPDX-License-Identifier: Apache-2.0
// Mean of the equations over an odd window, in one direction; linear filtering reads two texels per fetch.
in vec2 v_uv;
uniform sampler2D u_first, u_second;
uniform vec2 u_step;  // one texel along the direction, texture coordinates
uniform int u_window;

void average(out vec4 first, out float second) {
  first = texture(u_first, v_uv + float(u_window / 2) * u_step);
  second = texture(u_second, v_uv + float(u_window / 2) * u_step).x;
  for (int i = -(u_window / 2); i < u_window / 2; i += 2) {
    vec2 at = v_uv + (float(i) + 0.5) * u_step;
    first += 2.0 * texture(u_first, at);
    second += 2.0 * texture(u_second, at).x;
  }
  first /= float(u_window);
  second /= float(u_window);
}
