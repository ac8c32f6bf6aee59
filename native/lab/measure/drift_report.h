// SPDX-License-Identifier: Apache-2.0
// Drift of a tracked capture against a reference capture of the same motions, both of constant topology (drift.h).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "capture/capture.h"
#include "lab/measure/drift.h"

namespace fourdvt::measure {

struct FrameOfSequence {
  std::string sequence;
  uint32_t frame = 0;
};

struct DriftOptions {
  std::vector<std::string> sequences;      // those to measure; empty: all of the tracked capture
  std::optional<FrameOfSequence> bind_at;  // empty: "template" of the capture's track.json, else its first frame
  BindingLimits limits;
};

struct FrameDrift {
  double mean_m = 0, p95_m = 0, max_m = 0;
  double change_m = 0;  // errorChange_m to the next frame; of a loop's last frame: to the first one; else NaN
};

struct LargestError {
  std::string sequence;
  uint32_t frame = 0, vertex = 0;
  glm::vec3 position_m{0};  // tracked vertex, world
  double error_m = 0;
};

struct SequenceDrift {
  std::string sequence;  // "all" for the total
  DriftFigures figures;
  std::vector<FrameDrift> frames;  // empty for the total
  bool loop = false;
};

struct DriftReport {
  FrameOfSequence bound_at;
  BindingLimits limits;
  size_t bound = 0, far = 0, facing_away = 0;  // vertices
  std::vector<SequenceDrift> sequences;
  SequenceDrift all;
  LargestError largest;
};

// Reads "template": {"sequence", "frame"} of FOLDER/track.json; nullopt without the file or the key. Errors:
// FileUnreadable.
Result<std::optional<FrameOfSequence>> readTemplateFrame(const std::string& folder);

// Both captures of constant topology; the reference contains the measured sequences and the one of the binding, with as
// many frames. `on_frame` is called after each finished frame. Errors: those of readTemplateFrame and readMeshFrame;
// InvalidArgument (a sequence or frame that a capture lacks, no vertex is bound).
Result<DriftReport> measureDrift(const capture::Capture& tracked, const capture::Capture& reference,
                                 const DriftOptions& options,
                                 const std::function<void(const std::string& sequence, uint32_t frame)>& on_frame = {});

// Fixed width, with units.
std::string driftTable(const DriftReport& report);
// The same figures, and those of each frame, in millimetres.
std::string driftJson(const DriftReport& report);

}  // namespace fourdvt::measure
