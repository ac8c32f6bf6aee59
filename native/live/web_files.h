// SPDX-License-Identifier: Apache-2.0
// Files of a folder by HTTP path. Files outside the folder are not found, even through links, nor are names that begin
// with a dot.
#pragma once

#include <string>

#include "live/net/websocket.h"

namespace fourdvt::live {

// Returns the file, the index of a folder, a redirection to a folder's address with a trailing "/", or 404. path: as
// HttpRequest::path. folder: empty: 404.
HttpAnswer webFile(const std::string& folder, const std::string& path);

}  // namespace fourdvt::live
