// SPDX-License-Identifier: Apache-2.0
// Align::Flow by OpenCV's own Farnebäck or DIS (ultrafast) on read-back pictures: the reference of the GPU passes.
#pragma once

#include "render/flow/flow.h"

namespace fourdvt::edge {

std::unique_ptr<render::FlowSource> createOpencvFlow(gpu::Device& device, const render::FlowOptions& options = {});

}  // namespace fourdvt::edge
