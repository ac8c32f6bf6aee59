// SPDX-License-Identifier: Apache-2.0
// Looks up a picture of the same surface and view at this pixel. The picture has one sample a pixel: where the surface
// covers a pixel without its centre, neighbouring pixels are used.
uniform sampler2D u_shown;  // premultiplied, the view's size; alpha 0: empty
uniform vec2 u_origin;      // view pixel at the target's corner
out vec4 o_color;

void main() {
  ivec2 here = ivec2(u_origin + gl_FragCoord.xy), last = textureSize(u_shown, 0) - 1;
  vec4 shown = texelFetch(u_shown, here, 0);
  if (shown.a == 0.0)
    for (int i = 0; i < 9; ++i) shown += texelFetch(u_shown, clamp(here + ivec2(i % 3, i / 3) - 1, ivec2(0), last), 0);
  o_color = shown.a > 0.0 ? vec4(shown.rgb / shown.a, 1.0) : vec4(0.0);
}
