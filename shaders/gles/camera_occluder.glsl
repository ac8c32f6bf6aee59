// Dilated depth discontinuities (M4D 4.2): surface behind an occluder's outline in a camera's picture, or within a few
// pixels of it, is not textured from that camera. Include camera_blend.glsl first.
uniform float u_discontinuity;  // pixels beyond the outline; at most the 8 that depth maps reserve

const vec2 kRound[8] = vec2[8](vec2(1, 0), vec2(0.7071), vec2(0, 1), vec2(-0.7071, 0.7071), vec2(-1, 0), vec2(-0.7071),
                               vec2(0, -1), vec2(0.7071, -0.7071));

bool isNearOccluder(vec3 at, float cosine, int i, float reach) {
  if (u_reach < 0.0 || reach <= 0.0) return false;
  float slope = sqrt(max(1.0 - cosine * cosine, 0.0)) / max(cosine, 0.05);
  float near = at.z - u_depth_bias - (reach + u_reach / u_pixel_spans[i].y) * slope * at.z * u_pixel_spans[i].x;
  for (int k = 0; k < 8; ++k)
    if (mappedDepth(clamp(at.xy + reach * kRound[k], vec2(0.5), u_sizes_near_far[i].xy - 0.5), i) < near) return true;
  return false;
}
