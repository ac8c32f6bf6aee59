// SPDX-License-Identifier: Apache-2.0
// The ladder: renditions below the highest, which BakeOptions' own fields describe. Parses and checks them, supplies
// the standard ladder, and encodes a stream's renditions.
#pragma once

#include <future>
#include <memory>
#include <string>
#include <vector>

#include "bake/run/job.h"

namespace fourdvt::bake {

// Reads entries SIZE:CRF or SIZE:CRF:CODEC; without a codec that of `options`. Presets stay empty. Returns an error
// message, or an empty string.
std::string parseRenditions(const std::vector<std::string>& entries, const BakeOptions& options,
                            std::vector<LowerRendition>& out);

// Two renditions, by the measurements of quality.cpp: half the bitrate, by a coarser CRF of the same picture; and
// less than a quarter, by 3/8 of the texels a side, from cameras half of the pixels. Renditions that would not be
// below the highest are left out.
std::vector<LowerRendition> standardRenditions(const BakeOptions& options);

// Returns an error message on options.lower_renditions, or an empty string. Before the appearance is selected, sizes
// may be of either kind.
std::string checkRenditions(const BakeOptions& options);

// Suffix of a lower rendition's file name: ".384-34", or ".384-34-av1" if the highest has another codec.
std::string fileSuffix(const LowerRendition& rendition, const BakeOptions& options);

// Adds the lower renditions to a stream that has its highest.
void addLowerRenditions(const BakeOptions& options, StreamPlan& stream);

// True if a rendition below the highest uses coarser geometry (BakeOptions::coarse_step_m).
bool hasCoarseGeometry(const BakeOptions& options);

// Approximate texels of all renditions relative to the highest.
double ladderTexels(const BakeOptions& options);

// Work of one frame in the Encode stage; encoding is half of it with one rendition.
double encodeWork(const BakeOptions& options);

// Encodes one GOP of all renditions of a stream, each with an encoder of its own. Smaller lower renditions are scaled
// down from the highest's content. Memory: one picture of every smaller rendition, and the encoders' lookahead.

class LadderEncoder {
 public:
  // `plan` must outlive the encoder. lane: how renditions run beside one another. Errors: those of
  // GopEncoder::create.
  static Result<std::unique_ptr<LadderEncoder>> create(const StreamPlan& plan, uint32_t gop, std::launch lane);
  // highest: the tiled picture of the frame. parts: its tiled images, [member][layer], or the tiles of the cameras
  // that have one.
  Status push(const I420View& highest, const std::vector<const Image*>& parts, uint32_t frame);
  // [rendition] of the plan; ends the GOP.
  Result<std::vector<encode::EncodedGop>> finish();

 private:
  struct Rung {
    const RenditionPlan* plan = nullptr;
    std::vector<package::Rect> rects;  // rectangles of the parts in `picture`
    encode::I420Picture picture;       // scaled-down picture of the rendition
    std::unique_ptr<encode::GopEncoder> encoder;
    encode::EncodedGop encoded;
  };
  template <class Work>
  Status forEach(const Work& work);

  std::vector<Rung> rungs_;
  std::launch lane_ = std::launch::deferred;
};

}  // namespace fourdvt::bake
