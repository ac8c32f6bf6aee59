// SPDX-License-Identifier: Apache-2.0
// Report on computed mattes: mattes.html with a contact sheet per camera, and mattes.json.
#pragma once

#include <string>
#include <vector>

#include "mattes/run/mattes.h"

namespace fourdvt::mattes {

// One line per camera whose mattes should be inspected.
std::vector<std::string> warningsOf(const capture::Capture& capture, const MattesSummary& summary);

// Reads the contact sheets' cells from `cells_folder`/SEQUENCE/CAMERA/000000.png. Errors: WriteFailed, FileUnreadable.
Status writeReport(const std::string& folder, const std::string& cells_folder, const capture::Capture& capture,
                   const MattesOptions& options, const MattesSummary& summary);

}  // namespace fourdvt::mattes
