// SPDX-License-Identifier: Apache-2.0
#include "lab/study/motion/stage.h"

#include <algorithm>
#include <cmath>

#include "bake/motion/class_plan.h"
#include "edge/opencv_flow.h"
#include "lab/study/run/rows.h"
#include "lab/study/run/scene.h"
#include "motion/blend.h"

namespace fourdvt::study {
namespace {

constexpr float kApart_m = 0.002f;  // spacing of drawMany's figures

bool byOpencv(const AlignMethod& method) { return method == rows::kFlowOpencv || method == rows::kOpencvDis; }

Result<std::unique_ptr<render::FlowSource>> makeSource(gpu::Device& device, const AlignMethod& method) {
  render::FlowOptions options;
  if (method == rows::kFlowDis || method == rows::kOpencvDis) options.method = render::FlowMethod::Dis;
  if (!byOpencv(method)) return render::createGpuFlow(device, options);
  return edge::createOpencvFlow(device, options);
}

double lumaAt(const Image& rgba, int x, int y) {
  const uint8_t* p = rgba.at(x, y);
  return 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2];
}

// Restores contrast in the picture, as the renderer does in the texture of a baked blend (render/layered_pass.cpp):
// luma against its neighbours on both diagonals, if all of them are covered.
void putBackDetail(Image& rgba, double lost) {
  constexpr int kReach = 3;  // pixels
  const Image before = rgba;
  const auto covered = [&](int x, int y) { return before.at(x, y)[3] == 255; };
  for (int y = kReach; y + kReach < rgba.height; ++y)
    for (int x = kReach; x + kReach < rgba.width; ++x) {
      double beside = 0;
      int count = 0;
      for (int dx : {-kReach, kReach})
        for (int dy : {-kReach, kReach})
          if (covered(x + dx, y + dy)) beside += lumaAt(before, x + dx, y + dy), ++count;
      if (count < 4 || !covered(x, y)) continue;
      const double more = lost * (lumaAt(before, x, y) - beside / 4);
      for (int c = 0; c < 3; ++c)
        rgba.at(x, y)[c] = static_cast<uint8_t>(std::clamp(std::lround(before.at(x, y)[c] + more), 0l, 255l));
    }
}

// Gain, as in the renderer, that restores the contrast lost in a mean of these weights for detail of this correlation.
double lostDetail(const std::vector<float>& weights, double correlation) {
  double squares = 0;
  for (float w : weights) squares += w * w;
  return 1 / std::sqrt(squares + correlation * (1 - squares)) - 1;
}

// Samples in which only the first two members have weight, sorted by the second one's.
std::vector<const package::ParameterSample*> samplesBetween(const package::ParameterSpace& space) {
  std::vector<const package::ParameterSample*> out;
  for (const package::ParameterSample& sample : space.samples)
    if (std::abs(sample.weights[0] + sample.weights[1] - 1) < 1e-4f) out.push_back(&sample);
  std::sort(out.begin(), out.end(), [](const auto* a, const auto* b) { return a->weights[1] < b->weights[1]; });
  return out;
}

// Coefficients of the references at w, interpolated between the table's samples.
std::vector<float> offsetsAt(const package::Sequence& motion, float w) {
  std::vector<float> offsets(motion.reference_count, 0.0f);
  const auto samples = samplesBetween(motion.space);
  for (size_t i = 0; i + 1 < samples.size(); ++i) {
    const package::ParameterSample &a = *samples[i], &b = *samples[i + 1];
    if (w < a.weights[1] || w > b.weights[1] || a.weights[1] == b.weights[1]) continue;
    const float share = (w - a.weights[1]) / (b.weights[1] - a.weights[1]);
    for (size_t r = 0; r < offsets.size(); ++r) offsets[r] = (1 - share) * a.offsets[r] + share * b.offsets[r];
    break;
  }
  return offsets;
}

render::DrawOptions optionsOf(const AlignMethod& method) {
  render::DrawOptions options{studyRecipe(), alignOf(method)};
  options.recipe.keep_detail = method != rows::kAlignBakedMean;
  return options;
}

}  // namespace

