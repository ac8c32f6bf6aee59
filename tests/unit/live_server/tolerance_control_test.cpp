// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "live/server/instants.h"

namespace fourdvt::live {
namespace {

constexpr int64_t kFrame_us = 40'000;

// Simulated load: work independent of the tolerance, and hulls, proportional to t^-0.7 at a tolerance of t px.
struct Load {
  double fixed = 0.3, hull_at_1px = 0.6, machine = 1;
  double other() const { return machine * fixed; }
  double hull(double tolerance_px) const { return machine * hull_at_1px * std::pow(tolerance_px, -0.7); }
};

struct Machine {
  ToleranceControl control;
  Load load;
  int64_t now_us = 0;
  int changes = 0;
  // Tolerances that the outlines of the last frames were made with.
  std::vector<double> used = std::vector<double>(4, 1.0);

  void seconds(double count) {
    for (const int64_t end_us = now_us + int64_t(count * 1e6); now_us < end_us; now_us += kFrame_us) {
      used.push_back(control.tolerance_px());
      changes += control.add(now_us, load.hull(used[used.size() - 4]), load.other());
    }
  }
  double busy() const { return load.other() + load.hull(control.tolerance_px()); }
};

TEST(ToleranceControl, ConvergesAndHolds) {
  for (const double machine : {0.8, 1.0, 1.4, 1.9}) {
    Machine run{ToleranceControl({0.5, 16, 0.75})};
    run.load.machine = machine;
    run.seconds(30);
    EXPECT_LE(run.busy(), 0.75 * 1.12) << machine;
    EXPECT_TRUE(run.busy() >= 0.75 * 0.7 || run.control.tolerance_px() == 0.5) << machine << " " << run.busy();
    run.changes = 0;
    run.seconds(60);
    EXPECT_EQ(run.changes, 0) << machine;
  }
}

TEST(ToleranceControl, GivesWayInTwoSecondsAndReturnsSlowly) {
  Machine run{ToleranceControl({0.5, 16, 0.75})};
  run.seconds(30);
  const double before_px = run.control.tolerance_px();
  run.load.machine = 1.8;  // another process takes a core
  run.seconds(2.1);
  EXPECT_LE(run.busy(), 0.75 * 1.2);
  run.seconds(10);
  const double under_load_px = run.control.tolerance_px();
  EXPECT_GT(under_load_px, 2 * before_px);
  run.load.machine = 1;
  run.seconds(2);
  EXPECT_GT(run.control.tolerance_px(), 0.7 * under_load_px);
  run.seconds(60);
  EXPECT_LT(run.control.tolerance_px(), 2 * before_px);
}

TEST(ToleranceControl, KeepsToItsBoundsAndItsPace) {
  ToleranceControl control({0.5, 16, 0.75});
  int64_t last_us = -1'000'000;
  for (int64_t now_us = 0; now_us < 20'000'000; now_us += kFrame_us) {
    if (!control.add(now_us, 50, 0)) continue;
    EXPECT_GE(now_us - last_us, ToleranceControl::kStep_us);
    last_us = now_us;
    EXPECT_LE(control.tolerance_px(), 16);
  }
  EXPECT_EQ(control.tolerance_px(), 16);
  for (int64_t now_us = 20'000'000; now_us < 200'000'000; now_us += kFrame_us) control.add(now_us, 0, 0);
  EXPECT_EQ(control.tolerance_px(), 0.5);
  EXPECT_EQ(ToleranceControl({2, 4, 0.75}, 1).tolerance_px(), 2);
}

TEST(ToleranceControl, CoarseHullsDoNotPayForOtherWork) {
  for (const double fixed : {0.72, 0.8, 1.5}) {
    Machine run{ToleranceControl({0.5, 16, 0.75})};
    run.load = {fixed, 0.3};
    run.seconds(60);
    EXPECT_NEAR(run.load.hull(run.control.tolerance_px()), 0.15, 0.15 * 0.2) << fixed;
  }
}

TEST(ToleranceControl, OneSlowFrameChangesNothing) {
  ToleranceControl control({0.5, 16, 0.75});
  for (int i = 0; i < 500; ++i) EXPECT_FALSE(control.add(i * kFrame_us, i % 6 == 3 ? 5 : 0.4, 0.3));
}

}  // namespace
}  // namespace fourdvt::live
