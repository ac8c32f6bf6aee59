// Vertices pulled from CharacterModel's tables; gl_VertexID counts corners, three a face.
#include "tables.glsl"
uniform sampler2D u_corners;            // uv.x, uv.y, vertex index, unused
uniform sampler2D u_positions_normals;  // two texels a vertex

struct Corner {
  vec2 uv;
  int vertex;
};

Corner fetchCorner(int corner) {
  vec4 texel = texelFetch(u_corners, tableTexel(corner), 0);
  return Corner(texel.xy, int(texel.z + 0.5));
}

vec3 fetchPosition(int vertex) { return texelFetch(u_positions_normals, tableTexel(2 * vertex), 0).xyz; }
vec3 fetchNormal(int vertex) { return texelFetch(u_positions_normals, tableTexel(2 * vertex + 1), 0).xyz; }
