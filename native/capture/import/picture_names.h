// SPDX-License-Identifier: Apache-2.0
// Numbers and time stamps in the names of pictures.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace fourdvt::capture {

// Sort keys of a folder's pictures by name: the only number that differs between the names; seconds with a fraction
// ("1700000000.88", "1700000000_880000000") as nanoseconds; all digits of a date and time. Else the last number in the
// name; -1 without a number. Names have no extension.
std::vector<int64_t> pictureNumbers(const std::vector<std::string>& names);

}  // namespace fourdvt::capture
