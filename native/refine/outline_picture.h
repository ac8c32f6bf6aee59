// SPDX-License-Identifier: Apache-2.0
// Draws a mesh's outline over a camera's picture, coloured by its distance from the matte's.
#pragma once

#include <span>

#include "base/image.h"
#include "refine/outline.h"

namespace fourdvt::refine {

// RGB, the part of `rgba` round the matte, darkened and twice as large, with a dot at every point: green where the
// outlines agree to a quarter of a pixel, towards red where the mesh is too large, towards blue where it is too small
// (full colour from 2 pixels on). `camera`: the one that the points were taken with.
Image outlinePicture(const Image& rgba, const PinholeCamera& camera, std::span<const OutlinePoint> points);

// Two pictures of one height beside each other.
Image beside(const Image& left, const Image& right);

}  // namespace fourdvt::refine
