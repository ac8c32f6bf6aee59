// SPDX-License-Identifier: Apache-2.0
#include "refine/frames.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "mattes/frame_reader.h"
#include "refine/outline.h"

namespace fourdvt::refine {
namespace {

constexpr uint32_t kMaxFrames = 40, kMinFrames = 4;
constexpr double kMatteBytes = 256e6;  // limit in memory, above kMinFrames
constexpr double kFigureShare = 0.5;   // maximum share of a picture around the figure
constexpr int kEdgeStride = 4;  // pixels between samples on the matte's edge at which the picture's edge is searched

// Stride between sampled frames.
uint32_t strideOf(const capture::Capture& capture) {
  double frame_bytes = 0, all = 0;
  for (const auto& camera : capture.cameras) frame_bytes += kFigureShare * camera.pinhole.width * camera.pinhole.height;
  for (const auto& sequence : capture.sequences) all += sequence.frame_count;
  const double most = std::clamp(kMatteBytes / frame_bytes, double(kMinFrames), double(kMaxFrames));
  return std::max(1u, static_cast<uint32_t>(std::ceil(all / most)));
}

// Matte cropped to its non-empty rectangle.
MatteCrop cropOf(const Image& rgba) {
  int left = rgba.width, top = rgba.height, right = 0, bottom = 0;
  for (int y = 0; y < rgba.height; ++y)
    for (int x = 0; x < rgba.width; ++x) {
      if (rgba.at(x, y)[3] == 0) continue;
      left = std::min(left, x);
      right = std::max(right, x + 1);
      top = std::min(top, y);
      bottom = y + 1;
    }
  MatteCrop crop;
  if (right <= left) return crop;
  crop.left = left;
  crop.top = top;
  crop.alpha = Image(right - left, bottom - top, 1);
  for (int y = top; y < bottom; ++y)
    for (int x = left; x < right; ++x) *crop.alpha.at(x - left, y - top) = rgba.at(x, y)[3];
  return crop;
}

}  // namespace

Result<RefineFrames> readRefineFrames(const capture::Capture& capture, const OpenVideo& open_video,
                                      const std::vector<glm::uvec3>& welded_faces,
                                      const std::function<bool(double share)>& on_frame) {
  const uint32_t stride = strideOf(capture);
  double all = 0, read = 0;
  for (const auto& sequence : capture.sequences) all += sequence.frame_count;
  RefineFrames out;
  out.matte_edges.resize(capture.cameras.size());
  for (const capture::CaptureSequence& sequence : capture.sequences) {
    FOURDVT_ASSIGN(auto reader, mattes::FrameReader::open(capture, sequence, open_video));
    for (uint32_t f = 0; f < sequence.frame_count; f += stride) {
      if (!on_frame((read + f) / all))
        return Error{ErrorId::Interrupted, "stopped; the refinement was not saved, run the same command again"};
      reader->skipTo(f);
      FOURDVT_ASSIGN(auto captured, reader->next());
      RefineFrame frame;
      frame.sequence = &sequence;
      frame.index = f;
      frame.positions = std::move(captured.positions);
      computeVertexNormals(welded_faces, frame.positions.data(), frame.positions.size(), frame.normals);
      frame.mattes.resize(capture.cameras.size());
      inParallel(capture.cameras.size(), [&](int c) {
        frame.mattes[c] = cropOf(captured.pictures[c]);
        const auto edges = matteEdgeOffsets(captured.pictures[c], kEdgeStride);
        out.matte_edges[c].insert(out.matte_edges[c].end(), edges.begin(), edges.end());
      });
      out.frames.push_back(std::move(frame));
    }
    read += sequence.frame_count;
  }
  return out;
}

}  // namespace fourdvt::refine
