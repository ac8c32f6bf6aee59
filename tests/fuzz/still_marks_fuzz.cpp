// SPDX-License-Identifier: Apache-2.0
// EXIF orientation and colour profile of a JPEG or PNG; the profile is applied to a few pixels.
#include <cstdint>
#include <cstdlib>

#include "capture/still_marks.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace fourdvt;
  const auto found = capture::stillMarks({reinterpret_cast<const char*>(data), size});
  if (found.marks.quarter_turns < 0 || found.marks.quarter_turns > 3 || found.marks.stretches()) std::abort();
  Image image(3, 2, 3, 120);
  capture::toSrgb(found.profile, image);
  if (image.pixels.size() != 18) std::abort();
  return 0;
}
