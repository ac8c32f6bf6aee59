// SPDX-License-Identifier: Apache-2.0
// What the parts of methods.cpp share.
#pragma once

#include <string>
#include <vector>

#include "bake/bake.h"
#include "study/run/context.h"

namespace fourdvt::study {

struct Method {
  std::string name;  // as in the rows
  bake::BakeOptions options;
  std::string setting() const {
    return "layers=" + std::to_string(options.layers) + " size=" + std::to_string(options.texture) +
           " codec=" + bake::infoOf(options.codec).name + " crf=" + std::to_string(options.crf) +
           " layout=" + (options.equal_layers ? "equal" : "default");
  }
};

}  // namespace fourdvt::study
