// SPDX-License-Identifier: Apache-2.0
#include "render/barcodes/picture_checks.h"

namespace fourdvt::render {

std::string_view barcodeShaderText(std::string_view name);  // embedded shaders

namespace {
constexpr int kCells = 2 * package::kBarcodeCells;
}  // namespace

PictureChecks::~PictureChecks() {
  for (const Pending& pending : pending_) device_.endRead(pending.read, nullptr);
}

Status PictureChecks::prepare() {
  if (target_) return {};
  FOURDVT_ASSIGN(program_, gpu::makeProgram(device_, "barcode cells", gpu::shaderText("fullscreen.vert"),
                                            barcodeShaderText("barcode_cells.frag")));
  FOURDVT_ASSIGN(cells_, gpu::makeTexture(device_, {.width = kCells, .label = "barcode cells"}));
  FOURDVT_ASSIGN(target_, gpu::makeTarget(device_, {.colors = {cells_.id()}, .label = "barcode cells"}));
  return {};
}

Status PictureChecks::begin(int slot, gpu::TextureId picture, const package::BarcodeStrip& strip) {
  FOURDVT_TRY(prepare());
  const glm::vec4 at(strip.rect.x, strip.rect.y, strip.cell_size, strip.rect.height);
  device_.beginPass({.target = target_.id(), .label = "barcode cells"});
  device_.draw({.program = program_.id(),
                .textures = {{"u_picture_rgba", picture}},
                .uniforms = {gpu::uniform("u_strip", at)},
                .vertex_count = 3});
  device_.endPass();
  const gpu::ReadId read = device_.beginRead(target_.id(), {.width = kCells, .height = 1});
  if (!read) return Error{ErrorId::GpuFailure, "the GPU's pictures cannot be read back"};
  pending_.push_back({slot, read});
  return {};
}

bool PictureChecks::read(gpu::ReadId id, std::optional<uint32_t>& frame) {
  std::array<uint8_t, 4 * kCells> pixels{};
  if (!device_.endRead(id, pixels.data())) return false;
  std::array<uint8_t, kCells> lumas;
  for (size_t cell = 0; cell < kCells; ++cell) lumas[cell] = pixels[4 * cell];
  frame = package::frameFromCells(lumas, 127);
  return true;
}

}  // namespace fourdvt::render
