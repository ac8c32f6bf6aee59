// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "lab/studio/studio.h"

namespace fourdvt::studio {
namespace {

bool isFolderName(const std::string& name) {
  return !name.empty() && name[0] != '.' && name.find_first_of("/\\") == std::string::npos;
}

std::string wrongClass(const StudioClass& c) {
  if (!isFolderName(c.name) || c.parameter.empty() || c.members.size() < 2 || c.members.size() > 4)
    return "a class needs a name, a parameter and two to four members, like locomotion=speed_mps:walk,run";
  for (const std::string& member : c.members)
    if (std::count(c.members.begin(), c.members.end(), member) > 1)
      return "class \"" + c.name + "\" lists \"" + member + "\" twice";
  return {};
}

}  // namespace

std::string StudioOptions::check() const {
  if (folder.empty()) return "a folder to write is needed";
  if (cameras < 2 || cameras > 128) return "cameras must be 2 to 128";
  if (width < 16 || height < 16 || width > 4096 || height > 4096 || width % 2 || height % 2)
    return "pictures need even sides from 16 to 4096";
  if (!(fps >= 1 && fps <= 1000)) return "fps must be 1 to 1000";
  if (test_every < 1 || truth_phases < 1 || truth_ring < 0) return "counts must not be negative";
  if (!(scale >= 0.001 && scale <= 1000)) return "the scale must be 0.001 to 1000";
  if (frames < 0) return "counts must not be negative";
  if (frames > 0 && !classes.empty()) return "a class needs its whole motions; leave out --frames or --class";
  if (!(strides >= 0 && strides <= 100)) return "a gait has at most 100 strides";
  if (strides > 0 && !classes.empty()) return "a class needs loops; leave out --strides or --class";
  if (travel && strides == 0) return "a loop stays in its place; give the number of --strides that travel";
  if (plates < 0 || plates > 99) return "plates must be 0 (none) to 99";
  if (plates != 1 && !room) return "only the room has several plates, or none; choose --room as well";
  if (room_size_m != 0 && !room) return "only the room has a size; choose --room as well";
  if (!(room_size_m >= 0 && room_size_m <= 1000)) return "the room's size must be at most 1000 m";
  if (bystander && !room) return "only the room has a bystander; choose --room as well";
  if (knobs.soft_shadow_m != 0 && !room) return "only the room has shadows; choose --room as well";
  if (knobs.plate_move_pixels != 0 && !room) return "only the room's plates can be moved; choose --room as well";
  if (room && knobs.erosion_pixels > 0) return "a capture in the room has no mattes that could be too small";
  if (!(knobs.mesh_cell_mm >= 8 && knobs.mesh_cell_mm <= 45)) return "the mesh's cell must be 8 to 45 mm";
  if (actor != "procedural" && knobs.mesh_cell_mm != StudioKnobs().mesh_cell_mm)
    return "only the procedural actor can be meshed anew; a model keeps its own faces";
  if (actor != "procedural" && knobs.plain_clothes)
    return "only the procedural actor has plain clothes; a model keeps its own";
  for (const double t : truth_at)
    if (!(t >= 0 && t <= 1)) return "the truth's positions must be 0 (first member) to 1 (last member)";
  for (const StudioClass& c : classes)
    if (const std::string wrong = wrongClass(c); !wrong.empty()) return wrong;
  for (size_t i = 0; i < sequences.size(); ++i)
    if (!isFolderName(sequences[i]) || std::count(sequences.begin(), sequences.end(), sequences[i]) > 1)
      return "sequences must be different plain names, not \"" + sequences[i] + "\"";
  return {};
}

}  // namespace fourdvt::studio
