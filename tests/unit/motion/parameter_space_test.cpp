// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <tuple>

#include "motion/blend.h"

namespace fourdvt::motion {
namespace {

using package::Member;
using package::ParameterSample;
using package::Sequence;

Member speedMember(const char* name, double speed_mps, double duration_s) {
  Member member;
  member.name = name;
  member.parameter = {speed_mps};
  member.duration_s = duration_s;
  member.travel = {0, speed_mps * duration_s, 0};
  return member;
}

// Walk and run: travel and duration blend linearly, hence speed does not.
Sequence locomotion() {
  Sequence sequence;
  sequence.members = {speedMember("walk", 1.2, 1.2), speedMember("run", 2.7, 0.7)};
  sequence.reference_count = 1;
  sequence.space.names = {"speed_mps"};
  for (int i = 0; i <= 32; ++i) {
    const float w = float(i) / 32;
    const auto& [walk, run] = std::tie(sequence.members[0], sequence.members[1]);
    const double travel = (1 - w) * walk.travel.y + w * run.travel.y;
    const double duration = (1 - w) * walk.duration_s + w * run.duration_s;
    sequence.space.samples.push_back({{travel / duration}, {1 - w, w}, {1 - std::abs(2 * w - 1)}});
    if (i > 0) sequence.space.simplices.push_back({uint16_t(i - 1), uint16_t(i), uint16_t(i)});
  }
  return sequence;
}

double speedAt(const Sequence& sequence, const BlendWeights& weights) {
  double travel = 0;
  for (size_t m = 0; m < 2; ++m) travel += weights.members[m] * sequence.members[m].travel.y;
  return travel / durationAt(sequence, weights.members);
}

TEST(ParameterSpace, MetresPerSecondMeanWhatTheySay) {
  const Sequence sequence = locomotion();
  for (double speed = 1.2; speed <= 2.7; speed += 0.1) {
    const BlendWeights weights = weightsAt(sequence, std::vector<double>{speed});
    EXPECT_NEAR(speedAt(sequence, weights), speed, 1e-3) << speed;
    EXPECT_NEAR(weights.members[0] + weights.members[1], 1, 1e-6);
    EXPECT_NEAR(weights.offsets[0], 1 - std::abs(2 * weights.members[1] - 1), 1e-5);
  }
}

TEST(ParameterSpace, OutsideMeansTheNearestEnd) {
  const Sequence sequence = locomotion();
  EXPECT_EQ(weightsAt(sequence, std::vector<double>{0.3}).members, (std::vector<float>{1, 0}));
  EXPECT_EQ(weightsAt(sequence, std::vector<double>{9}).members, (std::vector<float>{0, 1}));
  EXPECT_EQ(memberWeights(sequence, 1).members, (std::vector<float>{0, 1}));
  EXPECT_EQ(memberWeights(sequence, 1).offsets, (std::vector<float>{0}));
}

TEST(ParameterSpace, RangeAndName) {
  const Sequence sequence = locomotion();
  EXPECT_DOUBLE_EQ(parameterRange(sequence, 0).min, 1.2);
  EXPECT_DOUBLE_EQ(parameterRange(sequence, 0).max, 2.7);
  EXPECT_EQ(findParameter(sequence, "speed_mps"), 0);
  EXPECT_EQ(findParameter(sequence, "height_m"), -1);
}

TEST(ParameterSpace, PlainSequenceHasOneWeight) {
  Sequence plain;
  plain.members.resize(1);
  plain.members[0].duration_s = 1.6;
  const BlendWeights weights = weightsAt(plain, {});
  EXPECT_EQ(weights.members, (std::vector<float>{1}));
  EXPECT_DOUBLE_EQ(durationAt(plain, weights.members), 1.6);
  EXPECT_EQ(parameterRange(plain, 0).max, 0);
}

// Jumps by height and length: a square of four members, split along its diagonal. The second parameter's unit is a
// hundred times smaller.
Sequence jumps() {
  Sequence sequence;
  sequence.members.resize(4);
  sequence.space.names = {"height_m", "length_cm"};
  const double at[4][2] = {{0, 0}, {1, 0}, {1, 100}, {0, 100}};
  for (int i = 0; i < 4; ++i) {
    ParameterSample sample{{at[i][0], at[i][1]}, std::vector<float>(4), {}};
    sample.weights[i] = 1;
    sequence.space.samples.push_back(sample);
  }
  sequence.space.simplices = {{0, 1, 2}, {0, 2, 3}};
  return sequence;
}

void expectWeights(const Sequence& sequence, std::vector<double> at, std::vector<float> expected) {
  const BlendWeights weights = weightsAt(sequence, at);
  for (size_t m = 0; m < 4; ++m) EXPECT_NEAR(weights.members[m], expected[m], 1e-6) << "member " << m;
}

TEST(ParameterSpace, TwoParametersMixTheTrianglesCorners) {
  const Sequence sequence = jumps();
  expectWeights(sequence, {0.75, 25}, {0.25, 0.5, 0.25, 0});
  expectWeights(sequence, {0.25, 75}, {0.25, 0, 0.25, 0.5});
  expectWeights(sequence, {0.5, 50}, {0.5, 0, 0.5, 0});
  expectWeights(sequence, {1, 0}, {0, 1, 0, 0});
}

TEST(ParameterSpace, TwoParametersOutsideMeanTheNearestEdge) {
  const Sequence sequence = jumps();
  expectWeights(sequence, {0.25, -300}, {0.75, 0.25, 0, 0});
  expectWeights(sequence, {7, 40}, {0, 0.6f, 0.4f, 0});
  expectWeights(sequence, {-1, 900}, {0, 0, 0, 1});
}

}  // namespace
}  // namespace fourdvt::motion
