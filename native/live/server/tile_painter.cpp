// SPDX-License-Identifier: Apache-2.0
#include "live/server/tile_painter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "encode/camera_layout.h"
#include "live/server/tiles.h"
#include "package/barcode.h"
#include "platform/ffmpeg_handles.h"

namespace fourdvt::live {
namespace {

constexpr uint8_t kGreyLuma = 126, kGreyChroma = 128;
constexpr int kBlock = 8;                     // texels of luma
constexpr int kLevels = 3;                    // colours spread over blocks of up to 64 texels
constexpr float kSeesBackground = 1.0f / 32;  // share of background above which a texel's colour is mixed
constexpr double kLittle = 0.6;               // minimum scale for bilinear sampling, which skips no pixel from there up
constexpr int kShift = 16;

// Tables of BT.601 full → BT.709 limited, which is linear: luma depends on all three channels, chroma on chroma alone.
struct ColourTables {
  std::array<int, 256> yy, yu, yv, uu, uv, vu, vv;  // × 2^kShift

  ColourTables() {
    // Coefficients of chroma in −0.5…0.5: R − Y, B − Y and G − Y by BT.601; then BT.709's luma of them.
    const double r_v = 1.402, b_u = 1.772, g_u = -0.344136286, g_v = -0.714136286;
    const double l_u = 0.7152 * g_u + 0.0722 * b_u, l_v = 0.2126 * r_v + 0.7152 * g_v;
    const double to_u = 1 / 1.8556, to_v = 1 / 1.5748;
    const auto fixed = [](double v) { return int(std::lround(v * (1 << kShift))); };
    for (int i = 0; i < 256; ++i) {
      const double c = i - 128;
      yy[i] = fixed(16.5 + 219.0 / 255 * i);
      yu[i] = fixed(219.0 / 255 * l_u * c);
      yv[i] = fixed(219.0 / 255 * l_v * c);
      uu[i] = fixed(128.5 + 224.0 / 255 * to_u * (b_u - l_u) * c);
      uv[i] = fixed(224.0 / 255 * to_u * -l_v * c);
      vv[i] = fixed(128.5 + 224.0 / 255 * to_v * (r_v - l_v) * c);
      vu[i] = fixed(224.0 / 255 * to_v * -l_u * c);
    }
  }
};

const ColourTables& colourTables() {
  static const ColourTables tables;
  return tables;
}

uint8_t byteOf(int fixed) { return uint8_t(std::clamp(fixed >> kShift, 0, 255)); }

// Scales a rectangle of one plane into a rectangle of another: copy, bilinear for slight reduction, else area means,
// which are much slower.
void stretch(const uint8_t* from, int from_stride, const package::Rect& part, uint8_t* to, int to_stride,
             const package::Rect& place) {
  const cv::Mat in(part.height, part.width, CV_8U,
                   const_cast<uint8_t*>(from) + ptrdiff_t(part.y) * from_stride + part.x, size_t(from_stride));
  cv::Mat out(place.height, place.width, CV_8U, to + ptrdiff_t(place.y) * to_stride + place.x, size_t(to_stride));
  if (in.size() == out.size())
    in.copyTo(out);
  else
    cv::resize(in, out, out.size(), 0, 0, place.width > kLittle * part.width ? cv::INTER_LINEAR : cv::INTER_AREA);
}

package::Rect halved(const package::Rect& r) {
  const int x = r.x / 2, y = r.y / 2;
  return {x, y, std::max(1, (r.x + r.width) / 2 - x), std::max(1, (r.y + r.height) / 2 - y)};
}

}  // namespace

TilePainter::TilePainter(const PackedSize& size)
    : size_(size), luma_(size_t(size.width) * size.height), blue_(luma_.size() / 4), red_(luma_.size() / 4) {
  clear();
}

void TilePainter::clear() {
  std::fill(luma_.begin(), luma_.end(), kGreyLuma);
  std::fill(blue_.begin(), blue_.end(), kGreyChroma);
  std::fill(red_.begin(), red_.end(), kGreyChroma);
}

I420View TilePainter::view() const {
  return {size_.width, size_.height, luma_.data(),    blue_.data(),
          red_.data(), size_.width,  size_.width / 2, size_.width / 2};
}

void TilePainter::drawBarcode(uint32_t number) {
  package::drawBarcode(size_.barcode, number, luma_.data(), size_.width);
}

void TilePainter::draw(const package::CameraTile& tile, const JpegPlanes& planes, const package::Rect& crop,
                       const std::vector<Ring16>& rings) {
  if (tile.empty()) return;
  const package::Rect cells = encode::cellsOf(tile.tile);
  const auto resized = [](Plane& plane, int width, int height) {
    plane.width = width, plane.height = height;
    plane.texels.resize(size_t(width) * height);
  };
  for (Plane* plane : {&y_, &known_}) resized(*plane, cells.width, cells.height);
  for (Plane* plane : {&u_, &v_}) resized(*plane, cells.width / 2, cells.height / 2);
  std::memset(known_.texels.data(), 0, known_.texels.size());
  fetch(tile, planes, crop);
  const std::vector<float>& background =
      coverage_.draw(rings, tile.source, tile.tile.width, tile.tile.height, cells.width, cells.height);
  for (size_t i = 0; i < known_.texels.size(); ++i)
    known_.texels[i] &= background[i] < kSeesBackground ? uint8_t(255) : uint8_t(0);
  convert();
  fill();
  const auto put = [](Plane& plane, uint8_t* to, int stride, int x, int y) {
    for (int row = 0; row < plane.height; ++row)
      std::memcpy(to + size_t(y + row) * stride + x, plane.row(row), size_t(plane.width));
  };
  put(y_, luma_.data(), size_.width, cells.x, cells.y);
  put(u_, blue_.data(), size_.width / 2, cells.x / 2, cells.y / 2);
  put(v_, red_.data(), size_.width / 2, cells.x / 2, cells.y / 2);
}

// Copies the part of the source that the crop covers into the tile and marks it in known_.
void TilePainter::fetch(const package::CameraTile& tile, const JpegPlanes& planes, const package::Rect& crop) {
  const package::Rect& source = tile.source;
  const package::Rect shown = common(source, crop);
  if (shown.width < 2 || shown.height < 2) return;
  const double sx = double(tile.tile.width) / source.width, sy = double(tile.tile.height) / source.height;
  const auto at = [](double v, int most) { return std::clamp(int(std::lround(v)), 0, most); };
  const int x0 = at((shown.x - source.x) * sx, tile.tile.width), y0 = at((shown.y - source.y) * sy, tile.tile.height);
  const int x1 = at((shown.x - source.x + shown.width) * sx, tile.tile.width);
  const int y1 = at((shown.y - source.y + shown.height) * sy, tile.tile.height);
  if (x1 - x0 < 2 || y1 - y0 < 2) return;
  const package::Rect place{x0, y0, x1 - x0, y1 - y0};
  const package::Rect part{shown.x - crop.x, shown.y - crop.y, shown.width, shown.height};
  stretch(planes.y, planes.stride_y, part, y_.texels.data(), y_.width, place);
  stretch(planes.u, planes.stride_u, halved(part), u_.texels.data(), u_.width, halved(place));
  stretch(planes.v, planes.stride_v, halved(part), v_.texels.data(), v_.width, halved(place));
  for (int y = y0; y < (y1 & ~1); ++y) std::memset(known_.row(y) + x0, 255, size_t((x1 & ~1) - x0));
}

void TilePainter::convert() {
  const ColourTables& t = colourTables();
  for (int y = 0; y < u_.height; ++y) {
    uint8_t *u = u_.row(y), *v = v_.row(y), *above = y_.row(2 * y), *below = y_.row(2 * y + 1);
    for (int x = 0; x < u_.width; ++x) {
      const int cu = u[x], cv = v[x], shift = t.yu[cu] + t.yv[cv];
      for (uint8_t* luma : {above + 2 * x, above + 2 * x + 1, below + 2 * x, below + 2 * x + 1})
        *luma = byteOf(t.yy[*luma] + shift);
      u[x] = byteOf(t.uu[cu] + t.uv[cv]);
      v[x] = byteOf(t.vv[cv] + t.vu[cu]);
    }
  }
}

// Averages known texels per block.
void TilePainter::gather(Blocks& blocks) const {
  blocks.width = y_.width / kBlock, blocks.height = y_.height / kBlock;
  blocks.at.assign(size_t(blocks.width) * blocks.height, {});
  for (int by = 0; by < blocks.height; ++by)
    for (int bx = 0; bx < blocks.width; ++bx) {
      int count = 0, luma = 0, half_count = 0, blue = 0, red = 0;
      for (int y = 0; y < kBlock; ++y) {
        const size_t at = size_t(by * kBlock + y) * y_.width + size_t(bx) * kBlock;
        for (int x = 0; x < kBlock; ++x) {
          const int known = known_.texels[at + x] & 1;
          count += known, luma += known * y_.texels[at + x];
        }
      }
      if (count == 0) continue;
      for (int y = 0; y < kBlock / 2; ++y) {
        const size_t at = size_t(by * kBlock + 2 * y) * y_.width + size_t(bx) * kBlock;
        const size_t half = size_t(by * kBlock / 2 + y) * u_.width + size_t(bx) * kBlock / 2;
        for (int x = 0; x < kBlock / 2; ++x) {
          const int known = known_.texels[at + 2 * x] & known_.texels[at + 2 * x + 1] &
                            known_.texels[at + y_.width + 2 * x] & known_.texels[at + y_.width + 2 * x + 1] & 1;
          half_count += known, blue += known * u_.texels[half + x], red += known * v_.texels[half + x];
        }
      }
      if (half_count == 0) continue;
      const float weight = std::min(1.0f, float(count) / (kBlock * kBlock / 4));
      blocks.at[size_t(by) * blocks.width + bx] = {weight * float(luma) / float(count),
                                                   weight * float(blue) / float(half_count),
                                                   weight * float(red) / float(half_count), weight};
    }
}

// Interpolates the blocks' colours over the plane's unknown texels. step: texels of luma per texel of the plane.
void TilePainter::fillPlane(const Blocks& blocks, float Block::*channel, int step, Plane& plane) {
  small_.resize(blocks.at.size());
  for (size_t i = 0; i < small_.size(); ++i)
    small_[i] = uint8_t(std::clamp(blocks.at[i].*channel + 0.5f, 0.0f, 255.0f));
  smooth_.resize(plane.texels.size());
  const cv::Mat in(blocks.height, blocks.width, CV_8U, small_.data());
  cv::Mat out(plane.height, plane.width, CV_8U, smooth_.data());
  cv::resize(in, out, out.size(), 0, 0, cv::INTER_LINEAR);
  for (int y = 0; y < plane.height; ++y) {
    const uint8_t* known = known_.row(y * step);
    const uint8_t* below = known_.row(y * step + step - 1);
    const uint8_t* smooth = &smooth_[size_t(y) * plane.width];
    uint8_t* texel = plane.row(y);
    if (step == 1) {
      for (int x = 0; x < plane.width; ++x) texel[x] = uint8_t((texel[x] & known[x]) | (smooth[x] & ~known[x]));
      continue;
    }
    for (int x = 0; x < plane.width; ++x) {
      const uint8_t all = known[2 * x] & known[2 * x + 1] & below[2 * x] & below[2 * x + 1];
      texel[x] = uint8_t((texel[x] & all) | (smooth[x] & ~all));
    }
  }
}

void TilePainter::fill() {
  std::vector<Blocks> levels(kLevels + 1);
  gather(levels[0]);
  for (int l = 1; l <= kLevels; ++l) {  // sums of up to four blocks; weights saturate
    const Blocks& fine = levels[size_t(l) - 1];
    Blocks& coarse = levels[size_t(l)];
    coarse.width = (fine.width + 1) / 2, coarse.height = (fine.height + 1) / 2;
    coarse.at.assign(size_t(coarse.width) * coarse.height, {});
    for (int y = 0; y < fine.height; ++y)
      for (int x = 0; x < fine.width; ++x) {
        const Block& from = fine.at[size_t(y) * fine.width + x];
        Block& to = coarse.at[size_t(y / 2) * coarse.width + x / 2];
        to.y += from.y, to.u += from.u, to.v += from.v, to.weight += from.weight;
      }
    for (Block& b : coarse.at)
      if (b.weight > 1) b = {b.y / b.weight, b.u / b.weight, b.v / b.weight, 1};
  }
  for (Block& b : levels.back().at) {
    const float open = 1 - b.weight;
    b = {b.y + open * kGreyLuma, b.u + open * kGreyChroma, b.v + open * kGreyChroma, 1};
  }
  for (int l = kLevels - 1; l >= 0; --l) {  // bilinear samples of the coarser level, for the missing weight
    const Blocks& coarse = levels[size_t(l) + 1];
    Blocks& fine = levels[size_t(l)];
    for (int y = 0; y < fine.height; ++y)
      for (int x = 0; x < fine.width; ++x) {
        Block& to = fine.at[size_t(y) * fine.width + x];
        const float open = 1 - to.weight;
        if (open <= 0) continue;
        const int cx = x / 2, cy = y / 2;
        const int nx = std::clamp(cx + (x % 2 ? 1 : -1), 0, coarse.width - 1);
        const int ny = std::clamp(cy + (y % 2 ? 1 : -1), 0, coarse.height - 1);
        const auto mix = [&](float Block::*c) {
          const auto at = [&](int px, int py) { return coarse.at[size_t(py) * coarse.width + px].*c; };
          return 0.5625f * at(cx, cy) + 0.1875f * (at(nx, cy) + at(cx, ny)) + 0.0625f * at(nx, ny);
        };
        to = {to.y + open * mix(&Block::y), to.u + open * mix(&Block::u), to.v + open * mix(&Block::v), 1};
      }
  }
  fillPlane(levels[0], &Block::y, 1, y_);
  fillPlane(levels[0], &Block::u, 2, u_);
  fillPlane(levels[0], &Block::v, 2, v_);
}

namespace {

class FfmpegJpeg final : public JpegDecoder {
 public:
  Status open() {
    const AVCodec* codec = avcodec_find_decoder(AV_CODEC_ID_MJPEG);
    if (!codec) return Error{ErrorId::Unsupported, "this FFmpeg decodes no JPEG; install one that does"};
    context_.reset(avcodec_alloc_context3(codec));
    context_->thread_count = 1;
    context_->max_pixels = kMaxPixels;
    context_->err_recognition = AV_EF_EXPLODE;
    if (avcodec_open2(context_.get(), codec, nullptr) < 0)
      return Error{ErrorId::Unsupported, "the JPEG decoder of this FFmpeg does not open"};
    frame_.reset(av_frame_alloc());
    packet_.reset(av_packet_alloc());
    return {};
  }

