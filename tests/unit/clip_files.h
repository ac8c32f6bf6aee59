// SPDX-License-Identifier: Apache-2.0
// Small videos whose containers a test defines: time stamps with gaps, time codes, edit lists, several tracks.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "matte_with.h"
#include "platform/ffmpeg_handles.h"
#include "platform/video_writer.h"

namespace fourdvt {

struct ClipFile {
  int pictures = 8, width = 16, height = 12;
  double fps = 25;
  int channels = 3;                   // 1: lossless grey, .mkv
  std::function<double(int)> time_s;  // [picture]; empty: by fps; an edit list hides negative ones
  std::function<int(int)> grey;       // [picture]; empty: 10 × index
  std::string timecode, created;
};

// Writes the packets of videos as tracks of one file, the first one as default; times in seconds, by picture.
inline void writeTracks(const std::string& path, const std::vector<std::string>& tracks, const ClipFile& clip) {
  AVFormatContext* out = nullptr;
  ASSERT_GE(avformat_alloc_output_context2(&out, nullptr, nullptr, path.c_str()), 0);
  std::vector<AVFormatContext*> in(tracks.size(), nullptr);
  for (size_t i = 0; i < tracks.size(); ++i) {
    ASSERT_EQ(avformat_open_input(&in[i], tracks[i].c_str(), nullptr, nullptr), 0);
    ASSERT_GE(avformat_find_stream_info(in[i], nullptr), 0);
    AVStream* to = avformat_new_stream(out, nullptr);
    ASSERT_GE(avcodec_parameters_copy(to->codecpar, in[i]->streams[0]->codecpar), 0);
    to->codecpar->codec_tag = 0;
    to->time_base = path.ends_with(".avi") ? av_inv_q(av_d2q(clip.fps, 1000)) : AVRational{1, 10000};
    to->avg_frame_rate = av_d2q(clip.fps, 1000);
    if (i == 0) to->disposition = AV_DISPOSITION_DEFAULT;
    if (i == 0 && !clip.timecode.empty()) av_dict_set(&to->metadata, "timecode", clip.timecode.c_str(), 0);
  }
  if (!clip.created.empty()) av_dict_set(&out->metadata, "creation_time", clip.created.c_str(), 0);
  ASSERT_GE(avio_open(&out->pb, path.c_str(), AVIO_FLAG_WRITE), 0);
  ASSERT_GE(avformat_write_header(out, nullptr), 0);
  platform::AvPacket packet(av_packet_alloc());
  for (int picture = 0; picture < clip.pictures; ++picture) {
    for (size_t i = 0; i < tracks.size(); ++i) {
      ASSERT_GE(av_read_frame(in[i], packet.get()), 0);
      const AVRational base = out->streams[i]->time_base;
      const double time_s = clip.time_s ? clip.time_s(picture) : picture / clip.fps;
      packet->pts = packet->dts = llround(time_s / av_q2d(base));
      packet->duration = llround(1 / clip.fps / av_q2d(base));
      packet->stream_index = int(i);
      packet->pos = -1;
      ASSERT_EQ(av_interleaved_write_frame(out, packet.get()), 0);
    }
  }
  ASSERT_EQ(av_write_trailer(out), 0);
  avio_closep(&out->pb);
  avformat_free_context(out);
  for (AVFormatContext*& file : in) avformat_close_input(&file);
}

// Writes pictures of one grey each, or mattes, at constant intervals.
inline void writePlainClip(const std::string& path, const ClipFile& clip) {
  std::filesystem::create_directories(std::filesystem::path(path).parent_path());
  platform::VideoFormat format{.width = clip.width, .height = clip.height, .channels = clip.channels, .fps = clip.fps};
  format.preset = "ultrafast";  // no B pictures: packets are in presentation order
  auto writer = platform::VideoWriter::create(path, format);
  ASSERT_TRUE(writer.ok()) << writer.error().message;
  for (int i = 0; i < clip.pictures; ++i) {
    const auto grey = static_cast<uint8_t>(clip.grey ? clip.grey(i) : 10 * i);
    const Image picture = clip.channels == 1 ? matteWith(grey, clip.width, clip.height)
                                             : Image(clip.width, clip.height, clip.channels, grey);
    ASSERT_TRUE(writer.value()->write(picture).ok());
  }
  ASSERT_TRUE(writer.value()->finish().ok());
}

inline void writeClip(const std::string& path, const ClipFile& clip) {
  const std::string plain = path + (clip.channels == 1 ? ".plain.mkv" : ".plain.mp4");
  writePlainClip(plain, clip);
  writeTracks(path, {plain}, clip);
  std::filesystem::remove(plain);
}

}  // namespace fourdvt
