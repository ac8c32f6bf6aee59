// SPDX-License-Identifier: Apache-2.0
// Static view of one motion class of a baked character: any phase, any share of its first two members, any mesh, drawn
// with each alignment of the members' appearance.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "edge/character_player.h"
#include "lab/measure/character_frame.h"
#include "lab/measure/motion_metrics.h"
#include "motion/blend.h"
#include "render/flow/flow.h"
#include "render/still_target.h"

namespace fourdvt::study {

// Row name of an alignment in the tables (rows.h: kAlign…). kOpencvDis is no product setting, only a baseline of
// flow-dis.
using AlignMethod = std::string;
render::Align alignOf(const AlignMethod& method);

constexpr double kFirstAzimuth_deg = 25;  // views around a motion

class MotionStage {
 public:
  // Errors: those of the character's files, InvalidArgument (no such class).
  static Result<std::unique_ptr<MotionStage>> open(gpu::Device& device, const std::string& folder,
                                                   const std::string& class_name);
  const package::Sequence& motion() const { return *stream_.sequence; }
  const package::Character& character() const { return stream_.character; }
  const package::BaseMesh& mesh() const { return stream_.mesh; }
  bool aligned() const { return stream_.index.alignment_count > 0; }

  // Selects the phase of pictures, labels and meshes, and sets its mesh at equal weights.
  Status show(uint32_t phase);
  std::vector<Positions> members() const;  // meshes of the phase
  Positions blended(double w) const;       // as the player blends: w of the second member
  // Blend between two phases, as for a class of more frames; a loop wraps to its start.
  Result<Positions> blendedAt(double w, double phase);
  const std::vector<glm::vec2>& alignment() const { return alignment_; }  // [member - 1][vertex], metres
  void setMesh(Positions positions);
  const Positions& positions() const { return positions_; }

  // Premultiplied, into a target of the view's size.
  Status drawInto(const render::View& view, double w, const AlignMethod& method, gpu::TargetId target);
  // Draws `count` figures in the same place, each slightly nearer than the previous one, so that the depth test
  // discards none.
  Status drawMany(const render::View& view, int count, const AlignMethod& method, gpu::TargetId target);
  // RGBA straight alpha, top row first. w = 0 and w = 1 show one member's own appearance. Also accepts kFlowGpuDetail:
  // the picture by flow, with the contrast gain of a baked blend of the same weights.
  Result<Image> draw(const PinholeCamera& camera, double w, const AlignMethod& method);
  // Flow from the first member's appearance to the second's, on the current mesh; `method`: one of the flow methods.
  Result<measure::FlowField> flow(const PinholeCamera& camera, const AlignMethod& method);

  // Orbit camera at the minimum distance that keeps the whole motion inside the picture.
  PinholeCamera orbit(double azimuth_deg, int width, int height) const;

 private:
  explicit MotionStage(gpu::Device& device) : device_(device), still_(device) {}
  Status loadChunk(uint32_t phase);
  Result<render::Recipe*> recipeFor(const AlignMethod& method);
  Result<render::FlowSource*> sourceFor(const AlignMethod& method);
  Status drawLook(const PinholeCamera& camera, double w, gpu::Texture& out);
  std::vector<float> weightsOf(double w) const;

  gpu::Device& device_;
  render::StillTarget still_;
  measure::CharacterStream stream_;
  std::unique_ptr<edge::CharacterPlayer> player_;
  std::optional<render::CharacterModel> model_;
  std::map<AlignMethod, std::unique_ptr<render::Recipe>> recipes_;
  std::map<AlignMethod, std::unique_ptr<render::FlowSource>> sources_;
  std::optional<package::ChunkFrames> chunk_;
  uint32_t chunk_number_ = 0, row_ = 0;
  Positions positions_;
  std::vector<glm::vec2> alignment_;
  render::Look look_;
};

}  // namespace fourdvt::study
