// SPDX-License-Identifier: Apache-2.0
#include "bake/run/ladder_encoder.h"

namespace fourdvt::bake {
namespace {

std::vector<package::Rect> partsOf(const StreamPlan& plan, const RenditionPlan& rendition, uint32_t gop) {
  if (plan.cameras.gops.empty()) return rendition.layout.layers;
  std::vector<package::Rect> out;
  for (const package::CameraTile& tile : plan.cameras.gops[gop])
    if (!tile.empty()) out.push_back(scaledCells(cellsOf(tile.tile), rendition.eighths));
  return out;
}

}  // namespace

Result<std::unique_ptr<LadderEncoder>> LadderEncoder::create(const StreamPlan& plan, uint32_t gop, std::launch lane) {
  auto out = std::make_unique<LadderEncoder>();
  out->lane_ = lane;
  for (const RenditionPlan& rendition : plan.renditions) {
    Rung& rung = out->rungs_.emplace_back();
    rung.plan = &rendition;
    if (rendition.shrunk) {
      rung.rects = partsOf(plan, rendition, gop);
      rung.picture = I420Picture(rendition.layout.width, rendition.layout.height);
    }
    FOURDVT_ASSIGN(rung.encoder, GopEncoder::create(rendition.encode));
  }
  return out;
}

// The calling thread takes the highest rendition, which is the most work.
template <class Work>
Status LadderEncoder::forEach(const Work& work) {
  std::vector<std::future<Status>> others;
  for (size_t r = 1; r < rungs_.size(); ++r) others.push_back(std::async(lane_, [&, r] { return work(rungs_[r]); }));
  Status first = work(rungs_[0]);
  for (std::future<Status>& other : others)
    if (Status status = other.get(); first.ok()) first = std::move(status);
  return first;
}

Status LadderEncoder::push(const I420View& highest, const std::vector<const Image*>& parts, uint32_t frame) {
  return forEach([&](Rung& rung) {
    if (!rung.plan->shrunk) return rung.encoder->push(highest);
    tileShrunk(rung.rects, parts, rung.plan->layout.barcode, frame, rung.picture);
    return rung.encoder->push(rung.picture.view());
  });
}

Result<std::vector<EncodedGop>> LadderEncoder::finish() {
  FOURDVT_TRY(forEach([](Rung& rung) -> Status {
    FOURDVT_ASSIGN(rung.encoded, rung.encoder->finish());
    rung.encoder.reset();
    return {};
  }));
  std::vector<EncodedGop> out;
  for (Rung& rung : rungs_) out.push_back(std::move(rung.encoded));
  return out;
}

}  // namespace fourdvt::bake
