// Cells of a surface's box, CELLS along each axis, as a square texture, for lookup of vertices by position.
#include "tables.glsl"
uniform vec3 u_cells_per_metre;

ivec3 cellOf(vec3 place) {  // place: relative to the box's minimum corner, metres
  return ivec3(clamp(place * u_cells_per_metre, vec3(0.0), vec3(float(CELLS) - 0.5)));
}

ivec2 cellTexel(ivec3 cell) {
  int index = cell.x + CELLS * (cell.y + CELLS * cell.z);
  return ivec2(index % CELL_TEXELS, index / CELL_TEXELS);
}
