// SPDX-License-Identifier: Apache-2.0
// One cell of a camera's contact sheet: the picture with its matte's outline and removed parts, and the performer
// alone. In memory only.
#pragma once

#include "base/image.h"
#include "mattes/joint_mattes.h"

namespace fourdvt::mattes {

inline constexpr int kCellHeight = 400;  // pixels

// RGB, two pictures one above the other, each kCellHeight high. Outline green; removed parts by reason: contradicted by
// other cameras red, on the floor blue, other yellow.
Image contactCell(const Image& picture, const CameraMatte& matte);

}  // namespace fourdvt::mattes
