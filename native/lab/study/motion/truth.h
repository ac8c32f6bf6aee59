// SPDX-License-Identifier: Apache-2.0
// The truth between a class's members, where the capture comes from the virtual studio (lab/studio/truth.h), in
// the vertex order of the baked character. A class's time is its members' common time, the studio's the phase of its
// actor. Which moments are the same follows from the members' frames alone (classPhase).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/camera.h"
#include "base/flat_json.h"
#include "base/image.h"
#include "lab/study/run/context.h"
#include "package/base_mesh.h"
#include "package/character.h"

namespace fourdvt::study {

class MotionTruth {
 public:
  struct Step {
    double w = 0;  // of the second member
    std::string pictures, positions;
  };
  struct Instant {
    uint32_t number = 0;  // of the truth's files
    double phase = 0;     // 0…1, of every member's motion
  };
  // What is known from the character's bake.
  struct Baked {
    package::EncodedBaseMesh mesh;
    std::vector<std::vector<double>> passed;  // [member][frame of the class], as of commonFrame
  };
  // Null: the capture has none, or the class has more than two members. Errors: FileUnreadable (a damaged truth).
  static Result<std::unique_ptr<MotionTruth>> open(const StudyContext& context, const package::Sequence& motion,
                                                   Baked baked);
  const std::vector<Step>& steps() const { return steps_; }
  const std::vector<Instant>& instants() const { return instants_; }
  const std::vector<PinholeCamera>& cameras() const { return cameras_; }
  // The fractional frame of the class that shows the instant (commonFrame).
  double classPhase(double w, const Instant& instant) const;
  // The class's whole frame nearest to the instant.
  uint32_t classFrame(double w, const Instant& instant) const;
  bool isAligned() const { return !alignment_.empty(); }

  Result<Image> picture(const Step& step, const PinholeCamera& camera, const Instant& instant) const;
  Result<Positions> mesh(const Step& step, const Instant& instant) const;
  // [vertex] the point of `mesh` where the second member shows what the first one shows at the vertex.
  Result<Positions> moved(const Instant& instant, const Positions& mesh) const;

 private:
  MotionTruth(const capture::Capture& capture, std::string folder, Baked baked, bool loop)
      : capture_(capture), folder_(std::move(folder)), baked_(std::move(baked)), loop_(loop) {}
  Status read(const FlatJson& json, const package::Sequence& motion);

  const capture::Capture& capture_;
  const std::string folder_;
  const Baked baked_;
  const bool loop_;
  double units_per_metre_ = 0;
  std::vector<Step> steps_;
  std::vector<Instant> instants_;
  std::vector<PinholeCamera> cameras_;
  std::string alignment_;  // pattern of the files
};

}  // namespace fourdvt::study
