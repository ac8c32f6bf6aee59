// SPDX-License-Identifier: Apache-2.0
// Functions of the module's second part (more.txt): the optical flow of some alignments and characters from cameras. Of
// abi.txt, looks, scene and room are there, too.
#pragma once

#include <memory>
#include <string_view>

#include "abi.h"
#include "instance.h"
#include "player/player.h"
#include "render/flow/flow.h"

namespace fourdvt {

// mode: one of the flows. Errors: Unsupported where the device has no such flow; GpuFailure.
Result<std::unique_ptr<render::FlowSource>> makeFlow(gpu::Device& device, abi::AlignMode mode);
// How characters from cameras are drawn from now on; an empty name: as the character's manifest says. Where the device
// or this player cannot, another method serves in its place and the page gets an event. Errors: InvalidArgument: no
// such method.
Status useMethod(Canvas& canvas, std::string_view name, const package::Character& character);

}  // namespace fourdvt
