// SPDX-License-Identifier: Apache-2.0
// Owning handles for FFmpeg's objects. Private to the files that link FFmpeg.
#pragma once

#include <memory>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavfilter/avfilter.h>
#include <libavformat/avformat.h>
#include <libavutil/pixdesc.h>
#include <libswresample/swresample.h>
#include <libswscale/swscale.h>
}

namespace fourdvt::platform {

struct AvDeleter {
  void operator()(AVIOContext* p) const { avio_closep(&p); }
  void operator()(AVFormatContext* p) const { avformat_close_input(&p); }
  void operator()(AVCodecContext* p) const { avcodec_free_context(&p); }
  void operator()(AVFilterGraph* p) const { avfilter_graph_free(&p); }
  void operator()(AVFrame* p) const { av_frame_free(&p); }
  void operator()(AVPacket* p) const { av_packet_free(&p); }
  void operator()(SwsContext* p) const { sws_freeContext(p); }
  void operator()(SwrContext* p) const { swr_free(&p); }
};

using AvIo = std::unique_ptr<AVIOContext, AvDeleter>;
using AvFormat = std::unique_ptr<AVFormatContext, AvDeleter>;
using AvCodec = std::unique_ptr<AVCodecContext, AvDeleter>;
using FilterGraph = std::unique_ptr<AVFilterGraph, AvDeleter>;
using AvFrame = std::unique_ptr<AVFrame, AvDeleter>;
using AvPacket = std::unique_ptr<AVPacket, AvDeleter>;
using Resampler = std::unique_ptr<SwrContext, AvDeleter>;
using SwsScaler = std::unique_ptr<SwsContext, AvDeleter>;

// Silences FFmpeg's log: our own errors name the file.
inline void quietFfmpeg() { av_log_set_level(AV_LOG_PANIC); }

}  // namespace fourdvt::platform
