// SPDX-License-Identifier: Apache-2.0
// What playing a character from cameras takes beyond layered ones, behind an interface: a player without it can be
// linked, and refuses such characters. Holds no state: that is the caller's.
#pragma once

#include <memory>
#include <vector>

#include "player/parts/frame_geometry.h"
#include "render/character_model.h"
#include "render/method.h"

namespace fourdvt {

// A frame of a character from cameras as a track shows it.
struct SurfaceFrame {
  std::vector<glm::uvec3> faces;
  uint64_t topology_serial = 0;  // changes with the faces; 0: none yet
  std::vector<render::CameraSource> sources;
  render::CameraLook look;  // refers to `sources`; without a picture
};

class CameraParts {
 public:
  virtual ~CameraParts() = default;
  // package::SurfaceChunk::open.
  virtual Result<std::unique_ptr<package::SurfaceChunk>> open(std::span<const uint8_t> bytes,
                                                              const package::StreamIndex& index, uint32_t chunk,
                                                              const package::Character& character,
                                                              const package::Sequence& sequence) const = 0;
  // Errors: GpuFailure.
  virtual Result<render::CharacterModel> makeModel(gpu::Device& device, const package::Character& character) const = 0;
  // Places the cameras' pictures of this GOP in the decoded pictures of this rendition of the sequence.
  virtual void placePictures(const package::Character& character, const package::Sequence& sequence,
                             const package::Rendition& rendition, const package::SurfaceChunk& chunk,
                             SurfaceFrame& frame) const = 0;
  // The decoded surface of the frame.
  virtual void takeSurface(const FrameGeometry& geometry, Positions& positions, SurfaceFrame& frame) const = 0;
  // The model gets the frame's faces, which `vertices` belong to.
  virtual void setTopology(gpu::Device& device, const SurfaceFrame& frame, size_t vertices,
                           render::CharacterModel& model) const = 0;
};

const CameraParts& cameraParts();

}  // namespace fourdvt
