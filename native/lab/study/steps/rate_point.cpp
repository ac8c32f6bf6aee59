// SPDX-License-Identifier: Apache-2.0
#include "lab/study/steps/rate_point.h"

#include <cstdio>

#include "base/watch.h"
#include "lab/study/run/scene.h"
#include "lab/study/steps/codec.h"
#include "package/barcode.h"

namespace fourdvt::study {
namespace {

struct FileCloser {
  void operator()(std::FILE* f) const { std::fclose(f); }
};
using File = std::unique_ptr<std::FILE, FileCloser>;

void add(const RateView& view, const Image& drawn, RateScore& sum) {
  if (!view.truth.empty()) sum.truth.add(measure::scorePicture(view.truth, drawn));
  sum.uncompressed.add(measure::scorePicture(view.uncompressed, drawn));
}

package::Rendition renditionOf(const RateClip& clip) {
  package::Rendition r;
  r.width = clip.layout.width;
  r.height = clip.layout.height;
  r.layers = clip.layout.layers;
  r.barcode = clip.layout.barcode;
  return r;
}

}  // namespace

Status appendPicture(const std::string& path, const encode::I420Picture& picture, bool first) {
  const File file(std::fopen(path.c_str(), first ? "wb" : "ab"));
  bool ok = file != nullptr;
  for (const auto* plane : {&picture.y, &picture.u, &picture.v})
    ok = ok && std::fwrite(plane->data(), 1, plane->size(), file.get()) == plane->size();
  if (ok && std::fflush(file.get()) == 0) return {};
  return Error{ErrorId::WriteFailed, path + ": cannot write; free disk space or choose another report folder"};
}

Result<std::unique_ptr<RateMeter>> RateMeter::create(gpu::Device& device, const RateClip& clip) {
  std::unique_ptr<RateMeter> meter(new RateMeter(device, clip));
  FOURDVT_ASSIGN(meter->figure_, render::PlainFigure::create(device, clip.character, *clip.mesh));
  meter->figure_.setLayout(renditionOf(clip));
  FOURDVT_ASSIGN(meter->picture_, render::createPicture(device, clip.layout.width, clip.layout.height,
                                                        render::PictureTextures::Kind::I420));
  FOURDVT_ASSIGN(meter->recipe_, render::Recipe::create(device));
  return meter;
}

Result<Image> RateMeter::draw(const I420View& picture, uint32_t frame, const PinholeCamera& camera) {
  render::uploadPicture(device_, picture_, picture);
  figure_.setFrame(device_, clip_.positions[frame], clip_.labels[frame]);
  const render::View view = render::viewFromCamera(camera);
  return still_.render(
      view, [&](gpu::TargetId target) { return figure_.draw(*recipe_, picture_, view, studyRecipe(), target); });
}

Status RateMeter::readPicture(uint32_t frame, encode::I420Picture& picture) const {
  const File file(std::fopen(clip_.pictures_path.c_str(), "rb"));
  const size_t bytes = picture.y.size() + picture.u.size() + picture.v.size();
  bool ok = file && fseeko(file.get(), static_cast<off_t>(bytes * frame), SEEK_SET) == 0;
  for (auto* plane : {&picture.y, &picture.u, &picture.v})
    ok = ok && std::fread(plane->data(), 1, plane->size(), file.get()) == plane->size();
  if (ok) return {};
  return Error{ErrorId::FileUnreadable, clip_.pictures_path + ": cannot be read; run the study again"};
}

Status RateMeter::drawUncompressed(std::vector<RateView>& views) {
  encode::I420Picture picture(clip_.layout.width, clip_.layout.height);
  for (RateView& view : views) {
    FOURDVT_TRY(readPicture(view.frame, picture));
    FOURDVT_ASSIGN(view.uncompressed, draw(picture.view(), view.frame, view.camera));
  }
  return {};
}

RateScore RateMeter::scoreUncompressed(const std::vector<RateView>& views) const {
  RateScore score;
  for (const RateView& view : views) add(view, view.uncompressed, score);
  return score;
}

Result<encode::EncodedGop> RateMeter::encodeGop(const encode::EncodeSettings& settings, size_t gop,
                                                double& seconds) const {
  const uint32_t first = clip_.gop_first_frames[gop];
  const uint32_t end = gop + 1 < clip_.gop_first_frames.size() ? clip_.gop_first_frames[gop + 1] : clip_.frame_count;
  encode::I420Picture picture(settings.width, settings.height);
  std::unique_ptr<encode::GopEncoder> encoder;
  const auto timed = [&](auto step) {
    const Watch watch;
    auto result = step();
    seconds += watch.seconds();
    return result;
  };
  FOURDVT_ASSIGN(encoder, timed([&] { return encode::GopEncoder::create(settings); }));
  for (uint32_t f = first; f < end; ++f) {
    FOURDVT_TRY(readPicture(f, picture));
    FOURDVT_TRY(timed([&] { return encoder->push(picture.view()); }));
  }
  return timed([&] { return encoder->finish(); });
}

Status RateMeter::scoreGop(const encode::EncodeSettings& settings, const encode::EncodedGop& gop, uint32_t first_frame,
                           const std::vector<RateView>& views, RateScore& sum) {
  const auto score = [&](uint32_t in_gop, const I420View& picture) -> Status {
    const uint32_t frame = first_frame + in_gop;
    const auto barcode = package::readBarcode(clip_.layout.barcode, picture);
    sum.unreadable_barcodes += barcode != std::optional<uint32_t>(frame % 4096);
    for (const RateView& view : views) {
      if (view.frame != frame) continue;
      FOURDVT_ASSIGN(const Image drawn, draw(picture, view.frame, view.camera));
      add(view, drawn, sum);
    }
    return {};
  };
  FOURDVT_ASSIGN([[maybe_unused]] const size_t pictures, decodeGop(settings.codec, gop, score));
  return {};
}

Result<RateScore> RateMeter::measure(const encode::EncodeSettings& given, const std::vector<RateView>& views) {
  encode::EncodeSettings settings = given;
  settings.width = clip_.layout.width;
  settings.height = clip_.layout.height;
  settings.fps = clip_.fps;
  RateScore score;
  double bytes = 0, seconds = 0;
  for (size_t g = 0; g < clip_.gop_first_frames.size(); ++g) {
    FOURDVT_ASSIGN(auto gop, encodeGop(settings, g, seconds));
    for (const encode::EncodedPacket& packet : gop.packets) bytes += double(packet.bytes.size());
    FOURDVT_TRY(scoreGop(settings, gop, clip_.gop_first_frames[g], views, score));
  }
  score.video_bps = 8 * bytes * clip_.fps / clip_.frame_count;
  score.encode_ms_frame = 1000 * seconds / clip_.frame_count;
  return score;
}

}  // namespace fourdvt::study
