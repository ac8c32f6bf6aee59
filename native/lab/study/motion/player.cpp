// SPDX-License-Identifier: Apache-2.0
#include "lab/study/motion/player.h"

#include <cmath>
#include <limits>

#include "lab/study/run/scene.h"

namespace fourdvt::study {
namespace {

constexpr int kComparedWidth = 240, kComparedHeight = 320;  // size of the compared pictures

// Reads the drawn mesh back from the table on the GPU: two texels a vertex.
Result<Positions> shownPositions(gpu::Device& device, const render::CharacterModel& model) {
  constexpr int kWidthOfTable = render::CharacterModel::kTableWidth;
  const int height = (2 * static_cast<int>(model.vertex_count) + kWidthOfTable - 1) / kWidthOfTable;
  FOURDVT_ASSIGN(auto target,
                 gpu::makeTarget(device, {.colors = {model.positions_normals.id()}, .label = "positions"}));
  std::vector<glm::vec4> table(size_t(kWidthOfTable) * height);
  FOURDVT_TRY(device.readPixels(target.id(), gpu::PixelFormat::RGBA32F, {.width = kWidthOfTable, .height = height},
                                table.data()));
  Positions out;
  for (uint32_t v = 0; v < model.vertex_count; ++v) {
    const int row = static_cast<int>(2 * v) / kWidthOfTable, column = static_cast<int>(2 * v) % kWidthOfTable;
    out.push_back(glm::vec3(table[size_t(height - 1 - row) * kWidthOfTable + column]));  // row 0 is the top row
  }
  return out;
}

}  // namespace

Result<std::unique_ptr<WatchedPlayer>> WatchedPlayer::open(gpu::Device& device, const std::string& folder,
                                                           bool travel) {
  std::unique_ptr<WatchedPlayer> out(new WatchedPlayer(device, travel));
  FOURDVT_ASSIGN(auto player, edge::CharacterPlayer::open(device, folder));
  out->player_ = std::move(player);
  out->player().setTravel(travel);
  return out;
}

double WatchedPlayer::middleParameter(const package::Sequence& sequence) {
  if (!sequence.isClass()) return std::numeric_limits<double>::quiet_NaN();
  const motion::Range range = motion::parameterRange(sequence, 0);
  return (range.min + range.max) / 2;
}

Status WatchedPlayer::start(const std::string& state, uint32_t frame, double parameter) {
  if (!std::isnan(parameter)) {
    const package::Sequence* sequence = player().character()->find(state);
    FOURDVT_TRY(player().setParameter(sequence->space.names[0], parameter, true));
  }
  FOURDVT_TRY(player_->showFrame(state, frame));
  player().setPlacement({});
  player().play();
  return look();
}

Status WatchedPlayer::look() {
  FOURDVT_ASSIGN(auto figure, player().figure());
  FOURDVT_ASSIGN(world_, shownPositions(device_, *figure.model));
  for (glm::vec3& p : world_) p = glm::vec3(figure.world_from_character * glm::vec4(p, 1));
  if (travel_) return {};
  OrbitView orbit = defaultOrbit(player().character()->bounds, double(kComparedWidth) / kComparedHeight);
  FOURDVT_ASSIGN(picture_,
                 player_->renderStill(render::viewFromCamera(cameraFromOrbit(orbit, kComparedWidth, kComparedHeight)),
                                      studyRecipe()));
  return {};
}

Result<TickChange> WatchedPlayer::tick() {
  const Positions before = world_;
  const Image picture_before = picture_;
  FOURDVT_TRY(player_->advance(kTick_s));
  FOURDVT_TRY(look());
  return TickChange{measure::largestStep_m(before, world_),
                    travel_ ? 0 : measure::pictureChange(picture_before, picture_)};
}

}  // namespace fourdvt::study
