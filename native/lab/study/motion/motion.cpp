// SPDX-License-Identifier: Apache-2.0
// Motion classes: mesh blend, alignment of the members' appearance, its cost, transitions. One class: the first.
#include "lab/study/motion/motion.h"

#include <algorithm>

#include "bake/run/stream_reader.h"
#include "bake/stages/stages.h"
#include "lab/study/run/rows.h"
#include "lab/study/run/run_steps.h"
#include "lab/study/run/scene.h"
#include "platform/files.h"

namespace fourdvt::study {
namespace {

constexpr double kBakeShare = 0.4;

// Options of a bake of the class's members with default settings; unless `quick`, also of the study's other sequences,
// for transitions.
bake::BakeOptions motionBake(const StudyContext& context, const capture::CaptureClass& motion_class) {
  bake::BakeOptions options = defaultBake(context, context.work() + "/motion/character");
  for (const capture::CaptureSequence& sequence : context.capture->sequences) {
    const auto is_member = [&](const auto& member) { return member.sequence == sequence.name; };
    const auto& wanted = context.options.sequences;
    const bool asked = !context.options.quick && std::find(wanted.begin(), wanted.end(), sequence.name) != wanted.end();
    if (asked || std::any_of(motion_class.members.begin(), motion_class.members.end(), is_member))
      options.sequences.push_back(sequence.name);
  }
  options.survey_folder = context.work() + "/survey";
  // The step "methods" has baked all sequences with the same settings.
  const std::string baked = context.work() + "/methods/" + rows::kJointDefault;
  if (options.sequences == context.options.sequences && isCharacter(baked)) options.character_folder = baked;
  return options;
}

// Vertex order and common time of the class, as found by the bake.
Result<MotionTruth::Baked> asBaked(const StudyContext& context, const bake::BakeOptions& options,
                                   const capture::CaptureClass& motion_class) {
  const bake::BakeEnvironment environment = bakeEnvironment(context);
  auto validated = bake::validate(options, environment);
  platform::removeIfEmpty(options.character_folder + ".work");  // removed only if empty: no bake is in progress there
  if (!validated) return validated.error();
  bake::BakeRun run(validated.take(), environment);
  FOURDVT_TRY(bake::refineJob(run));
  bake::Job& job = run.job;
  bake::MeshReader meshes(job);
  const capture::Capture& capture = job.capture;
  FOURDVT_ASSIGN(auto members, bake::classMembers(capture, motion_class, meshes.function()));
  MotionTruth::Baked out;
  for (const bake::ClassMember& member : members) {
    const double pass = member.source->frame_count - (member.source->loop ? 0 : 1);
    out.passed.emplace_back();
    for (const double frame : member.source_frame) out.passed.back().push_back(frame / pass);
  }
  out.mesh = std::move(job.mesh);
  return out;
}

struct Part {
  const char* name;
  Result<Rows> (*measure)(const MotionSubject& subject);
};
constexpr Part kParts[] = {{"motion-blend", measureBlend},
                           {"motion-flow", measureFlow},
                           {"motion-appearance", measureAppearance},
                           {"motion-cost", measureCost},
                           {"motion-transitions", measureTransitions},
                           {"motion-skate", measureSkate},
                           {"motion-pictures", drawMotionPictures}};

}  // namespace

std::vector<uint32_t> MotionSubject::phases(size_t count) const {
  std::vector<uint32_t> out;
  const size_t frames = motion().frame_count, kept = std::min(count, frames);
  for (size_t i = 0; i < kept; ++i) out.push_back(static_cast<uint32_t>(i * frames / kept));
  return out;
}

std::vector<AlignMethod> MotionSubject::methods(const std::vector<AlignMethod>& wanted) const {
  std::vector<AlignMethod> out;
  for (const AlignMethod& method : wanted)
    if (alignOf(method) != render::Align::Baked || stage.aligned()) out.push_back(method);
  return out;
}

std::vector<double> motionAzimuths_deg(size_t count) {
  std::vector<double> out;
  for (size_t i = 0; i < count; ++i) out.push_back(kFirstAzimuth_deg + 360.0 * double(i) / double(count));
  return out;
}

Result<Rows> runMotion(const StudyContext& context) {
  if (context.capture->classes.empty()) return Rows();
  const capture::CaptureClass& motion_class = context.capture->classes.front();
  const bake::BakeOptions options = motionBake(context, motion_class);
  FOURDVT_TRY(bakeOnce(context, options, [&](const std::string& stage, double share) {
    reportProgress(context, "motion", "bake " + stage, kBakeShare * share);
  }));
  FOURDVT_ASSIGN(auto stage, MotionStage::open(*context.device, options.character_folder, motion_class.name));
  FOURDVT_ASSIGN(auto baked, asBaked(context, options, motion_class));
  FOURDVT_ASSIGN(auto truth, MotionTruth::open(context, stage->motion(), std::move(baked)));
  FOURDVT_TRY(platform::makeFolder(context.pictures()));
  const MotionSubject subject{context, options.character_folder, *stage, truth.get()};
  Rows out;
  double done = 0;
  for (const Part& part : kParts) {
    reportProgress(context, "motion", std::string(part.name).substr(7),
                   kBakeShare + (1 - kBakeShare) * done++ / std::size(kParts));
    FOURDVT_TRY(addPart(
        context, part.name, [&] { return part.measure(subject); }, out));
  }
  return out;
}

}  // namespace fourdvt::study
