// SPDX-License-Identifier: Apache-2.0
// Marks of a JPEG or PNG beside its pixels: EXIF orientation and colour profile. Does NOT decode pictures.
#pragma once

#include <string>
#include <string_view>

#include "base/image.h"
#include "base/picture_marks.h"

namespace fourdvt::capture {

struct StillMarks {
  PictureMarks marks;
  std::string profile;  // ICC; empty if there is none
};

// Reads the segments before a JPEG's pixels (APP1 "Exif", APP2 "ICC_PROFILE") or the chunks of a PNG (eXIf, iCCP).
// Damaged ones and other files have no marks.
StillMarks stillMarks(std::string_view file);

// Converts RGB or RGBA pixels of a profile to sRGB, relative colorimetric. Leaves them where the profile is none of
// RGB, is damaged, or differs from sRGB by no more than kSrgbTolerance levels.
void toSrgb(const std::string& profile, Image& colour);
inline constexpr int kSrgbTolerance = 2;

// Returns true where toSrgb changes pixels, with the profile's own name.
bool changesColours(const std::string& profile, std::string* name = nullptr);

}  // namespace fourdvt::capture
