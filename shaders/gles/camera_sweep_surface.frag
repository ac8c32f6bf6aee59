// SPDX-License-Identifier: Apache-2.0
// Surface normals in the view.
centroid in vec3 v_normal;
out vec4 o_normal;

void main() { o_normal = vec4(0.5 * normalize(v_normal) + 0.5, 1.0); }
