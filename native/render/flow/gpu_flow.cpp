// SPDX-License-Identifier: Apache-2.0
#include "render/flow/gpu_flow.h"

namespace fourdvt::render {
namespace {

constexpr float kNeverSure_px = 1e6f;  // longer than any displacement

class GpuFlow final : public FlowSource {
 public:
  GpuFlow(gpu::Device& device, const FlowOptions& options) : device_(device), options_(options) {}

  Status compute(gpu::TextureId a, gpu::TextureId b, int width, int height) override {
    FOURDVT_TRY(resize(width, height));
    FOURDVT_TRY(pictures_.prepare(device_, a, b, width, height));
    const RawFlow raw = method_->run(device_, pictures_.texture());
    const float must_explain = static_cast<float>(options_.must_explain),
                sure_px = options_.sure_px > 0 ? static_cast<float>(options_.sure_px) : kNeverSure_px;
    runFlowPass(device_, finish_.id(), flow_.target.id(),
                {{"u_flow", raw.texture}, {"u_pictures", pictures_.texture()}},
                {gpu::uniform("u_gain", raw.gain), gpu::uniform("u_must_explain", must_explain),
                 gpu::uniform("u_sure", sure_px)});
    return {};
  }
  gpu::TextureId flow() const override { return flow_[0]; }

 private:
  Status resize(int width, int height) {
    if (!method_) {
      auto made =
          options_.method == FlowMethod::Dis ? createDis(device_, options_) : createFarneback(device_, options_);
      if (!made) return made.error();
      FOURDVT_TRY(makeFlowProgram(device_, "flow_finish.frag", finish_, options_.must_explain > 0 ? "EXPLAINS\n" : ""));
      method_ = made.take();
    }
    if (flow_.width == width && flow_.height == height) return {};
    flow_.width = 0;
    FOURDVT_TRY(method_->resize(device_, width, height));
    return makeFlowBuffer(device_, width, height, {gpu::PixelFormat::RG16F}, flow_);
  }

  gpu::Device& device_;
  const FlowOptions options_;
  FlowPictures pictures_;
  std::unique_ptr<FlowMethodPasses> method_;
  gpu::Program finish_;
  FlowBuffer flow_;
};

}  // namespace

Result<std::unique_ptr<FlowSource>> createGpuFlow(gpu::Device& device, const FlowOptions& options) {
  if (!device.caps().half_float_targets)
    return Error{ErrorId::Unsupported,
                 "this GPU cannot draw into half-float textures: align with baked alignment or another flow source"};
  if ((options.poly_n != 5 && options.poly_n != 7) || options.window < 3 || options.window % 2 == 0 ||
      options.levels < 0 || options.finest < 0 || !(options.must_explain >= 0) || !(options.sure_px >= 0) ||
      options.iterations < 1 || !(options.poly_sigma > 0))
    return Error{ErrorId::InvalidArgument,
                 "flow: poly_n is 5 or 7, the window odd and at least 3, one iteration or more, finest, "
                 "must_explain and sure_px 0 or more"};
  return std::unique_ptr<FlowSource>(std::make_unique<GpuFlow>(device, options));
}

}  // namespace fourdvt::render
