// SPDX-License-Identifier: Apache-2.0
// What not every visitor needs: the optical flow of some alignments, characters from cameras, and looks (fdvt_set_look
// of abi.txt). Implemented by extras.cpp in fourdvt-full.wasm; refused by no_extras.cpp in the player that every
// visitor downloads, which has no looks at all.
#pragma once

#include <memory>
#include <string_view>

#include "abi.h"
#include "player/player.h"
#include "render/flow/flow.h"

namespace fourdvt {

// mode: one of the flows. Errors: Unsupported where this module or the device has no such flow; GpuFailure.
Result<std::unique_ptr<render::FlowSource>> makeFlow(gpu::Device& device, abi::AlignMode mode);
// How characters from cameras are drawn. Where the device cannot run the method, another one serves in its place and
// the page gets an event. Errors: InvalidArgument: no such method; Unsupported in this module.
Result<std::unique_ptr<render::Method>> makeMethod(gpu::Device& device, std::string_view name);
const CameraParts* cameraPartsOfModule();  // null: characters from cameras are refused

}  // namespace fourdvt
