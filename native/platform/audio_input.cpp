// SPDX-License-Identifier: Apache-2.0
#include "platform/audio_input.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

#include "platform/media_file.h"

extern "C" {
#include <libavutil/channel_layout.h>
}

namespace fourdvt::platform {
namespace {

constexpr size_t kMinSamples = 4096;  // samples resampled at a time
constexpr int kLostPackets = 50;      // limit of damaged packets in a row before the file is rejected
constexpr double kMaxStart_s = 1e5;   // limit of the sound's start, from the first picture

class FfmpegAudio final : public AudioReader {
 public:
  FfmpegAudio(const std::string& path, int sample_rate) : path_(path), sample_rate_(sample_rate) {}
  ~FfmpegAudio() override { av_channel_layout_uninit(&resampled_layout_); }

  Status open() {
    quietFfmpeg();
    std::error_code ignored;
    if (!std::filesystem::exists(path_, ignored))
      return Error{ErrorId::FileMissing, path_ + ": cannot be read; check the path"};
    file_ = openFileOnly(path_);
    AVFormatContext* format = file_.format.get();
    if (!format) return failed(file_.io ? AVERROR_INVALIDDATA : AVERROR(EACCES));
    if (!findStreams(*format)) return failed(AVERROR_INVALIDDATA);
    const AVCodec* codec = nullptr;
    stream_ = av_find_best_stream(format, AVMEDIA_TYPE_AUDIO, -1, -1, &codec, 0);
    if (stream_ < 0 || !codec)
      return Error{ErrorId::FileUnreadable, path_ + ": has no sound; give a file that has, WAV for example"};
    decoder_.reset(avcodec_alloc_context3(codec));
    avcodec_parameters_to_context(decoder_.get(), format->streams[stream_]->codecpar);
    decoder_->pkt_timebase = format->streams[stream_]->time_base;
    if (const int code = avcodec_open2(decoder_.get(), codec, nullptr); code < 0) return failed(code);
    if (decoder_->ch_layout.nb_channels < 1) return failed(AVERROR_INVALIDDATA);
    channels_ = std::min(2, decoder_->ch_layout.nb_channels);
    packet_.reset(av_packet_alloc());
    frame_.reset(av_frame_alloc());
    return {};
  }

  int channels() const override { return channels_; }

  Result<size_t> read(std::span<float> out) override {
    const size_t channels = size_t(channels_), wanted = out.size() / channels;
    if (!resampler_ && !ended_) FOURDVT_TRY(decodeMore());
    while (held() + silence_ < wanted && !ended_) FOURDVT_TRY(decodeMore());
    const size_t silent = std::min(wanted, silence_), taken = std::min(wanted - silent, held());
    std::fill_n(out.begin(), silent * channels, 0.0f);
    silence_ -= silent;
    std::copy_n(samples_.begin() + long(next_), taken * channels, out.begin() + long(silent * channels));
    next_ += taken * channels;
    if (next_ > kMinSamples * channels) {
      samples_.erase(samples_.begin(), samples_.begin() + long(next_));
      next_ = 0;
    }
    return silent + taken;
  }

 private:
  Error failed(int code) const {
    char text[AV_ERROR_MAX_STRING_SIZE] = "";
    av_strerror(code, text, sizeof text);
    return {ErrorId::FileUnreadable,
            path_ + ": its sound cannot be decoded: " + text + "; export it again, as WAV for example"};
  }
  size_t held() const { return (samples_.size() - next_) / size_t(channels_); }

  // Seconds from the first picture to the first sample; 0 without pictures.
  double startAfterPicture_s() const {
    const int video = av_find_best_stream(file_.format.get(), AVMEDIA_TYPE_VIDEO, -1, stream_, nullptr, 0);
    if (video < 0) return 0;
    const AVStream *pictures = file_.format->streams[video], *sound = file_.format->streams[stream_];
    if (pictures->disposition & AV_DISPOSITION_ATTACHED_PIC) return 0;
    if (pictures->start_time == AV_NOPTS_VALUE || sound->start_time == AV_NOPTS_VALUE) return 0;
    return sound->start_time * av_q2d(sound->time_base) - pictures->start_time * av_q2d(pictures->time_base);
  }

