// SPDX-License-Identifier: Apache-2.0
// Option rows shared by several commands.
#pragma once

#include "refine/refine.h"
#include "tools/args.h"

namespace fourdvt::tools {

Option sequencesOption(std::vector<std::string>& field);
Option jobsOption(int& field, const std::string& what = "worker threads");
Option resumeOption(bool& field);
// Selects the rendition to draw; values as in findRendition (session.h).
Option renditionOption(std::optional<int>& field);

// Refinement of a capture's meshes and cameras against its pictures.
Options refineOptions(refine::RefineOptions& options);
bool refinesExplicitly(const Args& args);  // true if any of them is given

}  // namespace fourdvt::tools
