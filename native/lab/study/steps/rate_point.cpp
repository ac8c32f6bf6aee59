// SPDX-License-Identifier: Apache-2.0
#include "lab/study/steps/rate_point.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "base/watch.h"
#include "measure/metrics.h"
#include "package/barcode.h"
#include "platform/ffmpeg_video.h"

namespace fourdvt::study {
namespace {

struct FileCloser {
  void operator()(std::FILE* f) const { std::fclose(f); }
};
using File = std::unique_ptr<std::FILE, FileCloser>;

struct PairScore {
  double ssim = std::numeric_limits<double>::quiet_NaN(), psnr_db = ssim;
};

// Scores both over black, over the union of their silhouettes.
PairScore compare(const Image& truth, const Image& drawn) {
  if (truth.empty()) return {};
  const Image a = measure::compositedOnBlack(truth), b = measure::compositedOnBlack(drawn);
  const measure::Mask inside = measure::unionOfSilhouettes(truth, drawn);
  // Clamps the infinite PSNR of equal pictures, so that means stay finite.
  return {measure::ssim(a, b, inside), std::min(measure::psnr(a, b, inside), 99.0)};
}

void add(const RateView& view, const Image& drawn, RateScore& sum) {
  const PairScore truth = compare(view.truth, drawn), codec = compare(view.uncompressed, drawn);
  sum.ssim_fg += truth.ssim;
  sum.psnr_fg_db += truth.psnr_db;
  sum.ssim_fg_vs_uncompressed += codec.ssim;
  sum.psnr_fg_vs_uncompressed_db += codec.psnr_db;
}

void divide(RateScore& sum, size_t views) {
  for (double* v : {&sum.ssim_fg, &sum.psnr_fg_db, &sum.ssim_fg_vs_uncompressed, &sum.psnr_fg_vs_uncompressed_db})
    *v /= double(views);
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

Status RateMeter::prepareTarget(int width, int height) {
  if (width == target_width_ && height == target_height_) return {};
  gpu::TextureDesc texture;
  texture.width = width;
  texture.height = height;
  texture.label = "rate view";
  FOURDVT_ASSIGN(auto color, gpu::makeTexture(device_, texture));
  gpu::TargetDesc desc;
  desc.colors = {color.id()};
  desc.width = width;
  desc.height = height;
  desc.label = "rate view";
  FOURDVT_ASSIGN(target_, gpu::makeTarget(device_, desc));
  color_ = std::move(color);
  target_width_ = width;
  target_height_ = height;
  return {};
}

Result<Image> RateMeter::draw(const I420View& picture, uint32_t frame, const PinholeCamera& camera) {
  FOURDVT_TRY(prepareTarget(camera.width, camera.height));
  render::uploadPicture(device_, picture_, picture);
  figure_.setFrame(device_, clip_.positions[frame], clip_.labels[frame]);
  render::RecipeOptions options;
  options.ground_shadow = false;
  FOURDVT_TRY(figure_.draw(*recipe_, picture_, render::viewFromCamera(camera), options, target_.id()));
  Image image(camera.width, camera.height, 4);
  FOURDVT_TRY(device_.readPixels(target_.id(), gpu::PixelFormat::RGBA8,
                                 {.width = camera.width, .height = camera.height}, image.pixels.data()));
  unpremultiply(image);
  return image;
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
  divide(score, views.size());
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
  Status drawing;
  FOURDVT_ASSIGN(auto decoder,
                 platform::SampleDecoder::create(
                     encode::infoOf(settings.codec).kind, {}, [&](const I420View& picture, int64_t frame) {
                       const auto barcode = package::readBarcode(clip_.layout.barcode, picture);
                       sum.unreadable_barcodes +=
                           barcode != std::optional<uint32_t>(static_cast<uint32_t>(frame) % 4096);
                       for (const RateView& view : views) {
                         if (view.frame != frame || !drawing.ok()) continue;
                         auto drawn = draw(picture, view.frame, view.camera);
                         if (drawn)
                           add(view, drawn.value(), sum);
                         else
                           drawing = drawn.error();
                       }
                     }));
  for (const encode::EncodedPacket& packet : gop.packets) {
    std::vector<uint8_t> bytes;
    if (packet.key && settings.codec == encode::Codec::H264) bytes = gop.parameter_sets;
    bytes.insert(bytes.end(), packet.bytes.begin(), packet.bytes.end());
    FOURDVT_TRY(decoder->decode(bytes, int64_t(first_frame) + packet.frame, packet.key));
  }
  FOURDVT_TRY(decoder->flush());
  return drawing;
}

Result<RateScore> RateMeter::measure(const encode::EncodeSettings& given, const std::vector<RateView>& views) {
  encode::EncodeSettings settings = given;
  settings.width = clip_.layout.width;
  settings.height = clip_.layout.height;
  settings.fps = clip_.fps;
  RateScore score;
  score.encoder_codec = encode::infoOf(settings.codec).name;
  double bytes = 0, seconds = 0;
  for (size_t g = 0; g < clip_.gop_first_frames.size(); ++g) {
    FOURDVT_ASSIGN(auto gop, encodeGop(settings, g, seconds));
    for (const encode::EncodedPacket& packet : gop.packets) bytes += double(packet.bytes.size());
    FOURDVT_TRY(scoreGop(settings, gop, clip_.gop_first_frames[g], views, score));
  }
  divide(score, views.size());
  score.video_bps = 8 * bytes * clip_.fps / clip_.frame_count;
  score.encode_ms_frame = 1000 * seconds / clip_.frame_count;
  return score;
}

}  // namespace fourdvt::study
