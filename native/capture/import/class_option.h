// SPDX-License-Identifier: Apache-2.0
// Option --class of `fourdvt import`: a class of capture.json on one line.
#pragma once

#include <string>
#include <vector>

#include "capture/capture.h"

namespace fourdvt::capture {

// Parses NAME:PARAMETER=SEQUENCE:VALUE,SEQUENCE:VALUE, such as locomotion:speed_mps=walk:1.2,run:2.7; with two
// parameters NAME:P,Q=SEQUENCE:VALUE/VALUE,…. Values are optional for speed_mps, which the bake measures. Errors:
// InvalidArgument.
Result<CaptureClass> parseClassOption(const std::string& text);

// Describes the first problem of classes with these sequences and loops; empty: none.
std::string classProblem(const std::vector<CaptureClass>& classes, const std::vector<std::string>& sequences,
                         const std::vector<std::string>& loops);

}  // namespace fourdvt::capture
