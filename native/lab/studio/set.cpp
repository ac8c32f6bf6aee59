// SPDX-License-Identifier: Apache-2.0
#include "lab/studio/set.h"

#include <algorithm>
#include <cmath>

namespace fourdvt::studio {
namespace {

constexpr int kBoundsPhases = 16;
constexpr float kBoundsSlack_m = 0.02f;  // margin for bulges between the measured phases

std::vector<std::string> namesOf(const StudioOptions& options) {
  if (options.sequences.empty() && options.actor == "procedural") return {"walk", "run"};
  return options.sequences;
}

Result<std::unique_ptr<Actor>> openActor(const StudioOptions& options) {
  if (options.actor == "procedural")
    return createProceduralActor(namesOf(options), 1e-3 * options.knobs.mesh_cell_mm, options.knobs.plain_clothes);
  return openGltfActor(options.actor, options.sequences);
}

}  // namespace

uint32_t frameCount(const Motion& motion, double fps) {
  return std::max(1u, static_cast<uint32_t>(std::lround(motion.duration_s * fps)) + (motion.loop ? 0 : 1));
}

uint32_t filmedFrames(const Motion& motion, const StudioOptions& options) {
  const uint32_t whole = frameCount(motion, options.fps);
  return options.frames > 0 ? std::min(whole, uint32_t(options.frames)) : whole;
}

double framePhase(const Motion& motion, double frame, uint32_t count) {
  const double phase = frame / std::max(1u, motion.loop ? count : count - 1);
  return motion.loop ? phase - std::floor(phase) : std::clamp(phase, 0.0, 1.0);
}

namespace {

// Single texel with the texture's mean colour.
Image meanTexel(const Image& texture) {
  const size_t channels = size_t(texture.channels), texels = texture.pixels.size() / channels;
  Image out(1, 1, texture.channels);
  for (size_t k = 0; k < channels; ++k) {
    uint64_t sum = 0;
    for (size_t i = 0; i < texels; ++i) sum += texture.pixels[i * channels + k];
    out.pixels[k] = uint8_t((sum + texels / 2) / texels);
  }
  return out;
}

}  // namespace

StudioSet::StudioSet(const StudioOptions& options, std::unique_ptr<Actor> actor)
    : actor_(std::move(actor)),
      tracker_(*actor_, options.knobs),
      shading_{float(options.knobs.wrinkles), float(options.knobs.specular), float(options.knobs.shading)} {}

Result<std::unique_ptr<StudioSet>> StudioSet::open(const StudioOptions& options, gpu::Device& device) {
  FOURDVT_ASSIGN(auto actor, openActor(options));
  if (options.strides > 0) actor = withStrides(std::move(actor), options.strides, options.travel);
  std::unique_ptr<StudioSet> set(new StudioSet(options, std::move(actor)));
  FOURDVT_TRY(set->chooseClasses(options));
  set->measure(options);
  set->rig_ = makeRig(set->bounds_, options.cameras, options.width, options.height);
  set->texture_ = options.knobs.plain ? meanTexel(set->actor().texture()) : set->actor().texture();
  FOURDVT_ASSIGN(auto renderer,
                 Renderer::create(device, set->actor().surface(), set->texture_, options.width, options.height));
  set->renderer_ = std::make_unique<Renderer>(std::move(renderer));
  FOURDVT_TRY(set->openFilm(options, device));
  return set;
}

// Creates the resources of the ring cameras only.
Status StudioSet::openFilm(const StudioOptions& options, gpu::Device& device) {
  FOURDVT_ASSIGN(lens_, Lens::create(options.knobs.lens, rig_.ring[0]));
  const PinholeCamera drawn = lens_->drawn(rig_.ring[0]);
  if (options.bystander) {
    FOURDVT_ASSIGN(bystander_, Bystander::create(device, rig_, groundY_m(), options.knobs.seed, drawn));
  }
  if (!lens_->any()) return {};
  FOURDVT_ASSIGN(auto finer, Renderer::create(device, actor_->surface(), texture_, drawn.width, drawn.height));
  film_renderer_ = std::make_unique<Renderer>(std::move(finer));
  return {};
}

Status StudioSet::chooseClasses(const StudioOptions& options) {
  const auto& motions = actor_->motions();
  classes_ = options.classes;
  if (classes_.empty() && options.frames == 0 && options.strides == 0 && options.actor == "procedural") {
    StudioClass locomotion{"locomotion", "speed_mps", {}};
    for (const Motion& motion : motions)
      if (motion.is_gait) locomotion.members.push_back(motion.name);
    if (locomotion.members.size() > 1) classes_.push_back(locomotion);
  }
  places_.assign(motions.size(), 0);
  for (const StudioClass& c : classes_)
    for (size_t m = 0; m < c.members.size(); ++m) {
      const size_t index = motionIndex(c.members[m]);
      if (index == motions.size())
        return Error{ErrorId::InvalidArgument,
                     "class \"" + c.name + "\": \"" + c.members[m] + "\" is not among the sequences; add it to them"};
      if (motions[index].loop != motions[motionIndex(c.members[0])].loop)
        return Error{ErrorId::InvalidArgument,
                     "class \"" + c.name + "\": loops and motions with an end cannot be mixed"};
      if (options.actor == "procedural" && !motions[index].is_gait)
        return Error{ErrorId::InvalidArgument,
                     "class \"" + c.name + "\": \"" + c.members[m] + "\" does not blend; choose walk, jog and run"};
      places_[index] = double(m) / double(c.members.size() - 1);
    }
  return {};
}

void StudioSet::measure(const StudioOptions& options) {
  bounds_ = {glm::vec3(1e9f), glm::vec3(-1e9f)};
  Positions pose;
  std::vector<double> shares(actor_->motions().size(), 0);
  for (double& share : shares) {
    share = 1;
    const int phases = kBoundsPhases * std::max(1, int(std::ceil(options.strides)));
    for (int i = 0; i < phases; ++i) {
      actor_->pose(shares, double(i) / (options.strides > 0 ? phases - 1 : phases), pose);
      bounds_.grow(pose);
    }
    share = 0;
  }
  const glm::vec3 far = glm::max(glm::abs(bounds_.min), glm::abs(bounds_.max)) + 2 * kBoundsSlack_m;
  units_per_metre_ = std::min(10000.0, std::floor(32000 / double(std::max({far.x, far.y, far.z}))));
  bounds_.min -= kBoundsSlack_m * glm::vec3(1, 0, 1);
  bounds_.max += kBoundsSlack_m;
}

size_t StudioSet::motionIndex(const std::string& name) const {
  const auto& motions = actor_->motions();
  return size_t(std::find_if(motions.begin(), motions.end(), [&](const Motion& m) { return m.name == name; }) -
                motions.begin());
}

std::vector<double> StudioSet::sharesAt(const StudioClass& motion_class, double position) const {
  std::vector<double> shares(actor_->motions().size(), 0);
  const double along = position * double(motion_class.members.size() - 1);
  const size_t first = std::min(size_t(along), motion_class.members.size() - 2);
  shares[motionIndex(motion_class.members[first])] = 1 - (along - double(first));
  shares[motionIndex(motion_class.members[first + 1])] = along - double(first);
  return shares;
}

double StudioSet::placeOf(const std::vector<double>& shares) const {
  double place = 0;
  for (size_t i = 0; i < shares.size(); ++i) place += shares[i] * places_[i];
  return place;
}

void StudioSet::pose(const std::vector<double>& shares, double phase) {
  actor_->pose(shares, phase, surface_pose_);
  points_ = tracker_.points(placeOf(shares), phase);
  renderer_->setPose(surface_pose_, placeOf(shares), phase);
  if (film_renderer_) film_renderer_->setPose(surface_pose_, placeOf(shares), phase);
}

Result<Image> StudioSet::draw(const PinholeCamera& camera) {
  return renderer_->draw(camera, rig_.near_m, rig_.far_m, shading_);
}

Result<Image> StudioSet::film(const PinholeCamera& camera) {
  if (!film_renderer_) return draw(camera);
  FOURDVT_ASSIGN(const auto drawn, film_renderer_->draw(lens_->drawn(camera), rig_.near_m, rig_.far_m, shading_));
  return lens_->filmed(camera, drawn);
}

}  // namespace fourdvt::studio
