// SPDX-License-Identifier: Apache-2.0
// Floating Textures (FT): optical flow aligns the camera pictures in the view before they are blended. Martin Eisemann,
// Bert De Decker, Marcus Magnor, Philippe Bekaert, Edilson de Aguiar, Naveed Ahmed, Christian Theobalt, Anita Sellent:
// Floating Textures. Computer Graphics Forum 27(2) (Eurographics), 2008. Up to FloatingPictures::kMax cameras.
#pragma once

#include <memory>

#include "render/method.h"

namespace fourdvt::render {

enum class FloatingForm {
  Linear,  // no flow, same weights and pictures; FT's baseline
  Pairs,   // every picture to every other: n (n - 1) flows (FT Eq. 5-6)
  Mean,    // every picture to their mean: n flows a round
};

// Errors: Unsupported: no half-float targets.
Result<std::unique_ptr<Method>> makeFloating(gpu::Device& device, FloatingForm form);

// Floating Textures of a still scene (FT 4.1): flow between every two cameras in use, in each camera's own view, is
// computed when geometry or picture change and then kept; a view only looks up the displacement of each picture in
// every camera's field. Efficient for many views of one frame, for example while playback is paused; each new frame
// costs n (n - 1) flows. Newly chosen cameras add the missing pairs. Errors: Unsupported: no half-float targets.
Result<std::unique_ptr<Method>> makeFloatingStatic(gpu::Device& device);

}  // namespace fourdvt::render
