// SPDX-License-Identifier: Apache-2.0
#include "render/flow/gpu_flow.h"

#include <algorithm>
#include <cmath>

namespace fourdvt::render {

std::string_view flowShaderText(std::string_view name);  // embedded flow_*; see CMakeLists.txt

Status makeFlowProgram(gpu::Device& device, const char* fragment, gpu::Program& out, const char* defines) {
  FOURDVT_ASSIGN(
      out, gpu::makeProgram(device, fragment, gpu::shaderText("fullscreen.vert"), flowShaderText(fragment), defines));
  return {};
}

Status makeFlowBuffer(gpu::Device& device, int width, int height, std::initializer_list<gpu::PixelFormat> formats,
                      FlowBuffer& out) {
  gpu::TargetDesc desc{.label = "flow"};
  for (gpu::PixelFormat format : formats) {
    FOURDVT_ASSIGN(
        out.textures[desc.colors.size()],
        gpu::makeTexture(
            device,
            {.format = format, .width = width, .height = height, .filter = gpu::Filter::Linear, .label = "flow"}));
    desc.colors.push_back(out[desc.colors.size()]);
  }
  FOURDVT_ASSIGN(out.target, gpu::makeTarget(device, desc));
  out.width = width;
  out.height = height;
  return {};
}

void runFlowPass(gpu::Device& device, gpu::ProgramId program, gpu::TargetId target,
                 std::initializer_list<gpu::TextureBinding> textures, std::initializer_list<gpu::Uniform> uniforms) {
  device.beginPass({.target = target, .label = "flow"});
  device.draw({.program = program, .textures = textures, .uniforms = uniforms, .vertex_count = 3});
  device.endPass();
}

Status FlowPictures::resize(gpu::Device& device, int width, int height) {
  if (!fill_) {
    FOURDVT_TRY(makeFlowProgram(device, "flow_luma.frag", luma_));
    FOURDVT_TRY(makeFlowProgram(device, "flow_fill.frag", fill_));
  }
  if (width == width_ && height == height_) return {};
  width_ = height_ = 0;
  const auto make = [&](gpu::Filter filter, gpu::Texture& texture, gpu::Target& target) -> Status {
    auto made = gpu::makeTexture(device, {.width = width, .height = height, .filter = filter, .label = "flow luma"});
    if (!made) return made.error();
    auto drawn = gpu::makeTarget(device, {.colors = {made.value().id()}, .label = "flow luma"});
    if (!drawn) return drawn.error();
    texture = made.take();
    target = drawn.take();
    return {};
  };
  FOURDVT_TRY(make(gpu::Filter::LinearMipmap, premultiplied_, premultiplied_target_));
  FOURDVT_TRY(make(gpu::Filter::Linear, filled_, filled_target_));
  width_ = width;
  height_ = height;
  return {};
}

Status FlowPictures::prepare(gpu::Device& device, gpu::TextureId a, gpu::TextureId b, int width, int height) {
  FOURDVT_TRY(resize(device, width, height));
  runFlowPass(device, luma_.id(), premultiplied_target_.id(), {{"u_a", a}, {"u_b", b}},
              {gpu::uniform("u_size", glm::vec2(width, height))});
  device.generateMipmaps(premultiplied_.id());
  runFlowPass(device, fill_.id(), filled_target_.id(), {{"u_luma", premultiplied_.id()}}, {});
  return {};
}

Status ShrunkPair::resize(gpu::Device& device, const FlowSize& pictures, const FlowSize& level, double scale) {
  const double sigma = (1 / scale - 1) / 2;
  const int side = std::max(static_cast<int>(std::lrint(sigma * 5)) | 1, 3) / 2;
  const double fall = sigma > 0 ? 1 / (2 * sigma * sigma) : std::log(2.0);  // at full size (1, 2, 1) / 4: sigma is 0
  blur_x_ = glm::vec3(double(pictures.width) / level.width, side, fall);
  blur_y_ = glm::vec3(double(pictures.height) / level.height, side, fall);
  FOURDVT_TRY(makeFlowBuffer(device, level.width, pictures.height, {gpu::PixelFormat::RG16F}, rows_));
  return makeFlowBuffer(device, level.width, level.height, {gpu::PixelFormat::RG16F}, luma_);
}

void ShrunkPair::draw(gpu::Device& device, const gpu::Program& shrink, gpu::TextureId pictures) const {
  const auto pass = [&](const FlowBuffer& to, gpu::TextureId from, int down, const glm::vec3& blur,
                        const glm::vec2& values) {
    runFlowPass(device, shrink.id(), to.target.id(), {{"u_from", from}},
                {gpu::uniform("u_down", down), gpu::uniform("u_blur", blur), gpu::uniform("u_values", values)});
  };
  pass(rows_, pictures, 0, blur_x_, {0.5f, 255.0f});
  pass(luma_, rows_[0], 1, blur_y_, {0.0f, 1.0f});
}

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
