// SPDX-License-Identifier: Apache-2.0
// Number formatting for reports: suitable units, few digits, "–" for NaN.
#pragma once

#include <string>

namespace fourdvt::report {

std::string fixedText(double value, int decimals);  // with a minus sign, not a hyphen; "∞"
std::string percentText(double percent);            // 0..100
std::string bytesText(double bytes);
std::string secondsText(double seconds);
std::string bitrateText(double bits_per_s);

}  // namespace fourdvt::report
