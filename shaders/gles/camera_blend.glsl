// Texturing of a surface from CAMERAS pictures: projection into each camera's picture, depth test, and blend. A
// method's .frag defines cameraWeight, includes this file, and calls blendCameras. COMPARES_CAMERAS: it also defines
// compareCameras; OWN_COLOR: also cameraColor. TILED: the pictures are tiles of one decoded picture; otherwise layers
// of an array, with mattes. Blends encoded values, as the papers do.
#ifdef TILED
#include "decoded_picture.glsl"
uniform vec4 u_sources[CAMERAS];            // x, y, width, height of the region in the tile, pixels
uniform vec4 u_tiles[CAMERAS];              // x, y, width, height in picture texture coordinates
#else
uniform highp sampler2DArray u_pictures;    // premultiplied, alpha = matte; row 0 is the top row
uniform vec2 u_picture_size;                // texels of a layer
#endif
uniform highp sampler2DArray u_depth_maps;  // drawn y up: row 0 is the bottom row
uniform int u_depth_rows;                   // rows of a depth map
uniform float u_reach;                      // slope-scaled bias of the depth test, depth map texels; negative: no test
uniform float u_depth_bias;                 // constant bias of the depth test, metres
uniform float u_least_cosine;               // cosine of surface normal and ray below which a camera is rejected
uniform mat4 u_pixel_from_character[CAMERAS];  // → (pixel · depth, depth along the optical axis, unused)
uniform vec4 u_centres[CAMERAS];            // xyz character's frame; w layer of the depth maps
uniform vec4 u_pixel_spans[CAMERAS];        // x: metres per pixel at 1 m; yz: depth map texels per pixel; w: layer
uniform vec4 u_sizes_near_far[CAMERAS];     // pixels, pixels, metres, metres

const float kMinSum = 1e-6;

float cameraWeight(vec3 to_camera, float cosine, vec3 to_eye);  // blend weight by the method; 0: not used
void compareCameras(vec3 point, vec3 to_eye);  // called before a point's weights; for state that depends on all cameras
// Returns straight colour; alpha 0: none. at: projected(point, i).
vec4 cameraColor(vec3 point, vec3 to_eye, vec3 at, int i);

float mappedDepth(vec2 pixel, int i) {
  ivec2 at = ivec2(pixel * u_pixel_spans[i].yz);
  float z = texelFetch(u_depth_maps, ivec3(at.x, u_depth_rows - 1 - at.y, int(u_centres[i].w)), 0).r * 2.0 - 1.0;
  float near = u_sizes_near_far[i].z, far = u_sizes_near_far[i].w;
  return 2.0 * near * far / (far + near - z * (far - near));
}

// xy pixel, z depth; z <= 0: outside the picture or within half a pixel of its border.
vec3 projected(vec3 point, int i) {
  vec3 p = (u_pixel_from_character[i] * vec4(point, 1.0)).xyz;
  vec2 pixel = p.xy / p.z;
  vec2 low = vec2(0.5), high = u_sizes_near_far[i].xy - 0.5;
#ifdef TILED
  low += u_sources[i].xy, high = min(high, u_sources[i].xy + u_sources[i].zw - 0.5);
#endif
  bool inside = all(greaterThanEqual(pixel, low)) && all(lessThanEqual(pixel, high));
  return vec3(pixel, inside ? p.z : 0.0);
}

bool isHidden(vec3 at, float cosine, int i) {
  float slope = sqrt(max(1.0 - cosine * cosine, 0.0)) / max(cosine, 0.05);
  float reach = u_reach / u_pixel_spans[i].y;
  return u_reach >= 0.0 && at.z > mappedDepth(at.xy, i) + u_depth_bias + reach * slope * at.z * u_pixel_spans[i].x;
}

// Returns straight colour; alpha 0 where the matte is background.
vec4 pictureColor(vec2 pixel, int i) {
#ifdef TILED
  return vec4(decodedColor(u_tiles[i].xy + (pixel - u_sources[i].xy) / u_sources[i].zw * u_tiles[i].zw, u_tiles[i]), 1.0);
#else
  vec4 texel = textureLod(u_pictures, vec3(pixel / u_picture_size, u_pixel_spans[i].w), 0.0);
  return texel.a > 0.5 ? vec4(texel.rgb / texel.a, 1.0) : vec4(0.0);
#endif
}

#ifndef COMPARES_CAMERAS
void compareCameras(vec3 point, vec3 to_eye) {}
#endif
#ifndef OWN_COLOR
vec4 cameraColor(vec3 point, vec3 to_eye, vec3 at, int i) { return pictureColor(at.xy, i); }
#endif

// Returns the colour of the best-facing camera, occlusion ignored; black outside every picture.
vec3 bestFacingColor(vec3 point, vec3 normal) {
  vec3 color = vec3(0.0);
  float best = -2.0;
  for (int i = 0; i < CAMERAS; ++i) {
    float facing = dot(normalize(u_centres[i].xyz - point), normal);
    vec3 at = projected(point, i);
    if (facing <= best || at.z <= 0.0) continue;
    vec4 texel = pictureColor(at.xy, i);
    if (texel.a == 0.0) continue;
    best = facing;
    color = texel.rgb;
  }
  return color;
}

// Returns straight colour; alpha 0: no camera sees the point.
vec4 blendCameras(vec3 point, vec3 normal, vec3 to_eye) {
  compareCameras(point, to_eye);
  vec3 color = vec3(0.0);
  float sum = 0.0;
  for (int i = 0; i < CAMERAS; ++i) {
    vec3 ray = normalize(u_centres[i].xyz - point);
    float cosine = dot(normal, ray);
    if (cosine <= u_least_cosine) continue;
    float weight = cameraWeight(ray, cosine, to_eye);
    if (weight <= 0.0) continue;
    vec3 at = projected(point, i);
    if (at.z <= 0.0 || isHidden(at, cosine, i)) continue;
    vec4 texel = cameraColor(point, to_eye, at, i);
    color += weight * texel.a * texel.rgb;
    sum += weight * texel.a;
  }
  return sum > kMinSum ? vec4(color / sum, 1.0) : vec4(0.0);
}
