// Vertex shader of layered characters; writes layered_varyings.glsl.
#include "character_vertex.glsl"
#define VARYING out
#include "layered_varyings.glsl"
uniform usampler2D u_vertex_masks;  // [member][vertex]; bit c: camera c is in the set of every incident face
uniform usampler2D u_labels;        // [member][face]; 5 bits per rank, 31 empty
uniform mat4 u_clip_from_character;
uniform vec4 u_members[MEMBERS];    // per drawn member m: its number in the appearance, its weight
uniform int u_vertex_count;
uniform int u_face_count;
invariant gl_Position;              // matched by mesh_picture.vert

float maskOf(uint camera, uint mask) { return camera == kEmpty ? 0.0 : float((mask >> camera) & 1u); }

#ifdef ALIGNED
uniform sampler2D u_alignment;  // [member - 1][vertex]; metres along the tangents, from member 0's content

vec2 displacementOf(int m, int vertex) {
  int member = int(u_members[m].x);
  return member == 0 ? vec2(0.0) : texelFetch(u_alignment, tableTexel((member - 1) * u_vertex_count + vertex), 0).xy;
}

// Moves all members to the weighted mean of their displacements (algorithms/alignment.md).
void align(int corner, int vertex) {
  mat2 uv_from_tangents = fetchUvFromTangents(corner);
  vec2 mean = vec2(0.0);
  for (int m = 0; m < MEMBERS; ++m) mean += u_members[m].y * displacementOf(m, vertex);
  for (int m = 0; m < MEMBERS; ++m)
    v_uv[m] += uv_from_tangents * (displacementOf(m, vertex) - mean);
}
#endif

void setCorner() {
  Corner corner = fetchCorner(gl_VertexID);
  v_point = fetchPosition(corner.vertex);
  v_normal = fetchNormal(corner.vertex);
  for (int m = 0; m < MEMBERS; ++m) {
    int member = int(u_members[m].x);
    uint mask = texelFetch(u_vertex_masks, tableTexel(member * u_vertex_count + corner.vertex), 0).r;
    uint labels = texelFetch(u_labels, tableTexel(member * u_face_count + gl_VertexID / 3), 0).r;
    v_uv[m] = corner.uv;
    v_labels[m] = labels;
    for (int rank = 0; rank < LAYERS; ++rank) {
      int i = m * LAYERS + rank;
      v_masks[i / 4][i % 4] = maskOf((labels >> uint(5 * rank)) & kEmpty, mask);
    }
  }
#ifdef ALIGNED
  align(gl_VertexID, corner.vertex);
#endif
  gl_Position = u_clip_from_character * vec4(v_point, 1.0);
}
