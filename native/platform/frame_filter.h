// SPDX-License-Identifier: Apache-2.0
// A chain of FFmpeg's filters over decoded pictures. Private to the files that link FFmpeg.
#pragma once

#include <string>

#include "platform/ffmpeg_handles.h"

namespace fourdvt::platform {

class FrameFilter {
 public:
  // `chain`: FFmpeg's filter notation, for pictures of the size and format of `like`. Returns false if this FFmpeg
  // lacks a filter or rejects such pictures.
  bool open(const std::string& chain, const AVFrame& like);
  bool isOpen() const { return graph_ != nullptr; }
  void close() { graph_.reset(); }
  // Takes the picture's reference; null marks the end. Returns false if the chain rejects it.
  bool push(AVFrame* frame);
  // Moves the next filtered picture to `out`. AVERROR(EAGAIN): push more first; AVERROR_EOF: end of stream.
  int pull(AVFrame& out);

 private:
  FilterGraph graph_;
  AVFilterContext *source_ = nullptr, *sink_ = nullptr;  // owned by graph_
};

}  // namespace fourdvt::platform
