// SPDX-License-Identifier: Apache-2.0
// Fast keying against plates of the empty stage: a model per pixel, differences on reduced pictures, shadows recognised
// by their colour, holes closed. Each picture is keyed independently. Offline mattes: mattes/plate_key.h.
#pragma once

#include <memory>
#include <vector>

#include "base/image.h"
#include "base/result.h"

namespace fourdvt::live {

class Keyer {
 public:
  // plates: RGB, one or more, of one size. Errors: InvalidArgument.
  static Result<std::unique_ptr<Keyer>> create(const std::vector<Image>& plates);
  virtual ~Keyer() = default;
  // Coverage (1 channel: 0 background … 255 performer, the outline at 127.5) of an RGB picture of the plates' size.
  // Valid until the next call. Errors: InvalidArgument (another size).
  virtual Result<const Image*> key(const Image& picture) = 0;
};

}  // namespace fourdvt::live
