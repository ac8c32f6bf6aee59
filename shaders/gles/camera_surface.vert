// SPDX-License-Identifier: Apache-2.0
// A surface textured from cameras. Draw 3 * face_count vertices.
#include "character_vertex.glsl"
uniform mat4 u_clip_from_character;
centroid out vec3 v_point;   // character's frame, metres
centroid out vec3 v_normal;
out vec3 v_pixel_point;      // v_point at the pixel centre, for derivatives
out vec3 v_corner;           // barycentric, at the pixel centre, for derivatives
invariant gl_Position;       // matched by style_mesh.vert
#ifdef FILLED
uniform sampler2D u_fill;    // a texel per vertex: colour; alpha 0: unknown
centroid out vec4 v_fill;    // premultiplied
#endif
#ifdef FIELDS
uniform sampler2D u_field_low;   // a texel per vertex: values of the cameras in slots 0-3
uniform sampler2D u_field_high;  // 4-7
centroid out vec4 v_low;
centroid out vec4 v_high;
#endif

void main() {
  int vertex = vertexOf(gl_VertexID);
  v_point = fetchPosition(vertex);
  v_normal = fetchNormal(vertex);
  v_pixel_point = v_point;
  v_corner = vec3(equal(ivec3(gl_VertexID % 3), ivec3(0, 1, 2)));
#ifdef FILLED
  vec4 fill = texelFetch(u_fill, tableTexel(vertex), 0);
  v_fill = vec4(fill.rgb * fill.a, fill.a);
#endif
#ifdef FIELDS
  v_low = texelFetch(u_field_low, tableTexel(vertex), 0);
  v_high = texelFetch(u_field_high, tableTexel(vertex), 0);
#endif
  gl_Position = u_clip_from_character * vec4(v_point, 1.0);
}
