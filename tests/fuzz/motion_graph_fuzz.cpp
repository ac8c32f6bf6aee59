// SPDX-License-Identifier: Apache-2.0
// Motion graphs of a character with a loop of 4 frames, a class of two motions and 3 frames, and 2 frames that end:
// accepted ones refer only to existing frames and weights, and are written back as the same bytes.
#include <cmath>
#include <cstdlib>

#include "motion/motion_graph.h"

using namespace fourdvt;
using namespace fourdvt::motion;

namespace {

package::Character smallCharacter() {
  package::Character character;
  const auto add = [&](const char* name, uint32_t frames, bool loop, size_t members) {
    package::Sequence s;
    s.name = name;
    s.frame_count = frames;
    s.fps = 25;
    s.loop = loop;
    s.members.resize(members);
    character.sequences.push_back(s);
  };
  add("walk", 4, true, 1);
  add("locomotion", 3, true, 2);
  add("pickup", 2, false, 1);
  return character;
}

void require(bool condition) {
  if (!condition) std::abort();
}

void checkPair(const MotionGraph& graph, int source, int target, std::vector<Entry>& table) {
  const GraphState &from = graph.states()[size_t(source)], &to = graph.states()[size_t(target)];
  for (uint32_t row = 0; row < from.weight_rows.size(); ++row) {
    for (uint32_t frame = 0; frame < from.frame_count; ++frame) {
      const Entry* entry = graph.entry(source, frame, row, target);
      if (!entry) continue;
      require(entry->frame < to.frame_count && entry->weight_row < to.weight_rows.size() && entry->fade_frames > 0);
      require(entry->cost >= 0);
      require(std::isfinite(entry->cost + entry->shift.x + entry->shift.y + entry->shift.z));
      table.push_back(*entry);
    }
    const auto planned = graph.plan({source, 1, from.weight_rows[row], 25}, target);
    require(planned.has_value() == !table.empty());
    require(!planned || (planned->exit_frame < from.frame_count && planned->entry.frame < to.frame_count));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const auto read = MotionGraph::read({data, size}, smallCharacter());
  if (!read.ok()) return 0;
  const int states = static_cast<int>(read.value().states().size());
  require(states == 3);
  std::vector<std::vector<Entry>> tables;
  for (int pair = 0; pair < states * states; ++pair)
    checkPair(read.value(), pair / states, pair % states, tables.emplace_back());
  require(writeMotionGraph(read.value().states(), tables) == std::vector<uint8_t>(data, data + size));
  return 0;
}
