// The figure's finished picture; a style keeps its transparency.
uniform sampler2D u_shown;  // premultiplied, the target's size
uniform float u_strength;   // 0: unstyled, 1: full style
out vec4 o_color;

vec4 shownAt(ivec2 pixel) { return texelFetch(u_shown, clamp(pixel, ivec2(0), textureSize(u_shown, 0) - 1), 0); }

vec3 straight(vec4 shown) { return min(shown.rgb / max(shown.a, 1.0 / 255.0), 1.0); }

void show(vec4 shown, vec3 styled) {
  o_color = shown.a > 0.0 ? vec4(mix(straight(shown), styled, u_strength), 1.0) : vec4(0.0);
}
