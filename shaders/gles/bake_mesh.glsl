#include "tables.glsl"
// The mesh of one frame as tables: corner 3*face+k → (uv, vertex index, unused); vertex → position in world, metres.
uniform sampler2D corners;
uniform sampler2D positions;

vec4 cornerOf(int corner) { return texelFetch(corners, tableTexel(corner), 0); }
vec3 positionOf(vec4 corner) { return texelFetch(positions, tableTexel(int(corner.z)), 0).xyz; }
