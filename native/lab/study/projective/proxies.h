// SPDX-License-Identifier: Apache-2.0
// The surfaces that methods texture in this study, by name:
//   given           the capture's own
//   given-2000 …    the capture's own, simplified to about this many faces (bake::simplified)
//   hull            from the mattes alone: polyhedral, outlines to 1 px; hull-2px, hull-4px: coarser outlines
//   refined         the hull with its surface found by stereo: what `fourdvt reconstruct` makes by default
//   plane           a plane through the body's middle that faces the view (for light fields)
// Surfaces from pictures are cached in a folder.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "base/camera.h"
#include "lab/study/projective/frame_window.h"
#include "reconstruct/run/frame_surface.h"

namespace fourdvt::study {

class Proxies {
 public:
  // `folder`: cache of surfaces from pictures. `device`: for stereo.
  Proxies(const capture::Capture& capture, gpu::Device& device, std::string folder)
      : capture_(capture), device_(device), folder_(std::move(folder)) {}
  // All but "plane". Errors: InvalidArgument (no such proxy), those of captures and of SurfaceMaker.
  Result<TriangleMesh> surface(const std::string& proxy, FrameWindow& frames, uint32_t frame);

 private:
  // Reconstruction that continues from frame to frame of one sequence.
  struct Maker {
    reconstruct::SurfaceMaker surfaces;
    std::string sequence;
    uint32_t next = 0;
  };
  Result<TriangleMesh> reconstructed(const std::string& proxy, FrameWindow& frames, uint32_t frame);

  const capture::Capture& capture_;
  gpu::Device& device_;
  const std::string folder_;
  std::map<std::string, Maker> makers_;  // by proxy
};

// Grid of 32 × 32 quads through the centre of the surface's box, facing the view and covering the box.
TriangleMesh facingPlane(const Positions& surface, const PinholeCamera& view);

// Displaces the surface's vertices along their normals by up to `largest_mm`, smoothly over about 0.3 m.
TriangleMesh stoodOff(TriangleMesh surface, double largest_mm);

}  // namespace fourdvt::study
