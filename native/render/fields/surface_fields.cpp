// SPDX-License-Identifier: Apache-2.0
#include "render/fields/surface_fields.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "render/table.h"

namespace fourdvt::render {

Status SurfaceNeighbours::update(gpu::Device& device, const CharacterModel& model) {
  if (model.vertex_count > vertices_ || model.face_count > faces_) {
    // Reserves a quarter more, since the next surface has a similar size.
    const auto room = [](uint32_t count, uint32_t most) { return std::max(count, std::min(count + count / 4, most)); };
    const uint32_t vertices = room(model.vertex_count, model.maxVertices()),
                   faces = room(model.face_count, model.maxFaces());
    vertices_ = faces_ = 0;
    is_filled_ = false;
    FOURDVT_ASSIGN(table_,
                   makeTable(device, gpu::PixelFormat::R32UI, vertices + 1 + 6ull * faces, "vertices' neighbours"));
    vertices_ = vertices;
    faces_ = faces;
  }
  if (is_filled_ && topology_serial_ == model.topology_serial) return {};
  const uint32_t vertices = model.vertex_count;
  resizeToRows(lists_, vertices + 1 + 6ull * model.face_count, 0u);
  for (const glm::uvec3& face : model.faces())
    for (int k = 0; k < 3; ++k) lists_[face[k]] += 2;
  uint32_t end = vertices + 1;
  for (uint32_t v = 0; v <= vertices; ++v) {
    const uint32_t count = v < vertices ? lists_[v] : 0;
    lists_[v] = end;
    end += count;
  }
  std::vector<uint32_t> next(lists_.begin(), lists_.begin() + vertices);
  for (const glm::uvec3& face : model.faces())
    for (int k = 0; k < 3; ++k) {
      lists_[next[face[k]]++] = face[(k + 1) % 3];
      lists_[next[face[k]]++] = face[(k + 2) % 3];
    }
  uploadTable(device, table_, lists_);
  topology_serial_ = model.topology_serial;
  is_filled_ = true;
  return {};
}

std::string_view fieldShaderText(std::string_view name);  // embedded; see CMakeLists.txt

namespace {

constexpr float kSidesPerStep = 0.85f;  // maximum triangle sides between seam and clamp, per step
constexpr int kCells = 64;              // cells along each axis of the box
constexpr int kCellTexels = 512;        // texels along each side of the cells' texture
static_assert(kCells * kCells * kCells == kCellTexels * kCellTexels);

Status makeProgram(gpu::Device& device, const char* vertex, const char* fragment, gpu::Program& out) {
  if (out) return {};
  const std::string defines = "TABLE_WIDTH " + std::to_string(CharacterModel::kTableWidth) + "\nCELLS " +
                              std::to_string(kCells) + "\nCELL_TEXELS " + std::to_string(kCellTexels) + "\n";
  FOURDVT_ASSIGN(out, gpu::makeProgram(device, std::string(vertex) + " + " + fragment, fieldShaderText(vertex),
                                       fieldShaderText(fragment), defines));
  return {};
}

Status makeProgram(gpu::Device& device, const char* fragment, gpu::Program& out) {
  return makeProgram(device, "field_fullscreen.vert", fragment, out);
}

// Runs one pass with a texel per vertex.
void runPass(gpu::Device& device, gpu::TargetId target, uint32_t vertices, const gpu::Draw& draw) {
  device.beginPass({.target = target,
                    .width = CharacterModel::kTableWidth,
                    .height = static_cast<int>(tableRows(vertices)),
                    .label = "fields"});
  device.draw(draw);
  device.endPass();
}

uint32_t roomFor(const CharacterModel& model) { return std::max(model.vertex_count, model.maxVertices()); }

}  // namespace

FieldCameras keepSlots(const FieldCameras& before, std::span<const size_t> chosen) {
  const auto has = [](std::span<const size_t> cameras, size_t c) {
    return std::find(cameras.begin(), cameras.end(), c) != cameras.end();
  };
  FieldCameras slots = before;
  for (size_t& slot : slots)
    if (!has(chosen, slot)) slot = kNoCamera;
  for (size_t c : chosen.first(std::min<size_t>(chosen.size(), kFieldSlots)))
    if (!has(slots, c)) *std::find(slots.begin(), slots.end(), kNoCamera) = c;
  return slots;
}

Status SurfaceFields::makePair(gpu::Device& device, const CharacterModel& model, const char* label, Pair& out) {
  if (model.vertex_count <= out.vertices) return {};
  out = {};
  const uint32_t vertices = roomFor(model);
  FOURDVT_ASSIGN(out.low, makeTable(device, gpu::PixelFormat::RGBA16F, vertices, label));
  FOURDVT_ASSIGN(out.high, makeTable(device, gpu::PixelFormat::RGBA16F, vertices, label));
  FOURDVT_ASSIGN(out.target, gpu::makeTarget(device, {.colors = {out.low.id(), out.high.id()}, .label = label}));
  out.vertices = vertices;
  return {};
}

Status SurfaceFields::updateDistances(gpu::Device& device, const CharacterModel& model, FieldTables seen, float clamp_m,
                                      int steps) {
  steps += steps % 2;  // even, so that the last step writes the first pair
  for (Pair& pair : distances_) FOURDVT_TRY(makePair(device, model, "distances from seams", pair));
  FOURDVT_TRY(makeProgram(device, "field_seams.frag", seams_program_));
  FOURDVT_TRY(makeProgram(device, "field_spread.frag", spread_program_));
  FOURDVT_TRY(neighbours_.update(device, model));
  const int vertex_count = static_cast<int>(model.vertex_count);
  const float per_metre = 1 / std::max(clamp_m, 1e-4f), min_side = 1 / (kSidesPerStep * float(steps));
  const auto draw = [&](const Pair& to, const gpu::Program& program, const char* low, const char* high,
                        FieldTables from) {
    runPass(device, to.target.id(), model.vertex_count,
            {.program = program.id(),
             .textures = {{"u_neighbours", neighbours_.texture()},
                          {"u_positions_normals", model.positions_normals.id()},
                          {low, from.low},
                          {high, from.high}},
             .uniforms = {gpu::uniform("u_vertex_count", vertex_count), gpu::uniform("u_per_metre", per_metre),
                          gpu::uniform("u_least_side", min_side)},
             .vertex_count = 3});
  };
  draw(distances_[0], seams_program_, "u_seen_low", "u_seen_high", seen);
  for (int step = 0; step < steps; ++step)
    draw(distances_[(step + 1) % 2], spread_program_, "u_before_low", "u_before_high", distances_[step % 2].tables());
  return {};
}

Status SurfaceFields::follow(gpu::Device& device, const CharacterModel& model, FieldTables aims,
                             std::span<const size_t> cameras_of_slots, float elapsed_s, float settling_s) {
  FOURDVT_TRY(makeProgram(device, "field_follow.frag", follow_program_));
  const bool fits = fields_[0].vertices >= model.vertex_count;
  for (Pair& pair : fields_) FOURDVT_TRY(makePair(device, model, "fields", pair));
  bool at_once = !has_fields_ || !fits || !std::isfinite(elapsed_s) || !(settling_s > 0);
  if (has_fields_ && topology_serial_ != model.topology_serial) {
    topology_changes_ = true;
    if (before_.geometry_serial == 0 || !fits) at_once = true;
    if (!at_once) FOURDVT_TRY(carryOver(device, model, aims));
  }
  glm::vec4 keeps[2];
  for (int slot = 0; slot < kFieldSlots; ++slot) {
    const size_t camera = size_t(slot) < cameras_of_slots.size() ? cameras_of_slots[size_t(slot)] : kNoCamera;
    keeps[slot / 4][slot % 4] = cameras_[size_t(slot)] == camera ? 1 : 0;
    cameras_[size_t(slot)] = camera;
  }
  const float share = at_once ? 1 : 1 - std::exp(-std::max(elapsed_s, 0.0f) / settling_s);
  const FieldTables before = fields_[current_].tables();
  current_ = 1 - current_;
  runPass(device, fields_[current_].target.id(), model.vertex_count,
          {.program = follow_program_.id(),
           .textures = {{"u_before_low", before.low},
                        {"u_before_high", before.high},
                        {"u_aims_low", aims.low},
                        {"u_aims_high", aims.high}},
           .uniforms = {gpu::uniform("u_keeps_low", keeps[0]), gpu::uniform("u_keeps_high", keeps[1]),
                        gpu::uniform("u_share", share)},
           .vertex_count = 3});
  has_fields_ = true;
  topology_serial_ = model.topology_serial;
  return topology_changes_ ? keepPlaces(device, model) : Status();
}

Status SurfaceFields::carryOver(gpu::Device& device, const CharacterModel& model, FieldTables aims) {
  FOURDVT_TRY(makeProgram(device, "field_carry.frag", carry_program_));
  const FieldTables before = fields_[current_].tables();
  current_ = 1 - current_;
  const int vertex_count = static_cast<int>(model.vertex_count);
  const glm::vec3 cells_per_metre = float(kCells) / glm::max(before_.box.max - before_.box.min, glm::vec3(1e-3f));
  runPass(device, fields_[current_].target.id(), model.vertex_count,
          {.program = carry_program_.id(),
           .textures = {{"u_positions_normals", model.positions_normals.id()},
                        {"u_cells", before_.cells.id()},
                        {"u_places", before_.places.id()},
                        {"u_before_low", before.low},
                        {"u_before_high", before.high},
                        {"u_aims_low", aims.low},
                        {"u_aims_high", aims.high}},
           .uniforms = {gpu::uniform("u_vertex_count", vertex_count), gpu::uniform("u_box_min", before_.box.min),
                        gpu::uniform("u_cells_per_metre", cells_per_metre)},
           .vertex_count = 3});
  return {};
}

Status SurfaceFields::keepPlaces(gpu::Device& device, const CharacterModel& model) {
  if (before_.geometry_serial == model.geometry_serial) return {};
  FOURDVT_TRY(makeProgram(device, "field_places.frag", places_program_));
  FOURDVT_TRY(makeProgram(device, "field_cells.vert", "field_cells.frag", cells_program_));
  if (before_.vertices < model.vertex_count) {
    before_ = {};
    const uint32_t vertices = roomFor(model);
    FOURDVT_ASSIGN(before_.places, makeTable(device, gpu::PixelFormat::RGBA16F, vertices, "vertices' places"));
    FOURDVT_ASSIGN(before_.to_places,
                   gpu::makeTarget(device, {.colors = {before_.places.id()}, .label = "vertices' places"}));
    FOURDVT_ASSIGN(before_.cells, gpu::makeTexture(device, {.format = gpu::PixelFormat::R32UI,
                                                            .width = kCellTexels,
                                                            .height = kCellTexels,
                                                            .label = "vertices of cells"}));
    FOURDVT_ASSIGN(before_.to_cells,
                   gpu::makeTarget(device, {.colors = {before_.cells.id()}, .label = "vertices of cells"}));
    before_.vertices = vertices;
  }
  before_.box = model.frame_bounds;
  before_.geometry_serial = model.geometry_serial;
  const int vertex_count = static_cast<int>(model.vertex_count);
  const glm::vec3 cells_per_metre = float(kCells) / glm::max(before_.box.max - before_.box.min, glm::vec3(1e-3f));
  runPass(device, before_.to_places.id(), model.vertex_count,
          {.program = places_program_.id(),
           .textures = {{"u_positions_normals", model.positions_normals.id()}},
           .uniforms = {gpu::uniform("u_vertex_count", vertex_count), gpu::uniform("u_box_min", before_.box.min)},
           .vertex_count = 3});
  device.beginPass({.target = before_.to_cells.id(),
                    .width = kCellTexels,
                    .height = kCellTexels,
                    .clear_color = true,
                    .label = "vertices of cells"});
  device.draw({.program = cells_program_.id(),
               .textures = {{"u_places", before_.places.id()}},
               .uniforms = {gpu::uniform("u_cells_per_metre", cells_per_metre)},
               .vertex_count = 3 * vertex_count});
  device.endPass();
  return {};
}

}  // namespace fourdvt::render
