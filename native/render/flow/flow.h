// SPDX-License-Identifier: Apache-2.0
// Dense optical flow between two pictures of the same mesh and view: what Align::Flow aligns members with.
// Implementations: GpuFlow (farneback.cpp, dis.cpp: fragment passes), and edges that call OpenCV on read-back
// pictures (native: native/platform; browser: the separate wasm module).
#pragma once

#include <memory>

#include "gpu/device.h"

namespace fourdvt::render {

class FlowSource {
 public:
  virtual ~FlowSource() = default;
  // a, b: RGBA8, premultiplied, GL rows (bottom first), that show one area; alpha 0: no character. Displacement f with
  // a(p) ~ b(p + f), in pixels of the flow, y along GL rows; found in flow(), a texture of width × height whose .xy it
  // is. Pictures of another size are sampled with their filter: at twice the size a linear one averages 2 x 2 pixels.
  // Where nothing can be known, the displacement falls smoothly to 0. Errors: GpuFailure, Unsupported.
  virtual Status compute(gpu::TextureId a, gpu::TextureId b, int width, int height) = 0;
  virtual gpu::TextureId flow() const = 0;  // valid until the next compute
};

enum class FlowMethod { Farneback, Dis };

struct FlowOptions {
  FlowMethod method = FlowMethod::Farneback;
  int finest = 2;  // Dis: its finest patches lie so many octaves below width × height
  // A displacement is taken in full that removes this share of the difference's variance round the pixel, one that
  // removes less in proportion; 0: whatever it removes. OpenCV's flow has neither this nor `finest`.
  double must_explain = 0;
  // A displacement of this many pixels of the flow or more need not explain anything, one from half as long on less and
  // less: short ones are mostly noise of sampling. 0: all must explain. OpenCV's flow does not have it.
  double sure_px = 0;
  int levels = 4;           // Farneback: pyramid, factor 2
  int window = 13;          // Farneback: averaging window, pixels; odd
  int iterations = 3;       // per level
  int poly_n = 5;           // Farneback: neighbourhood of the polynomial expansion; 5 or 7
  double poly_sigma = 1.1;  // of the expansion's weights, pixels
};

// Farnebäck 2003 as fragment passes, or the fast DIS (Kroeger 2016). Needs float render targets (Caps); programs and
// targets are made at the first use. Errors: Unsupported.
Result<std::unique_ptr<FlowSource>> createGpuFlow(gpu::Device& device, const FlowOptions& options = {});

}  // namespace fourdvt::render
