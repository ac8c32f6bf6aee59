// SPDX-License-Identifier: Apache-2.0
#include "base/text.h"

#include <cmath>

#include "report/document.h"

namespace fourdvt::report {

std::string fixedText(double value, int decimals) {
  if (std::isnan(value)) return "–";
  if (std::isinf(value)) return value > 0 ? "∞" : "−∞";
  const std::string text = printed("%.*f", decimals, std::abs(value));
  // Drops the sign of a negative value that rounds to zero.
  const bool zero = text.find_first_not_of("0.") == std::string::npos;
  return (value < 0 && !zero ? "−" : "") + text;
}

std::string percentText(double percent) {
  if (std::isnan(percent)) return "–";
  const double size = std::abs(percent);
  return fixedText(percent, size < 0.1 ? 3 : size < 10 ? 2 : 1) + "\u00a0%";
}

std::string bytesText(double bytes) {
  if (std::isnan(bytes)) return "–";
  if (bytes < 1e3) return printed("%.0f\u00a0B", bytes);
  if (bytes < 1e6) return printed("%.1f\u00a0kB", bytes / 1e3);
  return bytes < 1e9 ? printed("%.2f\u00a0MB", bytes / 1e6) : printed("%.2f\u00a0GB", bytes / 1e9);
}

std::string secondsText(double seconds) {
  if (std::isnan(seconds)) return "–";
  if (seconds < 0.01) return printed("%.2f\u00a0ms", seconds * 1e3);
  return seconds < 1 ? printed("%.0f\u00a0ms", seconds * 1e3) : printed("%.2f\u00a0s", seconds);
}

std::string bitrateText(double bits_per_s) {
  if (std::isnan(bits_per_s)) return "–";
  return bits_per_s < 1e6 ? printed("%.0f\u00a0kbit/s", bits_per_s / 1e3)
                          : printed("%.2f\u00a0Mbit/s", bits_per_s / 1e6);
}

}  // namespace fourdvt::report
