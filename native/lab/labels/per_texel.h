// SPDX-License-Identifier: Apache-2.0
// Choice of cameras per texel. Volino, Hilton: Layered View-Dependent Texture Maps, CVMP 2013, section 3.1.
#pragma once

#include "bake/texels/resample.h"

namespace fourdvt::lab {

// bake::TexelRule: layer l of a texel is taken from the l-th camera of the face's order that sees this texel. Draws
// every camera for every layer size: slow.
Result<std::vector<Image>> resamplePerTexel(bake::Resampler& resampler, gpu::Device& device,
                                            const bake::GpuCapture& capture, const std::vector<uint8_t>& order);

}  // namespace fourdvt::lab
