// Camera of each of the eight slots of a field; negative: none. For passes with a texel per vertex.
#include "tables.glsl"
uniform vec4 u_slot_cameras[2];
uniform usampler2D u_vertex_masks;  // [member][vertex]; bit c: camera c is in the set of every incident face
uniform int u_first;                // first row of the member's vertices in the table
uniform int u_vertex_count;

int vertexHere() { return int(gl_FragCoord.y) * TABLE_WIDTH + int(gl_FragCoord.x); }
uint maskAt(int vertex) { return texelFetch(u_vertex_masks, tableTexel(u_first + vertex), 0).r; }
float seenIn(uint mask, float camera) { return camera < 0.0 ? 0.0 : float((mask >> uint(camera)) & 1u); }

vec4 seen(uint mask, vec4 cameras) {
  return vec4(seenIn(mask, cameras.x), seenIn(mask, cameras.y), seenIn(mask, cameras.z), seenIn(mask, cameras.w));
}
