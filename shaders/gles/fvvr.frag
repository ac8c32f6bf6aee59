// SPDX-License-Identifier: Apache-2.0
// Projective texturing from CAMERAS pictures with run-time depth tests, blended by LVDT Eq. 3-4 (corrected sign).
// Blends encoded values, as the paper does.
centroid in vec3 v_point;
centroid in vec3 v_normal;
out vec4 o_color;

uniform highp sampler2DArray u_pictures;    // premultiplied, alpha = matte; row 0 is the top row
uniform highp sampler2DArray u_depth_maps;  // drawn y up: row 0 is the bottom row
uniform vec2 u_picture_size;                // texels of a layer
uniform int u_depth_rows;                   // of a layer of the depth maps
uniform float u_reach;                      // texels of a depth map that its depth may be off by; negative: no depth test
uniform bool u_fills;                       // what no camera sees takes the best-facing one; else it is left transparent
uniform mat4 u_pixel_from_world[CAMERAS];   // → (pixel · depth, depth along the optical axis, unused)
uniform vec4 u_centres[CAMERAS];            // xyz world; w layer
uniform vec4 u_pixel_spans[CAMERAS];        // x: metres that a pixel spans at 1 m; yz: texels of the depth map per pixel
uniform vec4 u_sizes_near_far[CAMERAS];     // pixels, pixels, metres, metres
uniform vec3 u_eye_in_world;

const float kDepthBias = 0.01;    // metres
const float kMinSum = 1e-6;

float mappedDepth(vec2 pixel, int i) {
  ivec2 at = ivec2(pixel * u_pixel_spans[i].yz);
  float z = texelFetch(u_depth_maps, ivec3(at.x, u_depth_rows - 1 - at.y, int(u_centres[i].w)), 0).r * 2.0 - 1.0;
  float near = u_sizes_near_far[i].z, far = u_sizes_near_far[i].w;
  return 2.0 * near * far / (far + near - z * (far - near));
}

// xy pixel, z depth; z <= 0: outside the picture (its margin of half a pixel counts as outside).
vec3 projected(int i) {
  vec3 p = (u_pixel_from_world[i] * vec4(v_point, 1.0)).xyz;
  vec2 pixel = p.xy / p.z;
  bool inside = all(greaterThanEqual(pixel, vec2(0.5))) && all(lessThanEqual(pixel, u_sizes_near_far[i].xy - 0.5));
  return vec3(pixel, inside ? p.z : 0.0);
}

bool isHidden(vec3 at, float cosine, int i) {
  float slope = sqrt(max(1.0 - cosine * cosine, 0.0)) / max(cosine, 0.05);
  float reach = u_reach / u_pixel_spans[i].y;
  return u_reach >= 0.0 && at.z > mappedDepth(at.xy, i) + kDepthBias + reach * slope * at.z * u_pixel_spans[i].x;
}

// Straight colour; alpha 0 where the matte says background.
vec4 pictureColor(vec2 pixel, int i) {
  vec4 texel = textureLod(u_pictures, vec3(pixel / u_picture_size, u_centres[i].w), 0.0);
  return texel.a > 0.5 ? vec4(texel.rgb / texel.a, 1.0) : vec4(0.0);
}

// The camera that faces the point best in spite of occlusion; black where no matte has it.
vec3 bestFacingColor(vec3 normal) {
  vec3 color = vec3(0.0);
  float best = -2.0;
  for (int i = 0; i < CAMERAS; ++i) {
    float facing = dot(normalize(u_centres[i].xyz - v_point), normal);
    vec3 at = projected(i);
    if (facing <= best || at.z <= 0.0) continue;
    vec4 texel = pictureColor(at.xy, i);
    if (texel.a == 0.0) continue;
    best = facing;
    color = texel.rgb;
  }
  return color;
}

void main() {
  vec3 normal = normalize(v_normal);
  vec3 to_eye = normalize(u_eye_in_world - v_point);
  vec3 color = vec3(0.0);
  float sum = 0.0;
  for (int i = 0; i < CAMERAS; ++i) {
    vec3 ray = normalize(u_centres[i].xyz - v_point);
    float weight = max(dot(normal, ray), 0.0) * max(dot(ray, to_eye), 0.0);
    float cosine = dot(normal, ray);
    if (weight <= 0.0 || cosine <= 0.0) continue;
    vec3 at = projected(i);
    if (at.z <= 0.0 || isHidden(at, cosine, i)) continue;
    vec4 texel = pictureColor(at.xy, i);
    color += weight * texel.a * texel.rgb;
    sum += weight * texel.a;
  }
  if (sum > kMinSum)
    o_color = vec4(color / sum, 1.0);
  else
    o_color = u_fills ? vec4(bestFacingColor(normal), 1.0) : vec4(0.0);
}
