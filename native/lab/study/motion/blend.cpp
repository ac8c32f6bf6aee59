// SPDX-License-Identifier: Apache-2.0
// The mesh blend at run time against the full non-linear one: linear, and with R precomputed corrections.
#include "motion/blend.h"

#include <cmath>
#include <functional>

#include "bake/motion/hybrid_blend.h"
#include "base/robust.h"
#include "base/watch.h"
#include "lab/study/motion/motion.h"
#include "lab/study/run/row_writer.h"
#include "lab/study/run/rows.h"
#include "lab/study/run/run_steps.h"

namespace fourdvt::study {
namespace {

constexpr int kMaxReferences = 6, kCheckWeights = 25;  // as in the bake's own check
constexpr int kRepeats = 31;

double milliseconds(const std::function<void()>& run) {
  std::vector<double> times;
  for (int i = 0; i < kRepeats; ++i) {
    const Watch watch;
    run();
    times.push_back(watch.ms());
  }
  return median(times);
}

// Mesh blend of the player, on a frame of as many members and corrections.
class RunTimeBlend {
 public:
  explicit RunTimeBlend(const std::vector<Positions>& members) {
    index_.position_step_m = 0.00025f;
    frames_.frame_count = 1;
    frames_.vertex_count = static_cast<uint32_t>(members[0].size());
    frames_.member_count = static_cast<uint32_t>(members.size());
    frames_.reference_count = kMaxReferences;
    for (const Positions& member : members)
      for (const glm::vec3& p : member) frames_.positions.push_back(glm::ivec3(p / index_.position_step_m));
    frames_.offsets.resize(size_t(kMaxReferences) * frames_.vertex_count, glm::ivec3(1));
  }
  double ms(int references) {
    const motion::BlendWeights halves{{0.5f, 0.5f}, std::vector<float>(static_cast<size_t>(references), 0.3f)};
    return milliseconds([&] { motion::blendFrame(frames_, 0, index_, halves, out_); });
  }

 private:
  package::ChunkFrames frames_;
  package::StreamIndex index_;
  Positions out_;
};

}  // namespace

Result<Rows> measureBlend(const MotionSubject& subject) {
  MotionStage& stage = subject.stage;
  FOURDVT_ASSIGN(const auto blend, bake::NonlinearBlend::create(stage.mesh().topology, stage.mesh().positions));
  bake::HybridErrors errors({{0, 1, 1}}, bake::HybridMix::Polynomial, kCheckWeights - 1, kMaxReferences + 1);
  for (const uint32_t phase : subject.phases(subject.quick() ? 2 : subject.motion().frame_count)) {
    FOURDVT_TRY(checkStop(subject.context));
    FOURDVT_TRY(stage.show(phase));
    errors.add(blend, stage.members());
  }
  const std::vector<Positions> members = stage.members();
  RunTimeBlend run_time(members);
  Rows out;
  const std::string name = subject.motion().name;
  const float halves[] = {0.5f, 0.5f};
  const double solved_ms = milliseconds([&] { blend.blend(members, halves); });
  RowWriter(out, rows::kMotionBlend, name, rows::kNonlinear, "").add({{rows::kBlendMs, solved_ms}});
  for (int references = 0; references <= kMaxReferences; ++references) {
    const bool baked = references == static_cast<int>(subject.motion().reference_count);
    const RowWriter row(out, rows::kMotionBlend, name, references ? rows::kHybrid : rows::kLinear,
                        "references=" + std::to_string(references) + (baked ? " baked=1" : ""));
    const bake::HybridErrors::Error& error = errors.of(references + 1);
    row.add({{rows::kErrorMaxMm, 1e3 * error.max_m},
             {rows::kErrorRmsMm, 1e3 * std::sqrt(error.sum_squares / double(error.count))}});
    const double ms = run_time.ms(references);
    row.add({{rows::kBlendMs, ms}, {rows::kRatioToNonlinear, ms / solved_ms}});
  }
  return out;
}

}  // namespace fourdvt::study
