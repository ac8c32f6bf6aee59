// SPDX-License-Identifier: Apache-2.0
// What a picture of the same surface and view has at this pixel. The picture has one sample a pixel: where the surface
// covers only a part of a pixel whose middle it misses, the pixels round it answer.
uniform sampler2D u_shown;  // premultiplied, of the view's size; alpha 0: nothing
uniform vec2 u_origin;      // pixel of the view that the target begins at
out vec4 o_color;

void main() {
  ivec2 here = ivec2(u_origin + gl_FragCoord.xy), last = textureSize(u_shown, 0) - 1;
  vec4 shown = texelFetch(u_shown, here, 0);
  if (shown.a == 0.0)
    for (int i = 0; i < 9; ++i) shown += texelFetch(u_shown, clamp(here + ivec2(i % 3, i / 3) - 1, ivec2(0), last), 0);
  o_color = shown.a > 0.0 ? vec4(shown.rgb / shown.a, 1.0) : vec4(0.0);
}
