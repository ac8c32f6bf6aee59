// SPDX-License-Identifier: Apache-2.0
#include "capture/studio_video.h"

#include <cstdio>
#include <cstring>
#include <filesystem>

#include "platform/ffmpeg_handles.h"
#include "platform/files.h"

extern "C" {
#include <libavutil/opt.h>
}

namespace fourdvt::studio {
namespace {

constexpr const char* kCrf = "10";

class Video final : public PictureFile {
 public:
  Video(const std::string& path, int width, int height, int channels)
      : path_(path), width_(width), height_(height), colour_(channels == 3) {}

  ~Video() override {
    if (format_ && format_->pb) avio_closep(&format_->pb);
    if (format_) avformat_free_context(format_);
  }

  Status open(double fps) {
    av_log_set_level(AV_LOG_ERROR);
    const char* name = colour_ ? "libx264" : "ffv1";
    const AVCodec* codec = avcodec_find_encoder_by_name(name);
    if (!codec)
      return Error{ErrorId::Unsupported,
                   path_ + ": this FFmpeg has no " + name + "; install one that has, or --images"};
    encoder_.reset(avcodec_alloc_context3(codec));
    configure(fps);
    if (const int code = avcodec_open2(encoder_.get(), codec, nullptr); code < 0) return failed(code);
    if (const int code = avformat_alloc_output_context2(&format_, nullptr, nullptr, path_.c_str()); code < 0)
      return failed(code);
    format_->flags |= AVFMT_FLAG_BITEXACT;
    stream_ = avformat_new_stream(format_, nullptr);
    stream_->time_base = encoder_->time_base;
    stream_->avg_frame_rate = encoder_->framerate;
    avcodec_parameters_from_context(stream_->codecpar, encoder_.get());
    if (const int code = avio_open(&format_->pb, path_.c_str(), AVIO_FLAG_WRITE); code < 0) return failed(code);
    if (const int code = avformat_write_header(format_, nullptr); code < 0) return failed(code);
    return makeFrame();
  }

  Status write(const Image& picture) override {
    if (const int code = av_frame_make_writable(frame_.get()); code < 0) return failed(code);
    if (colour_) {
      const uint8_t* planes[] = {picture.pixels.data()};
      const int strides[] = {3 * width_};
      sws_scale(scaler_.get(), planes, strides, 0, height_, frame_->data, frame_->linesize);
    } else {
      for (int y = 0; y < height_; ++y)
        std::memcpy(frame_->data[0] + size_t(y) * frame_->linesize[0], picture.at(0, y), width_);
    }
    frame_->pts = next_pts_++;
    return encode(frame_.get());
  }

  Status finish() override {
    FOURDVT_TRY(encode(nullptr));
    if (const int code = av_write_trailer(format_); code < 0) return failed(code);
    const int closed = avio_closep(&format_->pb);
    return closed < 0 ? Status(failed(closed)) : Status();
  }

 private:
  Error failed(int code) const {
    char text[AV_ERROR_MAX_STRING_SIZE] = "";
    av_strerror(code, text, sizeof text);
    return {ErrorId::WriteFailed, path_ + ": " + text + "; choose a folder that is writable and has space"};
  }

  void configure(double fps) {
    encoder_->width = width_;
    encoder_->height = height_;
    encoder_->pix_fmt = colour_ ? AV_PIX_FMT_YUV420P : AV_PIX_FMT_GRAY8;
    encoder_->framerate = av_d2q(fps, 100000);
    encoder_->time_base = av_inv_q(encoder_->framerate);
    encoder_->thread_count = 1;  // the bytes depend on the pictures only
    encoder_->flags |= AV_CODEC_FLAG_GLOBAL_HEADER | AV_CODEC_FLAG_BITEXACT;
    if (!colour_) return;
    encoder_->colorspace = AVCOL_SPC_BT709;
    encoder_->color_primaries = AVCOL_PRI_BT709;
    encoder_->color_trc = AVCOL_TRC_BT709;
    encoder_->color_range = AVCOL_RANGE_MPEG;
    av_opt_set(encoder_->priv_data, "crf", kCrf, 0);
    av_opt_set(encoder_->priv_data, "preset", "veryfast", 0);
  }

  Status makeFrame() {
    packet_.reset(av_packet_alloc());
    frame_.reset(av_frame_alloc());
    frame_->format = encoder_->pix_fmt;
    frame_->width = width_;
    frame_->height = height_;
    frame_->colorspace = encoder_->colorspace;
    frame_->color_range = encoder_->color_range;
    if (const int code = av_frame_get_buffer(frame_.get(), 0); code < 0) return failed(code);
    if (!colour_) return {};
    scaler_.reset(sws_getContext(width_, height_, AV_PIX_FMT_RGB24, width_, height_, AV_PIX_FMT_YUV420P,
                                 SWS_BICUBIC | SWS_ACCURATE_RND | SWS_FULL_CHR_H_INP, nullptr, nullptr, nullptr));
    if (!scaler_) return Error{ErrorId::Internal, path_ + ": no colour conversion for this size"};
    const int* bt709 = sws_getCoefficients(SWS_CS_ITU709);
    sws_setColorspaceDetails(scaler_.get(), bt709, 1, bt709, 0, 0, 1 << 16, 1 << 16);
    return {};
  }

  Status encode(const AVFrame* frame) {
    int code = avcodec_send_frame(encoder_.get(), frame);
    if (code < 0) return failed(code);
    while ((code = avcodec_receive_packet(encoder_.get(), packet_.get())) >= 0) {
      packet_->duration = 1;
      av_packet_rescale_ts(packet_.get(), encoder_->time_base, stream_->time_base);
      packet_->stream_index = stream_->index;
      if (const int wrote = av_interleaved_write_frame(format_, packet_.get()); wrote < 0) return failed(wrote);
    }
    if (code != AVERROR(EAGAIN) && code != AVERROR_EOF) return failed(code);
    return {};
  }

  const std::string path_;
  const int width_, height_;
  const bool colour_;
  platform::AvCodec encoder_;
  platform::AvFrame frame_;
  platform::AvPacket packet_;
  platform::SwsScaler scaler_;
  AVFormatContext* format_ = nullptr;
  AVStream* stream_ = nullptr;  // owned by format_
  int64_t next_pts_ = 0;
};

class Numbered final : public PictureFile {
 public:
  explicit Numbered(const std::string& folder) : folder_(folder) {
    std::error_code ignored;  // the first write tells
    std::filesystem::create_directories(folder, ignored);
  }
  Status write(const Image& picture) override {
    char name[24];
    std::snprintf(name, sizeof name, "/%06u.png", next_++);
    return platform::writeImage(folder_ + name, picture);
  }
  Status finish() override { return {}; }

 private:
  const std::string folder_;
  uint32_t next_ = 0;
};

}  // namespace

Result<std::unique_ptr<PictureFile>> PictureFile::create(const std::string& stem, int width, int height, int channels,
                                                         double fps, bool images) {
  if (images) return std::unique_ptr<PictureFile>(std::make_unique<Numbered>(stem));
  auto video = std::make_unique<Video>(stem + (channels == 3 ? ".mp4" : ".mkv"), width, height, channels);
  FOURDVT_TRY(video->open(fps));
  return std::unique_ptr<PictureFile>(std::move(video));
}

}  // namespace fourdvt::studio
