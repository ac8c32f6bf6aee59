// SPDX-License-Identifier: Apache-2.0
#include "platform/video_input.h"

#include <algorithm>
#include <filesystem>
#include <mutex>
#include <vector>

#include "platform/ffmpeg_frames.h"
#include "platform/ffmpeg_handles.h"

#ifdef FOURDVT_AVDEVICE
extern "C" {
#include <libavdevice/avdevice.h>
}
#endif

namespace fourdvt::platform {
namespace {

constexpr int64_t kMaxInputPixels = int64_t{8192} * 8192;
constexpr uint32_t kSeekBeyond = 60;                   // seek distance, pictures; below it decoding continues
constexpr uint32_t kReordered = 16;                    // maximum pictures between a decoding and a presentation time
constexpr int64_t kEarliestWallClock = 1000000000000;  // µs: smaller stamps have another epoch

Error unreadableInput(const std::string& url, const std::string& what) {
  return {ErrorId::FileUnreadable, url + ": " + what};
}

void startInputs() {
  static std::once_flag once;
  std::call_once(once, [] {
    quietFfmpeg();
    avformat_network_init();
#ifdef FOURDVT_AVDEVICE
    avdevice_register_all();
#endif
  });
}

int stopAsked(void* stop) { return stop && static_cast<const std::atomic<bool>*>(stop)->load() ? 1 : 0; }

int refuseOtherAddresses(AVFormatContext*, AVIOContext**, const char*, int, AVDictionary**) { return AVERROR(EPERM); }

class FfmpegInput final : public VideoInput {
 public:
  Status open(const InputPlace& place, const std::atomic<bool>* stop) {
    place_ = place;
    stop_ = stop;
    file_ = place.format.empty() && place.url.find("://") == std::string::npos && !place.url.starts_with("/dev/");
    std::error_code ignored;
    if (file_ && !std::filesystem::is_regular_file(place.url, ignored))
      return Error{ErrorId::FileMissing, place.url + ": no such file; check the name and the folder"};
    FOURDVT_TRY(openFormat());
    FOURDVT_TRY(openDecoder());
    return file_ ? listPictures() : Status();
  }

  bool isFile() const override { return file_; }
  uint32_t pictures() const override { return uint32_t(stamps_.size()); }

  Status decode(uint32_t number) override {
    if (number >= stamps_.size()) return unreadableInput(place_.url, "has no such picture");
    if (number == at_) return {};
    if (at_ == kNone || number < at_ || number > at_ + kSeekBeyond) FOURDVT_TRY(seek(number));
    do {
      const Status decoded = decodeNext();
      if (!decoded.ok()) {
        at_ = kNone;
        return decoded.error();
      }
      const int64_t stamp = frame_->best_effort_timestamp;
      at_ = uint32_t(std::lower_bound(stamps_.begin(), stamps_.end(), stamp) - stamps_.begin());
    } while (at_ < number);
    return {};  // an undecodable picture is replaced by the next one
  }

  Status decodeNext() override {
    while (true) {
      const int received = avcodec_receive_frame(codec_.get(), frame_.get());
      if (received == 0) return {};
      if (received == AVERROR_EOF) return unreadableInput(place_.url, "the pictures have ended; open it again");
      if (received != AVERROR(EAGAIN)) return unreadableInput(place_.url, "a picture does not decode");
      FOURDVT_TRY(feed());
    }
  }

  int64_t wallClock_us() const override {
    const int64_t stamp = frame_->best_effort_timestamp;
    if (file_ || stamp == AV_NOPTS_VALUE) return 0;
    const int64_t us = av_rescale_q(stamp, format_->streams[stream_]->time_base, AVRational{1, 1000000});
    return us >= kEarliestWallClock ? us : 0;
  }

  Status convert(Image& out, int reduce) override {
    if (!converter_.convert(*frame_, out, reduce))
      return unreadableInput(place_.url, "its pictures do not convert to RGB");
    return {};
  }

 private:
  static constexpr uint32_t kNone = ~0u;

  Status openFormat() {
    const AVInputFormat* input = nullptr;
    if (!place_.format.empty() && !(input = av_find_input_format(place_.format.c_str())))
      return Error{ErrorId::Unsupported, place_.url + ": no input format \"" + place_.format +
                                             "\" in this build; correct \"format\", or for cameras at this machine "
                                             "install libavdevice-dev and build again"};
    AVFormatContext* raw = avformat_alloc_context();
    raw->interrupt_callback = {stopAsked, const_cast<std::atomic<bool>*>(stop_)};
    AVDictionary* options = nullptr;
    for (const auto& [key, value] : place_.options) av_dict_set(&options, key.c_str(), value.c_str(), 0);
    if (file_) {
      raw->io_open = refuseOtherAddresses;
      AVDictionary* only_file = nullptr;
      av_dict_set(&only_file, "protocol_whitelist", "file", 0);
      AVIOContext* io = nullptr;
      avio_open2(&io, ("file:" + place_.url).c_str(), AVIO_FLAG_READ, nullptr, &only_file);
      av_dict_free(&only_file);
      io_.reset(io);
      raw->pb = io;
      av_dict_set(&options, "protocol_whitelist", "none", 0);  // forbids protocols of referenced files
      if (!io) {
        avformat_free_context(raw);
        av_dict_free(&options);
        return unreadableInput(place_.url, "cannot be opened; check its permissions");
      }
    }
    const bool opened = avformat_open_input(&raw, place_.url.c_str(), input, &options) >= 0;  // frees raw if it fails
    av_dict_free(&options);
    if (!opened)
      return unreadableInput(place_.url, file_ ? "not a video file, or one that names other files; use H.264 in MP4"
                                               : "does not open; check that it is there, free and reachable, and its "
                                                 "\"format\" and \"options\"");
    format_.reset(raw);
    if (avformat_find_stream_info(raw, nullptr) < 0) return unreadableInput(place_.url, "no readable stream");
    return {};
  }

