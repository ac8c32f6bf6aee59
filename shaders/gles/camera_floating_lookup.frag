// SPDX-License-Identifier: Apache-2.0
// Floating Textures of a still scene (FT Eq. 7): the surface blended from the cameras' pictures, each looked up where the
// flow between the pictures in that camera's own view leads.
#include "camera_unseen.glsl"
uniform sampler2D u_weights;             // of the view's size, a channel per camera
uniform highp sampler2DArray u_flows;    // pixels of a layer, drawn y up: picture i at p resembles picture j at p + flow
uniform vec4 u_places[CAMERAS];          // x, y, width, height of what a camera's layers show, pixels of its picture
uniform vec4 u_layers[CAMERAS];          // of the flow from camera i's picture to each other's

float cameraWeight(vec3 to_camera, float cosine, vec3 to_eye) { return cosine; }

// Of the picture of camera i towards the mean, pixels of its picture.
vec2 towardsMean(vec2 pixel, int i, vec4 shares) {
  vec2 at = (pixel - u_places[i].xy) / u_places[i].zw, sum = vec2(0.0);
  for (int j = 0; j < CAMERAS; ++j)
    if (j != i) sum += shares[j] * texture(u_flows, vec3(at.x, 1.0 - at.y, u_layers[i][j])).xy;
  return sum * vec2(1.0, -1.0) * u_places[i].zw / vec2(textureSize(u_flows, 0).xy);
}

// The weights were drawn with one sample a pixel. They are 0 where no camera sees the surface, and where it misses the
// pixel's middle. Both show the unseen surface's colour; without one, the weights of the pixels round it are taken.
vec4 weightsHere() {
  ivec2 here = ivec2(gl_FragCoord.xy), last = textureSize(u_weights, 0) - 1;
  vec4 weights = texelFetch(u_weights, here, 0);
  if (!u_fills && weights == vec4(0.0))
    for (int i = 0; i < 9; ++i) weights += texelFetch(u_weights, clamp(here + ivec2(i % 3, i / 3) - 1, ivec2(0), last), 0);
  return weights;
}

out vec4 o_color;

void main() {
  vec4 weights = weightsHere();
  vec3 color = vec3(0.0);
  float sum = dot(weights, vec4(1.0)), used = 0.0;
  for (int i = 0; i < CAMERAS; ++i) {
    vec3 at = projected(v_point, i);
    if (weights[i] <= 0.0 || at.z <= 0.0) continue;
    vec2 first = towardsMean(at.xy, i, weights / sum);
    color += weights[i] * pictureColor(at.xy - towardsMean(at.xy - first, i, weights / sum), i).rgb;
    used += weights[i];
  }
  if (used > 0.0) o_color = vec4(color / used, 1.0);
  else o_color = u_fills ? unseenColor(normalize(v_normal)) : vec4(0.0);
}
