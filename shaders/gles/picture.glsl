// Layers of the tiled picture as sRGB-encoded colour.
#include "decoded_picture.glsl"
uniform vec4 u_layer_rects[MEMBERS * LAYERS];  // x, y, width, height in picture texture coordinates

// Samples at the character's uv (origin top left), clamped to the layer's rectangle.
vec3 sampleLayer(int layer, vec2 uv) {
  vec4 rect = u_layer_rects[layer];
  return decodedColor(rect.xy + uv * rect.zw, rect);
}

#ifdef ALIGNED
// Mean luma at plus and minus `offset` texels of the first layer.
float lumaBeside(int layer, vec2 uv, vec2 offset) {
  vec4 rect = u_layer_rects[layer];
  vec2 at = rect.xy + uv * rect.zw, away = offset / u_picture_size * (rect.zw / u_layer_rects[0].zw);
  vec2 one = clampInside(at + away, rect, 0.5), other = clampInside(at - away, rect, 0.5);
#ifdef PICTURE_YUV
  return (texture(u_picture_y, one).r + texture(u_picture_y, other).r) * (127.5 / 219.0) - 16.0 / 219.0;
#else
  return dot(texture(u_picture_rgba, one).rgb + texture(u_picture_rgba, other).rgb, 0.5 * kLuma);
#endif
}
#endif
