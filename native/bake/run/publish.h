// SPDX-License-Identifier: Apache-2.0
// Puts a finished character into its folder, which a web server may be serving.
#pragma once

#include <string>

#include "base/result.h"

namespace fourdvt::bake {

// Moves the files of `from` into `to`, the manifest last, then removes the files of the bake that was there: those that
// its manifest names, and the report that bakes once put there. Other files stay. At every moment the manifest in `to`
// has its files beside it; on failure the earlier one still has. A folder that does not exist yet appears complete.
// Removes `from`. Errors: WriteFailed.
Status publish(const std::string& from, const std::string& to);
// Puts a finished report in the place of an earlier one. Errors: WriteFailed.
Status publishReport(const std::string& from, const std::string& to);

}  // namespace fourdvt::bake
