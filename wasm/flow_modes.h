// SPDX-License-Identifier: Apache-2.0
// Alignment as a page numbers it, and the flow behind some of it: flow_modes.cpp in fourdvt-flow.wasm,
// no_flow_modes.cpp in the player that every visitor downloads.
#pragma once

#include <cstdint>
#include <memory>

#include "render/flow/flow.h"

namespace fourdvt {

enum AlignMode : int32_t { kNone, kBaked, kFarneback, kDis, kPageFlow };

// mode: kFarneback or above. Errors: Unsupported where this module or the device has no such flow; GpuFailure.
Result<std::unique_ptr<render::FlowSource>> makeFlow(gpu::Device& device, AlignMode mode);

}  // namespace fourdvt
