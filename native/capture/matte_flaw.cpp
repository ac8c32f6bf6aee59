// SPDX-License-Identifier: Apache-2.0
#include "capture/matte_flaw.h"

#include <algorithm>
#include <array>

namespace fourdvt::capture {
namespace {

constexpr double kBorderShare = 0.85, kPictureShare = 0.5, kLeftOutShare = 0.001;
constexpr double kLabelledShare = 0.001;  // share of the picture; compression alone lifts fewer pixels off 0
constexpr int kMaxLabels = 8;

struct Kept {
  double border = 0, picture = 0;  // shares of the pixels
};

Kept keptBy(const Image& matte) {
  size_t border = 0, all = 0;
  for (int y = 0; y < matte.height; ++y)
    for (int x = 0; x < matte.width; ++x) {
      const bool kept = *matte.at(x, y) >= 128;
      all += kept;
      border += kept && (x == 0 || y == 0 || x == matte.width - 1 || y == matte.height - 1);
    }
  const double round = 2.0 * (matte.width + matte.height) - 4;
  return {double(border) / round, double(all) / double(matte.pixels.size())};
}

bool isNearlyAll(const Kept& kept) { return kept.border >= kBorderShare && kept.picture > kPictureShare; }

// Detects label pictures: no value counts as the object, but a few dark values differ from 0.
bool isLabels(const Image& matte) {
  std::array<size_t, 256> count{};
  for (const uint8_t value : matte.pixels) ++count[value];
  if (std::any_of(count.begin() + 128, count.end(), [](size_t n) { return n > 0; })) return false;
  const auto labels = std::count_if(count.begin() + 1, count.end(), [](size_t n) { return n > 0; });
  const double labelled = double(matte.pixels.size() - count[0]);
  return labels > 0 && labels <= kMaxLabels && labelled > kLabelledShare * double(matte.pixels.size());
}

}  // namespace

bool keepsTheBorder(const Image& matte) { return isNearlyAll(keptBy(matte)); }

MatteFlaw flawOf(const Image& matte) {
  const Kept kept = keptBy(matte);
  if (isNearlyAll(kept)) return kept.picture > 1 - kLeftOutShare ? MatteFlaw::Covered : MatteFlaw::Swapped;
  return isLabels(matte) ? MatteFlaw::Labels : MatteFlaw::None;
}

Error flawedMattes(MatteFlaw flaw, const std::string& path, const std::string& camera) {
  const char* what =
      flaw == MatteFlaw::Covered ? "the matte covers the whole picture, so that it has no outline; export the mattes "
                                   "again, white is the object"
      : flaw == MatteFlaw::Swapped
          ? "the matte keeps the picture's border and leaves out what is within, as if object and background were "
            "swapped; invert the mattes: white is the object"
          : "the matte has no value above 127, as a label picture with the values 0 and 1; write 255 for the object "
            "and 0 for the rest";
  return {ErrorId::FileUnreadable, path + ": " + what + ", or reconstruct with --leave-out " + camera};
}

}  // namespace fourdvt::capture
