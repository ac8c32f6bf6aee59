// SPDX-License-Identifier: Apache-2.0
#include <cstring>

#include "gpu/checked_device.h"

namespace fourdvt::gpu {
namespace {

class NullDevice final : public CheckedDevice {
 public:
  explicit NullDevice(bool float_targets) {
    caps_.max_texture_size = 4096;
    caps_.max_samples = 4;
    caps_.float_targets = caps_.half_float_targets = float_targets;
    caps_.renderer = "null";
  }
  void invalidateState() override {}

 protected:
  Status onCreateTexture(TextureRecord& texture) override {
    texture.native = ++natives_;
    return {};
  }
  void onUpdateTexture(const TextureRecord&, const Region&, const void*, int, int) override {}
  void onGenerateMipmaps(const TextureRecord&) override {}
  void onDestroyTexture(const TextureRecord&) override {}
  IndexBufferId onCreateIndexBuffer() override { return ++natives_; }
  void onUpdateIndices(IndexBufferId, std::span<const uint32_t>) override {}
  void onDestroyIndexBuffer(IndexBufferId) override {}
  Status onCreateProgram(ProgramId, const std::string&, const std::string&, const std::string&) override { return {}; }
  void onDestroyProgram(ProgramId) override {}
  Status onCreateTarget(TargetRecord&) override { return {}; }
  void onDestroyTarget(const TargetRecord&) override {}
  void onBeginPass(const Pass&, const TargetRecord*) override {}
  void onDraw(const Draw&) override {}
  void onBlit(const TargetRecord*, const TargetRecord*, const Region&) override {}
  Status onReadPixels(const TargetRecord*, PixelFormat format, const Region& region, void* out) override {
    std::memset(out, 0, static_cast<size_t>(region.width) * region.height * readBytesPerPixel(format));
    return {};
  }
  void onBeginRead(ReadId, const TargetRecord*, const Region&) override {}
  bool onEndRead(ReadId, const Region& region, void* out) override {
    if (out) std::memset(out, 0, size_t{4} * static_cast<size_t>(region.width) * static_cast<size_t>(region.height));
    return true;
  }

 private:
  uint32_t natives_ = 0;
};

}  // namespace

std::unique_ptr<Device> createNullDevice(bool float_targets) { return std::make_unique<NullDevice>(float_targets); }

}  // namespace fourdvt::gpu
