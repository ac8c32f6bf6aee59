// SPDX-License-Identifier: Apache-2.0
#include "render/cameras/floating.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/cameras/floating_pictures.h"
#include "render/cameras/surface_picture.h"
#include "render/flow/flow.h"

namespace fourdvt::render {
namespace {

using gpu::PixelFormat;
constexpr int kMinSide = 64;  // pixels of a view's side; a quarter of less is too small for flow

class Floating final : public Method {
 public:
  explicit Floating(FloatingForm form) : form_(form) {}
  Status create(gpu::Device& device) {
    if (form_ == FloatingForm::Mean) {
      FOURDVT_ASSIGN(mean_, MeanFlows::create(device));
    } else if (form_ == FloatingForm::Pairs) {
      FOURDVT_ASSIGN(pairs_, createGpuFlow(device, floatingFlow(FloatingFlow::Pictures, 0)));
    }
    return {};
  }

  Status prepare(gpu::Device& device, size_t number, const CharacterModel& model, const CameraLook& look,
                 const CharacterView& view, const MethodOptions& options) override {
    while (figures_.size() <= number) figures_.emplace_back();
    Figure& figure = figures_[number];
    FOURDVT_TRY(surface_.prepare(device));
    FOURDVT_TRY(figure.cameras.prepare(device, model, look, view, options, FloatingPictures::kMax));
    FOURDVT_TRY(pictures_.update(device, model, look, view, options, figure.cameras));
    FOURDVT_TRY(resizeGroup(device, view.width, view.height, {PixelFormat::RGBA8}, false, figure.shown));
    using Warp = PictureBlend::Warp;
    if (form_ == FloatingForm::Linear || pictures_.count() == 1 || std::min(view.width, view.height) < kMinSide)
      return blend_.draw(device, {pictures_.weights(), pictures_.all()}, Warp::None, figure.shown);
    const bool to_mean = form_ == FloatingForm::Mean;
    FOURDVT_TRY(to_mean ? mean_.update(device, pictures_, blend_) : floatPairs(device));
    return blend_.draw(device, {pictures_.weights(), pictures_.all(), to_mean ? mean_.flows() : pairFlows()},
                       to_mean ? Warp::Mean : Warp::Pairs, figure.shown);
  }

  void draw(gpu::Device& device, size_t number, const CharacterModel& model, const CameraLook& look,
            const CharacterView& view, const MethodOptions& options) const override {
    surface_.draw(device, model, view, figures_[number].shown.textures[0].id());
  }

 private:
  struct Figure {
    FigureCameras cameras;
    PictureGroup shown;
  };

  std::vector<gpu::TextureId> pairFlows() const {
    std::vector<gpu::TextureId> out;
    for (size_t i = 0; i < pictures_.count(); ++i) out.push_back(flows_[i].textures[0].id());
    return out;
  }

  Status floatPairs(gpu::Device& device) {
    const size_t n = pictures_.count();
    for (size_t i = 0; i <= kScratch; ++i)
      if (i < n || i == kScratch)
        FOURDVT_TRY(resizeGroup(device, pictures_.width(), pictures_.height(), {PixelFormat::RG16F}, false, flows_[i]));
    for (size_t i = 0; i < n; ++i) {
      // Sums ping-pong so that the last one lands in the picture's own buffer.
      const PictureGroup* to = (n - 1) % 2 == 1 ? &flows_[i] : &flows_[kScratch];
      gpu::TextureId before = 0;
      for (size_t j = 0; j < n; ++j) {
        if (j == i) continue;
        FOURDVT_TRY(pairs_->compute(pictures_.picture(i), pictures_.picture(j), flows_[0].width, flows_[0].height));
        FOURDVT_TRY(sum_.draw(device, {pairs_->flow(), pictures_.weights(), int(j), before, kMaxBetweenPictures},
                              to->target.id()));
        before = to->textures[0].id();
        to = to == &flows_[i] ? &flows_[kScratch] : &flows_[i];
      }
    }
    return {};
  }

  static constexpr size_t kScratch = FloatingPictures::kMax;
  const FloatingForm form_;
  MeanFlows mean_;                     // mean form
  std::unique_ptr<FlowSource> pairs_;  // pair form
  std::vector<Figure> figures_;        // indexed by figure
  FloatingPictures pictures_;
  PictureGroup flows_[FloatingPictures::kMax + 1];  // by rank, for pairs, and scratch
  FlowSum sum_;
  PictureBlend blend_;
  SurfacePicture surface_;
};

}  // namespace

Result<std::unique_ptr<Method>> makeFloating(gpu::Device& device, FloatingForm form) {
  auto out = std::make_unique<Floating>(form);
  FOURDVT_TRY(out->create(device));
  return std::unique_ptr<Method>(std::move(out));
}

namespace {

constexpr int kMax = FloatingPictures::kMax;
constexpr int kLongestSide = 1024;  // maximum texels of a flow field's side
constexpr int kSideStep = 64;       // multiple of sizes, against changes from frame to frame
constexpr int kOctaves = 1;         // flow is computed at half size

// Flow fields of one figure: a layer for every ordered pair of cameras in use.
struct PairFlows {
  struct Pair {
    size_t from = 0, to = 0;  // cameras
    bool known = false;
  };
  gpu::Texture texture;  // RG16F array
  std::vector<gpu::Target> targets;
  std::vector<Pair> pairs;  // indexed by layer
  int width = 0, height = 0;
  double texels_per_pixel = 1;
  std::vector<glm::vec4> places;  // by camera: picture region of its layers, pixels
  uint64_t geometry = 0, picture = 0;
  MethodOptions options;  // options of the pictures compared by the flow

