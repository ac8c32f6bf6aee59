// SPDX-License-Identifier: Apache-2.0
#include "bake/run/renditions.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "bake/run/stage_table.h"
#include "base/text.h"
#include "package/chunk_counts.h"

namespace fourdvt::bake {
namespace {

constexpr int kMinTexels = 64, kTexelStep = 32;  // sides of further layers are then multiples of 16

bool isShare(double size) { return size <= 1; }
bool fromCameras(const BakeOptions& o) { return o.appearance == package::AppearanceKind::Cameras; }

std::string textOf(const LowerRendition& r) { return printed("%g:%d:%s", r.size, r.crf, encode::infoOf(r.codec).name); }

bool parseNumber(const std::string& text, double& out) {
  char* end = nullptr;
  out = std::strtod(text.c_str(), &end);
  return !text.empty() && *end == 0 && std::isfinite(out);
}

std::vector<std::string> split(const std::string& entry) {
  std::vector<std::string> out(1);
  for (char c : entry) {
    if (c == ':')
      out.emplace_back();
    else
      out.back() += c;
  }
  return out;
}

std::string parseOne(const std::string& entry, LowerRendition& out) {
  const std::vector<std::string> parts = split(entry);
  double crf = 0;
  if (parts.size() < 2 || parts.size() > 3 || !parseNumber(parts[0], out.size) || !parseNumber(parts[1], crf))
    return "\"" + entry + "\" is not SIZE:CRF or SIZE:CRF:CODEC";
  if (parts.size() == 3 && !encode::parseCodec(parts[2], out.codec))
    return "\"" + entry + "\": the codec must be one of " + encode::codecNames();
  const int highest = encode::infoOf(out.codec).highest_crf;
  if (!(crf >= 0 && crf <= highest) || crf != std::floor(crf))
    return "\"" + entry + "\": the CRF must be 0 to " + std::to_string(highest) + " for " +
           encode::infoOf(out.codec).name;
  out.crf = static_cast<int>(crf);
  return {};
}

std::string checkSize(const LowerRendition& r, const BakeOptions& o) {
  if (o.appearance && isShare(r.size) != fromCameras(o))
    return fromCameras(o) ? "its size must be a share of the highest's sides, such as 0.5, for a character from cameras"
                          : "its size must be texels of layer 1, such as 384, for a character from layers";
  if (isShare(r.size)) {
    const double eighths = r.size * 8;
    if (eighths >= 1 && eighths == std::floor(eighths)) return {};
    return "its size must be a multiple of 0.125 from 0.125 to 1";
  }
  if (r.size > o.texture) return "it has more texels than the highest, " + std::to_string(o.texture);
  if (r.size >= kMinTexels && std::fmod(r.size, kTexelStep) == 0) return {};
  return "its size must be a multiple of " + std::to_string(kTexelStep) + " from " + std::to_string(kMinTexels) +
         " texels";
}

// CRF of the highest plus `steps` of x264's scale. By the measurements in quality.cpp, 7 steps halve the bitrate; VP9
// and AV1 need 10.
int coarser(const BakeOptions& o, int steps) {
  const int scaled = o.codec == encode::Codec::H264 ? steps : static_cast<int>(std::lround(steps * 10 / 7.0));
  return std::min(o.crf + scaled, encode::infoOf(o.codec).highest_crf);
}

RenditionPlan planOf(const LowerRendition& r, const BakeOptions& o, const StreamPlan& stream) {
  RenditionPlan out;
  out.suffix = fileSuffix(r, o);
  if (fromCameras(o)) {
    out.eighths = static_cast<int>(std::lround(r.size * 8));
    out.shrunk = out.eighths < 8;
    const encode::CameraPicture picture = encode::scaledPicture(stream.cameras, out.eighths);
    out.tiles = picture.tiles;
    out.layout = {picture.width, picture.height, {}, picture.barcode};
  } else {
    const int texels = static_cast<int>(r.size);
    out.shrunk = texels < o.texture;
    out.layout =
        encode::makeTileLayout(o.layers, texels, o.equal_layers, static_cast<int>(stream.motion.members.size()));
  }
  out.encode = {out.layout.width, out.layout.height, stream.encode().fps, r.crf, r.codec, r.preset, {}};
  return out;
}

}  // namespace

std::string parseRenditions(const std::vector<std::string>& entries, const BakeOptions& options,
                            std::vector<LowerRendition>& out) {
  for (const std::string& entry : entries) {
    LowerRendition& r = out.emplace_back();
    r.codec = options.codec;
    if (const std::string wrong = parseOne(entry, r); !wrong.empty()) return wrong;
  }
  return {};
}

std::vector<LowerRendition> standardRenditions(const BakeOptions& o) {
  const int texels = std::max(kMinTexels, (o.texture * 3 / 8 + kTexelStep / 2) / kTexelStep * kTexelStep);
  const double same = fromCameras(o) ? 1 : o.texture, small = fromCameras(o) ? 0.5 : texels;
  std::vector<LowerRendition> out{{small, coarser(o, 5), o.codec, o.preset}};
  if (const int crf = coarser(o, 7); crf > o.crf) out.push_back({same, crf, o.codec, o.preset});
  return out;
}

std::string checkRenditions(const BakeOptions& o) {
  const std::vector<LowerRendition>& all = o.lower_renditions;
  if (all.size() >= package::kMaxRenditions)
    return "a character holds at most " + std::to_string(package::kMaxRenditions) +
           " renditions, the highest included, not " + std::to_string(all.size() + 1);
  for (auto r = all.begin(); r != all.end(); ++r) {
    if (const std::string wrong = checkSize(*r, o); !wrong.empty()) return "rendition " + textOf(*r) + ": " + wrong;
    const bool as_large = r->size == o.texture || r->size == 1;
    if (as_large && r->codec == o.codec && r->crf <= o.crf)
      return "rendition " + textOf(*r) + ": it is not below the highest, which --crf " + std::to_string(o.crf) +
             " and --codec " + encode::infoOf(o.codec).name + " set; leave it out";
    const auto same = [&](const LowerRendition& other) {
      return other.size == r->size && other.crf == r->crf && other.codec == r->codec;
    };
    if (std::find_if(all.begin(), r, same) != r) return "rendition " + textOf(*r) + ": is listed twice";
  }
  return {};
}

std::string fileSuffix(const LowerRendition& r, const BakeOptions& o) {
  return printed(".%g-%d", r.size, r.crf) + (r.codec == o.codec ? "" : std::string("-") + encode::infoOf(r.codec).name);
}

void addLowerRenditions(const BakeOptions& options, StreamPlan& stream) {
  for (const LowerRendition& r : options.lower_renditions) stream.renditions.push_back(planOf(r, options, stream));
}

bool hasCoarseGeometry(const BakeOptions& o) {
  const auto smaller = [&](const LowerRendition& r) { return r.size < o.texture; };
  return !fromCameras(o) && *o.coarse_step_m > *o.position_step_m &&
         std::any_of(o.lower_renditions.begin(), o.lower_renditions.end(), smaller);
}

double ladderTexels(const BakeOptions& o) {
  double sum = 1;
  for (const LowerRendition& r : o.lower_renditions) {
    const double share = isShare(r.size) ? r.size : r.size / o.texture;
    sum += share * share;
  }
  return sum;
}

double encodeWork(const BakeOptions& options) {
  return infoOf(Stage::Encode).work_s * 0.5 * (1 + ladderTexels(options));
}

namespace {

std::vector<package::Rect> partsOf(const StreamPlan& plan, const RenditionPlan& rendition, uint32_t gop) {
  if (plan.cameras.gops.empty()) return rendition.layout.layers;
  std::vector<package::Rect> out;
  for (const package::CameraTile& tile : plan.cameras.gops[gop])
    if (!tile.empty()) out.push_back(encode::scaledCells(encode::cellsOf(tile.tile), rendition.eighths));
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
      rung.picture = encode::I420Picture(rendition.layout.width, rendition.layout.height);
    }
    FOURDVT_ASSIGN(rung.encoder, encode::GopEncoder::create(rendition.encode));
  }
  return out;
}

// Runs the highest rendition on the calling thread: it is the largest share of the work.
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
    encode::tileShrunk(rung.rects, parts, rung.plan->layout.barcode, frame, rung.picture);
    return rung.encoder->push(rung.picture.view());
  });
}

Result<std::vector<encode::EncodedGop>> LadderEncoder::finish() {
  FOURDVT_TRY(forEach([](Rung& rung) -> Status {
    FOURDVT_ASSIGN(rung.encoded, rung.encoder->finish());
    rung.encoder.reset();
    return {};
  }));
  std::vector<encode::EncodedGop> out;
  for (Rung& rung : rungs_) out.push_back(std::move(rung.encoded));
  return out;
}

}  // namespace fourdvt::bake
