// SPDX-License-Identifier: Apache-2.0
#include "base/picture_marks.h"

#include "base/text.h"

namespace fourdvt {

std::string describe(const PictureMarks& marks) {
  std::string out = marks.mirrored ? "mirrored" : "";
  const auto add = [&](const std::string& more) { out += (out.empty() ? "" : " and ") + more; };
  if (marks.quarter_turns != 0) add("turned by " + std::to_string(90 * marks.quarter_turns) + "°");
  if (marks.stretches()) {
    add(printed("with pixels of %.4g to 1", marks.pixel_aspect));
  }
  return out;
}

}  // namespace fourdvt
