// SPDX-License-Identifier: Apache-2.0
// Rigs and frames of COLMAP 3.12 and later: poses of images by their rig, which override those in images.txt or
// images.bin.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "base/result.h"

namespace fourdvt::capture {

// image number → QW QX QY QZ TX TY TZ, world to camera. Contains no images of cameras without a pose in their rig.
using RigPoses = std::map<uint64_t, std::array<double, 7>>;

// Parses texts of rigs.txt and frames.txt; messages name `path` as their folder. Errors: CameraPose.
Result<RigPoses> parseRigsText(std::string_view rigs, std::string_view frames, const std::string& path);
// Parses rigs.bin and frames.bin in the same way.
Result<RigPoses> parseRigsBinary(std::string_view rigs, std::string_view frames, const std::string& path);

}  // namespace fourdvt::capture
