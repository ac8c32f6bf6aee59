// SPDX-License-Identifier: Apache-2.0
// DIS densification: a pixel's flow is the mean over the patches that cover it, each weighted by how well it explains
// the pixel.
out vec2 o_flow;
uniform sampler2D u_slopes, u_patches;
const int kStride = 4;  // half a patch

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy), last = textureSize(u_patches, 0) - 1;
  ivec2 high = min(at / kStride, last), low = min(max(at - kStride, 0) / kStride, high);
  vec3 sum = vec3(0.0);
  for (int y = low.y; y <= high.y; ++y)
    for (int x = low.x; x <= high.x; ++x) {
      vec2 flow = texelFetch(u_patches, ivec2(x, y), 0).xy;
      float b = texture(u_slopes, (gl_FragCoord.xy + flow) / vec2(textureSize(u_slopes, 0))).y;
      sum += vec3(flow, 1.0) / max(1.0, abs(b - texelFetch(u_slopes, at, 0).x));
    }
  o_flow = sum.xy / sum.z;
}
