// SPDX-License-Identifier: Apache-2.0
// Plane sweep: photo-consistency cost of a surface at four depths per fragment. The target holds blocks of the
// reference's region one above another; block b has the depths 4 b … 4 b + 3, counted from the plane just before the
// hull's front. Cost 1: the point lies outside the hull, as a camera that sees it sees background.
out vec4 o_costs;
uniform highp sampler2DArray u_pictures;          // straight RGBA, alpha = matte
uniform highp sampler2D u_front;                  // metres, 0: no hull
uniform mat4 u_pixel_from_reference[CAMERAS];     // from (x z, y z, z, 1), pixels and metres
uniform vec4 u_layers[CAMERAS];                   // x: layer of u_pictures, y, z: its size in pixels. Sources go first
uniform vec4 u_region;                            // reference region: first column, first row, columns, rows
uniform vec2 u_texel;                             // one over the size of a layer
uniform float u_step;                             // metres between planes
const int kSide = 2 * RADIUS + 1;
const float kNoise = 0.0006;           // variance of three channels below which a patch counts as untextured
const float kBackground = 0.35;        // a matte below this, between its reduced samples, is background
const float kUnlike = 0.95, kUnknown = 0.9;  // costs of patches without any match, and of untextured ones

vec3 pixelIn(int camera, vec2 pixel, float depth) {
  return (u_pixel_from_reference[camera] * vec4(pixel * depth, depth, 1.0)).xyz;
}

vec4 pictureAt(int camera, vec3 q) { return texture(u_pictures, vec3(q.xy / q.z * u_texel, u_layers[camera].x)); }

// False where the camera sees the point before its background.
bool mayHold(int camera, vec2 pixel, float depth) {
  vec3 q = pixelIn(camera, pixel, depth);
  vec2 at = q.xy / q.z;
  if (q.z <= 0.0 || any(lessThan(at, vec2(0.5))) || any(greaterThan(at, u_layers[camera].yz - 0.5))) return true;
  return pictureAt(camera, q).a >= kBackground;
}

bool insideHull(vec2 pixel, float depth) {
  for (int c = 1; c < CAMERAS; ++c)
    if (!mayHold(c, pixel, depth)) return false;
  return true;
}

// Cost of the patches round the pixel in the first source and another, from 1 - correlation, colour difference and
// matte difference.
float pairCost(float weight, vec3 a, vec3 b, vec3 aa, vec3 bb, vec3 ab, float mattes) {
  float samples = float(kSide * kSide);
  if (weight < 0.25 * samples) return kUnknown;
  a /= weight, b /= weight;
  vec3 var_a = max(aa / weight - a * a, 0.0), var_b = max(bb / weight - b * b, 0.0), cov = ab / weight - a * b;
  float va = dot(var_a, vec3(1)) + kNoise, vb = dot(var_b, vec3(1)) + kNoise;
  float correlation = (dot(cov, vec3(1)) + kNoise) / sqrt(va * vb);
  float colour = min(dot(abs(a - b), vec3(1)) / 0.45, 1.0);
  return min(CORRELATION_SHARE * min(1.0 - correlation, 1.0) + (1.0 - CORRELATION_SHARE) * colour + 0.5 * mattes / samples, kUnlike);
}

vec4 g_patch[kSide * kSide];  // patch of the reference, the first source: equal at all depths

float costAt(vec2 pixel, float depth) {
  if (!insideHull(pixel, depth)) return 1.0;
  float weight[SOURCES], mattes[SOURCES];
  vec3 a[SOURCES], b[SOURCES], aa[SOURCES], bb[SOURCES], ab[SOURCES];
  for (int s = 1; s < SOURCES; ++s)
    weight[s] = mattes[s] = 0.0, a[s] = b[s] = aa[s] = bb[s] = ab[s] = vec3(0);
  for (int j = -RADIUS; j <= RADIUS; ++j)
    for (int i = -RADIUS; i <= RADIUS; ++i) {
      vec2 o = vec2(i, j) * SPACING;
      vec4 first = g_patch[(j + RADIUS) * kSide + i + RADIUS];
      for (int s = 1; s < SOURCES; ++s) {
        vec4 other = pictureAt(s, pixelIn(s, pixel + o, depth));
        float w = first.a * other.a;
        weight[s] += w;
        mattes[s] += max(first.a - other.a, 0.0);
        a[s] += w * first.rgb, b[s] += w * other.rgb;
        aa[s] += w * first.rgb * first.rgb, bb[s] += w * other.rgb * other.rgb, ab[s] += w * first.rgb * other.rgb;
      }
    }
  float best = 1.0, sum = 0.0;
  for (int s = 1; s < SOURCES; ++s) {
    float cost = pairCost(weight[s], a[s], b[s], aa[s], bb[s], ab[s], mattes[s]);
    best = min(best, cost), sum += cost;
  }
  return SOURCES > 2 ? mix(best, sum / float(SOURCES - 1), 0.2) : best;
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  int block = at.y / int(u_region.w);
  at.y -= block * int(u_region.w);
  o_costs = vec4(1);
  float front = texelFetch(u_front, at, 0).r;
  if (front <= 0.0) return;
  vec2 pixel = u_region.xy + vec2(float(at.x) + 0.5, u_region.w - 0.5 - float(at.y));
  float first = floor(front / u_step) + float(4 * block);
  float depth = (first + 1.0) * u_step;
  if (!mayHold(0, pixel, depth)) return;
  for (int n = 0; n < kSide * kSide; ++n) {
    vec2 o = vec2(n % kSide - RADIUS, n / kSide - RADIUS) * SPACING;
    g_patch[n] = pictureAt(0, pixelIn(0, pixel + o, depth));
  }
  for (int k = 0; k < 4; ++k) o_costs[k] = costAt(pixel, (first + float(k)) * u_step);
}