  int layerOf(size_t from, size_t to) const {
    for (size_t l = 0; l < pairs.size(); ++l)
      if (pairs[l].known && pairs[l].from == from && pairs[l].to == to) return static_cast<int>(l);
    return -1;
  }
};

bool showsAlike(const MethodOptions& a, const MethodOptions& b) {
  return a.visibility == b.visibility && a.unseen == b.unseen && a.min_cosine == b.min_cosine &&
         a.floating.radius_px == b.floating.radius_px;
}

class FloatingStatic final : public Method {
 public:
  explicit FloatingStatic(std::unique_ptr<FlowSource> flow) : flow_(std::move(flow)) {}

  Status prepare(gpu::Device& device, size_t number, const CharacterModel& model, const CameraLook& look,
                 const CharacterView& view, const MethodOptions& options) override {
    while (figures_.size() <= number) figures_.push_back(std::make_unique<Figure>());
    Figure& figure = *figures_[number];
    FOURDVT_TRY(figure.cameras.prepare(device, model, look, view, options, kMax));
    FOURDVT_TRY(resize(device, model, look, options, figure));
    FOURDVT_TRY(computeMissing(device, model, look, options, figure));
    const std::string defines = figure.cameras.defines(look, options);
    gpu::Program& program = programs_[defines];
    if (!program) {
      FOURDVT_ASSIGN(program, makeCameraProgram(device, "camera_surface.vert", "camera_floating_lookup.frag", defines));
    }
    return figure.seen.updateWeights(device, model, look, view, options, figure.cameras);
  }

  void draw(gpu::Device& device, size_t number, const CharacterModel& model, const CameraLook& look,
            const CharacterView& view, const MethodOptions& options) const override {
    const Figure& figure = *figures_[number];
    const std::vector<size_t>& chosen = figure.cameras.chosen();
    std::vector<glm::vec4> places, layers;
    for (size_t from : chosen) {
      places.push_back(figure.flows.places[from]);
      layers.emplace_back(0);
      for (size_t j = 0; j < chosen.size(); ++j)
        if (chosen[j] != from) layers.back()[int(j)] = float(figure.flows.layerOf(from, chosen[j]));
    }
    gpu::Draw draw = surfaceDraw(model, programs_.at(figure.cameras.defines(look, options)).id());
    const CameraUniforms uniforms = figure.cameras.uniforms(look, options);
    uniforms.addTo(draw);
    figure.cameras.addTo(draw, view, options);
    draw.textures.push_back({"u_weights", figure.seen.weights()});
    draw.textures.push_back({"u_flows", figure.flows.texture.id()});
    draw.uniforms.push_back(gpu::uniform("u_most", kMaxBetweenPictures));
    draw.uniforms.push_back(gpu::uniform("u_places", std::span<const glm::vec4>(places)));
    draw.uniforms.push_back(gpu::uniform("u_layers", std::span<const glm::vec4>(layers)));
    device.draw(draw);
  }

 private:
  struct Figure {
    FigureCameras cameras;
    PairFlows flows;
    FloatingPictures seen;  // blend weights of the view
  };

