// The surface as the view of a sweep sees it, a texel for each of its pixels, and where the depths that are tried lie on
// the view's rays.
uniform sampler2D u_normals;         // of the surface, 0…1 for -1…1; alpha 0: it is not there
uniform highp sampler2D u_depths;    // drawn y up, as the normals
uniform mat4 u_character_from_clip;
uniform float u_length_scale;        // of lengths that suit a person

bool isSurface(ivec2 at) { return texelFetch(u_normals, at, 0).a > 0.0; }

vec4 unprojected(ivec2 at) {
  vec3 clip = vec3((vec2(at) + 0.5) / vec2(textureSize(u_depths, 0)), texelFetch(u_depths, at, 0).r) * 2.0 - 1.0;
  return u_character_from_clip * vec4(clip, 1.0);
}

// Metres along the view's axis.
float surfaceDepth(ivec2 at) { return 1.0 / unprojected(at).w; }

// 16 bits in two channels, for shifts of -1…1.
vec2 packedShift(float shift) {
  float steps = floor(clamp(0.5 * shift + 0.5, 0.0, 1.0) * 65535.0 + 0.5), high = floor(steps / 256.0);
  return vec2(high, steps - 256.0 * high) / 255.0;
}

float unpackedShift(vec2 texel) { return dot(texel, vec2(256.0, 1.0)) * 255.0 / 65535.0 * 2.0 - 1.0; }
