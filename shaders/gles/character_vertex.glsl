// Vertices pulled from CharacterModel's tables; gl_VertexID counts corners, three per face. INDEXED: surfaces without
// texture coordinates, with a topology that may change every frame.
#include "tables.glsl"
uniform sampler2D u_positions_normals;  // two texels per vertex
#ifdef INDEXED
uniform usampler2D u_corner_vertices;   // a texel per corner

int vertexOf(int corner) { return int(texelFetch(u_corner_vertices, tableTexel(corner), 0).r); }
#else
uniform sampler2D u_corners;            // two texels per corner: uv, vertex index, unused; uv_from_tangents by columns

struct Corner {
  vec2 uv;
  int vertex;
};

Corner fetchCorner(int corner) {
  vec4 texel = texelFetch(u_corners, tableTexel(2 * corner), 0);
  return Corner(texel.xy, int(texel.z + 0.5));
}

mat2 fetchUvFromTangents(int corner) {
  vec4 texel = texelFetch(u_corners, tableTexel(2 * corner + 1), 0);
  return mat2(texel.xy, texel.zw);
}

int vertexOf(int corner) { return fetchCorner(corner).vertex; }
#endif

vec3 fetchPosition(int vertex) { return texelFetch(u_positions_normals, tableTexel(2 * vertex), 0).xyz; }
vec3 fetchNormal(int vertex) { return texelFetch(u_positions_normals, tableTexel(2 * vertex + 1), 0).xyz; }
