// SPDX-License-Identifier: Apache-2.0
// Members and looks of invisible weight are not drawn.
#include <gtest/gtest.h>

#include "render/passes.h"

namespace fourdvt::render {
namespace {

std::vector<int> membersOf(const std::vector<float>& weights, Align align = Align::Baked) {
  const Look look{nullptr, nullptr, weights};
  const Figure figure{nullptr, {&look, 1}};
  std::vector<int> out;
  float shares = 0;
  for (const Part& part : partsOf(figure, {.align = align})) {
    float sum = 0;
    for (const WeightedMember& member : part.members) {
      out.push_back(member.member);
      sum += member.weight;
    }
    EXPECT_NEAR(sum, 1, 1e-6);
    shares += part.share;
  }
  EXPECT_NEAR(shares, 1, 1e-6);
  return out;
}

TEST(FigureParts, membersWithoutWeightAreNotDrawn) {
  EXPECT_EQ(membersOf({0.5f, 0, 0.5f}), (std::vector<int>{0, 2}));
  EXPECT_EQ(membersOf({0, 1, 0, 0}), (std::vector<int>{1}));
  EXPECT_EQ(membersOf({0.001f, 0.999f}), (std::vector<int>{1}));  // less than half a level
  EXPECT_EQ(membersOf({0.01f, 0.99f}), (std::vector<int>{0, 1}));
  EXPECT_EQ(membersOf({0, 1, 0}, Align::Flow), (std::vector<int>{1}));  // no flow for it either
}

TEST(FigureParts, looksThatHaveFadedAreNotDrawn) {
  const std::vector<float> whole{1};
  const Look looks[] = {{nullptr, nullptr, whole}, {nullptr, nullptr, whole}};
  const auto drawn = [&](float fade) {
    std::vector<const Look*> out;
    for (const Part& part : partsOf({nullptr, looks, fade}, {})) out.push_back(part.look);
    return out;
  };
  EXPECT_EQ(drawn(0), (std::vector<const Look*>{&looks[0]}));
  EXPECT_EQ(drawn(0.001f), (std::vector<const Look*>{&looks[0]}));
  EXPECT_EQ(drawn(0.5f), (std::vector<const Look*>{&looks[0], &looks[1]}));
  EXPECT_EQ(drawn(1), (std::vector<const Look*>{&looks[1]}));
}

}  // namespace
}  // namespace fourdvt::render
