// SPDX-License-Identifier: Apache-2.0
// Report of a reconstruction: reconstruct.html with pictures, and reconstruct.json with the figures of every frame.
#pragma once

#include "reconstruct/run/frame_surface.h"
#include "reconstruct/run/reconstruct.h"

namespace fourdvt::reconstruct {

inline constexpr const char* kReportJson = "reconstruct.json";

// One frame of each sequence, drawn over every camera's picture.
class ReportPictures {
 public:
  void add(const std::string& sequence, uint32_t frame, std::span<const Image> pictures, const FrameSurface& surface);
  struct Sheet {
    std::string sequence;
    uint32_t frame = 0;
    Image picture;  // RGB
  };
  const std::vector<Sheet>& sheets() const { return sheets_; }

 private:
  std::vector<Sheet> sheets_;
};

// Means, and warnings: one per camera with empty silhouettes in some frame, for fallbacks and for low overlaps.
ReconstructSummary summarise(const capture::Capture& capture, const std::vector<ReconstructedSequence>& sequences);

// Summary stored in a report. Errors: FileMissing, FileUnreadable.
Result<ReconstructSummary> readSummary(const std::string& folder);

// Writes both files. Errors: WriteFailed.
Status writeReport(const std::string& folder, const ReconstructOptions& options, const capture::Capture& capture,
                   const std::vector<ReconstructedSequence>& sequences, const ReportPictures& pictures,
                   const ReconstructSummary& summary);

}  // namespace fourdvt::reconstruct
