// SPDX-License-Identifier: Apache-2.0
// The bake report's section on the choice of a method.
#pragma once

#include <nlohmann/json.hpp>

#include "bake/run/figures.h"
#include "report/document.h"

namespace fourdvt::bake {

nlohmann::ordered_json methodJson(const ChosenMethod& chosen);
report::Section methodSection(const ChosenMethod& chosen);

}  // namespace fourdvt::bake
