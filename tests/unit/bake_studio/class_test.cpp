// SPDX-License-Identifier: Apache-2.0
// Common time and mesh blend of walk and run against the actor's exact intermediate motions.
#include <gtest/gtest.h>

#include <cmath>

#include "bake/motion/class_plan.h"
#include "lab/studio/actors/actor.h"
#include "lab/studio/tracker.h"

namespace fourdvt::bake {
namespace {

constexpr uint32_t kFrames[] = {28, 19};

class StudioClass : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    actor_ = studio::createProceduralActor({"walk", "run"}, 0.03).take();
    tracker_ = std::make_unique<studio::Tracker>(*actor_, studio::StudioKnobs());
    capture_ = std::make_unique<capture::Capture>();
    capture_->fps = 25;
    capture_->topology = actor_->tracked().topology;
    for (size_t m = 0; m < 2; ++m) {
      capture::CaptureSequence sequence;
      sequence.name = actor_->motions()[m].name;
      sequence.frame_count = kFrames[m];
      sequence.loop = true;
      sequence.root_velocity_mps = actor_->motions()[m].root_velocity_mps;
      capture_->sequences.push_back(sequence);
    }
    capture::CaptureClass locomotion{"locomotion", {"speed_mps"}, {{"walk", {}}, {"run", {}}}};
    members_ = classMembers(*capture_, locomotion, read).take();
  }
  static void TearDownTestSuite() {
    members_.clear();
    capture_.reset();
    tracker_.reset();
    actor_.reset();
  }

  // The tracked mesh; w: 0 walk … 1 run.
  static Positions truth(double w, double phase) {
    Positions surface;
    actor_->pose(std::vector<double>{1 - w, w}, phase, surface);
    return tracker_->truth(tracker_->points(w, phase), surface);
  }
  static Result<Positions> read(const capture::CaptureSequence& sequence, uint32_t frame) {
    return truth(sequence.name == "run" ? 1 : 0, double(frame) / sequence.frame_count);
  }
  // Lead of the run's cycle over the walk's at a phase of the class.
  static double ahead(uint32_t p) {
    const double ahead = members_[1].source_frame[p] / kFrames[1] - double(p) / kFrames[0];
    return ahead - std::round(ahead);
  }

  static inline std::unique_ptr<studio::Actor> actor_;
  static inline std::unique_ptr<studio::Tracker> tracker_;
  static inline std::unique_ptr<capture::Capture> capture_;
  static inline std::vector<ClassMember> members_;
};

// A frame of the run is 0.053 of its cycle. Runners' stances are shorter than walkers', so that no alignment matches
// all poses.
TEST_F(StudioClass, CommonTimeIsTheActorsPhase) {
  double mean = 0;
  for (uint32_t p = 0; p < kFrames[0]; ++p) {
    EXPECT_LT(std::abs(ahead(p)), 0.05) << p;
    mean += ahead(p) / kFrames[0];
  }
  EXPECT_LT(std::abs(mean), 0.02);
}

TEST_F(StudioClass, BlendsAreNearWhatTheActorDoes) {
  const auto blend = NonlinearBlend::create(capture_->topology, truth(0, 0)).take();
  for (const float w : {0.2f, 0.5f, 0.8f}) {
    double sum = 0, most = 0;
    size_t count = 0;
    for (uint32_t p = 0; p < kFrames[0]; p += 4) {
      const std::vector<Positions> members = {memberPositions(members_[0], p, read).take(),
                                              memberPositions(members_[1], p, read).take()};
      const Positions blended = blend.blend(members, std::vector<float>{1 - w, w});
      const Positions exact = truth(w, double(p) / kFrames[0] + w * ahead(p));
      for (size_t v = 0; v < exact.size(); ++v, ++count) {
        const double distance = glm::distance(blended[v], exact[v]);
        sum += distance;
        most = std::max(most, distance);
      }
    }
    EXPECT_LT(sum / double(count), 0.0075) << w;
    EXPECT_LT(most, 0.075) << w;  // a shin, where one member's foot has left the ground
  }
}

}  // namespace
}  // namespace fourdvt::bake
