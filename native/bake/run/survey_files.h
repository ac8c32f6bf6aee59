// SPDX-License-Identifier: Apache-2.0
// What the survey keeps besides records: label statistics and colour maps as bytes. For one machine, not a format.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "bake/labels/labelling.h"
#include "bake/texels/colour_calibration.h"

namespace fourdvt::bake {

// FOLDER/WHAT_<hash of key>.bin
std::string keyedPath(const std::string& folder, const std::string& what, const std::string& key);

std::vector<uint8_t> statisticsBytes(const LabelStatistics& statistics);
// False if the bytes are not exactly one.
bool statisticsFrom(std::span<const uint8_t> bytes, LabelStatistics& statistics);

std::vector<uint8_t> coloursBytes(const std::vector<ColourMap>& maps);
// False if the bytes are not as many maps as `maps` has.
bool coloursFrom(std::span<const uint8_t> bytes, std::vector<ColourMap>& maps);

}  // namespace fourdvt::bake
