// SPDX-License-Identifier: Apache-2.0
// Rigs and frames of COLMAP 3.12 and later: poses of images by the rig that took them, which go before those in
// images.txt or images.bin.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "base/result.h"

namespace fourdvt::capture {

// QW QX QY QZ TX TY TZ, world to camera, by image number. An image of a camera that has no pose in its rig is not in
// it.
using RigPoses = std::map<uint64_t, std::array<double, 7>>;

// Texts of rigs.txt and frames.txt; messages name `path` as their folder. Errors: CameraPose.
Result<RigPoses> parseRigsText(std::string_view rigs, std::string_view frames, const std::string& path);
// The same of rigs.bin and frames.bin.
Result<RigPoses> parseRigsBinary(std::string_view rigs, std::string_view frames, const std::string& path);

}  // namespace fourdvt::capture
