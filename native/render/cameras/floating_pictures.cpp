// SPDX-License-Identifier: Apache-2.0
#include "render/cameras/floating_pictures.h"

#include <algorithm>

namespace fourdvt::render {
namespace {

using gpu::PixelFormat;

// Returns the centre of the next-nearest camera to the view outside the chosen ones; w 0: none.
glm::vec4 nextCentre(const CameraLook& look, const CharacterView& view, const std::vector<size_t>& chosen) {
  for (size_t c : camerasTowards(look.cameras, viewAxis(view.clip_from_character), 0))
    if (look.sources[c].source.z > 0 && std::find(chosen.begin(), chosen.end(), c) == chosen.end())
      return glm::vec4(glm::vec3(look.cameras[c].centreInWorld()), 1);
  return glm::vec4(0);
}

Status drawFullscreen(gpu::Device& device, const gpu::Program& program, gpu::TargetId target,
                      std::vector<gpu::TextureBinding> textures, std::vector<gpu::Uniform> uniforms) {
  device.beginPass({.target = target, .label = "floating textures"});
  device.draw(
      {.program = program.id(), .textures = std::move(textures), .uniforms = std::move(uniforms), .vertex_count = 3});
  device.endPass();
  return {};
}

}  // namespace

Status resizeGroup(gpu::Device& device, int width, int height, const std::vector<PixelFormat>& formats, bool has_depth,
                   PictureGroup& out) {
  if (out.width == width && out.height == height && out.textures.size() == formats.size()) return {};
  out = {};
  gpu::TargetDesc desc{.own_depth = has_depth, .label = "floating textures"};
  for (PixelFormat format : formats) {
    FOURDVT_ASSIGN(gpu::Texture texture, gpu::makeTexture(device, {.format = format,
                                                                   .width = width,
                                                                   .height = height,
                                                                   .filter = gpu::Filter::Linear,
                                                                   .label = "floating textures"}));
    desc.colors.push_back(texture.id());
    out.textures.push_back(std::move(texture));
  }
  FOURDVT_ASSIGN(out.target, gpu::makeTarget(device, desc));
  out.width = width;
  out.height = height;
  return {};
}

Status SoftVisibility::update(gpu::Device& device, gpu::TextureId hidden, gpu::TextureId weights, int width, int height,
                              float radius_px) {
  if (!across_program_) {
    FOURDVT_ASSIGN(across_program_, makeCameraProgram(device, "camera_fullscreen.vert", "camera_soft_across.frag"));
    FOURDVT_ASSIGN(down_program_, makeCameraProgram(device, "camera_fullscreen.vert", "camera_soft_down.frag"));
  }
  FOURDVT_TRY(resizeGroup(device, width, height, {PixelFormat::RGBA8}, false, across_));
  FOURDVT_TRY(resizeGroup(device, width, height, {PixelFormat::RGBA16F}, false, soft_));
  const float radius = std::clamp(radius_px, 1.0f, kMaxRadius_px);
  FOURDVT_TRY(drawFullscreen(device, across_program_, across_.target.id(), {{"u_hidden", hidden}},
                             {gpu::uniform("u_radius", radius)}));
  return drawFullscreen(device, down_program_, soft_.target.id(),
                        {{"u_across", across_.textures[0].id()}, {"u_weights", weights}},
                        {gpu::uniform("u_radius", radius)});
}

FlowOptions floatingFlow(FloatingFlow between, int octaves) {
  const double sure_picture_px = between == FloatingFlow::EarlyMean ? 6 : between == FloatingFlow::KeptPictures ? 2 : 0;
  FlowOptions options;
  options.method = FlowMethod::Dis;
  options.finest -= octaves;
  options.must_explain = between == FloatingFlow::LastMean ? 0.08 : 0.25;
  options.sure_px = sure_picture_px / (1 << octaves);
  return options;
}

Status FlowSum::draw(gpu::Device& device, const Term& term, gpu::TargetId target) {
  if (!program_) {
    FOURDVT_ASSIGN(program_, makeCameraProgram(device, "camera_fullscreen.vert", "camera_floating_add.frag"));
  }
  const float keeps = term.before ? 1 : 0;
  return drawFullscreen(
      device, program_, target,
      {{"u_before", term.before ? term.before : term.flow}, {"u_flow", term.flow}, {"u_weights", term.weights}},
      {gpu::uniform("u_camera", term.rank), gpu::uniform("u_keeps", keeps), gpu::uniform("u_scale", term.scale),
       gpu::uniform("u_most", term.most)});
}

Status FloatingPictures::drawSight(gpu::Device& device, const CharacterModel& model, const CameraLook& look,
                                   const CharacterView& view, const MethodOptions& options,
                                   const FigureCameras& cameras) {
  gpu::Program& program = sight_programs_[cameras.defines(look, options)];
  if (!program) {
    FOURDVT_ASSIGN(program, makeCameraProgram(device, "camera_surface.vert", "camera_floating_sight.frag",
                                              cameras.defines(look, options)));
  }
  const CameraUniforms uniforms = cameras.uniforms(look, options);
  const glm::vec4 next = nextCentre(look, view, cameras.chosen());
  gpu::Draw draw = surfaceDraw(model, program.id());
  uniforms.addTo(draw);
  cameras.addTo(draw, view, options);
  draw.uniforms.push_back(gpu::uniform("u_next", next));
  device.beginPass({.target = sight_.target.id(), .clear_color = true, .clear_depth = true, .label = "sight"});
  device.draw(draw);
  device.endPass();
  return {};
}

Status FloatingPictures::updateWeights(gpu::Device& device, const CharacterModel& model, const CameraLook& look,
                                       const CharacterView& view, const MethodOptions& options,
                                       const FigureCameras& cameras) {
  FOURDVT_TRY(resizeGroup(device, view.width, view.height, {PixelFormat::RGBA8, PixelFormat::RGBA16F}, true, sight_));
  FOURDVT_TRY(drawSight(device, model, look, view, options, cameras));
  return soft_.update(device, sight_.textures[0].id(), sight_.textures[1].id(), view.width, view.height,
                      options.floating.radius_px);
}

Status FloatingPictures::update(gpu::Device& device, const CharacterModel& model, const CameraLook& look,
                                const CharacterView& view, const MethodOptions& options, const FigureCameras& cameras) {
  FOURDVT_TRY(updateWeights(device, model, look, view, options, cameras));
  FOURDVT_TRY(resizeGroup(device, view.width, view.height,
                          std::vector<PixelFormat>(cameras.chosen().size(), PixelFormat::RGBA8), true, pictures_));
  gpu::Program& program = project_programs_[cameras.defines(look, options)];
  if (!program) {
    FOURDVT_ASSIGN(program, makeCameraProgram(device, "camera_surface.vert", "camera_floating_project.frag",
                                              cameras.defines(look, options)));
  }
  const CameraUniforms uniforms = cameras.uniforms(look, options);
  gpu::Draw draw = surfaceDraw(model, program.id());
  uniforms.addTo(draw);
  cameras.addTo(draw, view, options);
  draw.textures.push_back({"u_weights", soft_.texture()});
  device.beginPass({.target = pictures_.target.id(), .clear_color = true, .clear_depth = true, .label = "project"});
  device.draw(draw);
  device.endPass();
  return {};
}

std::vector<gpu::TextureId> FloatingPictures::all() const {
  std::vector<gpu::TextureId> out;
  for (const gpu::Texture& picture : pictures_.textures) out.push_back(picture.id());
  return out;
}

namespace {

struct RoundOptions {
  FloatingFlow between;
  int octaves;        // octaves below the view's size
  int patch_octaves;  // added to FlowOptions::finest of flow at the view's size
};
constexpr RoundOptions kRounds[] = {{FloatingFlow::EarlyMean, 2, 1}, {FloatingFlow::LastMean, 1, 0}};
constexpr int kMeanOctaves = 1;  // octaves of the mean below the view's size (algorithms/floating.md)
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

Result<MeanFlows> MeanFlows::create(gpu::Device& device) {
  MeanFlows out;
  for (const RoundOptions& round : kRounds) {
    FlowOptions options = floatingFlow(round.between, round.octaves);
    options.finest += round.patch_octaves;
    FOURDVT_ASSIGN(auto flow, createGpuFlow(device, options));
    out.rounds_.push_back({std::move(flow), {}});
  }
  return out;
}

Status MeanFlows::update(gpu::Device& device, const FloatingPictures& pictures, PictureBlend& blend) {
  const std::vector<gpu::TextureId> shown = pictures.all();
  const glm::ivec2 size(pictures.width(), pictures.height());
  FOURDVT_TRY(
      resizeGroup(device, size.x >> kMeanOctaves, size.y >> kMeanOctaves, {gpu::PixelFormat::RGBA8}, false, mean_));
  std::vector<gpu::TextureId> flows;
  for (size_t r = 0; r < rounds_.size(); ++r) {
    Round& round = rounds_[r];
    FOURDVT_TRY(blend.draw(device, {pictures.weights(), shown, flows},
                           r > 0 ? PictureBlend::Warp::Mean : PictureBlend::Warp::None, mean_));
    const glm::ivec2 round_size = size >> kRounds[r].octaves;
    round.flows.resize(shown.size());
    for (size_t i = 0; i < shown.size(); ++i) {
      FOURDVT_TRY(resizeGroup(device, round_size.x, round_size.y, {gpu::PixelFormat::RG16F}, false, round.flows[i]));
      FOURDVT_TRY(round.source->compute(mean_.textures[0].id(), shown[i], round_size.x, round_size.y));
      FOURDVT_TRY(sum_.draw(device,
                            {.flow = round.source->flow(),
                             .weights = pictures.weights(),
                             .most = kMaxFromMean,
                             .scale = glm::vec2(size) / glm::vec2(round_size)},
                            round.flows[i].target.id()));
    }
    flows = texturesOf(round.flows);
  }
  return {};
}

std::vector<gpu::TextureId> MeanFlows::texturesOf(const std::vector<PictureGroup>& groups) {
  std::vector<gpu::TextureId> out;
  for (const PictureGroup& group : groups) out.push_back(group.textures[0].id());
  return out;
}

}  // namespace fourdvt::render
