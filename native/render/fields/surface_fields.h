// SPDX-License-Identifier: Apache-2.0
// Fields on a surface: a value per vertex and camera, by which a blend fades cameras out towards their seams and from
// view to view (M4D 4.4, 4.5). A camera's seam: the triangles of which it serves some vertices and not others. Knows
// surfaces and the numbers of cameras; what a camera serves, and what the fields should be, others say. Needs
// Caps::half_float_targets.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "render/character_model.h"

namespace fourdvt::render {

// Which faces meet at each vertex of a model's surface, as a table for shaders. What the topology has not changed is
// kept. Used by what spreads values over the surface.
class SurfaceNeighbours {
 public:
  // Errors: GpuFailure.
  Status update(gpu::Device& device, const CharacterModel& model);
  // R32UI: [vertex] where its list begins, and after the last the end; then the lists: the two other vertices of each
  // face at the vertex, in the face's order. A neighbour stands in a list once for each face that has both.
  gpu::TextureId texture() const { return table_.id(); }

 private:
  gpu::Texture table_;
  uint32_t vertices_ = 0, faces_ = 0;  // that the table has room for; 0: there is none
  uint64_t topology_serial_ = 0;
  bool is_filled_ = false;
  std::vector<uint32_t> lists_;  // scratch
};

constexpr int kFieldSlots = 8;  // cameras that fields have room for
constexpr size_t kNoCamera = ~size_t(0);
constexpr int kFieldSteps = 20;  // of distances (M4D 4.4)

// Values per vertex and slot: two textures addressed as CharacterModel's tables, a texel per vertex, a channel per
// slot.
struct FieldTables {
  gpu::TextureId low = 0, high = 0;  // slots 0-3 and 4-7
};

// Which camera each slot holds, kNoCamera: none.
using FieldCameras = std::array<size_t, kFieldSlots>;
constexpr FieldCameras kNoFieldCameras = {kNoCamera, kNoCamera, kNoCamera, kNoCamera,
                                          kNoCamera, kNoCamera, kNoCamera, kNoCamera};

// `chosen`: at most kFieldSlots cameras. Those that have a slot in `before` keep it; the others take slots whose
// cameras are not chosen.
FieldCameras keepSlots(const FieldCameras& before, std::span<const size_t> chosen);

class SurfaceFields {
 public:
  // γ of M4D Eq. 4. serves: RGBA8, 1 where the slot's camera serves the vertex, 0 where not. A distance runs on the
  // surface, from the slot's seam, in units of `clamp_m` and at most 1; without a seam it is 1 everywhere. Each of the
  // `steps` (rounded up to even, at least 2) costs a pass and reaches an edge further; where triangles are so small
  // that they would not reach the clamp, mean side below clamp_m / (0.85 steps), they count as that large. Errors:
  // GpuFailure.
  Status updateDistances(gpu::Device& device, const CharacterModel& model, FieldTables serves, float clamp_m,
                         int steps = kFieldSteps);
  FieldTables distances() const { return distances_[0].tables(); }  // RGBA16F

  // M4D Eq. 5, whatever the frame rate: the fields come nearer to `aims` (RGBA16F) by the share 1 - exp(-elapsed_s /
  // settling_s); at the first call, after an infinite time and with settling_s = 0 they are the aims. Where a slot's
  // camera is another than before, its field starts from 0. With another topology than at the last call the fields
  // before are those of the nearest vertex then (from the second such change on, and where there is one near; else they
  // are the aims). Errors: GpuFailure.
  Status follow(gpu::Device& device, const CharacterModel& model, FieldTables aims,
                std::span<const size_t> cameras_of_slots, float elapsed_s, float settling_s);
  FieldTables fields() const { return fields_[current_].tables(); }  // RGBA16F

 private:
  struct Pair {
    gpu::Texture low, high;
    gpu::Target target;  // of both
    uint32_t vertices = 0;
    FieldTables tables() const { return {low.id(), high.id()}; }
  };
  // Fields of the surface before, found by place.
  struct Before {
    gpu::Texture places, cells;  // a vertex's place in the box; a vertex of every cell
    gpu::Target to_places, to_cells;
    uint32_t vertices = 0;
    BoundingBox box;
    uint64_t geometry_serial = 0;  // 0: nothing is kept
  };
  Status makePair(gpu::Device& device, const CharacterModel& model, const char* label, Pair& out);
  Status carryOver(gpu::Device& device, const CharacterModel& model, FieldTables aims);
  Status keepPlaces(gpu::Device& device, const CharacterModel& model);

  SurfaceNeighbours neighbours_;
  gpu::Program seams_program_, spread_program_, follow_program_, carry_program_, places_program_, cells_program_;
  std::array<Pair, 2> distances_;  // the result is in the first
  std::array<Pair, 2> fields_;
  size_t current_ = 0;
  FieldCameras cameras_ = kNoFieldCameras;
  bool has_fields_ = false, topology_changes_ = false;
  uint64_t topology_serial_ = 0;  // of the fields
  Before before_;
};

}  // namespace fourdvt::render
