// SPDX-License-Identifier: Apache-2.0
// What a reconstruction leaves to look at: reconstruct.html with pictures, and reconstruct.json with every frame's
// figures.
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

// Means, and one warning for each camera that saw nothing in some frame, for fallbacks and for low overlaps.
ReconstructSummary summarise(const capture::Capture& capture, const std::vector<ReconstructedSequence>& sequences);

// The summary that a report was written with. Errors: FileMissing, FileUnreadable.
Result<ReconstructSummary> readSummary(const std::string& folder);

// Errors: WriteFailed.
Status writeReport(const std::string& folder, const ReconstructOptions& options, const capture::Capture& capture,
                   const std::vector<ReconstructedSequence>& sequences, const ReportPictures& pictures,
                   const ReconstructSummary& summary);

}  // namespace fourdvt::reconstruct
