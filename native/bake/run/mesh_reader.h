// SPDX-License-Identifier: Apache-2.0
// Reads captured meshes in the decoded mesh's order and keeps the last ones, because interpolation between frames asks
// for each of them several times. Not thread-safe.
#pragma once

#include <list>

#include "bake/run/job.h"

namespace fourdvt::bake {

class MeshReader {
 public:
  explicit MeshReader(const Job& job) : job_(&job) {}
  // Errors: those of capture::readMeshFrame.
  Result<Positions> read(const capture::CaptureSequence& sequence, uint32_t frame);
  // The same as a function, which borrows the reader.
  ReadPositions function() {
    return [this](const capture::CaptureSequence& sequence, uint32_t frame) { return read(sequence, frame); };
  }

 private:
  static constexpr size_t kKept = 24;  // four frames of each of four members, and some to spare
  struct Entry {
    const capture::CaptureSequence* sequence;
    uint32_t frame;
    Positions positions;
  };
  const Job* job_;
  std::list<Entry> entries_;  // the most recently used first
};

}  // namespace fourdvt::bake
