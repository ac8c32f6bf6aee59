// SPDX-License-Identifier: Apache-2.0
// Contents of a camera's files and their conversion on reading, for display. Reads one picture of each.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/video.h"
#include "capture/capture.h"

namespace fourdvt::capture {

struct PictureReport {
  std::string path;                  // path of the video, or of the first picture
  int width = 0, height = 0;         // stored size
  std::optional<uint64_t> pictures;  // videos only
  std::optional<double> fps;
  std::vector<std::string> done;  // conversions: "turned by 90°", "HLG, BT.2020 → BT.709"
};

// Describes each of a picture's marks and its effect; `applied`: calibratedMarks.
std::vector<std::string> describeMarks(const PictureMarks& marks, const PictureMarks& applied);

// Report on a camera's colour pictures in a sequence. Errors: those of reading its first picture.
Result<PictureReport> reportOnPictures(const CaptureSequence& sequence, const CaptureCamera& camera,
                                       const OpenVideo& open_video);

// Reads the first matte of a camera's pictures. Errors: those of MattedPictures; none without mattes.
Status checkMattes(const CaptureSequence& sequence, const CaptureCamera& camera, const OpenVideo& open_video);

// Source of a camera's mattes in a sequence: their file, "alpha of the pictures", "keyed against background/cam00.png",
// or "none".
std::string matteSource(const Capture& capture, const CaptureSequence& sequence, const CaptureCamera& camera,
                        const OpenVideo& open_video);

}  // namespace fourdvt::capture
