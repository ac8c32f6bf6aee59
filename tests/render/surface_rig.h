// SPDX-License-Identifier: Apache-2.0
// A surface on the GPU, and tables of values per vertex, written and read back.
#pragma once

#include "gl_fixture.h"
#include "render/fields/surface_fields.h"
#include "render/table.h"

namespace fourdvt::testing {

using VertexValues = std::vector<std::array<float, render::kFieldSlots>>;

struct Surface {
  Positions positions;
  std::vector<glm::uvec3> faces;
  std::vector<glm::dvec2> flat;  // vertices of the unrolled surface, metres
};

// Mesh of 2 × columns × rows equilateral triangles, `side` metres each, in the plane z = 0, centred on the origin.
// rolled: closed round the y axis instead.
inline Surface equilateral(int columns, int rows, double side, bool rolled = false) {
  Surface out;
  const int across = rolled ? columns : columns + 1;
  const double around = columns * side, height = std::sqrt(0.75) * side;
  for (int y = 0; y <= rows; ++y)
    for (int x = 0; x < across; ++x) {
      const glm::dvec2 at((x + 0.5 * (y % 2)) * side - around / 2, (y - rows / 2.0) * height);
      out.flat.push_back(at);
      const double angle = at.x / around * 2 * M_PI, radius = around / (2 * M_PI);
      out.positions.emplace_back(rolled ? glm::dvec3(radius * std::sin(angle), at.y, radius * std::cos(angle))
                                        : glm::dvec3(at, 0));
    }
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) {
      const auto vertex = [&](int dx, int dy) { return uint32_t((y + dy) * across + (x + dx) % across); };
      const uint32_t a = vertex(0, 0), b = vertex(1, 0), c = vertex(0, 1), d = vertex(1, 1);
      out.faces.push_back(y % 2 ? glm::uvec3(a, b, d) : glm::uvec3(a, b, c));
      out.faces.push_back(y % 2 ? glm::uvec3(a, d, c) : glm::uvec3(b, d, c));
    }
  return out;
}

inline render::CharacterModel modelOf(gpu::Device& device, const Surface& surface, size_t most = 0) {
  package::Character body;
  body.vertex_count = static_cast<uint32_t>(std::max(most, surface.positions.size()));
  body.face_count = static_cast<uint32_t>(std::max(2 * most, surface.faces.size()));
  auto model = render::CharacterModel::createForSurfaces(device, body).take();
  EXPECT_TRUE(model.setTopology(device, surface.faces, static_cast<uint32_t>(surface.positions.size())));
  model.setPositions(device, surface.positions);
  return model;
}

// Two textures of one format, as used by fields.
struct ValueTables {
  gpu::Texture low, high;
  render::FieldTables tables() const { return {low.id(), high.id()}; }
};

// Uploads as RGBA8; values 0…1.
inline ValueTables uploadValues(gpu::Device& device, const VertexValues& values) {
  ValueTables out;
  gpu::Texture* textures[] = {&out.low, &out.high};
  for (int half = 0; half < 2; ++half) {
    *textures[half] = render::makeTable(device, gpu::PixelFormat::RGBA8, values.size(), "values").take();
    std::vector<glm::u8vec4> table;
    render::resizeToRows(table, values.size(), glm::u8vec4(0));
    for (size_t v = 0; v < values.size(); ++v)
      for (int k = 0; k < 4; ++k) table[v][k] = static_cast<uint8_t>(std::lround(255 * values[v][4 * half + k]));
    render::uploadTable(device, *textures[half], table);
  }
  return out;
}

inline VertexValues readValues(gpu::Device& device, render::FieldTables tables, gpu::PixelFormat format, size_t count) {
  VertexValues out(count);
  const gpu::TextureId textures[] = {tables.low, tables.high};
  for (int half = 0; half < 2; ++half) {
    auto target = gpu::makeTarget(device, {.colors = {textures[half]}, .label = "values"}).take();
    const int width = render::CharacterModel::kTableWidth, rows = static_cast<int>(render::tableRows(count));
    std::vector<glm::vec4> floats(size_t(width) * rows);
    std::vector<glm::u8vec4> bytes(floats.size());
    const bool is_bytes = format == gpu::PixelFormat::RGBA8;
    EXPECT_TRUE(device.readPixels(target.id(), format, {.width = width, .height = rows},
                                  is_bytes ? static_cast<void*>(bytes.data()) : floats.data()));
    for (size_t v = 0; v < count; ++v) {
      const size_t row = v / width, at = (size_t(rows) - 1 - row) * width + v % width;  // read top row first
      for (int k = 0; k < 4; ++k) out[v][4 * half + k] = is_bytes ? bytes[at][k] / 255.0f : floats[at][k];
    }
  }
  return out;
}

}  // namespace fourdvt::testing
