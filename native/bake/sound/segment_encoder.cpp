// SPDX-License-Identifier: Apache-2.0
#include "bake/sound/segment_encoder.h"

#include <algorithm>
#include <memory>

#include "platform/ffmpeg_handles.h"

namespace fourdvt::bake {
namespace {

struct Recipe {
  SoundCodecInfo info;
  const char *encoder, *muxer;
  AVSampleFormat format;
  int block;            // samples per packet
  int64_t bit_rate[2];  // mono, stereo
};

// Nominal bit rates; Opus varies its own.
constexpr Recipe kOpus{
    {"audio/webm; codecs=\"opus\"", ".webm"}, "libopus", "webm", AV_SAMPLE_FMT_FLT, 960, {64'000, 112'000}};
constexpr Recipe kAac{
    {"audio/mp4; codecs=\"mp4a.40.2\"", ".m4a"}, "aac", "ipod", AV_SAMPLE_FMT_FLTP, 1024, {96'000, 144'000}};

const Recipe& recipeOf(SoundCodec codec) { return codec == SoundCodec::Opus ? kOpus : kAac; }

// An output file in memory.
struct MemoryFileDeleter {
  void operator()(AVFormatContext* p) const {
    uint8_t* rest = nullptr;
    if (p->pb) avio_close_dyn_buf(p->pb, &rest);
    av_free(rest);
    avformat_free_context(p);
  }
};

class SegmentEncoder {
 public:
  SegmentEncoder(const Recipe& recipe, int channels) : recipe_(recipe), channels_(channels) {}

  Status open() {
    const AVCodec* codec = avcodec_find_encoder_by_name(recipe_.encoder);
    if (!codec)
      return Error{ErrorId::Unsupported,
                   std::string("this FFmpeg has no ") + recipe_.encoder + "; install one that has"};
    context_.reset(avcodec_alloc_context3(codec));
    context_->sample_rate = kSoundRate;
    context_->sample_fmt = recipe_.format;
    context_->bit_rate = recipe_.bit_rate[channels_ - 1];
    context_->time_base = {1, kSoundRate};
    context_->flags |= AV_CODEC_FLAG_GLOBAL_HEADER | AV_CODEC_FLAG_BITEXACT;
    av_channel_layout_default(&context_->ch_layout, channels_);
    if (const int code = avcodec_open2(context_.get(), codec, nullptr); code < 0) return failed("opening", code);
    if (context_->frame_size != recipe_.block) return failed("block size", AVERROR_BUG);
    AVFormatContext* file = nullptr;
    avformat_alloc_output_context2(&file, nullptr, recipe_.muxer, nullptr);
    file_.reset(file);
    if (!file) return failed("container", AVERROR_MUXER_NOT_FOUND);
    file->flags |= AVFMT_FLAG_BITEXACT;
    AVStream* stream = avformat_new_stream(file, nullptr);
    stream->time_base = context_->time_base;
    avcodec_parameters_from_context(stream->codecpar, context_.get());
    if (const int code = avio_open_dyn_buf(&file->pb); code < 0) return failed("memory", code);
    const int code = avformat_write_header(file, nullptr);
    return code < 0 ? failed("header", code) : Status();
  }

  // Rounds a number of samples up so that together with the encoder's delay they fill whole packets: no padding at
  // the end.
  size_t roundedUp(size_t samples) const {
    const size_t block = size_t(recipe_.block), lead = delayInBlock();
    return (samples + lead + block - 1) / block * block - lead;
  }
  uint32_t priming() const { return static_cast<uint32_t>(context_->initial_padding); }

  Status encode(std::span<const float> samples, size_t count) {
    frame_.reset(av_frame_alloc());
    packet_.reset(av_packet_alloc());
    for (size_t at = 0; at < count; at += size_t(recipe_.block)) {
      frame_->nb_samples = static_cast<int>(std::min(size_t(recipe_.block), count - at));
      frame_->format = recipe_.format;
      frame_->sample_rate = kSoundRate;
      av_channel_layout_copy(&frame_->ch_layout, &context_->ch_layout);
      frame_->pts = int64_t(at);
      if (const int code = av_frame_get_buffer(frame_.get(), 0); code < 0) return failed("memory", code);
      fill(samples, at);
      FOURDVT_TRY(send(frame_.get()));
      av_frame_unref(frame_.get());
    }
    return send(nullptr);
  }

  Result<std::vector<uint8_t>> finish() {
    if (const int code = av_write_trailer(file_.get()); code < 0) return failed("trailer", code);
    uint8_t* bytes = nullptr;
    const int size = avio_close_dyn_buf(file_->pb, &bytes);
    file_->pb = nullptr;
    std::vector<uint8_t> out(bytes, bytes + std::max(0, size));
    av_free(bytes);
    return out;
  }

 private:
  Error failed(const char* what, int code) const {
    char text[AV_ERROR_MAX_STRING_SIZE] = "";
    av_strerror(code, text, sizeof text);
    return {ErrorId::Internal, std::string(recipe_.encoder) + " encoder: " + what + " failed: " + text};
  }
  size_t delayInBlock() const { return size_t(context_->initial_padding) % size_t(recipe_.block); }

  void fill(std::span<const float> samples, size_t at) {
    const size_t channels = size_t(channels_);
    for (size_t i = 0; i < size_t(frame_->nb_samples); ++i)
      for (size_t c = 0; c < channels; ++c) {
        const size_t from = (at + i) * channels + c;
        const float value = from < samples.size() ? samples[from] : 0;
        if (recipe_.format == AV_SAMPLE_FMT_FLTP)
          reinterpret_cast<float*>(frame_->data[c])[i] = value;
        else
          reinterpret_cast<float*>(frame_->data[0])[i * channels + c] = value;
      }
  }

  Status send(const AVFrame* frame) {
    if (const int code = avcodec_send_frame(context_.get(), frame); code < 0) return failed("encoding", code);
    for (;;) {
      const int code = avcodec_receive_packet(context_.get(), packet_.get());
      if (code == AVERROR(EAGAIN) || code == AVERROR_EOF) return {};
      if (code < 0) return failed("encoding", code);
      av_packet_rescale_ts(packet_.get(), context_->time_base, file_->streams[0]->time_base);
      const int written = av_interleaved_write_frame(file_.get(), packet_.get());
      if (written < 0) return failed("writing", written);
    }
  }

  const Recipe& recipe_;
  const int channels_;
  platform::AvCodec context_;
  std::unique_ptr<AVFormatContext, MemoryFileDeleter> file_;
  platform::AvFrame frame_;
  platform::AvPacket packet_;
};

}  // namespace

const SoundCodecInfo& infoOf(SoundCodec codec) { return recipeOf(codec).info; }

Result<EncodedSound> encodeSegment(SoundCodec codec, std::span<const float> samples, int channels) {
  av_log_set_level(AV_LOG_ERROR);
  SegmentEncoder encoder(recipeOf(codec), channels);
  FOURDVT_TRY(encoder.open());
  const size_t count = encoder.roundedUp(samples.size() / size_t(channels));
  FOURDVT_TRY(encoder.encode(samples, count));
  EncodedSound out;
  FOURDVT_ASSIGN(out.bytes, encoder.finish());
  out.samples = static_cast<uint32_t>(count);
  out.priming = encoder.priming();
  return out;
}

}  // namespace fourdvt::bake
