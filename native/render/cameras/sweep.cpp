// SPDX-License-Identifier: Apache-2.0
#include "render/cameras/sweep.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace fourdvt::render {
namespace {

constexpr int kShrink = 2;                        // factor from the sweep's size to the view's
constexpr int kSupportRadius = 2;                 // pixels of the sweep
constexpr int kPathLength = 6;                    // pixels of the sweep
constexpr glm::vec3 kPrices(0.02f, 0.1f, 0.05f);  // cost weights of camera_sweep_choose.frag

glm::mat4 characterFromClip(const CharacterView& view) {
  return glm::mat4(glm::inverse(glm::dmat4(view.clip_from_character)));
}

template <class Figure>
void addSurface(const Figure& figure, const glm::mat4& character_from_clip, gpu::Draw& draw) {
  draw.textures.push_back({"u_normals", figure.normals.texture.id()});
  draw.textures.push_back({"u_depths", figure.depths.id()});
  draw.uniforms.push_back(gpu::uniform("u_character_from_clip", character_from_clip));
  draw.uniforms.push_back(gpu::uniform("u_length_scale", figure.length_scale));
}

void runPass(gpu::Device& device, gpu::Draw& draw, gpu::TargetId target, const char* label) {
  draw.vertex_count = 3;
  device.beginPass({.target = target, .label = label});
  device.draw(draw);
  device.endPass();
}

}  // namespace

Status Sweep::prepare(gpu::Device& device, size_t number, const CharacterModel& model, const CameraLook& look,
                      const CharacterView& view, const MethodOptions& options) {
  SweepOptions sweep = options.sweep;
  if (model.sweep_band_m > 0) sweep.band_m = model.sweep_band_m;
  if (sweep.planes < kPlanesPerBlock || sweep.planes > kMaxPlanes || sweep.planes % kPlanesPerBlock ||
      !(sweep.band_m > 0))
    return Error{ErrorId::InvalidArgument, "a sweep has 4 to 32 planes, in steps of 4, and a band"};
  while (figures_.size() <= number) figures_.emplace_back();
  SweptFigure& figure = figures_[number];
  FOURDVT_TRY(figure.cameras.prepare(device, model, look, view, options));
  FOURDVT_TRY(resize(device, (view.width + kShrink - 1) / kShrink, (view.height + kShrink - 1) / kShrink,
                     sweep.planes / kPlanesPerBlock, figure));
  const Job job{look, view, options, characterFromClip(view), figure.cameras.defines(look, options)};
  FOURDVT_TRY(makePrograms(device, job.defines, sweep.planes));
  Cause cause{
      model.geometry_serial, look.serial,  view.clip_from_character, view.width,         view.height,
      sweep.planes,          sweep.band_m, options.min_cosine,       options.visibility, figure.cameras.chosen()};
  if (figure.cause == cause) return {};
  figure.cause = std::move(cause);
  drawSurface(device, model, view, figure);
  figure.length_scale = model.length_scale;
  const glm::vec2 band_m = model.length_scale * glm::vec2(-std::min(sweep.band_m, kBefore_m), sweep.band_m);
  figure.reach_m = band_m.y;
  drawCosts(device, job, figure, band_m);
  drawSupport(device, job, figure);
  drawShifts(device, job, figure, band_m);
  return {};
}

void Sweep::draw(gpu::Device& device, size_t number, const CharacterModel& model, const CameraLook& look,
                 const CharacterView& view, const MethodOptions& options) const {
  const SweptFigure& figure = figures_[number];
  const CameraUniforms cameras = figure.cameras.uniforms(look, options);
  const glm::mat4 character_from_clip = characterFromClip(view);
  const float texels = 1.0f / kShrink;
  gpu::Draw draw = surfaceDraw(model, programs_.at("blend " + figure.cameras.defines(look, options)).id());
  cameras.addTo(draw);
  figure.cameras.addTo(draw, view, options);
  addSurface(figure, character_from_clip, draw);
  draw.textures.push_back({"u_shifts", figure.shifts.texture.id()});
  draw.uniforms.push_back(gpu::uniform("u_reach_m", figure.reach_m));
  draw.uniforms.push_back(gpu::uniform("u_texels", texels));
  draw.uniforms.push_back(gpu::uniform("u_origin", view.origin));
  device.draw(draw);
}

Result<std::vector<float>> Sweep::readShifts(gpu::Device& device, size_t number) const {
  const SweptFigure& figure = figures_[number];
  const ViewPicture& shifts = figure.shifts;
  std::vector<uint8_t> texels(size_t(shifts.width) * size_t(shifts.height) * 4);
  FOURDVT_TRY(device.readPixels(shifts.target.id(), gpu::PixelFormat::RGBA8,
                                {.width = shifts.width, .height = shifts.height}, texels.data()));
  std::vector<float> out;
  for (size_t i = 0; i < texels.size(); i += 4) {
    const float steps = 256.0f * texels[i] + texels[i + 1];
    out.push_back(texels[i + 3] ? figure.reach_m * (2 * steps / 65535 - 1) : std::numeric_limits<float>::quiet_NaN());
  }
  return out;
}

