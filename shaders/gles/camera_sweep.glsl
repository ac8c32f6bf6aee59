// The surface in the view of a sweep, a texel per pixel, and the unprojection of its depths.
uniform sampler2D u_normals;         // surface normals, 0…1 for -1…1; alpha 0: no surface
uniform highp sampler2D u_depths;    // drawn y up, like the normals
uniform mat4 u_character_from_clip;
uniform float u_length_scale;        // factor of lengths that are tuned for a person

bool isSurface(ivec2 at) { return texelFetch(u_normals, at, 0).a > 0.0; }

vec4 unprojected(ivec2 at) {
  vec3 clip = vec3((vec2(at) + 0.5) / vec2(textureSize(u_depths, 0)), texelFetch(u_depths, at, 0).r) * 2.0 - 1.0;
  return u_character_from_clip * vec4(clip, 1.0);
}

// Depth of the surface, metres along the view's axis.
float surfaceDepth(ivec2 at) { return 1.0 / unprojected(at).w; }

// Shifts of -1…1 as 16 bits in two channels.
vec2 packedShift(float shift) {
  float steps = floor(clamp(0.5 * shift + 0.5, 0.0, 1.0) * 65535.0 + 0.5), high = floor(steps / 256.0);
  return vec2(high, steps - 256.0 * high) / 255.0;
}

float unpackedShift(vec2 texel) { return dot(texel, vec2(256.0, 1.0)) * 255.0 / 65535.0 * 2.0 - 1.0; }
