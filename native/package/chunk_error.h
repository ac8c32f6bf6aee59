// SPDX-License-Identifier: Apache-2.0
// The error of a chunk that does not decode, whatever kind of stream it is of. Internal to package/.
#pragma once

#include <string>

#include "base/result.h"

namespace fourdvt::package {

inline Error invalidChunk(const char* what) {
  return {ErrorId::StreamInvalid, std::string("GOP chunk: ") + what + "; the .bin file is damaged, upload it again"};
}

}  // namespace fourdvt::package