  Result<JpegPlanes> decode(std::span<const uint8_t> jpeg, int width, int height) override {
    const Error bad{ErrorId::FileUnreadable, "a camera's JPEG does not decode; use the same version on all sides"};
    bytes_.assign(jpeg.begin(), jpeg.end());
    bytes_.resize(jpeg.size() + AV_INPUT_BUFFER_PADDING_SIZE);
    packet_->data = bytes_.data();
    packet_->size = int(jpeg.size());
    const bool decoded = avcodec_send_packet(context_.get(), packet_.get()) >= 0 &&
                         avcodec_receive_frame(context_.get(), frame_.get()) >= 0;
    if (!decoded) {
      avcodec_flush_buffers(context_.get());
      return bad;
    }
    const bool sampled = frame_->format == AV_PIX_FMT_YUVJ420P || frame_->format == AV_PIX_FMT_YUV420P;
    if (!sampled || frame_->width != width || frame_->height != height) return bad;
    return JpegPlanes{width,
                      height,
                      frame_->data[0],
                      frame_->data[1],
                      frame_->data[2],
                      frame_->linesize[0],
                      frame_->linesize[1],
                      frame_->linesize[2]};
  }

 private:
  static constexpr int64_t kMaxPixels = int64_t(4096) * 4096;

  platform::AvCodec context_;
  platform::AvFrame frame_;
  platform::AvPacket packet_;
  std::vector<uint8_t> bytes_;
};

}  // namespace

Result<std::unique_ptr<JpegDecoder>> JpegDecoder::create() {
  auto decoder = std::make_unique<FfmpegJpeg>();
  FOURDVT_TRY(decoder->open());
  return std::unique_ptr<JpegDecoder>(std::move(decoder));
}

namespace {

using package::Rect;

constexpr double kRoomShare = 0.25, kMinRoomShare = 0.15;  // margins relative to the performer's longer side
constexpr int kRoomPixels = 16, kMinRoomPixels = 8;
constexpr double kTooLarge = 1.6;  // maximum area, relative to the required region
constexpr int64_t kUnseen_us = 1'000'000;

double areaOf(const Rect& r) { return double(r.width) * r.height; }

}  // namespace

std::vector<bool> CameraRegions::update(std::span<const Rect> boxes, int64_t now_us) {
  std::vector<bool> changed(cameras_.size(), false);
  if (boxes.empty()) {
    if (seen_us_ != INT64_MIN && now_us - seen_us_ < kUnseen_us) return changed;
    for (size_t c = 0; c < cameras_.size(); ++c) changed[c] = regions_[c].width != 0, regions_[c] = {};
    return changed;
  }
  seen_us_ = now_us;
  for (size_t c = 0; c < cameras_.size(); ++c) {
    if (boxes[c].width == 0) continue;  // not visible in this camera: region unchanged
    const Rect all{0, 0, cameras_[c].width, cameras_[c].height};
    const Rect wanted = padded(boxes[c], kRoomShare, kRoomPixels, all);
    const Rect least = padded(boxes[c], kMinRoomShare, kMinRoomPixels, all);
    const Rect& now = regions_[c].width == 0 ? all : regions_[c];
    if (areaOf(common(least, now)) == areaOf(least) && areaOf(now) <= kTooLarge * areaOf(wanted)) continue;
    regions_[c] = wanted;
    changed[c] = true;
  }
  return changed;
}

}  // namespace fourdvt::live
