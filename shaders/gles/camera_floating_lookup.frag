// SPDX-License-Identifier: Apache-2.0
// Floating Textures of a still scene (FT Eq. 7): blends the surface from the camera pictures, each displaced by the
// flow between the pictures, which was computed in every camera's own view. Each of these views gives a displacement of
// every picture along the surface; their weighted mean limits an error in one view's flow to that view's share.
#include "camera_unseen.glsl"
in vec3 v_pixel_point;                   // v_point at the pixel centre, for derivatives
uniform sampler2D u_weights;             // the view's size, a channel per camera
uniform highp sampler2DArray u_flows;    // pixels of a layer, drawn y up: picture i at p resembles picture j at p + flow
uniform vec4 u_places[CAMERAS];          // x, y, width, height of a camera's layers, pixels of its picture
uniform vec4 u_layers[CAMERAS];          // layers of the flow from camera i's picture to the others
uniform float u_most;                    // displacement with full weight, heights of the camera's picture
const float kMinFacing = 0.05;         // minimum cosine of surface normal and camera ray
const float kMinArea = 1e-9;           // pixels²: minimum share of one side's square; edge-on below
const float kTap = 0.2887;               // share of a pixel's side, 1/√12: taps have the variance of its area
const float kMaxTap_px = 4.0;           // pixels of a camera

float cameraWeight(vec3 to_camera, float cosine, vec3 to_eye) { return cosine; }

// Returns the displacement, in camera i's view, from `pixel` of picture i to the matching point of picture j; pixels of
// camera i.
vec2 flowTo(vec2 pixel, int i, int j) {
  vec2 at = (pixel - u_places[i].xy) / u_places[i].zw;
  vec2 flow = textureLod(u_flows, vec3(at.x, 1.0 - at.y, u_layers[i][j]), 0.0).xy;
  return flow * vec2(1.0, -1.0) * u_places[i].zw / vec2(textureSize(u_flows, 0).xy);
}

vec2 towardsMean(vec2 pixel, int i, vec4 shares) {
  vec2 sum = vec2(0.0);
  for (int j = 0; j < CAMERAS; ++j)
    if (j != i && shares[j] > 0.0) sum += shares[j] * flowTo(pixel, i, j);
  return sum;
}

// Returns the derivative of camera i's pixel along `step`.
vec2 pixelStep(vec3 point, vec2 pixel, vec3 step, int i) {
  vec3 p = (u_pixel_from_character[i] * vec4(point, 1.0)).xyz, moved = mat3(u_pixel_from_character[i]) * step;
  return (moved.xy - pixel * moved.z) / p.z;
}

// Returns the offset on the surface, metres along `right` and `up`, from this point to each picture's match of the
// mean.
void findOffsets(vec3 normal, vec3 right, vec3 up, vec4 shares, out vec2 offsets[CAMERAS]) {
  for (int i = 0; i < CAMERAS; ++i) offsets[i] = vec2(0.0);
  float sum = 0.0;
  for (int k = 0; k < CAMERAS; ++k) {
    vec3 here = projected(v_point, k);
    float facing = dot(normal, normalize(u_centres[k].xyz - v_point));
    if (!(shares[k] > 0.0 && here.z > 0.0 && facing >= kMinFacing)) continue;
    mat2 pixels = mat2(pixelStep(v_point, here.xy, right, k), pixelStep(v_point, here.xy, up, k));
    if (!(abs(determinant(pixels)) > kMinArea * dot(pixels[0], pixels[0]))) continue;
    vec2 from = here.xy - towardsMean(here.xy, k, shares);
    from = here.xy - towardsMean(from, k, shares);
    mat2 along_from_pixels = sqrt(shares[k]) * inverse(pixels);
    for (int i = 0; i < CAMERAS; ++i) {
      if (shares[i] <= 0.0) continue;
      vec2 to = i == k ? from : from + flowTo(from, k, i);
      offsets[i] += along_from_pixels * (to - here.xy);
    }
    sum += sqrt(shares[k]);
  }
  for (int i = 0; i < CAMERAS; ++i) offsets[i] /= max(sum, kMinSum);
}

// Returns the weights at this pixel. They were drawn with one sample a pixel: 0 where no camera sees the surface, and
// where the surface misses the pixel centre. Both cases use the fill colour; without fill (u_fills is false), the
// neighbouring pixels' weights are added.
vec4 weightsHere() {
  ivec2 here = ivec2(gl_FragCoord.xy), last = textureSize(u_weights, 0) - 1;
  vec4 weights = texelFetch(u_weights, here, 0);
  if (!u_fills && weights == vec4(0.0))
    for (int i = 0; i < 9; ++i) weights += texelFetch(u_weights, clamp(here + ivec2(i % 3, i / 3) - 1, ivec2(0), last), 0);
  return weights;
}

// Fades out long displacements, and ignores those that leave the picture. at: projected(v_point, i).
vec2 displaced(vec3 at, vec3 along, int i) {
  vec3 to = projected(v_point + along, i);
  float most = u_most * u_sizes_near_far[i].y;
  vec2 by = to.xy - at.xy;
  return to.z > 0.0 ? at.xy + by * (1.0 - smoothstep(most, 2.0 * most, length(by))) : at.xy;
}

// Returns the premultiplied mean over the view pixel's footprint, with sides dx and dy in camera i's picture.
vec4 areaColor(vec2 pixel, vec2 dx, vec2 dy, int i) {
  vec4 sum = vec4(0.0);
  for (int tap = 0; tap < 4; ++tap) {
    vec2 side = vec2(tap & 1, tap >> 1) * 2.0 - 1.0;
    vec4 color = pictureColor(pixel + clamp(kTap * (side.x * dx + side.y * dy), -kMaxTap_px, kMaxTap_px), i);
    sum += 0.25 * vec4(color.rgb * color.a, color.a);
  }
  return sum;
}

out vec4 o_color;

void main() {
  vec4 weights = weightsHere(), color = vec4(0.0);
  float sum = dot(weights, vec4(1.0));
  vec3 normal = normalize(v_normal);
  vec3 right = normalize(cross(normal, abs(normal.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0)));
  vec3 up = cross(normal, right);
  vec2 offsets[CAMERAS];
  if (CAMERAS > 1) findOffsets(normal, right, up, weights / max(sum, kMinSum), offsets);
  else offsets[0] = vec2(0.0);
  for (int i = 0; i < CAMERAS; ++i) {
    vec2 at_pixel = projected(v_pixel_point, i).xy, dx = dFdx(at_pixel), dy = dFdy(at_pixel);
    vec3 at = projected(v_point, i);
    if (weights[i] > 0.0 && at.z > 0.0)
      color += weights[i] * areaColor(displaced(at, offsets[i].x * right + offsets[i].y * up, i), dx, dy, i);
  }
  if (color.a > 0.0) o_color = vec4(color.rgb / color.a, 1.0);
  else o_color = u_fills ? unseenColor(normal) : vec4(0.0);
}
