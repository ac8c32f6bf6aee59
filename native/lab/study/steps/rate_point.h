// SPDX-License-Identifier: Apache-2.0
// One point of a rate-distortion curve: tiled pictures → encoder → decoder → renderer → scores of rendered views.
// rate.cpp bakes the layers and chooses the points. Memory: one GOP of pictures.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "encode/encoder.h"
#include "encode/tile.h"
#include "gpu/device.h"
#include "measure/picture_score.h"
#include "package/base_mesh.h"
#include "package/character.h"
#include "render/plain_figure.h"
#include "render/still_target.h"

namespace fourdvt::study {

// Encoder input of a sequence, and the data for drawing it.
struct RateClip {
  encode::TileLayout layout;
  double fps = 25;
  uint32_t frame_count = 0;
  std::string pictures_path;               // concatenated frames of tiled I420
  std::vector<uint32_t> gop_first_frames;  // ascending, starts with 0
  std::vector<Positions> positions;  // per frame, in the decoded mesh's order; may be empty for frames without views
  std::vector<std::vector<uint8_t>> labels;  // per frame, [layer][face]; may be empty without views
  package::Character character;              // cameras, counts, bounds
  const package::BaseMesh* mesh = nullptr;   // borrowed
};

struct RateView {
  uint32_t frame = 0;
  PinholeCamera camera;
  Image truth;         // RGBA, straight alpha; empty if unavailable
  Image uncompressed;  // RGBA, straight alpha, drawn before the codec; set by drawUncompressed
};

struct RateScore {
  measure::MeanScores truth, uncompressed;  // against the views' pictures; no scores without a truth
  double video_bps = 0;                     // bits a second
  double encode_ms_frame = 0;               // one thread, wall clock
  uint32_t unreadable_barcodes = 0;         // pictures that players would reject
};

Status appendPicture(const std::string& path, const encode::I420Picture& picture, bool first);  // WriteFailed

class RateMeter {
 public:
  // Errors: GpuFailure.
  static Result<std::unique_ptr<RateMeter>> create(gpu::Device& device, const RateClip& clip);
  // Errors: FileUnreadable, GpuFailure.
  Status drawUncompressed(std::vector<RateView>& views);
  // Mean scores over the views, drawn from the pictures before the codec: the upper bound at any bitrate.
  RateScore scoreUncompressed(const std::vector<RateView>& views) const;
  // settings: size and fps are the clip's. Errors: those of encoder and decoder.
  Result<RateScore> measure(const encode::EncodeSettings& settings, const std::vector<RateView>& views);

 private:
  RateMeter(gpu::Device& device, const RateClip& clip) : device_(device), clip_(clip), still_(device) {}
  Result<Image> draw(const I420View& picture, uint32_t frame, const PinholeCamera& camera);
  Status readPicture(uint32_t frame, encode::I420Picture& picture) const;
  Result<encode::EncodedGop> encodeGop(const encode::EncodeSettings& settings, size_t gop, double& seconds) const;
  Status scoreGop(const encode::EncodeSettings& settings, const encode::EncodedGop& gop, uint32_t first_frame,
                  const std::vector<RateView>& views, RateScore& sum);

  gpu::Device& device_;
  const RateClip& clip_;
  render::PlainFigure figure_;
  render::PictureTextures picture_;
  std::unique_ptr<render::Recipe> recipe_;
  render::StillTarget still_;
};

}  // namespace fourdvt::study
