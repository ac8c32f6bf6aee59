// Neighbours of a vertex, for passes with a texel per vertex.
#include "tables.glsl"
uniform usampler2D u_neighbours;        // [vertex] start of its list, and the end; then the lists: pairs
uniform sampler2D u_positions_normals;  // two texels per vertex
uniform int u_vertex_count;

int neighbourTexel(int i) { return int(texelFetch(u_neighbours, tableTexel(i), 0).r); }
int vertexHere() { return int(gl_FragCoord.y) * TABLE_WIDTH + int(gl_FragCoord.x); }
vec3 fetchPosition(int vertex) { return texelFetch(u_positions_normals, tableTexel(2 * vertex), 0).xyz; }
