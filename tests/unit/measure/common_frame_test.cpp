// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <vector>

#include "lab/measure/motion_metrics.h"

namespace fourdvt::measure {
namespace {

// Elapsed shares of ten frames; `ahead`: offset of the motion.
std::vector<double> passing(double ahead, bool loop) {
  std::vector<double> out;
  for (int f = 0; f < 10; ++f) out.push_back(f / (loop ? 10.0 : 9.0) + ahead);
  return out;
}

TEST(CommonFrame, IsWhereTheMixedPhasesAre) {
  const auto first = passing(0, true), behind = passing(0.96, true);  // a twenty-fifth of the cycle
  for (const double w : {0.0, 0.3, 1.0}) {
    EXPECT_NEAR(commonFrame(first, behind, true, w, 0.5), 5 + 0.4 * w, 1e-9) << w;
    EXPECT_NEAR(commonFrame(first, behind, true, w, 0), 0.4 * w, 1e-9) << w;
    EXPECT_NEAR(commonFrame(first, behind, true, w, 0.98), 9.8 + 0.4 * w - (w == 1 ? 10 : 0), 1e-9) << w;
  }
  const auto before = passing(0.04, true);
  EXPECT_NEAR(commonFrame(first, before, true, 0.5, 0), 9.8, 1e-9);
}

TEST(CommonFrame, EndsStayEnds) {
  const auto first = passing(0, false);
  std::vector<double> late = first;
  for (double& share : late) share *= share;
  EXPECT_NEAR(commonFrame(first, late, false, 0.5, 0), 0, 1e-9);
  EXPECT_NEAR(commonFrame(first, late, false, 0.5, 1), 9, 1e-9);
  EXPECT_NEAR(commonFrame(first, late, false, 1, 4.0 / 81), 2, 1e-9);
}

}  // namespace
}  // namespace fourdvt::measure