  Status openDecoder() {
    const AVCodec* codec = nullptr;
    stream_ = av_find_best_stream(format_.get(), AVMEDIA_TYPE_VIDEO, -1, -1, &codec, 0);
    if (stream_ < 0 || !codec) return unreadableInput(place_.url, "no video stream that this build decodes");
    for (unsigned i = 0; i < format_->nb_streams; ++i)
      if (static_cast<int>(i) != stream_) format_->streams[i]->discard = AVDISCARD_ALL;
    codec_.reset(avcodec_alloc_context3(codec));
    avcodec_parameters_to_context(codec_.get(), format_->streams[stream_]->codecpar);
    codec_->max_pixels = kMaxInputPixels;
    codec_->thread_count = 1;  // several cameras are decoded in parallel
    if (!file_) codec_->flags |= AV_CODEC_FLAG_LOW_DELAY;
    if (avcodec_open2(codec_.get(), codec, nullptr) < 0)
      return unreadableInput(place_.url, "the decoder does not start");
    return {};
  }

  // Lists the pictures' distinct time stamps, ascending; a picture's number is its index in the list.
  Status listPictures() {
    int read;
    while ((read = av_read_frame(format_.get(), packet_.get())) >= 0) {
      const int64_t stamp = packet_->pts != AV_NOPTS_VALUE ? packet_->pts : packet_->dts;
      if (packet_->stream_index == stream_ && !(packet_->flags & AV_PKT_FLAG_DISCARD)) stamps_.push_back(stamp);
      av_packet_unref(packet_.get());
      if (stamp == AV_NOPTS_VALUE && !stamps_.empty() && stamps_.back() == stamp)
        return unreadableInput(place_.url, "its pictures have no time stamps; put it into an MP4 file");
    }
    if (read != AVERROR_EOF) return unreadableInput(place_.url, "reading stops inside the file");
    std::sort(stamps_.begin(), stamps_.end());
    stamps_.erase(std::unique(stamps_.begin(), stamps_.end()), stamps_.end());
    if (stamps_.empty()) return unreadableInput(place_.url, "no pictures");
    return {};
  }

  Status seek(uint32_t number) {
    at_ = kNone;
    const int64_t stamp = stamps_[number - std::min(number, kReordered)];
    if (av_seek_frame(format_.get(), stream_, stamp, AVSEEK_FLAG_BACKWARD) < 0 &&
        av_seek_frame(format_.get(), stream_, 0, AVSEEK_FLAG_BYTE) < 0)
      return unreadableInput(place_.url, "cannot be wound back; put it into an MP4 file");
    avcodec_flush_buffers(codec_.get());
    return {};
  }

  Status feed() {
    while (true) {
      const int read = av_read_frame(format_.get(), packet_.get());
      if (read == AVERROR(EAGAIN)) continue;
      if (read == AVERROR_EOF) {
        avcodec_send_packet(codec_.get(), nullptr);
        return {};
      }
      if (read < 0) return unreadableInput(place_.url, "no more pictures come; check the camera and its connection");
      const bool ours = packet_->stream_index == stream_;
      const int sent = ours ? avcodec_send_packet(codec_.get(), packet_.get()) : 0;
      av_packet_unref(packet_.get());
      // Skips a camera's damaged picture.
      if (sent < 0 && (file_ || sent != AVERROR_INVALIDDATA))
        return unreadableInput(place_.url, "a picture does not decode");
      if (ours) return {};
    }
  }

  InputPlace place_;
  const std::atomic<bool>* stop_ = nullptr;
  bool file_ = false;
  int stream_ = -1;
  std::vector<int64_t> stamps_;  // file only
  uint32_t at_ = kNone;          // decoded picture's number
  AvIo io_;                      // outlives format_
  AvFormat format_;
  AvCodec codec_;
  AvFrame frame_{av_frame_alloc()};
  AvPacket packet_{av_packet_alloc()};
  RgbConverter converter_{true};
};

}  // namespace

Result<std::unique_ptr<VideoInput>> VideoInput::open(const InputPlace& place, const std::atomic<bool>* stop) {
  startInputs();
  auto input = std::make_unique<FfmpegInput>();
  FOURDVT_TRY(input->open(place, stop));
  return std::unique_ptr<VideoInput>(std::move(input));
}

}  // namespace fourdvt::platform