render::Align alignOf(const AlignMethod& method) {
  if (method == rows::kAlignNone) return render::Align::None;
  return method == rows::kAlignBaked || method == rows::kAlignBakedMean ? render::Align::Baked : render::Align::Flow;
}

Result<std::unique_ptr<MotionStage>> MotionStage::open(gpu::Device& device, const std::string& folder,
                                                       const std::string& class_name) {
  std::unique_ptr<MotionStage> stage(new MotionStage(device));
  FOURDVT_TRY(measure::openCharacterStream(folder, class_name, stage->stream_));
  if (!stage->motion().isClass())
    return Error{ErrorId::InvalidArgument, folder + ": " + class_name + " is no motion class; bake it again"};
  FOURDVT_ASSIGN(stage->player_, edge::CharacterPlayer::open(device, folder));
  FOURDVT_ASSIGN(auto model, render::CharacterModel::create(device, stage->character(), stage->mesh()));
  stage->model_.emplace(std::move(model));
  return stage;
}

Status MotionStage::loadChunk(uint32_t phase) {
  const uint32_t number = stream_.index.chunkOfFrame(phase);
  if (!chunk_ || number != chunk_number_) {
    FOURDVT_ASSIGN(chunk_, measure::readCharacterChunk(stream_, number));
    chunk_number_ = number;
  }
  row_ = phase - stream_.index.chunks[number].first_frame;
  return {};
}

Status MotionStage::show(uint32_t phase) {
  FOURDVT_TRY(player_->showFrame(motion().name, phase));
  FOURDVT_TRY(loadChunk(phase));
  FOURDVT_ASSIGN(auto figure, player_->player().figure());
  look_ = figure.looks[0];
  motion::alignmentOf(*chunk_, row_, stream_.index, alignment_);
  setMesh(blended(0.5));
  return {};
}

std::vector<float> MotionStage::weightsOf(double w) const {
  std::vector<float> weights(motion().members.size(), 0.0f);
  weights[0] = static_cast<float>(1 - w);
  weights[1] = static_cast<float>(w);
  return weights;
}

std::vector<Positions> MotionStage::members() const {
  std::vector<Positions> out(2);
  for (size_t m = 0; m < out.size(); ++m)
    motion::blendFrame(*chunk_, row_, stream_.index, {weightsOf(double(m)), {}}, out[m]);
  return out;
}

Positions MotionStage::blended(double w) const {
  Positions out;
  motion::blendFrame(*chunk_, row_, stream_.index, {weightsOf(w), offsetsAt(motion(), static_cast<float>(w))}, out);
  return out;
}

Result<Positions> MotionStage::blendedAt(double w, double phase) {
  const uint32_t shown = stream_.index.chunks[chunk_number_].first_frame + row_;
  capture::CaptureSequence frames;
  frames.frame_count = motion().frame_count;
  frames.loop = motion().loop;
  const auto read = [&](const capture::CaptureSequence&, uint32_t frame) -> Result<Positions> {
    FOURDVT_TRY(loadChunk(frame));
    return blended(w);
  };
  auto out = bake::memberPositions({&frames, {phase}, {}}, 0, read);
  FOURDVT_TRY(loadChunk(shown));
  return out;
}

void MotionStage::setMesh(Positions positions) {
  positions_ = std::move(positions);
  model_->setPositions(device_, positions_);
}

Result<render::Recipe*> MotionStage::recipeFor(const AlignMethod& method) {
  auto& recipe = recipes_[method];
  if (recipe) return recipe.get();
  FOURDVT_ASSIGN(auto made, render::Recipe::create(device_));
  if (alignOf(method) == render::Align::Flow) {
    FOURDVT_ASSIGN(auto source, makeSource(device_, method));
    made->setFlow(std::move(source));
  }
  recipe = std::move(made);
  return recipe.get();
}

