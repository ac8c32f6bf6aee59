// SPDX-License-Identifier: Apache-2.0
// Relighting: light from nine coefficients at the normal in the viewer's frame (M4D Eq. 6-7) brightens or darkens the
// picture (M4D Eq. 8); half of the range is neutral. Blends encoded values, as the paper does.
#include "style_shown.glsl"
centroid in vec3 v_normal;            // character's frame
uniform mat4 u_light_from_character;  // a rotation
uniform vec4 u_light[9];              // render/styles/light.h

vec3 lightAt(vec3 d) {
  vec3 first = 0.488603 * (d.y * u_light[1].rgb + d.z * u_light[2].rgb + d.x * u_light[3].rgb);
  vec3 second = 1.092548 * (d.x * d.y * u_light[4].rgb + d.y * d.z * u_light[5].rgb + d.x * d.z * u_light[7].rgb) +
                0.315392 * (3.0 * d.z * d.z - 1.0) * u_light[6].rgb +
                0.546274 * (d.x * d.x - d.y * d.y) * u_light[8].rgb;
  return clamp(0.282095 * u_light[0].rgb + first + second, 0.0, 1.0);
}

void main() {
  vec4 shown = shownAt(ivec2(gl_FragCoord.xy));
  vec3 color = straight(shown);
  vec3 light = lightAt(normalize(mat3(u_light_from_character) * v_normal));
  show(shown, color + abs(1.0 - 2.0 * light) * (pow(color, 1.5 - light) - color));
}
