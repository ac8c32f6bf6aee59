// SPDX-License-Identifier: Apache-2.0
// View-independent colour of each vertex from the cameras that see it, a texel per vertex; alpha 0: unseen.
#include "character_vertex.glsl"
#include "camera_blend.glsl"
uniform int u_vertex_count;
out vec4 o_color;

float cameraWeight(vec3 to_camera, float cosine, vec3 to_eye) { return cosine * cosine; }

void main() {
  int vertex = int(gl_FragCoord.y) * TABLE_WIDTH + int(gl_FragCoord.x);
  if (vertex >= u_vertex_count) {
    o_color = vec4(0.0);
    return;
  }
  o_color = blendCameras(fetchPosition(vertex), normalize(fetchNormal(vertex)), vec3(0.0));
}
