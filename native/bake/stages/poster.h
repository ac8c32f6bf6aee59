// SPDX-License-Identifier: Apache-2.0
// Pictures of the finished character for people: the poster, and stills as JPEG.
#pragma once

#include "bake/run/job.h"
#include "bake/run/work_folder.h"
#include "package/character.h"

namespace fourdvt::bake {

constexpr int kPosterWidth = 720, kPosterHeight = 960;

// Renders the still from the view that the page starts with, 720 × 960, as RGBA with straight alpha. layout: of
// the still's picture. `positions` are in the decoded mesh's order. Errors: GpuFailure.
Result<Image> renderPoster(gpu::Device& device, const package::Character& character, const package::BaseMesh& mesh,
                           const package::Rendition& layout, const StillArtefact& still, const Positions& positions);

// Encodes RGB or RGBA as a file. `extension`: ".jpg" or ".webp". Errors: Internal.
Result<std::vector<uint8_t>> encodePicture(const Image& image, const std::string& extension, int quality);

}  // namespace fourdvt::bake
