// SPDX-License-Identifier: Apache-2.0
#include "render/flow/pictures.h"

#include <algorithm>
#include <cmath>

namespace fourdvt::render {

std::string_view flowShaderText(std::string_view name);  // the embedded flow_*; see CMakeLists.txt

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
  const double fall = sigma > 0 ? 1 / (2 * sigma * sigma) : std::log(2.0);  // at full size (1, 2, 1) / 4
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

}  // namespace fourdvt::render
