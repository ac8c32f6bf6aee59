// SPDX-License-Identifier: Apache-2.0
#include "bake/run/mesh_reader.h"

#include <algorithm>

namespace fourdvt::bake {

Result<Positions> MeshReader::read(const capture::CaptureSequence& sequence, uint32_t frame) {
  const auto known = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    return entry.sequence == &sequence && entry.frame == frame;
  });
  if (known != entries_.end()) {
    entries_.splice(entries_.begin(), entries_, known);
    return entries_.front().positions;
  }
  FOURDVT_ASSIGN(auto positions, capture::readMeshFrame(job_->capture, sequence, frame));
  entries_.push_front({&sequence, frame, reordered(job_->mesh, positions)});
  if (entries_.size() > kKept) entries_.pop_back();
  return entries_.front().positions;
}

}  // namespace fourdvt::bake
