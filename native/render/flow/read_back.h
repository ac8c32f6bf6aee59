// SPDX-License-Identifier: Apache-2.0
// A FlowSource that reads both pictures' filled luma back, computes flow on the CPU by the given solver, and uploads it
// faded by the confidence. Blocks on the GPU, but requires no float targets.
#pragma once

#include <functional>

#include "render/flow/flow.h"

namespace fourdvt::render {

// Computes flow on the CPU. a, b: luma, width × height bytes; flow: output, 2 floats per pixel, x then y, in row order.
using FlowSolver = std::function<Status(const uint8_t* a, const uint8_t* b, int width, int height, float* flow)>;

std::unique_ptr<FlowSource> createReadBackFlow(gpu::Device& device, FlowSolver solver);

}  // namespace fourdvt::render
