// Colour of a fragment, from the shares of the ranks (rankShares).
#ifdef ALIGNED
uniform float u_detail;  // contrast gain that compensates for the mean of several looks
const float kReach = 3.0;
#endif

// Returns the colour of drawn member m. ALIGNED: detail is restored against both neighbours on a diagonal that
// alternates between members.
vec3 memberColor(int m, vec3 normal, vec3 to_eye) {
  float shares[LAYERS];
  rankShares(m, normal, to_eye, shares);
  vec3 color = vec3(0.0);
#ifdef ALIGNED
  int main_rank = 0;
  vec3 main_color = vec3(0.0);
#endif
  for (int rank = 0; rank < LAYERS; ++rank) {
    if (shares[rank] <= 0.0) continue;
    vec3 layer = sampleLayer(m * LAYERS + rank, v_uv[m]);
    color += shares[rank] * layer;
#ifdef ALIGNED
    if (shares[rank] >= shares[main_rank]) {
      main_rank = rank;
      main_color = layer;
    }
#endif
  }
#ifdef ALIGNED
  vec2 diagonal = vec2(kReach, m % 2 == 0 ? kReach : -kReach);
  color += u_detail * (dot(main_color, kLuma) - lumaBeside(m * LAYERS + main_rank, v_uv[m], diagonal));
#endif
  return color;
}

#ifdef DEBUG_VIEW
uniform int u_debug_layer;

vec3 labelColor(uint label) {
  if (label == kEmpty) return vec3(0.25);
  vec3 hue = fract(float(label) * 0.618034 + vec3(0.0, 2.0, 1.0) / 3.0);
  return 0.15 + 0.85 * clamp(abs(hue * 6.0 - 3.0) - 1.0, 0.0, 1.0);
}

vec3 debugColor(vec3 normal, vec3 to_eye) {
#if DEBUG_VIEW == 1
  return labelColor(labelOf(0, u_debug_layer));
#elif DEBUG_VIEW == 2
  return sampleLayer(u_debug_layer, v_uv[0]);
#elif DEBUG_VIEW == 3
  float shares[LAYERS];
  rankShares(0, normal, to_eye, shares);
  vec3 shown = vec3(0.0);
  for (int rank = 0; rank < min(LAYERS, 3); ++rank) shown[rank] = shares[rank];
  return shown;
#else
  return normal * 0.5 + 0.5;
#endif
}
#endif

void main() {
  vec3 normal = normalize(v_normal);
  vec3 to_eye = normalize(u_eye - v_point);
#ifdef DEBUG_VIEW
  o_color = vec4(debugColor(normal, to_eye), 1.0);
#else
  vec3 color = vec3(0.0);
  for (int m = 0; m < MEMBERS; ++m) color += u_members[m].y * memberColor(m, normal, to_eye);
  o_color = vec4(color, 1.0);
#endif
}
