// SPDX-License-Identifier: Apache-2.0
// Checks that the corpus is accepted: one of an outdated layout would be rejected at once, and fuzzing would test
// nothing.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "motion/motion_graph.h"

using namespace fourdvt;

TEST(FuzzCorpus, MotionGraphIsAccepted) {
  std::ifstream file(FOURDVT_SOURCE_DIR "/tests/fuzz/corpus/motion_graph_fuzz/three_states.bin", std::ios::binary);
  const std::vector<uint8_t> bytes((std::istreambuf_iterator<char>(file)), {});
  package::Character character;
  for (uint32_t frames : {4, 3, 2}) {  // as motion_graph_fuzz.cpp has them
    package::Sequence& s = character.sequences.emplace_back();
    s.frame_count = frames;
    s.loop = frames > 2;
    s.members.resize(frames == 3 ? 2 : 1);
  }
  auto graph = motion::MotionGraph::read(bytes, character);
  ASSERT_TRUE(graph.ok()) << graph.error().message;
  EXPECT_TRUE(graph.value().entry(0, 3, 0, 1));
  EXPECT_FALSE(graph.value().entry(2, 0, 0, 1)) << "no way from the last state to the class";
}
