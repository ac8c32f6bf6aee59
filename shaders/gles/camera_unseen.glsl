// The colour of what no camera sees: its neighbourhood's (FILLED), else that of the camera that faces it best.
#include "camera_blend.glsl"
centroid in vec3 v_point;   // character's frame, metres
centroid in vec3 v_normal;
#ifdef FILLED
centroid in vec4 v_fill;    // premultiplied; alpha 0: nothing near is seen either
#endif
uniform vec3 u_eye;
uniform bool u_fills;       // else it is left transparent

vec4 unseenColor(vec3 normal) {
#ifdef FILLED
  if (v_fill.a > 0.01) return vec4(v_fill.rgb / v_fill.a, 1.0);
#endif
  return vec4(bestFacingColor(v_point, normal), 1.0);
}
