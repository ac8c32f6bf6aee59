// SPDX-License-Identifier: Apache-2.0
// Push-pull over the mipmaps: coarser levels fill the gaps of finer ones with the mean of both pictures.
in vec2 v_uv;
out vec4 o_filled;  // luma of a, luma of b, unused, confidence
uniform sampler2D u_luma;
const float kNoise = 2.0 / 255.0;  // standard deviation of luma from compression alone
const int kEmptyLevel = 4;         // mipmap level: nine texels cover the reach of finer levels and of confidence

// Confidence: falls to 0 within 10 pixels of the character, starting where coverage is below 0.4, and where a's luma is
// constant.
float confidence() {
  vec3 sum = vec3(0.0);
  vec2 step = 4.0 / vec2(textureSize(u_luma, 0));
  for (int i = 0; i < 25; ++i) {
    vec4 luma = textureLod(u_luma, v_uv + step * vec2(i % 5 - 2, i / 5 - 2), 1.0);
    float y = luma.r / max(luma.b, 1e-3);
    sum += luma.b * vec3(1.0, y, y * y);
  }
  vec2 moments = sum.yz / max(sum.x, 1e-3);
  float variance = max(moments.y - moments.x * moments.x, 0.0);
  return smoothstep(0.0, 0.4, sum.x / 25.0) * variance / (variance + kNoise * kNoise);
}

// True without any character in the nine texels of kEmptyLevel round the pixel. Mipmaps of odd sizes drop columns and
// rows, and single pixels round to 0, so covered pixels are excluded first.
bool isFarOutside(ivec2 size) {
  if (max(size.x, size.y) >> kEmptyLevel == 0) return false;
  ivec2 coarse = textureSize(u_luma, kEmptyLevel), here = ivec2(v_uv * vec2(coarse)), last = coarse - 1;
  float sum = 0.0;
  for (int i = 0; i < 9; ++i) {
    vec4 luma = texelFetch(u_luma, clamp(here + ivec2(i % 3, i / 3) - 1, ivec2(0), last), kEmptyLevel);
    sum += luma.z + luma.w;
  }
  return sum == 0.0;
}

void main() {
  vec4 own = texelFetch(u_luma, ivec2(gl_FragCoord.xy), 0);
  ivec2 size = textureSize(u_luma, 0);
  bool is_covered = own.z == 1.0 && own.w == 1.0, is_far = own.z + own.w == 0.0 && isFarOutside(size);
  float outside = 0.0;
  if (!is_covered) {
    vec2 fill = vec2(0.0);  // premultiplied luma, weight
    for (int level = is_far ? kEmptyLevel + 1 : 0; max(size.x, size.y) >> level > 0 && fill.y < 0.999; ++level) {
      vec4 luma = textureLod(u_luma, v_uv, float(level));
      fill += (1.0 - fill.y) * 0.5 * vec2(luma.x + luma.y, luma.z + luma.w);
    }
    outside = fill.x / max(fill.y, 1e-3);
  }
  o_filled = vec4(own.xy + (1.0 - own.zw) * outside, 0.0, is_far ? 0.0 : confidence());
}
