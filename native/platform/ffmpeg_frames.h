// SPDX-License-Identifier: Apache-2.0
// FFmpeg's decoded frames: conversion to RGB by their own matrix and range, and chains of filters. Private to the files
// that link FFmpeg.
#pragma once

#include <string>

#include "base/image.h"
#include "platform/ffmpeg_handles.h"

namespace fourdvt::platform {

// Returns true for full range. Unspecified range: full for gray (mattes are coverage, not luma) and RGB, limited for
// YUV.
bool isFullRange(const AVFrame& frame, const AVPixFmtDescriptor& format);

// Returns true for the matrix of standard definition: marked so, or unspecified and of at most 576 lines.
bool isBt601(const AVFrame& frame);

class RgbConverter {
 public:
  // fast: nearest-neighbour chroma upsampling and less exact rounding.
  explicit RgbConverter(bool fast = false) : fast_(fast) {}
  // Converts to 3 channels at the frame's size, its sides divided by `reduce` and rounded down: a pixel is the mean of
  // reduce² pixels. Reuses the memory of `out`. Returns false for formats that FFmpeg cannot convert.
  bool convert(const AVFrame& frame, Image& out, int reduce = 1);

 private:
  bool fast_;
  SwsScaler scaler_;
};

// A chain of filters over decoded pictures.
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
