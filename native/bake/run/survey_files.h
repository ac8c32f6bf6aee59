// SPDX-License-Identifier: Apache-2.0
// The bytes of what the survey keeps besides records: label statistics and colour maps. Only the machine that wrote
// them reads them: this is not a format.
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
// False if the bytes are not exactly one statistics record.
bool statisticsFrom(std::span<const uint8_t> bytes, LabelStatistics& statistics);

std::vector<uint8_t> coloursBytes(const std::vector<ColourMap>& maps);
// False if the bytes do not hold exactly as many maps as `maps` has.
bool coloursFrom(std::span<const uint8_t> bytes, std::vector<ColourMap>& maps);

}  // namespace fourdvt::bake
