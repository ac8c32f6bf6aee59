// SPDX-License-Identifier: Apache-2.0
// The optical flow that some alignments need: implemented by flow_modes.cpp in fourdvt-flow.wasm; refused by
// no_flow_modes.cpp in the player that every visitor downloads.
#pragma once

#include <memory>

#include "abi.h"
#include "render/flow/flow.h"

namespace fourdvt {

// mode: one of the flows. Errors: Unsupported where this module or the device has no such flow; GpuFailure.
Result<std::unique_ptr<render::FlowSource>> makeFlow(gpu::Device& device, abi::AlignMode mode);

}  // namespace fourdvt
