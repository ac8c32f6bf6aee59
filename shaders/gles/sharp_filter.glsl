// Catmull-Rom filter of a premultiplied picture over 4 × 4 pixels, without those of the background.
vec4 filterTap(ivec2 pixel, int i);  // the includer's picture i, premultiplied

vec4 catmullRom(float t) {
  return vec4(((-0.5 * t + 1.0) * t - 0.5) * t, (1.5 * t - 2.5) * t * t + 1.0, ((-1.5 * t + 2.0) * t + 0.5) * t,
              (0.5 * t - 0.5) * t * t);
}

// Returns a premultiplied colour; leaves out pixels whose matte is below `threshold`. Where the negative lobes would
// then dominate, interpolates the remaining pixels bilinearly; without any, returns `otherwise`.
vec4 sampleSharp(vec2 pixel, ivec2 size, float threshold, vec4 otherwise, int i) {
  vec2 base = floor(pixel - 0.5), t = pixel - 0.5 - base;
  vec4 wx = catmullRom(t.x), wy = catmullRom(t.y);
  vec4 sharp = vec4(0.0), plain = vec4(0.0);
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 4; ++x) {
      vec4 tap = filterTap(clamp(ivec2(base) + ivec2(x - 1, y - 1), ivec2(0), size - 1), i);
      if (tap.a < threshold) continue;
      sharp += wx[x] * wy[y] * tap;
      vec2 tent = max(1.0 - abs(vec2(x - 1, y - 1) - t), 0.0);
      plain += tent.x * tent.y * tap;
    }
  }
  if (sharp.a > 0.75) return clamp(sharp, vec4(0.0), sharp.aaaa);
  return plain.a > 0.01 ? plain : otherwise;
}
