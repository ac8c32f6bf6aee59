// SPDX-License-Identifier: Apache-2.0
#include "render/cameras/floating_star.h"

namespace fourdvt::render {
namespace {

struct RoundOptions {
  FloatingFlow between;
  int octaves;        // its size against the view's
  int patch_octaves;  // its finest patches against those of flow at the view's size
};
constexpr RoundOptions kRounds[] = {{FloatingFlow::EarlyMean, 2, 1}, {FloatingFlow::LastMean, 1, 0}};
constexpr int kMeanOctaves = 1;  // the mean's size against the view's (ALGORITHMS 14.2)
constexpr const char* kPictureNames[] = {"u_picture_0", "u_picture_1", "u_picture_2", "u_picture_3"};
constexpr const char* kFlowNames[] = {"u_flow_0", "u_flow_1", "u_flow_2", "u_flow_3"};

}  // namespace

Status PictureBlend::draw(gpu::Device& device, const Sources& sources, Warp warp, const PictureGroup& target) {
  std::string defines = "CAMERAS " + std::to_string(sources.pictures.size()) + "\n";
  if (warp != Warp::None) defines += warp == Warp::Pairs ? "WARPED\nPAIRS\n" : "WARPED\n";
  gpu::Program& program = programs_[defines];
  if (!program) {
    FOURDVT_ASSIGN(program, makeCameraProgram(device, "camera_fullscreen.vert", "camera_floating_blend.frag", defines));
  }
  const glm::vec2 size(target.width, target.height);
  gpu::Draw draw{.program = program.id(),
                 .textures = {{"u_weights", sources.weights}},
                 .uniforms = {gpu::uniform("u_size", size)},
                 .vertex_count = 3};
  for (size_t i = 0; i < sources.pictures.size(); ++i) {
    draw.textures.push_back({kPictureNames[i], sources.pictures[i]});
    if (warp != Warp::None) draw.textures.push_back({kFlowNames[i], sources.flows[i]});
  }
  device.beginPass({.target = target.target.id(), .label = "blend"});
  device.draw(draw);
  device.endPass();
  return {};
}

Result<FloatingStar> FloatingStar::create(gpu::Device& device) {
  FloatingStar out;
  for (const RoundOptions& round : kRounds) {
    FlowOptions options = floatingFlow(round.between, round.octaves);
    options.finest += round.patch_octaves;
    FOURDVT_ASSIGN(auto flow, createGpuFlow(device, options));
    out.rounds_.push_back({std::move(flow), {}});
  }
  return out;
}

Status FloatingStar::update(gpu::Device& device, const FloatingPictures& pictures, PictureBlend& blend) {
  const std::vector<gpu::TextureId> shown = pictures.all();
  const glm::ivec2 size(pictures.width(), pictures.height());
  FOURDVT_TRY(
      resizeGroup(device, size.x >> kMeanOctaves, size.y >> kMeanOctaves, {gpu::PixelFormat::RGBA8}, false, mean_));
  std::vector<gpu::TextureId> flows;
  for (size_t r = 0; r < rounds_.size(); ++r) {
    Round& round = rounds_[r];
    FOURDVT_TRY(blend.draw(device, {pictures.weights(), shown, flows},
                           r > 0 ? PictureBlend::Warp::Star : PictureBlend::Warp::None, mean_));
    const glm::ivec2 round_size = size >> kRounds[r].octaves;
    round.flows.resize(shown.size());
    for (size_t i = 0; i < shown.size(); ++i) {
      FOURDVT_TRY(resizeGroup(device, round_size.x, round_size.y, {gpu::PixelFormat::RG16F}, false, round.flows[i]));
      FOURDVT_TRY(round.source->compute(mean_.textures[0].id(), shown[i], round_size.x, round_size.y));
      FOURDVT_TRY(sum_.draw(device,
                            {.flow = round.source->flow(),
                             .weights = pictures.weights(),
                             .most = kMostFromMean,
                             .scale = glm::vec2(size) / glm::vec2(round_size)},
                            round.flows[i].target.id()));
    }
    flows = texturesOf(round.flows);
  }
  return {};
}

std::vector<gpu::TextureId> FloatingStar::texturesOf(const std::vector<PictureGroup>& groups) {
  std::vector<gpu::TextureId> out;
  for (const PictureGroup& group : groups) out.push_back(group.textures[0].id());
  return out;
}

}  // namespace fourdvt::render
