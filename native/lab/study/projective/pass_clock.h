// SPDX-License-Identifier: Apache-2.0
// A device that hands every call on and measures how long passes take, by their label. It waits for the GPU after every
// pass, so that the parts add up to more than an undisturbed frame.
#pragma once

#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "gpu/device.h"

namespace fourdvt::study {

class PassClock final : public gpu::Device {
 public:
  explicit PassClock(gpu::Device& device) : device_(device) {}
  Status prepare();  // before anything else. Errors: GpuFailure

  struct Part {
    std::string label;  // of the passes; "upload": updates of textures
    double seconds = 0;
  };
  const std::vector<Part>& parts() const { return parts_; }  // in order of their first use
  void forget() { parts_.clear(); }

  const gpu::Caps& caps() const override { return device_.caps(); }
  Result<gpu::TextureId> createTexture(const gpu::TextureDesc& desc) override { return device_.createTexture(desc); }
  void updateTexture(gpu::TextureId texture, const gpu::Region& region, const void* pixels, int stride_bytes,
                     int layer) override;
  void generateMipmaps(gpu::TextureId texture) override { device_.generateMipmaps(texture); }
  void destroyTexture(gpu::TextureId texture) override { device_.destroyTexture(texture); }
  gpu::IndexBufferId createIndexBuffer() override { return device_.createIndexBuffer(); }
  void updateIndices(gpu::IndexBufferId buffer, std::span<const uint32_t> indices) override {
    device_.updateIndices(buffer, indices);
  }
  void destroyIndexBuffer(gpu::IndexBufferId buffer) override { device_.destroyIndexBuffer(buffer); }
  Result<gpu::ProgramId> createProgram(std::string_view label, std::string_view vertex_text,
                                       std::string_view fragment_text, std::string_view defines) override {
    return device_.createProgram(label, vertex_text, fragment_text, defines);
  }
  void destroyProgram(gpu::ProgramId program) override { device_.destroyProgram(program); }
  Result<gpu::TargetId> createTarget(const gpu::TargetDesc& desc) override { return device_.createTarget(desc); }
  void destroyTarget(gpu::TargetId target) override { device_.destroyTarget(target); }
  void beginPass(const gpu::Pass& pass) override;
  void draw(const gpu::Draw& draw) override { device_.draw(draw); }
  void endPass() override;
  void blit(gpu::TargetId from, gpu::TargetId to, const gpu::Region& region) override {
    device_.blit(from, to, region);
  }
  Status readPixels(gpu::TargetId target, gpu::PixelFormat format, const gpu::Region& region, void* out) override {
    return device_.readPixels(target, format, region, out);
  }
  gpu::ReadId beginRead(gpu::TargetId target, const gpu::Region& region) override {
    return device_.beginRead(target, region);
  }
  bool endRead(gpu::ReadId read, void* out) override { return device_.endRead(read, out); }
  uint32_t nativeTexture(gpu::TextureId texture) const override { return device_.nativeTexture(texture); }
  void invalidateState() override { device_.invalidateState(); }
  const gpu::Counters& counters() const override { return device_.counters(); }
  void resetCounters() override { device_.resetCounters(); }
  std::string takeErrors() override { return device_.takeErrors(); }

 private:
  using Clock = std::chrono::steady_clock;
  void wait();
  void add(const std::string& label, Clock::time_point since);

  gpu::Device& device_;
  gpu::Texture color_;
  gpu::Target target_;
  std::string label_;
  Clock::time_point start_;
  std::vector<Part> parts_;
};

}  // namespace fourdvt::study
