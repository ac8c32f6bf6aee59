// The frame's mesh as tables: corner 3*face+k → vertex index; vertex → position and normal, two texels.
#include "tables.glsl"
uniform usampler2D u_corner_vertices;
uniform sampler2D u_positions_normals;

int vertexOf(int corner) { return int(texelFetch(u_corner_vertices, tableTexel(corner), 0).r); }
vec3 positionOf(int vertex) { return texelFetch(u_positions_normals, tableTexel(2 * vertex), 0).xyz; }
vec3 normalOf(int vertex) { return texelFetch(u_positions_normals, tableTexel(2 * vertex + 1), 0).xyz; }
