// SPDX-License-Identifier: Apache-2.0
// Visibility of each vertex from each slot's camera (M4D Eq. 2 and 4): it is in the picture, faces the camera, has no
// occluder nearby in the depth map, and enough of the other cameras that see it agree with its colour (M4D Eq. 3).
// VOTES_ONLY: 0 where the colour was outvoted, else 1. A texel per vertex.
#include "character_vertex.glsl"
#include "camera_blend.glsl"
#include "camera_occluder.glsl"
#include "camera_slots.glsl"
uniform int u_vertex_count;
uniform vec4 u_used_low;         // 1 where the slot holds a camera
uniform vec4 u_used_high;
uniform float u_vote_threshold;  // colour distance in Lab, with L in 0…1; 0: no vote
uniform float u_vote_reach;      // pixels from an occluder within which votes are held; negative: everywhere
layout(location = 0) out vec4 o_low;
layout(location = 1) out vec4 o_high;

const float kCoarse = 3.0;  // pixels between the samples of the coarse level

float cameraWeight(vec3 to_camera, float cosine, vec3 to_eye) { return 0.0; }

vec3 labColor(vec3 encoded) {  // sRGB, D65
  vec3 linear = mix(encoded / 12.92, pow((encoded + 0.055) / 1.055, vec3(2.4)), step(0.04045, encoded));
  vec3 xyz = mat3(0.4339, 0.2126, 0.0177, 0.3762, 0.7152, 0.1095, 0.1899, 0.0722, 0.8727) * linear;
  vec3 f = mix(7.787 * xyz + 16.0 / 116.0, pow(xyz, vec3(1.0 / 3.0)), step(0.008856, xyz));
  return vec3(1.16 * f.y - 0.16, 5.0 * (f.x - f.y), 2.0 * (f.y - f.z));
}

// Returns the colour round a pixel: one sample, or the mean of nine.
vec3 levelColor(vec2 pixel, int i, float spacing) {
  if (spacing == 0.0) return labColor(pictureColor(pixel, i).rgb);
  vec4 sum = vec4(0.0);
  for (int k = 0; k < 9; ++k) {
    vec4 texel = pictureColor(pixel + spacing * (vec2(k % 3, k / 3) - 1.0), i);
    sum += vec4(texel.rgb * texel.a, texel.a);
  }
  return labColor(sum.rgb / max(sum.a, 1e-4));
}

void main() {
  o_low = o_high = vec4(0.0);
  int vertex = int(gl_FragCoord.y) * TABLE_WIDTH + int(gl_FragCoord.x);
  if (vertex >= u_vertex_count) return;
  vec3 point = fetchPosition(vertex), normal = normalize(fetchNormal(vertex));
  bool sees[CAMERAS], asked[CAMERAS], agrees[CAMERAS];
  vec2 pixels[CAMERAS];
  vec3 colors[CAMERAS];
  int count = 0;
  for (int i = 0; i < CAMERAS; ++i) {
    vec3 at = projected(point, i);
    float cosine = dot(normal, normalize(u_centres[i].xyz - point));
    sees[i] = slotOf(u_used_low, u_used_high, i) > 0.5 && at.z > 0.0 && cosine > u_least_cosine &&
              !isHidden(at, cosine, i) && !isNearOccluder(at, cosine, i, u_discontinuity) &&
              pictureColor(at.xy, i).a > 0.0;
    asked[i] = sees[i] && u_vote_threshold > 0.0 &&
               (u_vote_reach < 0.0 || isNearOccluder(at, cosine, i, u_vote_reach));
    agrees[i] = !asked[i];
    pixels[i] = at.xy;
    count += int(sees[i]);
  }
  // Votes from coarse to fine: agreement with enough others at one level suffices.
  bool any_asked = false;
  for (int i = 0; i < CAMERAS; ++i) any_asked = any_asked || asked[i];
  for (int level = 0; any_asked && level < 2; ++level) {
    for (int i = 0; i < CAMERAS; ++i)
      if (sees[i]) colors[i] = levelColor(pixels[i], i, level == 0 ? kCoarse : 0.0);
    for (int i = 0; i < CAMERAS; ++i) {
      if (agrees[i]) continue;
      int votes = 0;
      for (int j = 0; j < CAMERAS; ++j)
        votes += int(j != i && sees[j] && distance(colors[i], colors[j]) < u_vote_threshold);
      agrees[i] = votes >= count / 2;
    }
  }
  for (int i = 0; i < CAMERAS; ++i) {
#ifdef VOTES_ONLY
    setSlot(o_low, o_high, i, float(agrees[i] && slotOf(u_used_low, u_used_high, i) > 0.5));
#else
    setSlot(o_low, o_high, i, float(sees[i] && agrees[i]));
#endif
  }
}
