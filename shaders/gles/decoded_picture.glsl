// A decoded picture as sRGB-encoded colour. PICTURE_YUV: planes, BT.709 limited range, chroma sited in the middle of
// its 2 × 2 block, in one two-channel texture with PICTURE_PAIR, otherwise in two; without PICTURE_YUV: one RGBA
// texture.
uniform vec2 u_picture_size;         // texels
#ifdef PICTURE_YUV
uniform sampler2D u_picture_y;
uniform sampler2D u_picture_u;
#ifndef PICTURE_PAIR
uniform sampler2D u_picture_v;
#endif
#else
uniform sampler2D u_picture_rgba;
#endif

const vec3 kLuma = vec3(0.2126, 0.7152, 0.0722);  // BT.709

vec2 clampInside(vec2 at, vec4 rect, float margin_texels) {
  vec2 margin = margin_texels / u_picture_size;
  return clamp(at, rect.xy + margin, rect.xy + rect.zw - margin);
}

// ITU-R BT.709, 8 bits: luma 16..235, chroma 16..240.
vec3 rgbFromYuv709(float y, float u, float v) {
  float luma = (y * 255.0 - 16.0) / 219.0;
  float cb = (u * 255.0 - 128.0) / 224.0;
  float cr = (v * 255.0 - 128.0) / 224.0;
  return clamp(vec3(luma + 1.5748 * cr, luma - 0.187324 * cb - 0.468124 * cr, luma + 1.8556 * cb), 0.0, 1.0);
}

// Samples at texture coordinates, clamped to the rectangle (x, y, width, height).
vec3 decodedColor(vec2 at, vec4 rect) {
  vec2 luma_at = clampInside(at, rect, 0.5);
#ifdef PICTURE_YUV
  vec2 chroma_at = clampInside(at, rect, 1.0);
#ifdef PICTURE_PAIR
  vec2 chroma = texture(u_picture_u, chroma_at).rg;
#else
  vec2 chroma = vec2(texture(u_picture_u, chroma_at).r, texture(u_picture_v, chroma_at).r);
#endif
  return rgbFromYuv709(texture(u_picture_y, luma_at).r, chroma.x, chroma.y);
#else
  return texture(u_picture_rgba, luma_at).rgb;
#endif
}
