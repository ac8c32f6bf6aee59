// SPDX-License-Identifier: Apache-2.0
// Edges of a camera's depth map as wide lines that overlap the contour (OVH03 5.2.2; Ming Li, Marcus Magnor, Hans-Peter
// Seidel: Online Accelerated Rendering of Visual Hulls in Real Scenes. Journal of WSCG 11, 2003). A face's lines lie
// behind it by its slope times half the line width. Draw 18 * face_count vertices.
#include "character_vertex.glsl"
uniform mat4 u_clip_from_character;
uniform vec3 u_centre;          // camera centre, world
uniform vec2 u_clip_per_texel;
uniform vec2 u_near_far;        // metres
uniform float u_half_width;     // texels
uniform float u_texel_span;     // metres per texel at a depth of 1 m
uniform bool u_closed;          // closed surface: back faces get no lines

const float kBehind = 0.005;    // metres, on flat faces
const float kMinCosine = 0.25;
const ivec2 kCorners[6] = ivec2[6](ivec2(0, -1), ivec2(0, 1), ivec2(1, -1), ivec2(1, -1), ivec2(0, 1), ivec2(1, 1));

void main() {
  int face = gl_VertexID / 18, edge = gl_VertexID / 6 % 3;
  ivec2 corner = kCorners[gl_VertexID % 6];
  vec3 points[3];
  for (int k = 0; k < 3; ++k) points[k] = fetchPosition(vertexOf(3 * face + k));
  vec3 normal = cross(points[1] - points[0], points[2] - points[0]);
  vec3 from = points[edge], to = points[(edge + 1) % 3];
  float facing = dot(normalize(normal), normalize(u_centre - from));
  if (!(length(normal) > 0.0) || (u_closed && facing < 0.0)) {
    gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
    return;
  }
  vec4 first = u_clip_from_character * vec4(from, 1.0), last = u_clip_from_character * vec4(to, 1.0);
  vec2 along = (last.xy / last.w - first.xy / first.w) / u_clip_per_texel;
  along = length(along) > 1e-4 ? normalize(along) : vec2(1.0, 0.0);
  vec2 aside = float(corner.y) * vec2(-along.y, along.x) + float(2 * corner.x - 1) * along;
  vec4 at = corner.x == 0 ? first : last;
  float cosine = max(abs(facing), kMinCosine), slope = sqrt(max(1.0 - cosine * cosine, 0.0)) / cosine;
  float depth = at.w + kBehind + u_half_width * slope * at.w * u_texel_span;
  float near = u_near_far.x, far = u_near_far.y;
  vec2 place = at.xy / at.w + u_half_width * aside * u_clip_per_texel;
  gl_Position = vec4(place * depth, ((far + near) * depth - 2.0 * far * near) / (far - near), depth);
}
