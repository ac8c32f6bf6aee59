// SPDX-License-Identifier: Apache-2.0
// Cache of GOPs: lists those that playback needs next, and evicts the least recently used above the budget. Pure logic
// over encoded bytes and decoded geometry, without fetches.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "package/chunk_decoder.h"
#include "package/surface_chunk.h"

namespace fourdvt {

struct GopKey {
  int sequence = -1;
  uint32_t gop = 0;
  auto operator<=>(const GopKey&) const = default;
};

enum class PartState { Absent, Fetching, Present, Failed };

struct Gop {
  static constexpr uint32_t kNoRow = UINT32_MAX;
  PartState video_state = PartState::Absent, chunk_state = PartState::Absent;
  uint32_t rendition = 0;                      // rendition of `video`, loaded or requested
  std::vector<uint8_t> video;                  // the GOP's samples, contiguous as in the file
  PartState better_state = PartState::Absent;  // replacement samples in another rendition
  uint32_t better_rendition = 0;
  std::vector<uint8_t> better;
  std::vector<uint8_t> chunk;                // encoded geometry
  bool coarse = false;                       // `chunk`, loaded or requested, is a coarse one
  PartState fine_state = PartState::Absent;  // chunk that replaces a coarse one
  std::vector<uint8_t> fine;
  uint32_t row = kNoRow;                            // row requested last
  std::unique_ptr<package::ChunkDecoder> geometry;  // decoder of `chunk`, as far as requested
  bool damaged = false;                             // chunk does not decode
  std::unique_ptr<package::SurfaceChunk> surfaces;  // decoder of `chunk`, character from cameras
  uint32_t job = 0;   // decode job of `geometry` (Loading::decodeElsewhere); 0: decoded here
  bool here = false;  // decode here: decoding elsewhere failed
  uint64_t last_use = 0;
  uint64_t encodedBytes() const { return video.size() + chunk.size() + better.size() + fine.size(); }
  bool decoded() const { return geometry || surfaces; }
  void dropDecoded() {
    geometry.reset();
    surfaces.reset();
    job = 0;
  }
  uint64_t decodedBytes() const { return geometry ? geometry->frames().bytes() : surfaces ? surfaces->bytes() : 0; }
  uint32_t decodedRows() const { return geometry ? geometry->decodedCount() : surfaces ? surfaces->decodedCount() : 0; }
};

class GopCache {
 public:
  explicit GopCache(uint64_t encoded_budget_bytes, uint64_t decoded_budget_bytes = 32u << 20)
      : encoded_budget_bytes_(encoded_budget_bytes), decoded_budget_bytes_(decoded_budget_bytes) {}
  Gop& touch(GopKey key);  // creates on demand; marks as used
  Gop* find(GopKey key);   // null if not held
  const Gop* find(GopKey key) const;
  // Evicts least recently used GOPs that are neither kept nor being fetched, until the encoded bytes are within their
  // budget; then decoded geometry of unkept GOPs, until that is within its own, so that a short loop is decoded once.
  void trim(const std::vector<GopKey>& keep);
  void dropSequence(int sequence);
  uint64_t encodedBytes() const;
  uint64_t decodedBytes() const;
  bool hasRoomForDecoded() const { return decodedBytes() < decoded_budget_bytes_; }
  size_t decodedCount() const;

 private:
  using Entry = std::map<GopKey, Gop>::iterator;
  // Least recently used entry that satisfies `may_go`; end if none.
  template <class MayGo>
  Entry oldest(const MayGo& may_go);

  uint64_t encoded_budget_bytes_, decoded_budget_bytes_, uses_ = 0;
  std::map<GopKey, Gop> gops_;
};

// GOPs to hold for playback from `frame`, nearest first: the frame's own, the next one, and more until they have
// `ahead` frames from `frame` on; wraps if looping.
std::vector<uint32_t> neededGops(const package::StreamIndex& index, uint32_t frame, bool loop, uint32_t ahead);

}  // namespace fourdvt
