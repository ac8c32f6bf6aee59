// SPDX-License-Identifier: Apache-2.0
// openVideoFile: demux, decode, convert with the stream's own matrix and range.
#include "platform/ffmpeg_video.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <vector>

#include "platform/ffmpeg_frames.h"
#include "platform/ffmpeg_handles.h"
#include "platform/media_file.h"
#include "platform/video_alpha.h"
#include "platform/video_marks.h"

namespace fourdvt::platform {
namespace {

Error unreadable(const std::string& path, const std::string& what) {
  return {ErrorId::FileUnreadable, path + ": " + what + "; re-encode the video (H.264 in MP4 works everywhere)"};
}

std::array<uint8_t, 256> lumaTable(bool full_range) {
  std::array<uint8_t, 256> table;
  for (int y = 0; y < 256; ++y) {
    const double value = full_range ? y : (y - 16) * 255.0 / 219.0;
    table[y] = static_cast<uint8_t>(std::lround(std::fmin(255.0, std::fmax(0.0, value))));
  }
  return table;
}

Image lumaPlane(const AVFrame& frame, bool full_range) {
  Image image(frame.width, frame.height, 1);
  const auto table = lumaTable(full_range);
  for (int y = 0; y < frame.height; ++y) {
    const uint8_t* row = frame.data[0] + static_cast<ptrdiff_t>(y) * frame.linesize[0];
    for (int x = 0; x < frame.width; ++x) *image.at(x, y) = table[row[x]];
  }
  return image;
}

Image grayFromRgb(const Image& rgb) {  // BT.709 luma
  Image gray(rgb.width, rgb.height, 1);
  for (size_t i = 0; i < gray.pixels.size(); ++i) {
    const uint8_t* p = &rgb.pixels[i * 3];
    gray.pixels[i] = static_cast<uint8_t>(std::lround(0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2]));
  }
  return gray;
}

class FileSource final : public VideoSource {
 public:
  Status open(const std::string& path, int channels, const std::string& index_folder) {
    path_ = path;
    channels_ = channels;
    index_folder_ = index_folder;
    FOURDVT_TRY(openFormat());
    AVFormatContext* raw = file_.format.get();
    stream_ = pictureTrack(*raw);
    const AVCodec* codec = stream_ < 0 ? nullptr : avcodec_find_decoder(raw->streams[stream_]->codecpar->codec_id);
    if (!codec) return unreadable(path, "no video stream that this build decodes");
    for (unsigned i = 0; i < raw->nb_streams; ++i) {
      if (static_cast<int>(i) != stream_) raw->streams[i]->discard = AVDISCARD_ALL;
    }
    alpha_ = alphaKindOf(*raw->streams[stream_]);
    if (channels != 3) {
      FOURDVT_ASSIGN(codec, decoderWithAlpha(*raw->streams[stream_], codec, path));
    }
    const AVCodecParameters& picture = *raw->streams[stream_]->codecpar;
    if (int64_t{picture.width} * picture.height > kMaxVideoPixels)
      return unreadable(path, "pictures of more than 16384x8192 pixels");
    codec_.reset(avcodec_alloc_context3(codec));
    avcodec_parameters_to_context(codec_.get(), &picture);
    codec_->max_pixels = kMaxVideoPixels;
    codec_->thread_count = 1;  // callers decode several files in parallel
    if (avcodec_open2(codec_.get(), codec, nullptr) < 0) return unreadable(path, "the decoder does not start");
    const auto marks = marksOf(*raw, *raw->streams[stream_]);
    if (!marks) return unreadable(path, "its display matrix turns pictures by an angle that is no quarter turn");
    marks_ = *marks;
    judged_ = false;
    deinterlacer_.close();
    to_bt709_.close();
    return {};
  }

  Result<VideoListing> list() override {
    if (number_ > 0) FOURDVT_TRY(rewind());
    const VideoStamps stamps = listStamps(*file_.format, stream_, stampsPath(path_, index_folder_));
    VideoListing out = listVideo(*file_.format, stream_, stamps);
    FOURDVT_TRY(rewind());
    return out;
  }

  std::optional<double> framesPerSecond() const override {
    const AVRational rate = file_.format->streams[stream_]->avg_frame_rate;
    if (rate.num <= 0 || rate.den <= 0) return std::nullopt;
    return av_q2d(rate);
  }

  PictureMarks marks() const override { return marks_; }
  std::vector<std::string> conversions() const override { return conversions_; }
  bool hasAlpha() const override { return alpha_ != AlphaKind::None; }

  Result<std::optional<Image>> next() override {
    FOURDVT_ASSIGN(const bool more, advance());
    if (!more) return std::optional<Image>();
    return picture();
  }

