// SPDX-License-Identifier: Apache-2.0
#include "gpu/device.h"

namespace fourdvt::gpu {

int bytesPerPixel(PixelFormat format) {
  constexpr uint8_t kBytes[] = {1, 2, 4, 4, 8, 16, 4, 4, 4, 8};  // in the order of PixelFormat
  return kBytes[static_cast<size_t>(format)];
}

int readBytesPerPixel(PixelFormat format) {
  const bool is_half = format == PixelFormat::RG16F || format == PixelFormat::RGBA16F;
  return bytesPerPixel(format) * (is_half ? 2 : 1);
}

Result<Texture> makeTexture(Device& device, const TextureDesc& desc) {
  auto id = device.createTexture(desc);
  if (!id) return id.error();
  return Texture(device, id.value());
}

Result<Program> makeProgram(Device& device, std::string_view label, std::string_view vertex_text,
                            std::string_view fragment_text, std::string_view defines) {
  auto id = device.createProgram(label, vertex_text, fragment_text, defines);
  if (!id) return id.error();
  return Program(device, id.value());
}

Result<Target> makeTarget(Device& device, const TargetDesc& desc) {
  auto id = device.createTarget(desc);
  if (!id) return id.error();
  return Target(device, id.value());
}

IndexBuffer makeIndexBuffer(Device& device) { return IndexBuffer(device, device.createIndexBuffer()); }

}  // namespace fourdvt::gpu
