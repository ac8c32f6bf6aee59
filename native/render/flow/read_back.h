// SPDX-License-Identifier: Apache-2.0
// A FlowSource that reads both pictures' filled luma back, lets the edge compute flow on the CPU, and uploads it faded
// by the confidence. Slow (it waits for the GPU), but needs no float targets.
#pragma once

#include <functional>

#include "render/flow/flow.h"

namespace fourdvt::render {

// a, b: luma, width × height bytes; flow: 2 floats per pixel, x then y in row order; filled by the solver.
using FlowSolver = std::function<Status(const uint8_t* a, const uint8_t* b, int width, int height, float* flow)>;

std::unique_ptr<FlowSource> createReadBackFlow(gpu::Device& device, FlowSolver solver);

}  // namespace fourdvt::render
