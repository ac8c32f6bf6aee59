// SPDX-License-Identifier: Apache-2.0
#include "platform/video_writer.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>

#include "platform/ffmpeg_handles.h"

extern "C" {
#include <libavutil/opt.h>
}

namespace fourdvt::platform {
namespace {

Image overBlack(const Image& picture) {
  Image out(picture.width, picture.height, 3);
  for (size_t i = 0; i < out.pixels.size() / 3; ++i)
    for (int c = 0; c < 3; ++c)
      out.pixels[3 * i + c] = static_cast<uint8_t>((picture.pixels[4 * i + c] * picture.pixels[4 * i + 3] + 127) / 255);
  return out;
}

class FfmpegWriter final : public VideoWriter {
 public:
  FfmpegWriter(const std::string& path, const VideoFormat& format)
      : path_(path),
        partial_(path + ".part"),
        format_(format),
        colour_(format.channels == 3),
        mp4_(colour_ && !path.ends_with(".mkv")) {}

  ~FfmpegWriter() override {
    if (file_ && file_->pb) avio_closep(&file_->pb);
    avformat_free_context(file_);
    if (unfinished_) std::remove(partial_.c_str());
  }

  Status open() {
    quietFfmpeg();
    const char* name = colour_ ? "libx264" : "ffv1";
    const AVCodec* codec = avcodec_find_encoder_by_name(name);
    if (!codec) return Error{ErrorId::Unsupported, path_ + ": this FFmpeg has no " + name + "; install one that has"};
    encoder_.reset(avcodec_alloc_context3(codec));
    configure();
    if (const int code = avcodec_open2(encoder_.get(), codec, nullptr); code < 0) return failed(code);
    const char* container = mp4_ ? "mp4" : "matroska";
    if (const int code = avformat_alloc_output_context2(&file_, nullptr, container, partial_.c_str()); code < 0)
      return failed(code);
    file_->flags |= AVFMT_FLAG_BITEXACT;
    stream_ = avformat_new_stream(file_, nullptr);
    stream_->time_base = encoder_->time_base;
    stream_->avg_frame_rate = encoder_->framerate;
    avcodec_parameters_from_context(stream_->codecpar, encoder_.get());
    if (const int code = avio_open(&file_->pb, partial_.c_str(), AVIO_FLAG_WRITE); code < 0) return failed(code);
    unfinished_ = true;
    FOURDVT_TRY(writeHeader());
    return makeFrame();
  }

  Status write(const Image& picture) override {
    if (picture.width != format_.width || picture.height != format_.height)
      return Error{ErrorId::Internal, path_ + ": picture of another size"};
    if (const int code = av_frame_make_writable(frame_.get()); code < 0) return failed(code);
    if (colour_) {
      const Image& rgb = picture.channels == 4 ? flat_ = overBlack(picture) : picture;
      const uint8_t* planes[] = {rgb.pixels.data()};
      const int strides[] = {3 * rgb.width};
      sws_scale(scaler_.get(), planes, strides, 0, rgb.height, frame_->data, frame_->linesize);
    } else {
      for (int y = 0; y < picture.height; ++y)
        std::copy_n(picture.at(0, y), picture.width, frame_->data[0] + size_t(y) * frame_->linesize[0]);
    }
    frame_->pts = next_pts_++;
    return encode(frame_.get());
  }

  Status finish() override {
    FOURDVT_TRY(encode(nullptr));
    if (const int code = av_write_trailer(file_); code < 0) return failed(code);
    if (const int code = avio_closep(&file_->pb); code < 0) return failed(code);
    if (std::rename(partial_.c_str(), path_.c_str()) != 0) return failed(AVERROR(errno));
    unfinished_ = false;
    return {};
  }

 private:
  Error failed(int code) const {
    char text[AV_ERROR_MAX_STRING_SIZE] = "";
    av_strerror(code, text, sizeof text);
    return {ErrorId::WriteFailed, path_ + ": " + text + "; choose a folder that exists, is writable and has space"};
  }

