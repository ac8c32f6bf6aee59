// SPDX-License-Identifier: Apache-2.0
// The truth between a class's members, where the capture comes from the virtual studio (capture/studio_truth.h), in
// the vertex order of the baked character. Only instants that fall on a phase of the class are used: no picture is
// compared with another moment.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/camera.h"
#include "base/flat_json.h"
#include "base/image.h"
#include "evaluate/study.h"
#include "package/base_mesh.h"
#include "package/character.h"

namespace fourdvt::evaluate {

class MotionTruth {
 public:
  struct Step {
    double w = 0;  // of the second member
    std::string pictures, positions;
  };
  struct Instant {
    uint32_t number = 0;  // of the truth's files
    uint32_t phase = 0;   // of the class
  };
  // Null: the capture has none, or the class has more than two members, or no instant falls on a phase. mesh: of the
  // character's bake. Errors: FileUnreadable (a damaged truth).
  static Result<std::unique_ptr<MotionTruth>> open(const StudyContext& context, const package::Sequence& motion,
                                                   package::EncodedBaseMesh mesh);
  const std::vector<Step>& steps() const { return steps_; }
  const std::vector<Instant>& instants() const { return instants_; }
  const std::vector<PinholeCamera>& cameras() const { return cameras_; }
  bool isAligned() const { return !alignment_.empty(); }

  Result<Image> picture(const Step& step, const PinholeCamera& camera, const Instant& instant) const;
  Result<Positions> mesh(const Step& step, const Instant& instant) const;
  // [vertex] the point of `mesh` where the second member shows what the first one shows at the vertex.
  Result<Positions> moved(const Instant& instant, const Positions& mesh) const;

 private:
  MotionTruth(const capture::Capture& capture, std::string folder, package::EncodedBaseMesh mesh)
      : capture_(capture), folder_(std::move(folder)), mesh_(std::move(mesh)) {}
  Status read(const FlatJson& json, const package::Sequence& motion);

  const capture::Capture& capture_;
  const std::string folder_;
  const package::EncodedBaseMesh mesh_;
  double units_per_metre_ = 0;
  std::vector<Step> steps_;
  std::vector<Instant> instants_;
  std::vector<PinholeCamera> cameras_;
  std::string alignment_;  // pattern of the files
};

}  // namespace fourdvt::evaluate
