// Colour of unseen surface: the fill from nearby surface (FILLED), otherwise that of the best-facing camera.
#include "camera_blend.glsl"
centroid in vec3 v_point;   // character's frame, metres
centroid in vec3 v_normal;
#ifdef FILLED
centroid in vec4 v_fill;    // premultiplied; alpha 0: the fill does not reach it
#endif
uniform vec3 u_eye;
uniform bool u_fills;       // false: unseen surface is transparent

vec4 unseenColor(vec3 normal) {
#ifdef FILLED
  if (v_fill.a > 0.01) return vec4(v_fill.rgb / v_fill.a, 1.0);
#endif
  return vec4(bestFacingColor(v_point, normal), 1.0);
}
