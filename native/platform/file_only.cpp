// SPDX-License-Identifier: Apache-2.0
#include "platform/file_only.h"

#include <array>
#include <fstream>
#include <vector>

#include "platform/ffmpeg_video.h"

extern "C" {
#include <libavutil/intreadwrite.h>
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

}  // namespace fourdvt::platform
