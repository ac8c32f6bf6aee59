// SPDX-License-Identifier: Apache-2.0
// Number formatting for reports: suitable units, few digits, "–" for NaN.
#pragma once

#include <string>

namespace fourdvt::report {

std::string fixedText(double value, int decimals);  // prints a minus sign (U+2212) and "∞"
std::string percentText(double percent);            // 0..100
std::string bytesText(double bytes);
std::string secondsText(double seconds);
std::string bitrateText(double bits_per_s);

}  // namespace fourdvt::report
