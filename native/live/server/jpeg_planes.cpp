// SPDX-License-Identifier: Apache-2.0
#include "live/server/jpeg_planes.h"

#include <cstring>
#include <vector>

#include "live/server/ffmpeg.h"

namespace fourdvt::live {
namespace {

class FfmpegJpeg final : public JpegDecoder {
 public:
  Status open() {
    const AVCodec* codec = avcodec_find_decoder(AV_CODEC_ID_MJPEG);
    if (!codec) return Error{ErrorId::Unsupported, "this FFmpeg decodes no JPEG; install one that does"};
    context_.reset(avcodec_alloc_context3(codec));
    context_->thread_count = 1;
    context_->max_pixels = kMostPixels;
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
  static constexpr int64_t kMostPixels = int64_t(4096) * 4096;

  AvContext context_;
  AvFrame frame_;
  AvPacket packet_;
  std::vector<uint8_t> bytes_;
};

}  // namespace

Result<std::unique_ptr<JpegDecoder>> JpegDecoder::create() {
  auto decoder = std::make_unique<FfmpegJpeg>();
  FOURDVT_TRY(decoder->open());
  return std::unique_ptr<JpegDecoder>(std::move(decoder));
}

}  // namespace fourdvt::live
