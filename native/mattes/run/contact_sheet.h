// SPDX-License-Identifier: Apache-2.0
// One cell of a camera's contact sheet: the picture with its matte's outline and what was dropped, and the performer
// alone. Does NOT read or write files.
#pragma once

#include "base/image.h"
#include "mattes/joint_mattes.h"

namespace fourdvt::mattes {

inline constexpr int kCellHeight = 400;  // pixels

// RGB, two pictures one above the other, each kCellHeight high. Outline green; dropped because other cameras contradict
// it: red; because it lies on the floor: blue; for another reason: yellow.
Image contactCell(const Image& picture, const CameraMatte& matte);

}  // namespace fourdvt::mattes
