// SPDX-License-Identifier: Apache-2.0
#include "platform/media_file.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <span>

#include "base/bytes.h"
#include "base/hash.h"
#include "base/text.h"
#include "platform/ffmpeg_video.h"
#include "platform/files.h"

extern "C" {
#include <libavutil/intreadwrite.h>
#include <libavutil/timecode.h>
}

namespace fourdvt::platform {
namespace {

int refuseOtherFiles(AVFormatContext*, AVIOContext**, const char*, int, AVDictionary**) { return AVERROR(EPERM); }

// Prefixes "file:", so that a colon in the name is not parsed as a protocol.
AvIo openBytes(const std::string& path) {
  AVDictionary* options = nullptr;
  av_dict_set(&options, "protocol_whitelist", "file", 0);
  AVIOContext* io = nullptr;
  avio_open2(&io, ("file:" + path).c_str(), AVIO_FLAG_READ, nullptr, &options);
  av_dict_free(&options);
  return AvIo(io);
}

}  // namespace

bool lacksIndex(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  uint64_t at = 0;
  for (int box = 0; box < 1000; ++box) {
    std::array<unsigned char, 16> head{};
    file.seekg(static_cast<std::streamoff>(at));
    file.read(reinterpret_cast<char*>(head.data()), 8);
    if (!file) return box > 0;
    const std::string type(head.begin() + 4, head.begin() + 8);
    if (type == "moov" || (box == 0 && type != "ftyp" && type != "wide" && type != "mdat")) return false;
    uint64_t bytes = AV_RB32(head.data());
    if (bytes == 1 && !file.read(reinterpret_cast<char*>(head.data()) + 8, 8)) return true;
    if (bytes == 1) bytes = AV_RB64(head.data() + 8);
    if (bytes < 8 || bytes > INT64_MAX - at) return bytes == 0;  // 0: to the end of the file
    at += bytes;
  }
  return false;
}

FileOnly openFileOnly(const std::string& path) {
  FileOnly out;
  out.io = openBytes(path);
  if (!out.io) return out;
  AVFormatContext* raw = avformat_alloc_context();
  raw->pb = out.io.get();
  raw->io_open = refuseOtherFiles;
  AVDictionary* options = nullptr;
  // Forbids all protocols for referenced files: the concat demuxer bypasses our io_open.
  av_dict_set(&options, "protocol_whitelist", "none", 0);
  const bool opened = avformat_open_input(&raw, path.c_str(), nullptr, &options) >= 0;  // frees raw if it fails
  av_dict_free(&options);
  if (opened) out.format.reset(raw);
  return out;
}

bool findStreams(AVFormatContext& format) {
  std::vector<AVDictionary*> options(format.nb_streams, nullptr);
  for (AVDictionary*& o : options) av_dict_set_int(&o, "max_pixels", kMaxVideoPixels, 0);
  const bool found = avformat_find_stream_info(&format, options.data()) >= 0;
  for (AVDictionary*& o : options) av_dict_free(&o);
  return found;
}

namespace {

constexpr uint64_t kPresentation = 1, kCutOff = 2;  // flags in a cached file

// Stamps by the index of MP4 and AVI, if it lists all pictures of the file at equal intervals.
std::optional<VideoStamps> stampsOfIndex(const AVFormatContext& format, AVStream& stream) {
  const int entries = avformat_index_get_entries_count(&stream);
  if (entries < 2 || stream.nb_frames != entries) return std::nullopt;
  const int64_t bytes = avio_size(format.pb);
  VideoStamps out{.presentation = true, .from_index = true};
  for (int i = 0; i < entries; ++i) {
    const AVIndexEntry& entry = *avformat_index_get_entry(&stream, i);
    if (entry.flags & AVINDEX_DISCARD_FRAME) continue;
    if (bytes > 0 && entry.pos > bytes - entry.size)
      out.cut_off = true;
    else
      out.times.push_back(entry.timestamp);
  }
  const std::vector<int64_t>& t = out.times;
  if (out.cut_off || t.size() < 2 || t[1] <= t[0]) return std::nullopt;
  for (size_t i = 2; i < t.size(); ++i)
    if (uint64_t(t[i]) - uint64_t(t[i - 1]) != uint64_t(t[1]) - uint64_t(t[0])) return std::nullopt;
  return out;
}

// Returns false for VP8 packets with reference-only pictures.
bool isShown(const AVPacket& packet, AVCodecID codec) {
  if (packet.flags & AV_PKT_FLAG_DISCARD || packet.size == 0) return false;
  return codec != AV_CODEC_ID_VP8 || (packet.data[0] & 0x10) != 0;
}

VideoStamps stampsOfPackets(AVFormatContext& format, int stream) {
  VideoStamps out;
  av_seek_frame(&format, stream, 0, AVSEEK_FLAG_BACKWARD);  // on failure, the file is at its beginning
  AvPacket packet(av_packet_alloc());
  bool timed = true;
  out.presentation = true;
  int read = 0;
  while ((read = av_read_frame(&format, packet.get())) >= 0) {
    const bool ours = packet->stream_index == stream;
    const bool cut = ours && isCutOff(format, *packet);
    out.cut_off = out.cut_off || cut;
    if (ours && !cut && isShown(*packet, format.streams[stream]->codecpar->codec_id)) {
      const int64_t time = packet->pts != AV_NOPTS_VALUE ? packet->pts : packet->dts;
      out.presentation = out.presentation && packet->pts != AV_NOPTS_VALUE;
      timed = timed && time != AV_NOPTS_VALUE;
      out.times.push_back(time);
    }
    av_packet_unref(packet.get());
  }
  out.cut_off = out.cut_off || read != AVERROR_EOF;
  if (timed) std::sort(out.times.begin(), out.times.end());
  const bool unique = timed && std::adjacent_find(out.times.begin(), out.times.end()) == out.times.end();
  out.presentation = out.presentation && unique && !out.times.empty();
  return out;
}

bool loadStamps(const std::string& path, VideoStamps& out) {
  const auto bytes = readFile(path);
  if (!bytes || bytes.value().size() % sizeof(int64_t) != 0 || bytes.value().size() < 2 * sizeof(uint64_t))
    return false;
  const std::span<const uint8_t> all(bytes.value()), stamps = all.first(all.size() - sizeof(uint64_t));
  if (ByteReader(all.last(sizeof(uint64_t))).u64() != fnv1a(stamps)) return false;
  ByteReader in(stamps);
  const uint64_t flags = in.u64();
  out.presentation = (flags & kPresentation) != 0, out.cut_off = (flags & kCutOff) != 0;
  while (in.remaining() > 0) out.times.push_back(static_cast<int64_t>(in.u64()));
  return true;
}

// Caches the stamps. Ignores failures: the next call reads the video again.
void keepStamps(const std::string& path, const VideoStamps& stamps) {
  ByteWriter out;
  out.u64((stamps.presentation ? kPresentation : 0) | (stamps.cut_off ? kCutOff : 0));
  for (const int64_t time : stamps.times) out.u64(static_cast<uint64_t>(time));
  out.u64(fnv1a(out.data()));
  static_cast<void>(writeFileAtomic(path, out.data()));
}

std::string tag(const AVFormatContext& format, const AVStream& stream, const char* key) {
  for (AVDictionary* tags : {stream.metadata, format.metadata})
    if (const AVDictionaryEntry* entry = av_dict_get(tags, key, nullptr, 0)) return entry->value;
  return {};
}

bool isRate(AVRational rate) { return rate.num > 0 && rate.den > 0 && av_q2d(rate) <= 1000; }

// Seconds since midnight; the time code track has a rate of its own.
std::optional<double> timecodeSeconds(const AVFormatContext& format, const AVStream& stream, const std::string& text) {
  AVRational rate = isRate(stream.r_frame_rate) ? stream.r_frame_rate : stream.avg_frame_rate;
  for (unsigned i = 0; i < format.nb_streams; ++i) {
    const AVStream& other = *format.streams[i];
    if (other.codecpar->codec_tag == MKTAG('t', 'm', 'c', 'd') && isRate(other.avg_frame_rate))
      rate = other.avg_frame_rate;
  }
  AVTimecode code;
  if (text.empty() || !isRate(rate) || av_timecode_init_from_string(&code, rate, text.c_str(), nullptr) < 0)
    return std::nullopt;
  return code.start / av_q2d(rate);
}

bool isPictures(const AVStream& stream) {
  return stream.codecpar->codec_type == AVMEDIA_TYPE_VIDEO && !(stream.disposition & AV_DISPOSITION_ATTACHED_PIC);
}

bool isColour(const AVCodecParameters& picture) {
  const auto* format = av_pix_fmt_desc_get(static_cast<AVPixelFormat>(picture.format));
  return format && format->nb_components >= 3;
}

std::string describeTrack(const AVStream& stream) {
  const AVCodecParameters& picture = *stream.codecpar;
  const char* pixels = av_get_pix_fmt_name(static_cast<AVPixelFormat>(picture.format));
  const AVDictionaryEntry* title = av_dict_get(stream.metadata, "title", nullptr, 0);
  return "track " + std::to_string(stream.index) + " (" + avcodec_get_name(picture.codec_id) + ", " +
         std::to_string(picture.width) + "x" + std::to_string(picture.height) + (pixels ? ", " : "") +
         (pixels ? pixels : "") + (title ? ", \"" : "") + (title ? title->value : "") + (title ? "\"" : "") + ")";
}

// Returns true if the only track ends before the header's duration, the only evidence of a truncated Matroska file.
bool endsEarly(const AVFormatContext& format, const VideoListing& listing) {
  if (format.nb_streams != 1 || format.duration <= 0 || listing.times_s.size() < 2) return false;
  const double seconds = static_cast<double>(format.duration) / AV_TIME_BASE, last = listing.times_s.back();
  const double begin =
      std::max<double>(0, double(format.start_time)) / AV_TIME_BASE;  // included in Matroska's duration
  return seconds > begin + last + 3 * last / double(listing.times_s.size() - 1);
}

}  // namespace

bool isCutOff(const AVFormatContext& format, const AVPacket& packet) {
  return (packet.flags & AV_PKT_FLAG_CORRUPT) != 0 && avio_feof(format.pb) != 0;
}

VideoStamps listStamps(AVFormatContext& format, int stream, const std::string& kept) {
  if (auto stamps = stampsOfIndex(format, *format.streams[stream])) return *stamps;
  VideoStamps out;
  if (!kept.empty() && loadStamps(kept, out)) return out;
  out = stampsOfPackets(format, stream);
  if (!kept.empty()) keepStamps(kept, out);
  return out;
}

std::string stampsPath(const std::string& video, const std::string& folder) {
  namespace fs = std::filesystem;
  std::error_code failed;
  if (folder.empty() || !fs::is_directory(folder, failed)) return {};
  const auto time = std::chrono::floor<std::chrono::seconds>(fs::last_write_time(video, failed).time_since_epoch());
  const std::string key = fs::absolute(video, failed).lexically_normal().string() + " " +
                          std::to_string(fs::file_size(video, failed)) + " " + std::to_string(time.count());
  return folder + "/" + hexDigits(fnv1a(key)) + ".times";
}

int pictureTrack(const AVFormatContext& format) {
  int best = -1, best_score = -1;
  for (unsigned i = 0; i < format.nb_streams; ++i) {
    const AVStream& stream = *format.streams[i];
    if (!isPictures(stream) || !avcodec_find_decoder(stream.codecpar->codec_id)) continue;
    const int score = 2 * ((stream.disposition & AV_DISPOSITION_DEFAULT) != 0) + isColour(*stream.codecpar);
    if (score > best_score) best = static_cast<int>(i), best_score = score;
  }
  return best;
}

VideoListing listVideo(const AVFormatContext& format, int stream, const VideoStamps& stamps) {
  const AVStream& track = *format.streams[stream];
  VideoListing out;
  out.pictures = stamps.times.size();
  out.announced = static_cast<uint64_t>(std::max<int64_t>(0, track.nb_frames));
  out.tick_s = av_q2d(track.time_base);
  const std::vector<int64_t>& t = stamps.times;
  if (std::adjacent_find(t.begin(), t.end(), std::greater_equal<int64_t>()) == t.end())
    for (const int64_t time : t) out.times_s.push_back((double(time) - double(t.front())) * out.tick_s);
  out.cut_off = stamps.cut_off || endsEarly(format, out);
  out.track = describeTrack(track);
  out.timecode = tag(format, track, "timecode");
  out.timecode_s = timecodeSeconds(format, track, out.timecode);
  out.created = tag(format, track, "creation_time");
  for (unsigned i = 0; i < format.nb_streams; ++i)
    if (static_cast<int>(i) != stream && isPictures(*format.streams[i]))
      out.other_tracks.push_back(describeTrack(*format.streams[i]));
  return out;
}

}  // namespace fourdvt::platform
