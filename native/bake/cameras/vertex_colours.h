// SPDX-License-Identifier: Apache-2.0
// Colours of a surface's vertices from calibrated pictures, for glTF viewers that draw neither videos nor cameras. Does
// not make a texture: detail finer than the vertices' distance is averaged. CPU only.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "base/camera.h"
#include "base/image.h"
#include "base/mesh.h"

namespace fourdvt::bake {

// Linear RGB of each vertex, 65535 = 1, as glTF's COLOR_0 has it. A camera counts where it sees the vertex (a depth
// test against the surface itself, half a mean edge to spare), by the fourth power of the cosine between normal and
// ray; its colour is the mean of the pixels of at least half alpha in a square round it, two thirds of the mean edge
// wide and 25 pixels at most. Vertices that no camera sees take a mean of their neighbours, nearest first; all are
// mid-grey where none is seen. `pictures` has one of each camera, of the camera's size: RGBA, sRGB.
std::vector<glm::u16vec3> vertexColours(const TriangleMesh& surface, const std::vector<PinholeCamera>& cameras,
                                        std::span<const Image> pictures);

}  // namespace fourdvt::bake
