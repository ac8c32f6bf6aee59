// SPDX-License-Identifier: Apache-2.0
// The stages of a bake in order of execution. This is their only list: clock, progress and report use it. A new stage
// needs: an entry in Stage and in kStages; a StageClock::Span round its work, in a file of bake/stages/ that is
// listed in CMakeLists.txt there; a call in runStages (bake.cpp), unless it is part of the survey or of the GOPs; and
// the units of its work in expectWork (bake.cpp), which the stage reports as done through BakeRun::progress.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <mutex>
#include <string>

#include "base/watch.h"

namespace fourdvt::bake {

enum class Stage {
  Validate,
  Refine,
  Regions,
  Warp,
  Decode,
  Visibility,
  Colours,
  Method,
  Labels,
  Resample,
  Fill,
  Detail,
  Tile,
  Encode,
  Align,
  Geometry,
  Graph,
  Room,
  Assemble,
};

struct StageInfo {
  const char* name;
  const char* does;
  // Rough seconds of work per unit on two cores; only the ratios matter. 0: another stage's estimate includes it.
  double work_s;
  const char* unit;
};

inline constexpr std::array<StageInfo, 19> kStages{{
    {"validate", "checks that the capture can be read and the output written", 0, ""},
    {"refine", "moves the mesh's outlines onto the mattes', turns cameras that the pictures contradict", 0.15,
     "captured frame"},
    {"regions", "from cameras: finds what every camera shows of the performer, and packs these parts", 0.02,
     "captured frame"},
    {"warp", "puts a class's members on common time; root motion, corrections of the mesh blend", 0.1,
     "phase and member"},
    {"decode", "reads pictures and meshes; survey and layers each do so once", 0, ""},
    {"visibility", "finds which camera sees which face, from depth maps and sample points on the GPU", 0.3,
     "captured frame, with decoding, colours and labels"},
    {"colours", "makes the cameras' colours agree", 0, ""},
    {"method", "from cameras: tries the methods on cameras that are left out", 6, "tried frame"},
    {"labels", "chooses the cameras of every face for whole sequences", 0, ""},
    {"resample", "draws the cameras' pictures into texture layers, or crops them", 0, ""},
    {"fill", "fills empty texels, gutters and what lies round the performer", 0, ""},
    {"detail", "averages the fine detail of layers over the frames of a GOP", 0, ""},
    {"tile", "puts layers and barcode into one 4:2:0 picture", 0, ""},
    {"encode", "codes the pictures, one closed GOP at a time", 0.55,
     "frame and member, with decoding, resampling, filling, detail and tiling"},
    {"align", "aligns on the surface what a class's members show", 1.2, "phase and member but the first"},
    {"geometry", "codes positions, labels, corrections and alignment, or surfaces, as chunks", 0, ""},
    {"graph", "finds where every motion may lead into every other one", 0.01, "frame of a stream"},
    {"room", "textures the faces of the capture's room from its plates", 4, "room"},
    {"assemble", "writes the character's files and moves them into place", 0, ""},
}};

constexpr const StageInfo& infoOf(Stage stage) { return kStages[static_cast<size_t>(stage)]; }

// Sums seconds of work by stage. Stages overlap in time, so that the sum may exceed the wall clock. Thread-safe.

class StageClock {
 public:
  // Counts the time from its construction to its destruction.
  class Span {
   public:
    Span(StageClock& clock, Stage stage) : clock_(clock), stage_(stage) {}
    ~Span() { clock_.add(stage_, watch_.seconds()); }
    Span(const Span&) = delete;
    Span& operator=(const Span&) = delete;

   private:
    StageClock& clock_;
    const Stage stage_;
    const Watch watch_;
  };

  void add(Stage stage, double seconds) {
    std::lock_guard lock(mutex_);
    seconds_[static_cast<size_t>(stage)] += seconds;
  }
  // Seconds by the stages' names; stages that never ran are left out.
  std::map<std::string, double> seconds() const {
    std::lock_guard lock(mutex_);
    std::map<std::string, double> out;
    for (size_t s = 0; s < kStages.size(); ++s)
      if (seconds_[s] > 0) out[kStages[s].name] = seconds_[s];
    return out;
  }

 private:
  mutable std::mutex mutex_;
  std::array<double, kStages.size()> seconds_{};
};

}  // namespace fourdvt::bake
