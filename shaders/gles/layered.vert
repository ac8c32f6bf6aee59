// SPDX-License-Identifier: Apache-2.0
// Corners of the character with, per layer slot, the vector to the slot's camera and its seam mask (ALGORITHMS 2).
#include "character_vertex.glsl"
uniform usampler2D u_vertex_masks;  // bit c: camera c is in the set of every incident face
uniform usampler2D u_labels;        // 5 bits a slot, 31 empty
uniform mat4 u_clip_from_world;
uniform vec3 u_eye_in_world;
#ifdef PAPER_WEIGHTS
uniform vec3 u_view_axis;  // unit, of the viewing camera
uniform vec4 u_camera_forwards[MAX_CAMERAS];
#else
uniform vec4 u_camera_centres[MAX_CAMERAS];
#endif

out vec2 v_uv;
out vec3 v_normal;
out vec3 v_to_eye;             // world, not unit
out vec4 v_to_camera[LAYERS];  // xyz world, not unit, linear over the face; w seam mask
flat out uint v_labels;

const uint kEmpty = 31u;

vec4 toCamera(uint camera, vec3 point, uint mask) {
  if (camera == kEmpty) return vec4(0.0);
#ifdef PAPER_WEIGHTS
  return vec4(-u_camera_forwards[camera].xyz, 1.0);
#else
  return vec4(u_camera_centres[camera].xyz - point, float((mask >> camera) & 1u));
#endif
}

void main() {
  Corner corner = fetchCorner(gl_VertexID);
  vec3 point = fetchPosition(corner.vertex);
  uint mask = texelFetch(u_vertex_masks, tableTexel(corner.vertex), 0).r;
  v_labels = texelFetch(u_labels, tableTexel(gl_VertexID / 3), 0).r;
  v_uv = corner.uv;
  v_normal = fetchNormal(corner.vertex);
#ifdef PAPER_WEIGHTS
  v_to_eye = -u_view_axis;
#else
  v_to_eye = u_eye_in_world - point;
#endif
  for (int slot = 0; slot < LAYERS; ++slot)
    v_to_camera[slot] = toCamera((v_labels >> uint(5 * slot)) & kEmpty, point, mask);
  gl_Position = u_clip_from_world * vec4(point, 1.0);
}
