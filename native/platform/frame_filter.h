// SPDX-License-Identifier: Apache-2.0
// A chain of FFmpeg's filters over decoded pictures. Private to the files that link FFmpeg.
#pragma once

#include <string>

#include "platform/ffmpeg_handles.h"

namespace fourdvt::platform {

class FrameFilter {
 public:
  // `chain` is in FFmpeg's notation, for pictures of the size and format of `like`. False: this FFmpeg lacks one of the
  // filters, or it does not take such pictures.
  bool open(const std::string& chain, const AVFrame& like);
  bool isOpen() const { return graph_ != nullptr; }
  void close() { graph_.reset(); }
  // Takes the picture's reference; null: there are no more. False: the chain refuses it.
  bool push(AVFrame* frame);
  // The next picture that is done, in `out`. AVERROR(EAGAIN): more must be pushed; AVERROR_EOF: there are no more.
  int pull(AVFrame& out);

 private:
  FilterGraph graph_;
  AVFilterContext *source_ = nullptr, *sink_ = nullptr;  // owned by graph_
};

}  // namespace fourdvt::platform