  Status makeResampler() {
    AVChannelLayout layout;
    av_channel_layout_default(&layout, channels_);
    SwrContext* resampler = nullptr;
    int code = swr_alloc_set_opts2(&resampler, &layout, AV_SAMPLE_FMT_FLT, sample_rate_, &frame_->ch_layout,
                                   AVSampleFormat(frame_->format), frame_->sample_rate, 0, nullptr);
    resampler_.reset(resampler);
    if (code >= 0) code = swr_init(resampler);
    if (code >= 0) code = av_channel_layout_copy(&resampled_layout_, &frame_->ch_layout);
    resampled_rate_ = frame_->sample_rate;
    resampled_format_ = frame_->format;
    return code < 0 ? Status(failed(code)) : Status();
  }
  // Concatenated files may change their format midway.
  bool fitsFrame() const {
    return resampler_ && resampled_rate_ == frame_->sample_rate && resampled_format_ == frame_->format &&
           av_channel_layout_compare(&resampled_layout_, &frame_->ch_layout) == 0;
  }

  // Computes the silence to insert before the samples, or the number of samples to drop, so that reading begins at the
  // first picture.
  Status align() {
    const double start_s = startAfterPicture_s();
    if (!(std::abs(start_s) <= kMaxStart_s))
      return Error{ErrorId::FileUnreadable,
                   path_ + ": its sound begins " + std::to_string(start_s) + " s after its pictures; export it again"};
    const auto samples = std::llround(start_s * sample_rate_);
    if (samples > 0) silence_ = size_t(samples);
    if (samples < 0) drop_ = size_t(-samples);
    return {};
  }

  Status resampleFrame() {
    if (!resampler_) FOURDVT_TRY(align());
    if (!fitsFrame()) {
      FOURDVT_TRY(flushResampler());
      FOURDVT_TRY(makeResampler());
    }
    return convert(const_cast<const uint8_t**>(frame_->extended_data), frame_->nb_samples);
  }
  // Drains the resampler.
  Status flushResampler() { return resampler_ ? convert(nullptr, 0) : Status(); }

  Status convert(const uint8_t** in, int count) {
    const int most = swr_get_out_samples(resampler_.get(), count);
    const size_t before = samples_.size();
    samples_.resize(before + size_t(std::max(0, most)) * size_t(channels_));
    uint8_t* out[] = {reinterpret_cast<uint8_t*>(samples_.data() + before)};
    const int got = swr_convert(resampler_.get(), out, most, in, count);
    if (got < 0) return failed(got);
    samples_.resize(before + size_t(got) * size_t(channels_));
    const size_t dropped = std::min(drop_, size_t(got));
    samples_.erase(samples_.begin() + long(before), samples_.begin() + long(before + dropped * size_t(channels_)));
    drop_ -= dropped;
    return {};
  }

  Status receive() {
    for (;;) {
      const int code = avcodec_receive_frame(decoder_.get(), frame_.get());
      if (code == AVERROR(EAGAIN) || code == AVERROR_EOF) return {};
      if (code < 0) return lost(code);
      lost_ = 0;
      FOURDVT_TRY(resampleFrame());
    }
  }
  // Skips a damaged packet, as players do.
  Status lost(int code) { return ++lost_ > kLostPackets ? Status(failed(code)) : Status(); }

  Status decodeMore() {
    const int code = av_read_frame(file_.format.get(), packet_.get());
    if (code < 0) {
      ended_ = true;
      if (code != AVERROR_EOF) return failed(code);
      avcodec_send_packet(decoder_.get(), nullptr);
      FOURDVT_TRY(receive());
      if (!resampler_) return failed(AVERROR_INVALIDDATA);
      return flushResampler();
    }
    Status status;
    if (packet_->stream_index == stream_) {
      const int sent = avcodec_send_packet(decoder_.get(), packet_.get());
      status = sent < 0 ? lost(sent) : receive();
    }
    av_packet_unref(packet_.get());
    return status;
  }

  std::string path_;
  int sample_rate_ = 0, channels_ = 1, stream_ = -1, lost_ = 0;
  FileOnly file_;
  AvCodec decoder_;
  AvPacket packet_;
  AvFrame frame_;
  Resampler resampler_;
  std::vector<float> samples_;  // resampled, interleaved
  size_t next_ = 0;             // index of the next value in samples_
  size_t drop_ = 0;             // samples before the first picture
  size_t silence_ = 0;          // samples of silence before samples_[0]
  AVChannelLayout resampled_layout_{};
  int resampled_rate_ = 0, resampled_format_ = -1;
  bool ended_ = false;
};

}  // namespace

Result<std::unique_ptr<AudioReader>> AudioReader::open(const std::string& path, int sample_rate) {
  auto reader = std::make_unique<FfmpegAudio>(path, sample_rate);
  FOURDVT_TRY(reader->open());
  return std::unique_ptr<AudioReader>(std::move(reader));
}

}  // namespace fourdvt::platform
