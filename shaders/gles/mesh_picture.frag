// SPDX-License-Identifier: Apache-2.0
// Looks up a picture of the same mesh and view at this pixel. Alpha is the mesh's coverage, supplied by this draw.
uniform sampler2D u_shown;  // premultiplied, the target's size
out vec4 o_color;

void main() {
  vec4 shown = texelFetch(u_shown, ivec2(gl_FragCoord.xy), 0);
  o_color = vec4(shown.rgb / max(shown.a, 1.0 / 255.0), 1.0);
}
