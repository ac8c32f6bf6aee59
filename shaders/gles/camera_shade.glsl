// Shades the surface with the blend of its cameras, and the fill of unseen surface.
#include "camera_unseen.glsl"
out vec4 o_color;

void main() {
  vec3 normal = normalize(v_normal);
  o_color = blendCameras(v_point, normal, normalize(u_eye - v_point));
  if (o_color.a == 0.0 && u_fills) o_color = unseenColor(normal);
}