Status Sweep::resize(gpu::Device& device, int width, int height, int blocks, SweptFigure& figure) {
  if (figure.normals.width != width || figure.normals.height != height) {
    figure.normals = {};
    FOURDVT_ASSIGN(
        figure.depths,
        gpu::makeTexture(
            device, {.format = gpu::PixelFormat::Depth24, .width = width, .height = height, .label = "sweep: depths"}));
  }
  FOURDVT_TRY(
      resizeViewPicture(device, width, height, {.label = "sweep: normals"}, figure.depths.id(), figure.normals));
  FOURDVT_TRY(resizeViewPicture(device, width, height, {.label = "sweep: shifts"}, 0, figure.shifts));
  if (width == width_ && height == height_ && blocks == blocks_) return {};
  width_ = height_ = blocks_ = 0;
  for (Costs& costs : costs_) {
    costs = {};
    FOURDVT_ASSIGN(
        costs.texture,
        gpu::makeTexture(device, {.width = width, .height = height, .layers = blocks, .label = "sweep: costs"}));
    for (int b = 0; b < blocks; ++b) {
      costs.targets.emplace_back();
      FOURDVT_ASSIGN(
          costs.targets.back(),
          gpu::makeTarget(device, {.colors = {costs.texture.id()}, .color_layer = b, .label = "sweep: costs"}));
    }
  }
  width_ = width, height_ = height, blocks_ = blocks;
  return {};
}

Status Sweep::makePrograms(gpu::Device& device, const std::string& defines, int planes) {
  const std::string blocks = "BLOCKS " + std::to_string(planes / kPlanesPerBlock) + "\n";
  FOURDVT_TRY(make(device, "surface ", "camera_surface.vert", "camera_sweep_surface.frag", ""));
  FOURDVT_TRY(make(device, "support ", "camera_fullscreen.vert", "camera_sweep_support.frag", ""));
  FOURDVT_TRY(make(device, "costs ", "camera_fullscreen.vert", "camera_sweep_costs.frag", defines));
  FOURDVT_TRY(make(device, "choose ", "camera_fullscreen.vert", "camera_sweep_choose.frag", blocks));
  return make(device, "blend ", "camera_surface.vert", "camera_sweep_blend.frag", defines);
}

Status Sweep::make(gpu::Device& device, const std::string& name, const char* vertex, const char* fragment,
                   const std::string& defines) {
  gpu::Program& program = programs_[name + defines];
  if (program) return {};
  FOURDVT_ASSIGN(program, makeCameraProgram(device, vertex, fragment, defines));
  return {};
}

void Sweep::drawSurface(gpu::Device& device, const CharacterModel& model, const CharacterView& view,
                        const SweptFigure& figure) const {
  device.beginPass(
      {.target = figure.normals.target.id(), .clear_color = true, .clear_depth = true, .label = "sweep: surface"});
  gpu::Draw draw = surfaceDraw(model, programs_.at("surface ").id());
  draw.uniforms = {gpu::uniform("u_clip_from_character", view.clip_from_character)};
  device.draw(draw);
  device.endPass();
}

void Sweep::drawCosts(gpu::Device& device, const Job& job, const SweptFigure& figure, const glm::vec2& band_m) {
  const CameraUniforms cameras = figure.cameras.uniforms(job.look, job.options);
  const int planes = blocks_ * kPlanesPerBlock;
  for (int b = 0; b < blocks_; ++b) {
    glm::vec4 offsets;
    for (int k = 0; k < kPlanesPerBlock; ++k)
      offsets[k] = glm::mix(band_m.x, band_m.y, float(kPlanesPerBlock * b + k) / float(planes - 1));
    gpu::Draw draw;
    draw.program = programs_.at("costs " + job.defines).id();
    cameras.addTo(draw);
    addSurface(figure, job.character_from_clip, draw);
    draw.uniforms.push_back(gpu::uniform("u_eye", job.view.eye_in_character));
    draw.uniforms.push_back(gpu::uniform("u_offsets", offsets));
    runPass(device, draw, costs_[0].targets[size_t(b)].id(), "sweep: costs");
  }
}

// Blurs from [0] across to [1] and down to [0] again.
void Sweep::drawSupport(gpu::Device& device, const Job& job, const SweptFigure& figure) {
  for (int down = 0; down < 2; ++down)
    for (int b = 0; b < blocks_; ++b) {
      const glm::vec2 step(1 - down, down);
      gpu::Draw draw;
      draw.program = programs_.at("support ").id();
      addSurface(figure, job.character_from_clip, draw);
      draw.textures.push_back({"u_costs", costs_[down].texture.id()});
      draw.uniforms.push_back(gpu::uniform("u_block", b));
      draw.uniforms.push_back(gpu::uniform("u_step", step));
      draw.uniforms.push_back(gpu::uniform("u_radius", kSupportRadius));
      runPass(device, draw, costs_[1 - down].targets[size_t(b)].id(), "sweep: support");
    }
}

void Sweep::drawShifts(gpu::Device& device, const Job& job, const SweptFigure& figure, const glm::vec2& band_m) {
  gpu::Draw draw;
  draw.program = programs_.at("choose BLOCKS " + std::to_string(blocks_) + "\n").id();
  addSurface(figure, job.character_from_clip, draw);
  draw.textures.push_back({"u_costs", costs_[0].texture.id()});
  draw.uniforms.push_back(gpu::uniform("u_length", kPathLength));
  draw.uniforms.push_back(gpu::uniform("u_prices", kPrices));
  draw.uniforms.push_back(gpu::uniform("u_band", band_m));
  draw.uniforms.push_back(gpu::uniform("u_reach_m", figure.reach_m));
  runPass(device, draw, figure.shifts.target.id(), "sweep: shifts");
}

}  // namespace fourdvt::render