  Status skip(uint32_t pictures) override {
    const uint32_t wanted = number_ + pictures;
    // Block alpha has keyframes of its own, which seeking ignores.
    const bool seeks = channels_ == 3 || alpha_ != AlphaKind::InBlocks;
    if (pictures > kSeekBeyond && seeks) FOURDVT_TRY(seekBefore(wanted));
    while (number_ < wanted) {
      FOURDVT_ASSIGN(const bool more, advance());
      if (!more) return {};
    }
    return {};
  }

 private:
  // Makes frame_ the next picture. Returns false at the end of the video.
  Result<bool> advance() {
    while (true) {
      if (deinterlacer_.isOpen()) {
        av_frame_unref(frame_.get());
        const int pulled = deinterlacer_.pull(*frame_);
        if (pulled == AVERROR_EOF) return false;
        if (pulled == 0) {
          ++number_;
          return true;
        }
        if (pulled != AVERROR(EAGAIN)) return unreadable(path_, "a picture is not deinterlaced");
      }
      FOURDVT_ASSIGN(const bool decoded, decode());
      if (decoded && !judged_) FOURDVT_TRY(judge());
      if (!deinterlacer_.isOpen()) {
        number_ += decoded;
        return decoded;
      }
      if (!deinterlacer_.push(decoded ? frame_.get() : nullptr))
        return unreadable(path_, "a picture is not deinterlaced");
    }
  }

  // Selects the conversions by the first picture.
  Status judge() {
    judged_ = true;
    conversions_.clear();
    FOURDVT_TRY(openFilter(deinterlacing(*file_.format->streams[stream_], *frame_), deinterlacer_));
    return channels_ == 1 ? Status() : openFilter(toBt709(*frame_), to_bt709_);
  }

  Status openFilter(const Conversion& conversion, FrameFilter& filter) {
    if (conversion.chain.empty()) return {};
    if (!filter.open(conversion.chain, *frame_))
      return unreadable(path_, conversion.name + ": this FFmpeg does not convert such pictures");
    conversions_.push_back(conversion.name);
    return {};
  }

  // Decodes the next picture into frame_. Returns false at the end of the video.
  Result<bool> decode() {
    while (true) {
      const int received = avcodec_receive_frame(codec_.get(), frame_.get());
      if (received == 0) {
        if (!judged_) first_stamp_ = frame_->best_effort_timestamp;
        return true;
      }
      if (received == AVERROR_EOF) return false;
      if (received != AVERROR(EAGAIN)) return unreadable(path_, "a picture does not decode");
      FOURDVT_TRY(feed());
    }
  }

  // Lists the presentation times that number the pictures, if present; may move the file's position.
  void listTimes() {
    VideoStamps stamps = listStamps(*file_.format, stream_, stampsPath(path_, index_folder_));
    if (!stamps.presentation || stamps.times.empty()) return;
    const int64_t later = stamps.from_index ? first_stamp_ - stamps.times.front() : 0;
    for (int64_t& time : stamps.times) time += later;
    if (stamps.times.front() == first_stamp_) stamps_ = std::move(stamps.times);
  }

  // Seeks to a picture at or before `wanted` where stamps number the pictures and a keyframe is nearer than the
  // position; else position and number stay, or restart from 0.
  Status seekBefore(uint32_t wanted) {
    if (number_ == 0) {
      FOURDVT_ASSIGN(const bool more, advance());  // sets first_stamp_
      if (!more) return {};
    }
    if (deinterlacer_.isOpen()) return {};  // pictures depend on their neighbours
    bool moved = false;
    if (!listed_ && first_stamp_ != AV_NOPTS_VALUE) {
      listed_ = moved = true;
      listTimes();
    }
    const uint32_t target = wanted - kReordered;
    if (target < stamps_.size() && target > number_) {
      moved = true;
      if (av_seek_frame(file_.format.get(), stream_, stamps_[target], AVSEEK_FLAG_BACKWARD) >= 0) {
        avcodec_flush_buffers(codec_.get());
        FOURDVT_ASSIGN(const bool decoded, decode());
        const auto found = std::lower_bound(stamps_.begin(), stamps_.end(), frame_->best_effort_timestamp);
        const auto at = static_cast<uint32_t>(found - stamps_.begin());
        if (decoded && at < wanted && found != stamps_.end() && *found == frame_->best_effort_timestamp) {
          number_ = at + 1;
          return {};
        }
      }
    }
    return moved ? rewind() : Status();
  }

  // Reopens the file.
  Status rewind() {
    number_ = 0;
    return open(std::string(path_), channels_, std::string(index_folder_));
  }

  Status openFormat() {
    file_ = openFileOnly(path_);
    if (!file_.io) return unreadable(path_, "cannot be opened");
    if (!file_.format && lacksIndex(path_))
      return Error{
          ErrorId::FileUnreadable,
          path_ + ": is cut off before its index (\"moov\"), as when a battery dies: no picture can be read; let " +
              "the camera repair it, or leave this camera out"};
    if (!file_.format) return unreadable(path_, "not a video file, or one that names other files");
    if (!findStreams(*file_.format)) return unreadable(path_, "no readable stream");
    return {};
  }

