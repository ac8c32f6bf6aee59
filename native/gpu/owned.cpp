// SPDX-License-Identifier: Apache-2.0
#include "gpu/device.h"

namespace fourdvt::gpu {

int bytesPerPixel(PixelFormat format) {
  switch (format) {
    case PixelFormat::R8:
      return 1;
    case PixelFormat::RG8:
      return 2;
    case PixelFormat::RGBA8:
      return 4;
    case PixelFormat::R32UI:
      return 4;
    case PixelFormat::RG32F:
      return 8;
    case PixelFormat::RGBA32F:
      return 16;
    case PixelFormat::R32F:
      return 4;
    case PixelFormat::Depth24:
      return 4;
    case PixelFormat::RG16F:
      return 4;
    case PixelFormat::RGBA16F:
      return 8;
  }
  return 0;
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

Result<Program> makeProgram(Device& device, std::string_view label, std::string_view vertex_source,
                            std::string_view fragment_source, std::string_view defines) {
  auto id = device.createProgram(label, vertex_source, fragment_source, defines);
  if (!id) return id.error();
  return Program(device, id.value());
}

Result<Target> makeTarget(Device& device, const TargetDesc& desc) {
  auto id = device.createTarget(desc);
  if (!id) return id.error();
  return Target(device, id.value());
}

}  // namespace fourdvt::gpu
