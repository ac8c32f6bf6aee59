// SPDX-License-Identifier: Apache-2.0
// Display marks stored in a file beside its pixels.
#pragma once

#include <string>

namespace fourdvt {

// Marks in the order of application: stretching, mirroring, rotation.
struct PictureMarks {
  bool mirrored = false;    // left to right
  int quarter_turns = 0;    // clockwise, 0 to 3
  double pixel_aspect = 1;  // width of a stored pixel to its height
  bool turns() const { return mirrored || quarter_turns != 0; }
  bool swapsSides() const { return quarter_turns % 2 != 0; }
  bool stretches() const { return pixel_aspect != 1; }
};

// "mirrored and turned by 90°", "with pixels of 1.333 to 1"; empty if there are no marks.
std::string describe(const PictureMarks& marks);

}  // namespace fourdvt
