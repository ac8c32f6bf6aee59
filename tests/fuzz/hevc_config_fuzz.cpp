// SPDX-License-Identifier: Apache-2.0
// HEVC decoder configuration records, searched for an alpha layer. Truncated bytes may hide one, but never add one.
#include <cstdlib>

#include "platform/video_alpha.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::span<const uint8_t> all(data, size);
  if (fourdvt::platform::hevcConfigHasAlpha(all.first(size / 2)) && !fourdvt::platform::hevcConfigHasAlpha(all))
    std::abort();
  return 0;
}
