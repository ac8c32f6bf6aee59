// SPDX-License-Identifier: Apache-2.0
#include "render/cameras/floating_star.h"

namespace fourdvt::render {
namespace {

// A round costs mostly what its finest patches cost, so the first round has coarser ones.
struct Round {
  FloatingFlow between;
  int octaves;        // its size against the view's
  int patch_octaves;  // its finest patches against those of flow at the view's size
};
constexpr Round kRounds[] = {
    {FloatingFlow::EarlyMean, 2, 1}, {FloatingFlow::EarlyMean, 2, 0}, {FloatingFlow::LastMean, 1, 0}};
constexpr const char* kPictureNames[] = {"u_picture_0", "u_picture_1", "u_picture_2", "u_picture_3"};
constexpr const char* kFlowNames[] = {"u_flow_0", "u_flow_1", "u_flow_2", "u_flow_3"};

}  // namespace

Status PictureBlend::draw(gpu::Device& device, const FloatingPictures& pictures, std::span<const gpu::TextureId> flows,
                          Warp warp, gpu::TargetId target) {
  std::string defines = "CAMERAS " + std::to_string(pictures.count()) + "\n";
  if (warp != Warp::None) defines += warp == Warp::Pairs ? "WARPED\nPAIRS\n" : "WARPED\n";
  gpu::Program& program = programs_[defines];
  if (!program) {
    FOURDVT_ASSIGN(program, makeCameraProgram(device, "camera_fullscreen.vert", "camera_floating_blend.frag", defines));
  }
  gpu::Draw draw{.program = program.id(), .textures = {{"u_weights", pictures.weights()}}, .vertex_count = 3};
  for (size_t i = 0; i < pictures.count(); ++i) {
    draw.textures.push_back({kPictureNames[i], pictures.picture(i)});
    if (warp != Warp::None) draw.textures.push_back({kFlowNames[i], flows[i]});
  }
  device.beginPass({.target = target, .label = "blend"});
  device.draw(draw);
  device.endPass();
  return {};
}

Result<FloatingStar> FloatingStar::create(gpu::Device& device) {
  FloatingStar out;
  for (const Round& round : kRounds) {
    FlowOptions options = floatingFlow(round.between, round.octaves);
    options.finest += round.patch_octaves;
    FOURDVT_ASSIGN(auto flow, createGpuFlow(device, options));
    out.rounds_.push_back(std::move(flow));
  }
  return out;
}

Status FloatingStar::update(gpu::Device& device, const FloatingPictures& pictures, PictureBlend& blend,
                            const PictureGroup& mean) {
  const int width = pictures.width(), height = pictures.height();
  flows_.resize(pictures.count());
  for (PictureGroup& flow : flows_)
    FOURDVT_TRY(resizeGroup(device, width, height, {gpu::PixelFormat::RG16F}, false, flow));
  for (size_t r = 0; r < rounds_.size(); ++r) {
    const PictureBlend::Warp warp = r > 0 ? PictureBlend::Warp::Star : PictureBlend::Warp::None;
    FOURDVT_TRY(blend.draw(device, pictures, flows(), warp, mean.target.id()));
    for (size_t i = 0; i < flows_.size(); ++i) {
      FOURDVT_TRY(rounds_[r]->compute(mean.textures[0].id(), pictures.picture(i), width >> kRounds[r].octaves,
                                      height >> kRounds[r].octaves));
      FOURDVT_TRY(sum_.draw(device, {.flow = rounds_[r]->flow(), .weights = pictures.weights(), .most = kMostFromMean},
                            flows_[i].target.id()));
    }
  }
  return {};
}

std::vector<gpu::TextureId> FloatingStar::flows() const {
  std::vector<gpu::TextureId> out;
  for (const PictureGroup& flow : flows_) out.push_back(flow.textures[0].id());
  return out;
}

}  // namespace fourdvt::render
