// SPDX-License-Identifier: Apache-2.0
// Ground truth between a class's members for captures of the virtual studio (lab/studio/truth.h), in the vertex order
// of the baked character. A class's time is its members' common time, the studio's the phase of its actor. The members'
// frames alone determine their correspondence (classPhase).
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
    double w = 0;  // the second member's weight
    std::string pictures, positions;
  };
  struct Instant {
    uint32_t number = 0;  // number of the truth's files
    double phase = 0;     // 0…1, of all members' motion
  };
  // Inputs from the character's bake.
  struct Baked {
    package::EncodedBaseMesh mesh;
    std::vector<std::vector<double>> passed;  // [member][frame of the class], see commonFrame
  };
  // Returns null if the capture has no truth, or if the class has more than two members. Errors: FileUnreadable (a
  // damaged truth).
  static Result<std::unique_ptr<MotionTruth>> open(const StudyContext& context, const package::Sequence& motion,
                                                   Baked baked);
  const std::vector<Step>& steps() const { return steps_; }
  const std::vector<Instant>& instants() const { return instants_; }
  const std::vector<PinholeCamera>& cameras() const { return cameras_; }
  // Fractional frame of the class at the instant (commonFrame).
  double classPhase(double w, const Instant& instant) const;
  // Nearest whole frame of the class at the instant.
  uint32_t classFrame(double w, const Instant& instant) const;
  bool isAligned() const { return !alignment_.empty(); }

  Result<Image> picture(const Step& step, const PinholeCamera& camera, const Instant& instant) const;
  Result<Positions> mesh(const Step& step, const Instant& instant) const;
  // [vertex] point of `mesh` at which the second member has the first one's appearance at the vertex.
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
  std::string alignment_;  // file name pattern
};

}  // namespace fourdvt::study
