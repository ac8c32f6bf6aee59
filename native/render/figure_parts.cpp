// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "render/passes.h"

namespace fourdvt::render {
namespace {

constexpr float kLeastShare = 1.0f / 512;  // below half a level of eight bits

Error invalid(const char* message) { return Error{ErrorId::InvalidArgument, message}; }

Status checkLook(const Look& look, const CharacterModel& model) {
  if (!look.appearance || !look.picture) return invalid("a look needs an appearance and a picture");
  const Appearance& appearance = *look.appearance;
  const PictureTextures& picture = *look.picture;
  if (!appearance.ready() || appearance.layer_count != model.layer_count)
    return invalid(
        "the appearance needs setFrame, and setLayout with a rendition of as many layers as the character's members "
        "have");
  if (picture.kind == PictureTextures::Kind::I420 ? !picture.y || !picture.u || !picture.v : !picture.rgba)
    return invalid("the picture's textures are missing; call createPicture");
  if (look.weights.size() != static_cast<size_t>(appearance.member_count))
    return invalid("a look needs one weight for each member of its appearance");
  float sum = 0;
  for (float weight : look.weights) {
    if (!(weight >= 0)) return invalid("weights of members must not be negative");
    sum += weight;
  }
  return std::abs(sum - 1) < 0.01f ? Status() : invalid("the members' weights must sum to 1");
}

std::vector<Source> sourcesOf(const Look& look) {
  std::vector<Source> sources;
  float sum = 0;
  for (size_t member = 0; member < look.weights.size(); ++member) {
    if (look.weights[member] < kLeastShare) continue;
    sources.push_back({static_cast<int>(member), look.weights[member]});
    sum += look.weights[member];
  }
  for (Source& source : sources) source.weight /= sum;
  return sources;
}

// A debug view shows one member.
std::vector<Part> heaviestOf(const std::vector<Part>& parts) {
  const auto lighter = [](const auto& a, const auto& b) { return a.share < b.share; };
  Part part = *std::max_element(parts.begin(), parts.end(), lighter);
  const auto source = std::max_element(part.sources.begin(), part.sources.end(),
                                       [](const Source& a, const Source& b) { return a.weight < b.weight; });
  part.sources = {{source->member, 1}};
  part.share = 1;
  return {part};
}

}  // namespace

Status checkFigure(const Figure& figure, const RecipeOptions& options) {
  if (!figure.model || figure.model->geometry_serial == 0)
    return invalid("a figure needs a model; call its setPositions before drawing");
  const CharacterModel& model = *figure.model;
  if (model.camera_count < 1) return invalid("the character has no cameras");
  if (figure.looks.empty() || figure.looks.size() > 2) return invalid("a figure has one look, two in a transition");
  if (!(figure.fade >= 0 && figure.fade <= 1)) return invalid("fade must be between 0 and 1");
  const float size = glm::determinant(figure.world_from_character);
  if (!(size > 0) || !std::isfinite(size)) return invalid("world_from_character cannot be inverted or mirrors");
  if (options.debug_layer < 0 || options.debug_layer >= model.layer_count) return invalid("no such debug layer");
  for (const Look& look : figure.looks) FOURDVT_TRY(checkLook(look, model));
  return {};
}

std::vector<Part> partsOf(const Figure& figure, const DrawOptions& options) {
  float second = figure.looks.size() > 1 ? figure.fade : 0;
  if (second < kLeastShare) second = 0;
  if (second > 1 - kLeastShare) second = 1;
  std::vector<Part> parts;
  for (size_t i = 0; i < figure.looks.size(); ++i) {
    const float share = i == 0 ? 1 - second : second;
    if (share == 0) continue;
    const std::vector<Source> sources = sourcesOf(figure.looks[i]);
    if (options.align != Align::Flow) {
      parts.push_back({&figure.looks[i], sources, share});
      continue;
    }
    for (const Source& source : sources)
      parts.push_back({&figure.looks[i], {{source.member, 1}}, share * source.weight});
  }
  return options.recipe.debug == DebugView::None ? parts : heaviestOf(parts);
}

View viewOfFigure(const View& view, const Figure& figure) {
  View out = view;
  out.clip_from_world = view.clip_from_world * figure.world_from_character;
  out.eye_in_world = glm::vec3(glm::inverse(figure.world_from_character) * glm::vec4(view.eye_in_world, 1));
  return out;
}

}  // namespace fourdvt::render