  // Makes fields of equal size and scale; each camera's shows the box of the surface.
  static Status resize(gpu::Device& device, const CharacterModel& model, const CameraLook& look,
                       const MethodOptions& options, Figure& figure) {
    PairFlows& flows = figure.flows;
    const size_t n = figure.cameras.chosen().size(), layers = std::max<size_t>(n * (n - 1), 1);
    if (flows.geometry == model.geometry_serial && flows.picture == look.serial && flows.pairs.size() >= layers &&
        showsAlike(flows.options, options))
      return {};
    flows.options = options;
    flows.geometry = model.geometry_serial;
    flows.picture = look.serial;
    for (PairFlows::Pair& pair : flows.pairs) pair.known = false;
    Positions corners;
    const BoundingBox& box = model.frame_bounds;
    for (int i = 0; i < 8; ++i)
      corners.emplace_back(i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y, i & 4 ? box.max.z : box.min.z);
    glm::dvec2 size_px(1);
    flows.places.clear();
    for (const PinholeCamera& camera : look.cameras) {
      const PictureRegion region = regionOf(camera, corners);
      flows.places.emplace_back(region.x, region.y, 0, 0);
      size_px = glm::max(size_px, glm::dvec2(region.width, region.height));
    }
    flows.texels_per_pixel = std::min(1.0, kLongestSide / std::max(size_px.x, size_px.y));
    const auto texels = [&](double pixels) {
      return int(std::ceil(pixels * flows.texels_per_pixel / kSideStep)) * kSideStep;
    };
    const int width = texels(size_px.x), height = texels(size_px.y);
    for (glm::vec4& place : flows.places) {
      place.z = float(width / flows.texels_per_pixel);
      place.w = float(height / flows.texels_per_pixel);
    }
    if (width == flows.width && height == flows.height && flows.pairs.size() >= layers) return {};
    flows.targets.clear();
    flows.pairs.assign(layers, {});
    flows.width = width;
    flows.height = height;
    FOURDVT_ASSIGN(flows.texture, gpu::makeTexture(device, {.format = gpu::PixelFormat::RG16F,
                                                            .width = width,
                                                            .height = height,
                                                            .layers = static_cast<int>(layers),
                                                            .filter = gpu::Filter::Linear,
                                                            .label = "flow between cameras"}));
    for (size_t l = 0; l < layers; ++l) {
      FOURDVT_ASSIGN(gpu::Target target, gpu::makeTarget(device, {.colors = {flows.texture.id()},
                                                                  .color_layer = static_cast<int>(l),
                                                                  .label = "flow between cameras"}));
      flows.targets.push_back(std::move(target));
    }
    return {};
  }

  Status computeMissing(gpu::Device& device, const CharacterModel& model, const CameraLook& look,
                        const MethodOptions& options, Figure& figure) {
    const std::vector<size_t>& chosen = figure.cameras.chosen();
    PairFlows& flows = figure.flows;
    const auto is_used = [&](size_t c) { return std::find(chosen.begin(), chosen.end(), c) != chosen.end(); };
    for (PairFlows::Pair& pair : flows.pairs) pair.known = pair.known && is_used(pair.from) && is_used(pair.to);
    for (size_t i = 0; i < chosen.size(); ++i) {
      bool has_pictures = false;
      for (size_t j = 0; j < chosen.size(); ++j) {
        if (i == j || flows.layerOf(chosen[i], chosen[j]) >= 0) continue;
        if (!has_pictures)
          FOURDVT_TRY(pictures_.update(device, model, look, viewOf(look, flows, chosen[i]), options, figure.cameras));
        has_pictures = true;
        FOURDVT_TRY(flow_->compute(pictures_.picture(i), pictures_.picture(j), flows.width >> kOctaves,
                                   flows.height >> kOctaves));
        const size_t layer = static_cast<size_t>(
            std::find_if(flows.pairs.begin(), flows.pairs.end(), [](const auto& p) { return !p.known; }) -
            flows.pairs.begin());
        // Flow height in heights of the camera picture: the field covers the performer only and varies with the pose.
        const double camera_heights = look.cameras[chosen[i]].height * flows.texels_per_pixel / flows.height;
        FOURDVT_TRY(add_.draw(device,
                              {.flow = flow_->flow(),
                               .weights = pictures_.weights(),
                               .most = static_cast<float>(kMaxBetweenPictures * camera_heights)},
                              flows.targets[layer].id()));
        flows.pairs[layer] = {chosen[i], chosen[j], true};
      }
    }
    return {};
  }

  static CharacterView viewOf(const CameraLook& look, const PairFlows& flows, size_t camera) {
    PinholeCamera crop = look.cameras[camera];
    const double scale = flows.texels_per_pixel;
    crop.fx *= scale;
    crop.fy *= scale;
    crop.cx = (crop.cx - flows.places[camera].x) * scale;
    crop.cy = (crop.cy - flows.places[camera].y) * scale;
    crop.width = flows.width;
    crop.height = flows.height;
    const View view = viewFromCamera(crop);
    return {view.clip_from_world, view.eye_in_world, view.width, view.height};
  }

  std::unique_ptr<FlowSource> flow_;
  std::vector<std::unique_ptr<Figure>> figures_;  // indexed by figure
  FloatingPictures pictures_;                     // pictures in a camera's view
  FlowSum add_;
  std::map<std::string, gpu::Program> programs_;  // keyed by defines
};

}  // namespace

Result<std::unique_ptr<Method>> makeFloatingStatic(gpu::Device& device) {
  FOURDVT_ASSIGN(auto flow, createGpuFlow(device, floatingFlow(FloatingFlow::KeptPictures, kOctaves)));
  return std::unique_ptr<Method>(std::make_unique<FloatingStatic>(std::move(flow)));
}

}  // namespace fourdvt::render
