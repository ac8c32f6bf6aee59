// SPDX-License-Identifier: Apache-2.0
#include "render/flow/flow.h"
#include "render/flow/gpu_flow.h"

namespace fourdvt::render {
namespace {

class ReadBackFlow final : public FlowSource {
 public:
  ReadBackFlow(gpu::Device& device, FlowSolver solver) : device_(device), solver_(std::move(solver)) {}

  Status compute(gpu::TextureId a, gpu::TextureId b, int width, int height) override {
    FOURDVT_TRY(resize(width, height));
    FOURDVT_TRY(pictures_.prepare(device_, a, b, width, height));
    FOURDVT_TRY(device_.readPixels(pictures_.target(), gpu::PixelFormat::RGBA8, {.width = width, .height = height},
                                   pixels_.data()));
    // Rows are read top first, whereas flow is along GL rows.
    const size_t count = a_.size(), row = width;
    for (size_t i = 0; i < count; ++i) {
      const size_t from = (count / row - 1 - i / row) * row + i % row;
      a_[i] = pixels_[4 * from];
      b_[i] = pixels_[4 * from + 1];
      confidence_[i] = pixels_[4 * from + 3];
    }
    FOURDVT_TRY(solver_(a_.data(), b_.data(), width, height, flow_values_.data()));
    for (size_t i = 0; i < 2 * count; ++i) flow_values_[i] *= confidence_[i / 2] / 255.0f;
    device_.updateTexture(flow_.id(), {.width = width, .height = height}, flow_values_.data());
    return {};
  }
  gpu::TextureId flow() const override { return flow_.id(); }

 private:
  Status resize(int width, int height) {
    if (width == width_ && height == height_) return {};
    FOURDVT_ASSIGN(
        flow_, gpu::makeTexture(
                   device_, {.format = gpu::PixelFormat::RG32F, .width = width, .height = height, .label = "flow"}));
    width_ = width;
    height_ = height;
    const size_t count = static_cast<size_t>(width) * height;
    pixels_.resize(4 * count);
    a_.resize(count);
    b_.resize(count);
    confidence_.resize(count);
    flow_values_.resize(2 * count);
    return {};
  }

  gpu::Device& device_;
  const FlowSolver solver_;
  FlowPictures pictures_;
  gpu::Texture flow_;
  std::vector<uint8_t> pixels_, a_, b_, confidence_;
  std::vector<float> flow_values_;
  int width_ = 0, height_ = 0;
};

}  // namespace

std::unique_ptr<FlowSource> createReadBackFlow(gpu::Device& device, FlowSolver solver) {
  return std::make_unique<ReadBackFlow>(device, std::move(solver));
}

}  // namespace fourdvt::render
