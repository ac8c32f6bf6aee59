// SPDX-License-Identifier: Apache-2.0
// Scores of a capture's mattes, keyed or read from files, against the true mattes of a virtual studio, stored in
// FOLDER/SEQUENCE/maskNN like a capture's mattes. Needs no meshes.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "capture/capture.h"
#include "lab/measure/matte_agreement.h"

namespace fourdvt::measure {

struct MatteScore {
  std::string sequence, camera;
  MatteAgreement agreement;  // over the sequence's frames
};

// `capture`: opened with MeshNeed::Nothing. `against`: the true mattes' folder, as filmed. `on_frame` is called after
// each finished frame. Errors: those of FrameReader and of pictures; FileMissing, naming the folder, if a camera has no
// true mattes.
Result<std::vector<MatteScore>> scoreMattes(
    const capture::Capture& capture, const std::string& against, const OpenVideo& open_video,
    const std::function<void(const std::string& sequence, uint32_t frame)>& on_frame = {});

// One row per camera of each sequence and, for several, one for all. Fixed width, with units.
std::string matteTable(const std::vector<MatteScore>& scores);
// The same rows: {"band_pixels": …, "mattes": [{"sequence": …, "camera": …, "frames": …, "iou": …,
// "iou_outside_band": …, "edge_distance_pixels": … or null}, …]}.
std::string matteJson(const std::vector<MatteScore>& scores);

}  // namespace fourdvt::measure
