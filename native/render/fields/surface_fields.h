// SPDX-License-Identifier: Apache-2.0
// Fields on a surface: a value per vertex and camera that fades cameras out towards their seams and smooths changes of
// the view in time (M4D 4.4, 4.5). A camera's seam: triangles with both visible and invisible vertices for that camera.
// The caller supplies visibility and target values. Requires Caps::half_float_targets.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "render/character_model.h"

namespace fourdvt::render {

// Faces at each vertex of a model's surface, as a table for shaders. Rebuilt only when the topology changes.
class SurfaceNeighbours {
 public:
  // Errors: GpuFailure.
  Status update(gpu::Device& device, const CharacterModel& model);
  // R32UI: [vertex] start of its list, and the end of the last list; then the lists: for each face at the vertex its
  // two other vertices, in the face's order. A neighbour appears once for each face that has both vertices.
  gpu::TextureId texture() const { return table_.id(); }

 private:
  gpu::Texture table_;
  uint32_t vertices_ = 0, faces_ = 0;  // capacity of the table; 0: no table
  uint64_t topology_serial_ = 0;
  bool is_filled_ = false;
  std::vector<uint32_t> lists_;  // scratch
};

constexpr int kFieldSlots = 8;  // maximum cameras of a field
constexpr size_t kNoCamera = ~size_t(0);
constexpr int kFieldSteps = 20;  // distance passes (M4D 4.4)

// Values per vertex and slot: two textures addressed as CharacterModel's tables, a texel per vertex, a channel per
// slot.
struct FieldTables {
  gpu::TextureId low = 0, high = 0;  // slots 0-3 and 4-7
};

// Camera in each slot; kNoCamera: empty.
using FieldCameras = std::array<size_t, kFieldSlots>;
constexpr FieldCameras kNoFieldCameras = {kNoCamera, kNoCamera, kNoCamera, kNoCamera,
                                          kNoCamera, kNoCamera, kNoCamera, kNoCamera};

// Assigns slots to `chosen` (at most kFieldSlots cameras): those with a slot in `before` keep it; the others take slots
// of cameras that are not chosen.
FieldCameras keepSlots(const FieldCameras& before, std::span<const size_t> chosen);

class SurfaceFields {
 public:
  // Computes γ of M4D Eq. 4 from visibility: RGBA8, 1 where the slot's camera sees the vertex, else 0. Distances run
  // over the surface from the slot's seam, in units of `clamp_m` and at most 1; without a seam they are 1 everywhere.
  // Each of the `steps` (rounded up to even, at least 2) costs a pass and extends the reach by an edge; triangles too
  // small to reach the clamp, mean side below clamp_m / (0.85 steps), count as that large. Errors: GpuFailure.
  Status updateDistances(gpu::Device& device, const CharacterModel& model, FieldTables seen, float clamp_m,
                         int steps = kFieldSteps);
  FieldTables distances() const { return distances_[0].tables(); }  // RGBA16F

  // Smooths the fields in time (M4D Eq. 5), independent of frame rate: moves them towards `aims` (RGBA16F) by the share
  // 1 - exp(-elapsed_s / settling_s). They equal the aims at the first call, after an infinite time and with settling_s
  // = 0. A slot with a new camera starts from 0. After a topology change each vertex starts from the nearest vertex of
  // the previous surface; from the aims at the first such change, or if none is within reach. Errors: GpuFailure.
  Status follow(gpu::Device& device, const CharacterModel& model, FieldTables aims,
                std::span<const size_t> cameras_of_slots, float elapsed_s, float settling_s);
  FieldTables fields() const { return fields_[current_].tables(); }  // RGBA16F

 private:
  struct Pair {
    gpu::Texture low, high;
    gpu::Target target;  // target of both textures
    uint32_t vertices = 0;
    FieldTables tables() const { return {low.id(), high.id()}; }
  };
  // Fields of the previous surface, looked up by position.
  struct Before {
    gpu::Texture places, cells;  // each vertex's position in the box; a vertex of every cell
    gpu::Target to_places, to_cells;
    uint32_t vertices = 0;
    BoundingBox box;
    uint64_t geometry_serial = 0;  // 0: empty
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
  uint64_t topology_serial_ = 0;  // topology of the fields
  Before before_;
};

}  // namespace fourdvt::render