  void configure() {
    encoder_->width = format_.width;
    encoder_->height = format_.height;
    encoder_->pix_fmt = colour_ ? AV_PIX_FMT_YUV420P : AV_PIX_FMT_GRAY8;
    encoder_->framerate = av_d2q(format_.fps, 100000);
    encoder_->time_base = av_inv_q(encoder_->framerate);
    encoder_->flags |= AV_CODEC_FLAG_GLOBAL_HEADER | AV_CODEC_FLAG_BITEXACT;
    if (format_.reproducible) encoder_->thread_count = 1;
    if (!colour_) return;
    encoder_->colorspace = AVCOL_SPC_BT709;
    encoder_->color_primaries = AVCOL_PRI_BT709;
    encoder_->color_trc = AVCOL_TRC_BT709;
    encoder_->color_range = AVCOL_RANGE_MPEG;
    av_opt_set_double(encoder_->priv_data, "crf", format_.crf, 0);
    av_opt_set(encoder_->priv_data, "preset", format_.preset, 0);
    // Disables macroblock trees, which vary with the addresses of x264's buffers (measured at 96 pixels of width).
    if (format_.reproducible) av_opt_set(encoder_->priv_data, "x264-params", "mbtree=0", 0);
  }

  Status writeHeader() {
    AVDictionary* options = nullptr;
    if (mp4_) av_dict_set(&options, "movflags", "+faststart", 0);
    const int code = avformat_write_header(file_, &options);
    av_dict_free(&options);
    return code < 0 ? Status(failed(code)) : Status();
  }

  Status makeFrame() {
    packet_.reset(av_packet_alloc());
    frame_.reset(av_frame_alloc());
    frame_->format = encoder_->pix_fmt;
    frame_->width = format_.width;
    frame_->height = format_.height;
    frame_->colorspace = encoder_->colorspace;
    frame_->color_range = encoder_->color_range;
    if (const int code = av_frame_get_buffer(frame_.get(), 0); code < 0) return failed(code);
    if (!colour_) return {};
    scaler_.reset(sws_getContext(format_.width, format_.height, AV_PIX_FMT_RGB24, format_.width, format_.height,
                                 AV_PIX_FMT_YUV420P, SWS_BICUBIC | SWS_ACCURATE_RND | SWS_FULL_CHR_H_INP, nullptr,
                                 nullptr, nullptr));
    if (!scaler_) return Error{ErrorId::Internal, path_ + ": no colour conversion for this size"};
    const int* bt709 = sws_getCoefficients(SWS_CS_ITU709);
    sws_setColorspaceDetails(scaler_.get(), bt709, 1, bt709, 0, 0, 1 << 16, 1 << 16);
    return {};
  }

  Status encode(const AVFrame* frame) {
    int code = avcodec_send_frame(encoder_.get(), frame);
    if (code < 0) return failed(code);
    while ((code = avcodec_receive_packet(encoder_.get(), packet_.get())) >= 0) {
      packet_->duration = 1;  // otherwise the last picture has no duration and is not shown
      av_packet_rescale_ts(packet_.get(), encoder_->time_base, stream_->time_base);
      packet_->stream_index = stream_->index;
      if (const int wrote = av_interleaved_write_frame(file_, packet_.get()); wrote < 0) return failed(wrote);
    }
    if (code != AVERROR(EAGAIN) && code != AVERROR_EOF) return failed(code);
    return {};
  }

  const std::string path_, partial_;
  const VideoFormat format_;
  const bool colour_, mp4_;
  AvCodec encoder_;
  AvFrame frame_;
  Image flat_;  // scratch
  AvPacket packet_;
  SwsScaler scaler_;
  AVFormatContext* file_ = nullptr;
  AVStream* stream_ = nullptr;  // owned by file_
  int64_t next_pts_ = 0;
  bool unfinished_ = false;  // the partial file exists
};

}  // namespace

Result<std::unique_ptr<VideoWriter>> VideoWriter::create(const std::string& path, const VideoFormat& format) {
  auto writer = std::make_unique<FfmpegWriter>(path, format);
  FOURDVT_TRY(writer->open());
  return std::unique_ptr<VideoWriter>(std::move(writer));
}

}  // namespace fourdvt::platform
