// SPDX-License-Identifier: Apache-2.0
// Files of a folder by the paths of HTTP. Nothing outside of the folder is found, also not through links, and nothing
// with a name that begins with a dot. Does NOT read the files.
#pragma once

#include <string>

#include "live/net/websocket.h"

namespace fourdvt::live {

// The file, the index of a folder, a redirection to a folder's address with "/" at its end, or 404. path: as
// HttpRequest::path. folder: empty: 404.
HttpAnswer webFile(const std::string& folder, const std::string& path);

}  // namespace fourdvt::live
