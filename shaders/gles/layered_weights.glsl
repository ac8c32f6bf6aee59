// Blend weight of each rank at a fragment, before normalisation.
#define VARYING in
#include "layered_varyings.glsl"
#include "picture.glsl"
out vec4 o_color;

uniform vec4 u_members[MEMBERS];  // per drawn member m: its number in the appearance, its weight
uniform vec3 u_eye;
uniform vec4 u_camera_centres[MAX_CAMERAS];
uniform vec2 u_exponents;  // RecipeOptions::facing_exponent, view_exponent

// Sum of weights below which the first rank is used alone.
const float kMinSum = 1e-8;

uint labelOf(int m, int rank) { return (v_labels[m] >> uint(5 * rank)) & kEmpty; }

float rankWeight(int m, int rank, vec3 normal, vec3 to_eye) {
  int i = m * LAYERS + rank;
  float mask = v_masks[i / 4][i % 4];
  if (mask <= 0.0) return 0.0;
  vec3 direction = normalize(u_camera_centres[labelOf(m, rank)].xyz - v_point);
  float facing = max(dot(normal, direction), 0.0);
  float viewing = max(dot(direction, to_eye), 0.0);
  return mask * pow(facing, u_exponents.x) * pow(viewing, u_exponents.y);
}
