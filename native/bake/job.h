// SPDX-License-Identifier: Apache-2.0
// What the stages of one bake share: the resolved plan, and the clock that adds up seconds per stage.
#pragma once

#include <chrono>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "bake/bake.h"
#include "bake/encode.h"
#include "bake/tile.h"
#include "capture/capture.h"
#include "package/base_mesh.h"

namespace fourdvt::bake {

struct SequencePlan {
  const capture::CaptureSequence* source = nullptr;  // borrowed from Job::capture
  std::vector<uint32_t> gop_first_frames;            // ascending, starts with 0
  uint32_t gopEnd(size_t gop) const {
    return gop + 1 < gop_first_frames.size() ? gop_first_frames[gop + 1] : source->frame_count;
  }
};

struct Job {
  BakeOptions options;  // resolved: jobs > 0, sequences listed, folders without a trailing slash
  capture::Capture capture;
  std::vector<PinholeCamera> cameras;
  std::vector<SequencePlan> sequences;
  package::EncodedBaseMesh mesh;  // THE order of vertices and faces of everything below
  BoundingBox bounds;             // over all frames
  TileLayout layout;
  EncodeSettings encode;
  uint32_t total_frames = 0;
  // Beside the character folder and on its file system: finished GOPs, and the result until it is renamed into place.
  std::string workFolder() const { return options.character_folder + ".work"; }
  std::string resultFolder() const { return workFolder() + "/result"; }
};

// Equal lengths ±1, at most `gop` frames each.
std::vector<uint32_t> planGops(uint32_t frame_count, int gop);

// Positions in the decoded mesh's order.
Positions reordered(const package::EncodedBaseMesh& mesh, const Positions& source);

// Seconds of work by stage; stages overlap in time, so that the sum may exceed the wall clock. Thread-safe.
class StageClock {
 public:
  class Span {
   public:
    Span(StageClock& clock, const char* stage) : clock_(clock), stage_(stage), start_(Now::now()) {}
    ~Span() { clock_.add(stage_, std::chrono::duration<double>(Now::now() - start_).count()); }
    Span(const Span&) = delete;
    Span& operator=(const Span&) = delete;

   private:
    using Now = std::chrono::steady_clock;
    StageClock& clock_;
    const char* stage_;
    Now::time_point start_;
  };
  void add(const char* stage, double seconds) {
    std::lock_guard lock(mutex_);
    seconds_[stage] += seconds;
  }
  std::map<std::string, double> seconds() const {
    std::lock_guard lock(mutex_);
    return seconds_;
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::string, double> seconds_;
};

}  // namespace fourdvt::bake
