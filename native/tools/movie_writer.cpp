// SPDX-License-Identifier: Apache-2.0
#include "tools/movie_writer.h"

#include <cerrno>
#include <cmath>
#include <cstdio>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
#include <libswscale/swscale.h>
}

namespace fourdvt::tools {
namespace {

std::string avText(int code) {
  char text[AV_ERROR_MAX_STRING_SIZE] = "";
  av_strerror(code, text, sizeof text);
  return text;
}

class H264Writer final : public MovieWriter {
 public:
  H264Writer(const std::string& path, int width, int height)
      : path_(path), partial_(path + ".part"), width_(width), height_(height) {}

  ~H264Writer() override {
    sws_freeContext(scaler_);
    av_packet_free(&packet_);
    av_frame_free(&frame_);
    avcodec_free_context(&encoder_);
    if (format_ && format_->pb) avio_closep(&format_->pb);
    avformat_free_context(format_);
    if (!finished_ && opened_) std::remove(partial_.c_str());
  }

  Status open(double fps) {
    const AVCodec* codec = avcodec_find_encoder_by_name("libx264");
    if (!codec) return Error{ErrorId::Unsupported, path_ + ": this FFmpeg has no libx264; install one that has"};
    encoder_ = avcodec_alloc_context3(codec);
    encoder_->width = width_;
    encoder_->height = height_;
    encoder_->pix_fmt = AV_PIX_FMT_YUV420P;
    encoder_->framerate = av_d2q(fps, 100000);
    encoder_->time_base = av_inv_q(encoder_->framerate);
    encoder_->colorspace = AVCOL_SPC_BT709;
    encoder_->color_primaries = AVCOL_PRI_BT709;
    encoder_->color_trc = AVCOL_TRC_BT709;
    encoder_->color_range = AVCOL_RANGE_MPEG;
    encoder_->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    av_opt_set(encoder_->priv_data, "crf", "18", 0);
    av_opt_set(encoder_->priv_data, "preset", "medium", 0);
    if (const int code = avcodec_open2(encoder_, codec, nullptr); code < 0) return failed(code);
    if (const int code = avformat_alloc_output_context2(&format_, nullptr, "mp4", partial_.c_str()); code < 0)
      return failed(code);
    stream_ = avformat_new_stream(format_, nullptr);
    stream_->time_base = encoder_->time_base;
    avcodec_parameters_from_context(stream_->codecpar, encoder_);
    if (const int code = avio_open(&format_->pb, partial_.c_str(), AVIO_FLAG_WRITE); code < 0) return failed(code);
    opened_ = true;
    AVDictionary* options = nullptr;
    av_dict_set(&options, "movflags", "+faststart", 0);
    const int code = avformat_write_header(format_, &options);
    av_dict_free(&options);
    if (code < 0) return failed(code);
    return makeFrame();
  }

  Status write(const Image& picture) override {
    if (picture.width != width_ || picture.height != height_)
      return Error{ErrorId::Internal, path_ + ": picture of another size"};
    const Image rgb = flattened(picture);
    const uint8_t* planes[] = {rgb.pixels.data()};
    const int strides[] = {3 * width_};
    if (const int code = av_frame_make_writable(frame_); code < 0) return failed(code);
    sws_scale(scaler_, planes, strides, 0, height_, frame_->data, frame_->linesize);
    frame_->pts = next_pts_++;
    return encode(frame_);
  }

  Status finish() override {
    FOURDVT_TRY(encode(nullptr));
    if (const int code = av_write_trailer(format_); code < 0) return failed(code);
    const int closed = avio_closep(&format_->pb);
    if (closed < 0) return failed(closed);
    if (std::rename(partial_.c_str(), path_.c_str()) != 0) return failed(AVERROR(errno));
    finished_ = true;
    return {};
  }

 private:
  Error failed(int code) const {
    return {ErrorId::WriteFailed,
            path_ + ": " + avText(code) + "; choose a folder that exists, is writable and has space"};
  }

  Status makeFrame() {
    packet_ = av_packet_alloc();
    frame_ = av_frame_alloc();
    frame_->format = AV_PIX_FMT_YUV420P;
    frame_->width = width_;
    frame_->height = height_;
    frame_->colorspace = AVCOL_SPC_BT709;
    frame_->color_range = AVCOL_RANGE_MPEG;
    if (const int code = av_frame_get_buffer(frame_, 0); code < 0) return failed(code);
    scaler_ = sws_getContext(width_, height_, AV_PIX_FMT_RGB24, width_, height_, AV_PIX_FMT_YUV420P,
                             SWS_BICUBIC | SWS_ACCURATE_RND | SWS_FULL_CHR_H_INP, nullptr, nullptr, nullptr);
    if (!scaler_) return Error{ErrorId::Internal, path_ + ": no colour conversion for this size"};
    const int* bt709 = sws_getCoefficients(SWS_CS_ITU709);
    sws_setColorspaceDetails(scaler_, bt709, 1, bt709, 0, 0, 1 << 16, 1 << 16);
    return {};
  }

  Status encode(const AVFrame* frame) {
    int code = avcodec_send_frame(encoder_, frame);
    if (code < 0) return failed(code);
    while ((code = avcodec_receive_packet(encoder_, packet_)) >= 0) {
      if (packet_->duration == 0) packet_->duration = 1;  // else the last picture takes no time and is not shown
      av_packet_rescale_ts(packet_, encoder_->time_base, stream_->time_base);
      packet_->stream_index = stream_->index;
      if (const int wrote = av_interleaved_write_frame(format_, packet_); wrote < 0) return failed(wrote);
    }
    if (code != AVERROR(EAGAIN) && code != AVERROR_EOF) return failed(code);
    return {};
  }

  static Image flattened(const Image& picture) {
    if (picture.channels == 3) return picture;
    Image out(picture.width, picture.height, 3);
    for (size_t i = 0; i < out.pixels.size() / 3; ++i)
      for (int c = 0; c < 3; ++c)
        out.pixels[3 * i + c] =
            static_cast<uint8_t>((picture.pixels[4 * i + c] * picture.pixels[4 * i + 3] + 127) / 255);
    return out;
  }

  std::string path_, partial_;
  int width_, height_;
  AVCodecContext* encoder_ = nullptr;
  AVFormatContext* format_ = nullptr;
  AVStream* stream_ = nullptr;  // owned by format_
  AVFrame* frame_ = nullptr;
  AVPacket* packet_ = nullptr;
  SwsContext* scaler_ = nullptr;
  int64_t next_pts_ = 0;
  bool opened_ = false, finished_ = false;
};

}  // namespace

Result<std::unique_ptr<MovieWriter>> MovieWriter::create(const std::string& path, int width, int height, double fps) {
  av_log_set_level(AV_LOG_ERROR);
  auto writer = std::make_unique<H264Writer>(path, width, height);
  FOURDVT_TRY(writer->open(fps));
  return std::unique_ptr<MovieWriter>(std::move(writer));
}

}  // namespace fourdvt::tools
