// SPDX-License-Identifier: Apache-2.0
// Blends the cameras at the point that the sweep found on each fragment's ray.
#include "camera_unseen.glsl"
#include "camera_sweep.glsl"
uniform sampler2D u_shifts;
uniform float u_reach_m;     // metres for a shift of 1
uniform float u_texels;      // texels of the shifts along a side of a pixel
uniform vec2 u_origin;       // view pixel at the target's corner
out vec4 o_color;

const float kSlack = 3.0;      // depth test slack, in shifts: occluders may be off as much as the surface
const float kSamePart = 0.01;  // approximate depth difference within one part of a person, metres

float cameraWeight(vec3 to_camera, float cosine, vec3 to_eye) { return cosine * max(dot(to_camera, to_eye), 0.0); }

// Returns the shift, interpolated within the same part of the surface; 0 without any.
float shiftHere(float depth) {
  vec2 at = (u_origin + gl_FragCoord.xy) * u_texels - 0.5, first = floor(at), share = at - first;
  ivec2 last = textureSize(u_shifts, 0) - 1;
  float shift = 0.0, sum = 0.0;
  for (int i = 0; i < 4; ++i) {
    ivec2 corner = ivec2(i & 1, i >> 1), texel = clamp(ivec2(first) + corner, ivec2(0), last);
    vec4 shown = texelFetch(u_shifts, texel, 0);
    if (shown.a == 0.0) continue;
    vec2 near = mix(1.0 - share, share, vec2(corner));
    float away = (surfaceDepth(texel) - depth) / (u_length_scale * kSamePart);
    float weight = (near.x * near.y + 1e-3) / (1.0 + away * away * away * away);
    shift += weight * unpackedShift(shown.xy);
    sum += weight;
  }
  return sum > 0.0 ? u_reach_m * shift / sum : 0.0;
}

// Blends like blendCameras at the moved point.
vec4 blendMoved(vec3 point, vec3 normal, vec3 to_eye, float moved) {
  vec3 color = vec3(0.0);
  float sum = 0.0;
  for (int i = 0; i < CAMERAS; ++i) {
    vec3 to_camera = normalize(u_centres[i].xyz - point);
    float cosine = dot(normal, to_camera);
    if (cosine <= u_least_cosine) continue;
    float weight = cameraWeight(to_camera, cosine, to_eye);
    if (weight <= 0.0) continue;
    vec3 at = projected(point, i);
    if (at.z <= 0.0 || isHidden(vec3(at.xy, at.z - kSlack * max(moved, 0.0)), cosine, i)) continue;
    vec4 texel = pictureColor(at.xy, i);
    color += weight * texel.a * texel.rgb;
    sum += weight * texel.a;
  }
  return sum > kMinSum ? vec4(color / sum, 1.0) : vec4(0.0);
}

void main() {
  vec3 normal = normalize(v_normal), to_eye = normalize(u_eye - v_point);
  float moved = shiftHere(1.0 / gl_FragCoord.w);
  o_color = blendMoved(v_point - moved * to_eye, normal, to_eye, moved);
  if (o_color.a == 0.0 && u_fills) o_color = unseenColor(normal);
}
