// SPDX-License-Identifier: Apache-2.0
// Metadata of a JPEG or PNG: EXIF orientation and colour profile, without decoding pixels.
#pragma once

#include <string>
#include <string_view>

#include "base/image.h"

namespace fourdvt::capture {

struct StillMarks {
  PictureMarks marks;
  std::string profile;  // ICC; empty without one
};

// Reads the segments before a JPEG's pixels (APP1 "Exif", APP2 "ICC_PROFILE") or the chunks of a PNG (eXIf, iCCP).
// Damaged segments and other files give no marks.
StillMarks stillMarks(std::string_view file);

// Converts RGB or RGBA pixels of a profile to sRGB, relative colorimetric. Pixels are unchanged if the profile is not
// RGB, is damaged, or differs from sRGB by at most kSrgbTolerance levels.
void toSrgb(const std::string& profile, Image& colour);
inline constexpr int kSrgbTolerance = 2;

// Returns true where toSrgb changes pixels; sets `name` to the profile's name.
bool changesColours(const std::string& profile, std::string* name = nullptr);

}  // namespace fourdvt::capture
