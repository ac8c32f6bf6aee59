// SPDX-License-Identifier: Apache-2.0
// Encodes one GOP of all renditions of a stream, each with an encoder of its own. Lower renditions that are smaller
// show what the highest shows, shrunk. Memory: one picture of every smaller rendition, and the encoders' lookahead.
#pragma once

#include <future>
#include <memory>
#include <vector>

#include "bake/run/job.h"

namespace fourdvt::bake {

class LadderEncoder {
 public:
  // `plan` outlives it. lane: how renditions run beside one another. Errors: those of GopEncoder::create.
  static Result<std::unique_ptr<LadderEncoder>> create(const StreamPlan& plan, uint32_t gop, std::launch lane);
  // highest: the tiled picture of the frame. parts: what is tiled in it, [member][layer], or the tiles of the cameras
  // that have one.
  Status push(const I420View& highest, const std::vector<const Image*>& parts, uint32_t frame);
  // [rendition] of the plan; ends the GOP.
  Result<std::vector<EncodedGop>> finish();

 private:
  struct Rung {
    const RenditionPlan* plan = nullptr;
    std::vector<package::Rect> rects;  // of the parts in `picture`
    I420Picture picture;               // of a shrunk rendition
    std::unique_ptr<GopEncoder> encoder;
    EncodedGop encoded;
  };
  template <class Work>
  Status forEach(const Work& work);

  std::vector<Rung> rungs_;
  std::launch lane_ = std::launch::deferred;
};

}  // namespace fourdvt::bake
