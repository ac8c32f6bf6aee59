// SPDX-License-Identifier: Apache-2.0
// One GOP of a character from cameras: placement of each camera's picture in the tiled picture, and the surfaces of its
// frames. Consecutive frames of one topology are a run: its first surface is coded as a mesh, the others as motion.
// Byte layout: FORMAT.md, "A chunk of a stream from cameras".
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/bytes.h"
#include "base/mesh.h"
#include "package/character.h"
#include "package/stream_file.h"

namespace fourdvt::package {

// Placement of one camera's picture, in all frames of a GOP.
struct CameraTile {
  Rect source;                                      // pixels of the camera picture
  Rect tile;                                        // texels of the sequence's layout; the source is scaled to it
  bool empty() const { return source.width == 0; }  // GOP without a picture of this camera
};

struct Surface {
  uint32_t topology = 0;                 // run number within the chunk
  std::span<const glm::uvec3> faces;     // indices < positions.size(), counter-clockwise seen from outside
  std::span<const glm::vec3> positions;  // metres
};

class SurfaceChunk {
 public:
  // `bytes` is borrowed for the object's life. Errors: StreamInvalid.
  static Result<std::unique_ptr<SurfaceChunk>> open(std::span<const uint8_t> bytes, const StreamIndex& index,
                                                    uint32_t chunk, const Character& character,
                                                    const Sequence& sequence);
  ~SurfaceChunk();
  // Decodes until frames 0..frame of the chunk, or all of them, are present. Errors: StreamInvalid, from then on
  // always.
  Status decodeTo(uint32_t frame);
  uint32_t decodedCount() const { return static_cast<uint32_t>(frames_.size()); }
  // Surface of a decoded frame; valid for the chunk's life.
  Surface surface(uint32_t frame) const;
  std::span<const CameraTile> tiles() const { return tiles_; }                   // one per camera of the character
  uint64_t bytes() const { return bytes_ + tiles_.size() * sizeof(tiles_[0]); }  // held in memory

 private:
  class Motion;  // positions of a run's frames
  struct Run {
    uint32_t first = 0, frame_count = 0;
    std::span<const uint8_t> mesh, motion;
    std::vector<glm::uvec3> faces;  // set once the first frame is decoded
  };
  struct Frame {
    uint32_t run;
    Positions positions;
  };

  SurfaceChunk(const StreamIndex& index, uint32_t chunk);
  Status read(std::span<const uint8_t> bytes, const Character& character, const Sequence& sequence);
  Status readTiles(ByteReader& in, const Character& character, const Sequence& sequence);
  Status readRuns(ByteReader& in);
  // False: corrupt.
  bool decodeNext();
  bool beginRun(uint32_t frame);
  bool moveOn(uint32_t frame);
  bool append(const std::vector<glm::ivec3>& quantised);

  const uint32_t frame_count_, max_vertices_, max_faces_;
  const glm::vec3 origin_;
  const float step_m_;
  std::vector<CameraTile> tiles_;
  std::vector<Run> runs_;
  std::vector<Frame> frames_;       // decoded frames
  uint32_t run_ = 0;                // run of the last decoded frame
  std::unique_ptr<Motion> motion_;  // decoder of this run, until its last frame
  uint64_t bytes_ = 0;
  bool broken_ = false;
};

// position = origin + step * q, with the header's origin and step.
struct QuantisedSurface {
  std::vector<glm::uvec3> faces;
  std::vector<glm::ivec3> positions;
};

struct EncodedSurfaces {
  std::vector<uint8_t> bytes;                 // the chunk
  uint32_t vertex_count = 0, face_count = 0;  // maximum over the decoded frames
  uint32_t run_count = 0;
};

// Encodes a chunk; tiles: one per camera. Drops vertices without a face and faces without three different vertices;
// Draco may repeat vertices where more than one sheet of the surface meets. Native only. Errors: Internal.
Result<EncodedSurfaces> encodeSurfaceChunk(std::span<const CameraTile> tiles, std::span<const QuantisedSurface> frames);

}  // namespace fourdvt::package
