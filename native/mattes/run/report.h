// SPDX-License-Identifier: Apache-2.0
// The report of made mattes: mattes.html with a contact sheet a camera, and mattes.json.
#pragma once

#include <string>
#include <vector>

#include "mattes/run/mattes.h"

namespace fourdvt::mattes {

// One line for each camera whose mattes deserve a look.
std::vector<std::string> warningsOf(const capture::Capture& capture, const MattesSummary& summary);

// `cells_folder`/SEQUENCE/CAMERA/000000.png are the contact sheets' cells. Errors: WriteFailed, FileUnreadable.
Status writeReport(const std::string& folder, const std::string& cells_folder, const capture::Capture& capture,
                   const MattesOptions& options, const MattesSummary& summary);

}  // namespace fourdvt::mattes
