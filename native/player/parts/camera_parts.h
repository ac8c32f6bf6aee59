// SPDX-License-Identifier: Apache-2.0
// A frame of a character from cameras, as a track shows it.
#pragma once

#include <vector>

#include "player/parts/frame_geometry.h"
#include "render/method.h"

namespace fourdvt {

struct SurfaceFrame {
  std::vector<glm::uvec3> faces;
  uint64_t topology_serial = 0;  // changes with the faces; 0: none yet
  std::vector<render::CameraSource> sources;
  render::CameraLook look;  // refers to `sources`; without a picture

  // Places the cameras' pictures of this GOP in the decoded pictures of this rendition of the sequence.
  void place(const package::Character& character, const package::Sequence& sequence,
             const package::Rendition& rendition, const package::SurfaceChunk& chunk);
  // Takes the decoded surface of the frame: positions, and faces if they changed.
  void take(const FrameGeometry& geometry, Positions& positions);
};

}  // namespace fourdvt
