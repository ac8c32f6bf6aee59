// SPDX-License-Identifier: Apache-2.0
// The figures' picture, pixel by pixel, at its place in the view.
out vec4 o_color;
uniform sampler2D u_figures;  // premultiplied
uniform vec2 u_origin;        // pixel of the view that it begins at

void main() { o_color = texelFetch(u_figures, ivec2(gl_FragCoord.xy - u_origin), 0); }
