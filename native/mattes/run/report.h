// SPDX-License-Identifier: Apache-2.0
// Report on computed mattes: mattes.html with a contact sheet per camera, and mattes.json.
#pragma once

#include <string>
#include <vector>

#include "base/image.h"
#include "mattes/joint_mattes.h"
#include "mattes/run/mattes.h"

namespace fourdvt::mattes {

// One line per camera whose mattes should be inspected.
std::vector<std::string> warningsOf(const capture::Capture& capture, const MattesSummary& summary);

// Reads the contact sheets' cells from `cells_folder`/SEQUENCE/CAMERA/000000.png. Errors: WriteFailed, FileUnreadable.
Status writeReport(const std::string& folder, const std::string& cells_folder, const capture::Capture& capture,
                   const MattesOptions& options, const MattesSummary& summary);

inline constexpr int kCellHeight = 400;  // pixels

// Makes one cell of a camera's contact sheet: the picture with its matte's outline and removed parts, and the performer
// alone. RGB, two pictures one above the other, each kCellHeight high. Outline green; removed parts by reason:
// contradicted by other cameras red, on the floor blue, other yellow.
Image contactCell(const Image& picture, const CameraMatte& matte);

}  // namespace fourdvt::mattes
