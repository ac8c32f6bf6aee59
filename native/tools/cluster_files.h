// SPDX-License-Identifier: Apache-2.0
// The files of tools/cluster/, which `fourdvt plan` writes into a job folder.
#pragma once

#include <span>
#include <string_view>

namespace fourdvt::tools {

struct ClusterFile {
  const char* name;  // in the job folder
  std::string_view text;
};

extern const std::span<const ClusterFile> kClusterFiles;

}  // namespace fourdvt::tools
