// SPDX-License-Identifier: Apache-2.0
// Montage4D (M4D 4.2 to 4.5) and its baseline, for figures from cameras. Ruofei Du, Ming Chuang, Wayne Chang, Hugues
// Hoppe, Amitabh Varshney: Montage4D: Real-time Seamless Fusion and Stylization of Multiview Video Textures. Journal of
// Computer Graphics Techniques 8(1), 2019. Up to eight cameras, in slots of fields on the surface. Visibility per
// vertex, votes, seams and their distances depend on surface and pictures only and persist between views; the view's
// blend weights and the temporal fields are updated for every picture. The paper's ambient occlusion is omitted.
#pragma once

#include <memory>
#include <string_view>

#include "render/method.h"

namespace fourdvt::render {

// Makes "montage4d", "holoportation" (normal weights, dilated depth discontinuities, votes) or, for inspection,
// "montage4d-seams" or "montage4d-weights". Returns null for other names. Errors: Unsupported: no half-float targets,
// which all but "holoportation" require.
Result<std::unique_ptr<Method>> makeMontage(gpu::Device& device, std::string_view name);

}  // namespace fourdvt::render
