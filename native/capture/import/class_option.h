// SPDX-License-Identifier: Apache-2.0
// The option --class of `fourdvt import`: the skeleton of a class of capture.json on one line.
#pragma once

#include <string>
#include <vector>

#include "capture/capture.h"

namespace fourdvt::capture {

// NAME:PARAMETER=SEQUENCE:VALUE,SEQUENCE:VALUE, such as locomotion:speed_mps=walk:1.2,run:2.7; with two parameters
// NAME:P,Q=SEQUENCE:VALUE/VALUE,…. Values may be left out where the parameter is speed_mps, which the bake measures.
// Errors: InvalidArgument.
Result<CaptureClass> parseClassOption(const std::string& text);

// Problem of classes among sequences of these names, of which `loops` are loops; empty: none.
std::string classProblem(const std::vector<CaptureClass>& classes, const std::vector<std::string>& sequences,
                         const std::vector<std::string>& loops);

}  // namespace fourdvt::capture
