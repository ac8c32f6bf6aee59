// SPDX-License-Identifier: Apache-2.0
// Marks that a file has beside its pixels: how a stored picture is to be shown.
#pragma once

#include <string>

namespace fourdvt {

// A picture is shown stretched, then mirrored, then turned.
struct PictureMarks {
  bool mirrored = false;    // left to right
  int quarter_turns = 0;    // clockwise, 0 to 3
  double pixel_aspect = 1;  // width of a stored pixel to its height
  bool turns() const { return mirrored || quarter_turns != 0; }
  bool swapsSides() const { return quarter_turns % 2 != 0; }
  bool stretches() const { return pixel_aspect != 1; }
};

// "mirrored and turned by 90°", "with pixels of 1.333 to 1"; empty without marks.
std::string describe(const PictureMarks& marks);

}  // namespace fourdvt
