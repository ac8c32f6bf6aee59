// SPDX-License-Identifier: Apache-2.0
// Floating Textures (FT): the cameras' pictures of the view are brought together by optical flow between them before
// they are blended. Up to FloatingPictures::kMost cameras.
#pragma once

#include <memory>

#include "render/method.h"

namespace fourdvt::render {

enum class FloatingForm {
  Linear,  // no flow: the same weights and pictures; what FT compares with
  Pairs,   // every picture to every other: n (n - 1) flows (FT Eq. 5-6)
  Star,    // every picture to their mean: n flows a round
};

// Errors: Unsupported: the device has no half-float targets.
Result<std::unique_ptr<Method>> makeFloating(gpu::Device& device, FloatingForm form);

// Floating Textures of a still scene (FT 4.1): flow between the pictures of every two cameras in use, in each camera's
// own view, is computed when geometry or picture change and kept; a view is a look-up, in which every camera's view
// tells how far each picture is displaced. It pays where many views of one frame are drawn, as while playback is
// paused; each new frame costs n (n - 1) flows. Another choice of cameras computes what is missing.
// Errors: Unsupported: the device has no half-float targets.
Result<std::unique_ptr<Method>> makeFloatingStatic(gpu::Device& device);

}  // namespace fourdvt::render
