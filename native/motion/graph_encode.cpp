// SPDX-License-Identifier: Apache-2.0
// Layout of the motion graph's file. Little-endian, packed, no padding; f32 = IEEE 754 binary32, finite.
//
//   u32  magic 0x47564434: the bytes "4DVG"
//   u16  version: 2
//   u16  0
//   u32  length of the file in bytes
//   u32  S: number of states = number of the manifest's sequences, in their order
//   S times, once per state:
//     u32  F: frames, as the manifest's frame_count
//     u32  W: weight rows, 1 or more
//     W × M f32  [row][member] weights of the members, 0..1, each row's sum 1 (M: members in the manifest)
//   S × S times, [source][target]:
//     u32  N: entries, 0 (no transition from source to target; always so on the diagonal) or F × W of the source
//     N times, [row][frame] of the source:
//       u32  frame of the target that is shown as the cross-fade begins, < F of the target
//       u16  weight row of the target, < W of the target
//       u16  length of the cross-fade in frames of the target, 1 or more
//       f32  cost, millimetres, >= 0
//       f32 × 3  the target's character frame seen from the source's: metres along x and z, radians about y
//
// Nothing follows. Readers reject other lengths, counts and values.
#include "base/bytes.h"
#include "motion/motion_graph.h"

namespace fourdvt::motion {

std::vector<uint8_t> writeMotionGraph(const std::vector<GraphState>& states,
                                      const std::vector<std::vector<Entry>>& tables) {
  ByteWriter body;
  body.u32(uint32_t(states.size()));
  for (const GraphState& state : states) {
    body.u32(state.frame_count);
    body.u32(uint32_t(state.weight_rows.size()));
    for (const auto& row : state.weight_rows)
      for (float weight : row) body.f32(weight);
  }
  for (const auto& table : tables) {
    body.u32(uint32_t(table.size()));
    for (const Entry& entry : table) {
      body.u32(entry.frame);
      body.u16(uint16_t(entry.weight_row));
      body.u16(uint16_t(entry.fade_frames));
      body.f32(entry.cost);
      for (int i = 0; i < 3; ++i) body.f32(entry.shift[i]);
    }
  }
  ByteWriter out;
  out.u32(kGraphMagic);
  out.u16(kGraphVersion);
  out.u16(0);
  out.u32(uint32_t(12 + body.size()));
  out.bytes(body.data());
  return out.take();
}

}  // namespace fourdvt::motion