Result<render::FlowSource*> MotionStage::sourceFor(const AlignMethod& method) {
  auto& source = sources_[method];
  if (source) return source.get();
  FOURDVT_ASSIGN(source, makeSource(device_, method));
  return source.get();
}

Status MotionStage::drawInto(const render::View& view, double w, const AlignMethod& method, gpu::TargetId target) {
  FOURDVT_ASSIGN(auto recipe, recipeFor(method));
  const std::vector<float> weights = weightsOf(w);
  const render::Look look{look_.appearance, look_.picture, weights};
  const render::Figure figure{&*model_, {&look, 1}};
  return recipe->draw({&figure, 1}, nullptr, view, optionsOf(method), target);
}

Status MotionStage::drawMany(const render::View& view, int count, const AlignMethod& method, gpu::TargetId target) {
  FOURDVT_ASSIGN(auto recipe, recipeFor(method));
  const std::vector<float> weights = weightsOf(0.5);
  const render::Look look{look_.appearance, look_.picture, weights};
  std::vector<render::Figure> figures;
  for (int i = 0; i < count; ++i) {
    render::Figure figure{&*model_, {&look, 1}};
    figure.world_from_character[3] += glm::vec4(-kApart_m * float(i) * render::viewAxis(view.clip_from_world), 0);
    figures.push_back(figure);
  }
  return recipe->draw(figures, nullptr, view, optionsOf(method), target);
}

Result<Image> MotionStage::draw(const PinholeCamera& camera, double w, const AlignMethod& method) {
  const render::View view = render::viewFromCamera(camera);
  const bool puts_back = method == rows::kFlowGpuDetail;
  const AlignMethod drawn = puts_back ? rows::kFlowGpu : method;
  auto image = still_.render(view, [&](gpu::TargetId target) { return drawInto(view, w, drawn, target); });
  if (image && puts_back) putBackDetail(image.value(), lostDetail(weightsOf(w), look_.appearance->detail_correlation));
  return image;
}

Status MotionStage::drawLook(const PinholeCamera& camera, double w, gpu::Texture& out) {
  FOURDVT_ASSIGN(auto color, gpu::makeTexture(device_, {.width = camera.width,
                                                        .height = camera.height,
                                                        .filter = gpu::Filter::Linear,
                                                        .label = "look of a member"}));
  FOURDVT_ASSIGN(auto target, gpu::makeTarget(device_, {.colors = {color.id()}, .label = "look of a member"}));
  FOURDVT_TRY(drawInto(render::viewFromCamera(camera), w, rows::kAlignNone, target.id()));
  out = std::move(color);
  return {};
}

Result<measure::FlowField> MotionStage::flow(const PinholeCamera& camera, const AlignMethod& method) {
  gpu::Texture first, second;
  FOURDVT_TRY(drawLook(camera, 0, first));
  FOURDVT_TRY(drawLook(camera, 1, second));
  FOURDVT_ASSIGN(auto source, sourceFor(method));
  FOURDVT_TRY(source->compute(first.id(), second.id(), camera.width, camera.height));
  FOURDVT_ASSIGN(auto target, gpu::makeTarget(device_, {.colors = {source->flow()}, .label = "flow"}));
  measure::FlowField out{camera.width, camera.height, std::vector<glm::vec2>(size_t(camera.width) * camera.height)};
  const auto format = byOpencv(method) ? gpu::PixelFormat::RG32F : gpu::PixelFormat::RG16F;
  FOURDVT_TRY(device_.readPixels(target.id(), format, {.width = camera.width, .height = camera.height},
                                 out.displacement.data()));
  for (glm::vec2& f : out.displacement) f.y = -f.y;  // GL row order
  return out;
}

PinholeCamera MotionStage::orbit(double azimuth_deg, int width, int height) const {
  OrbitView view = defaultOrbit(character().bounds, double(width) / height);
  view.azimuth_deg = azimuth_deg;
  return cameraFromOrbit(view, width, height);
}

}  // namespace fourdvt::study