  Status feed() {
    while (true) {
      const int read = av_read_frame(file_.format.get(), packet_.get());
      if (read == AVERROR_EOF || (read < 0 && avio_feof(file_.format->pb))) {  // EOF of a truncated file
        avcodec_send_packet(codec_.get(), nullptr);
        return {};
      }
      if (read < 0) return unreadable(path_, "reading stops inside the file");
      const bool ours = packet_->stream_index == stream_ && !isCutOff(*file_.format, *packet_);
      const int sent = ours ? avcodec_send_packet(codec_.get(), packet_.get()) : 0;
      av_packet_unref(packet_.get());
      if (sent < 0) return unreadable(path_, "a picture does not decode");
      if (ours) return {};
    }
  }

  Result<std::optional<Image>> picture() {
    Image alpha;
    if (channels_ != 3) alpha = alphaOf(*frame_);
    if (channels_ == 1 && !isOpaque(alpha)) return std::optional<Image>(std::move(alpha));
    if (to_bt709_.isOpen()) {
      const bool pushed = to_bt709_.push(frame_.get());
      if (!pushed || to_bt709_.pull(*frame_) != 0) return unreadable(path_, "the picture does not convert to BT.709");
    }
    const auto* format = av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame_->format));
    if (!format) return unreadable(path_, "unknown pixel format");
    const bool luma_first = !(format->flags & (AV_PIX_FMT_FLAG_RGB | AV_PIX_FMT_FLAG_PAL)) &&
                            format->comp[0].depth == 8 && format->comp[0].step == 1 && format->comp[0].plane == 0;
    if (channels_ == 1 && luma_first) return std::optional<Image>(lumaPlane(*frame_, isFullRange(*frame_, *format)));
    Image rgb;
    if (!converter_.convert(*frame_, rgb)) return unreadable(path_, "the picture does not convert to RGB");
    if (channels_ == 4) return std::optional<Image>(withAlpha(rgb, alpha));
    return std::optional<Image>(channels_ == 1 ? grayFromRgb(rgb) : std::move(rgb));
  }

  static constexpr uint32_t kSeekBeyond = 60;  // seek distance, pictures; below it all are decoded
  static constexpr uint32_t kReordered = 17;   // maximum pictures between a decoding and a presentation time, plus one

  std::string path_, index_folder_;
  int channels_ = 3, stream_ = -1;
  uint32_t number_ = 0;                   // next picture's
  int64_t first_stamp_ = AV_NOPTS_VALUE;  // picture 0's
  std::vector<int64_t> stamps_;           // [picture], once a seek needs them
  bool listed_ = false;
  AlphaKind alpha_ = AlphaKind::None;
  FileOnly file_;
  AvCodec codec_;
  AvFrame frame_{av_frame_alloc()};
  AvPacket packet_{av_packet_alloc()};
  RgbConverter converter_;
  PictureMarks marks_;
  bool judged_ = false;  // the first picture is decoded and its filters are set up
  std::vector<std::string> conversions_;
  FrameFilter deinterlacer_, to_bt709_;
};

}  // namespace

namespace {

Result<std::unique_ptr<FileSource>> openSource(const std::string& path, int channels, const std::string& index_folder) {
  quietFfmpeg();
  if (channels != 1 && channels != 3 && channels != 4) {
    return Error{ErrorId::InvalidArgument, path + ": a video opens with 1, 3 or 4 channels"};
  }
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) {
    return Error{ErrorId::FileMissing, path + ": no such video file; check the name and the folder"};
  }
  auto source = std::make_unique<FileSource>();
  FOURDVT_TRY(source->open(path, channels, index_folder));
  return source;
}

}  // namespace

Result<std::unique_ptr<VideoSource>> openVideoFile(const std::string& path, int channels) {
  return openIndexedVideo(path, channels, {});
}

Result<std::unique_ptr<VideoSource>> openIndexedVideo(const std::string& path, int channels,
                                                      const std::string& index_folder) {
  FOURDVT_ASSIGN(auto source, openSource(path, channels, index_folder));
  return std::unique_ptr<VideoSource>(std::move(source));
}

Status indexVideo(const std::string& path, const std::string& index_folder) {
  std::error_code failed;
  if (const std::string kept = stampsPath(path, index_folder); !kept.empty() && std::filesystem::exists(kept, failed))
    return {};
  FOURDVT_ASSIGN(const auto source, openSource(path, 1, index_folder));
  const auto listed = source->list();
  return listed.ok() ? Status() : Status(listed.error());
}

}  // namespace fourdvt::platform
