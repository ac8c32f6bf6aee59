// SPDX-License-Identifier: Apache-2.0
// Dense optical flow between two pictures of the same mesh and view, for Align::Flow. Implementations: GpuFlow
// (farneback.cpp, dis.cpp: fragment passes), and platforms that call OpenCV on read-back pictures (native:
// native/platform; browser: the separate wasm module).
#pragma once

#include <functional>
#include <memory>

#include "gpu/device.h"

namespace fourdvt::render {

class FlowSource {
 public:
  virtual ~FlowSource() = default;
  // Computes displacement f with a(p) ~ b(p + f), in pixels of the flow, y along GL rows. a, b: RGBA8, premultiplied,
  // GL rows (bottom first), of the same area; alpha 0: no character. The result is .xy of flow(), a texture of width ×
  // height. Pictures of another size are sampled with their filter: at twice the size a linear one averages 2 x 2
  // pixels. Without evidence the displacement falls smoothly to 0. Errors: GpuFailure, Unsupported.
  virtual Status compute(gpu::TextureId a, gpu::TextureId b, int width, int height) = 0;
  virtual gpu::TextureId flow() const = 0;  // valid until the next compute
};

enum class FlowMethod { Farneback, Dis };

struct FlowOptions {
  FlowMethod method = FlowMethod::Farneback;
  int finest = 2;  // Dis: octaves of the finest patches below width × height
  // Share of the variance of the pictures' difference round the pixel that a displacement must remove to have full
  // weight; below it the weight falls in proportion. 0: full weight always. OpenCV's flow has neither this nor
  // `finest`.
  double must_explain = 0;
  // Displacements of at least this many pixels of the flow are exempt from must_explain, from half of it gradually:
  // short ones are mostly sampling noise. 0: no exemption. OpenCV's flow lacks this option.
  double sure_px = 0;
  int levels = 4;           // Farneback: pyramid, factor 2
  int window = 13;          // Farneback: averaging window, pixels; odd
  int iterations = 3;       // per level
  int poly_n = 5;           // Farneback: neighbourhood of the polynomial expansion; 5 or 7
  double poly_sigma = 1.1;  // standard deviation of the expansion's weights, pixels
};

// Makes Farnebäck 2003 as fragment passes, or the fast DIS (Kroeger 2016). Requires float render targets (Caps);
// programs and targets are made on first use. Errors: Unsupported.
Result<std::unique_ptr<FlowSource>> createGpuFlow(gpu::Device& device, const FlowOptions& options = {});

// Computes flow on the CPU. a, b: luma, width × height bytes; flow: output, 2 floats per pixel, x then y, in row order.
using FlowSolver = std::function<Status(const uint8_t* a, const uint8_t* b, int width, int height, float* flow)>;

// Makes a source that reads both pictures' filled luma back, computes flow on the CPU by the given solver, and uploads
// it faded by the confidence. Blocks on the GPU, but requires no float targets.
std::unique_ptr<FlowSource> createReadBackFlow(gpu::Device& device, FlowSolver solver);

}  // namespace fourdvt::render
