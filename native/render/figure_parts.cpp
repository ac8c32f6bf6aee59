// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "render/passes.h"

namespace fourdvt::render {
namespace {

constexpr float kMinShare = 1.0f / 512;  // below half a level of eight bits

Error invalid(const char* message) { return Error{ErrorId::InvalidArgument, message}; }

Status checkLook(const Look& look, const CharacterModel& model) {
  if (!look.appearance || !look.picture) return invalid("a look needs an appearance and a picture");
  const Appearance& appearance = *look.appearance;
  const PictureTextures& picture = *look.picture;
  if (!appearance.ready() || appearance.layer_count != model.layer_count)
    return invalid("the appearance needs setFrame and setLayout for the character's layers");
  if (!picture.made()) return invalid("the picture's textures are missing; call createPicture");
  if (look.weights.size() != static_cast<size_t>(appearance.member_count))
    return invalid("a look needs one weight for each member of its appearance");
  float sum = 0;
  for (float weight : look.weights) {
    if (!(weight >= 0)) return invalid("weights of members must not be negative");
    sum += weight;
  }
  return std::abs(sum - 1) < 0.01f ? Status() : invalid("the members' weights must sum to 1");
}

Status checkCameras(const CameraLook& look) {
  if (!look.picture || !look.picture->made()) return invalid("the picture's textures are missing; call createPicture");
  return look.sources.size() == look.cameras.size() ? Status() : invalid("there is one source for each camera");
}

std::vector<WeightedMember> weightedMembersOf(const Look& look) {
  std::vector<WeightedMember> members;
  float sum = 0;
  for (size_t member = 0; member < look.weights.size(); ++member) {
    if (look.weights[member] < kMinShare) continue;
    members.push_back({static_cast<int>(member), look.weights[member]});
    sum += look.weights[member];
  }
  for (WeightedMember& member : members) member.weight /= sum;
  return members;
}

// Returns the member of the largest share only, for debug views.
std::vector<Part> heaviestOf(const std::vector<Part>& parts) {
  const auto lighter = [](const auto& a, const auto& b) { return a.share < b.share; };
  Part part = *std::max_element(parts.begin(), parts.end(), lighter);
  const auto heaviest =
      std::max_element(part.members.begin(), part.members.end(),
                       [](const WeightedMember& a, const WeightedMember& b) { return a.weight < b.weight; });
  part.members = {{heaviest->member, 1}};
  part.share = 1;
  return {part};
}

}  // namespace

Status checkFigure(const Figure& figure, const RecipeOptions& options) {
  if (!figure.model || figure.model->geometry_serial == 0)
    return invalid("a figure needs a model; call its setPositions before drawing");
  const CharacterModel& model = *figure.model;
  if (model.camera_count < 1) return invalid("the character has no cameras");
  const float size = glm::determinant(figure.world_from_character);
  if (!(size > 0) || !std::isfinite(size)) return invalid("world_from_character cannot be inverted or mirrors");
  if (figure.cameras) return checkCameras(*figure.cameras);
  if (figure.looks.empty() || figure.looks.size() > 2) return invalid("a figure has one look, two in a transition");
  if (!(figure.fade >= 0 && figure.fade <= 1)) return invalid("fade must be between 0 and 1");
  if (options.debug_layer < 0) return invalid("no such debug layer");
  for (const Look& look : figure.looks) FOURDVT_TRY(checkLook(look, model));
  return {};
}

std::vector<Part> partsOf(const Figure& figure, const DrawOptions& options) {
  float second = figure.looks.size() > 1 ? figure.fade : 0;
  if (second < kMinShare) second = 0;
  if (second > 1 - kMinShare) second = 1;
  std::vector<Part> parts;
  for (size_t i = 0; i < figure.looks.size(); ++i) {
    const float share = i == 0 ? 1 - second : second;
    if (share == 0) continue;
    const std::vector<WeightedMember> members = weightedMembersOf(figure.looks[i]);
    if (options.align != Align::Flow) {
      parts.push_back({&figure.looks[i], members, share});
      continue;
    }
    for (const WeightedMember& member : members)
      parts.push_back({&figure.looks[i], {{member.member, 1}}, share * member.weight});
  }
  return options.recipe.debug == DebugView::None ? parts : heaviestOf(parts);
}

CharacterView viewOfFigure(const View& view, const Figure& figure) {
  return {view.clip_from_world * figure.world_from_character,
          glm::vec3(glm::inverse(figure.world_from_character) * glm::vec4(view.eye_in_world, 1)), view.width,
          view.height};
}

LengthScales lengthScalesOf(std::span<const Figure> figures) {
  if (figures.empty()) return {};
  LengthScales out{figures[0].model->length_scale, figures[0].model->length_scale};
  for (const Figure& figure : figures) {
    out.least = std::min(out.least, figure.model->length_scale);
    out.most = std::max(out.most, figure.model->length_scale);
  }
  return out;
}

}  // namespace fourdvt::render
