// SPDX-License-Identifier: Apache-2.0
// FVVR against the held-out cameras: the papers' form on mesh and cameras as given and as refined, from fewer cameras,
// and at its best (render::tunedFvvr). On the study's first sequence also what that was chosen from: the tuned options
// with another value of one of them, or of both exponents. Memory: one frame of pictures.
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "base/text.h"
#include "lab/study/run/row_writer.h"
#include "lab/study/run/rows.h"
#include "lab/study/run/run_steps.h"
#include "lab/study/run/scene.h"
#include "lab/study/steps/steps.h"
#include "mattes/frame_reader.h"

namespace fourdvt::study {
namespace {

using namespace rows;

struct Variant {
  std::string name;  // method, or setting of kTuning
  render::FvvrOptions options;
  measure::MeanScores scores;
};

std::string settingOf(const render::FvvrOptions& o) {
  return printed("closest=%d facing=%g view=%g cosine=%g filter=%s unseen=%s", o.closest, o.facing_exponent,
                 o.view_exponent, o.min_cosine, o.sharp ? "sharp" : "bilinear",
                 o.unseen == render::Unseen::Neighbourhood ? "filled" : "best-facing");
}

// Lists each set of options once.
std::vector<Variant> tuningVariants() {
  std::vector<Variant> out;
  const auto add = [&](const render::FvvrOptions& options) {
    const std::string setting = settingOf(options);
    if (std::none_of(out.begin(), out.end(), [&](const Variant& v) { return v.name == setting; }))
      out.push_back({setting, options, {}});
  };
  const render::FvvrOptions tuned = render::tunedFvvr();
  const auto addWith = [&](auto field, auto... values) {
    for (const auto value : {values...}) {
      render::FvvrOptions options = tuned;
      options.*field = value;
      add(options);
    }
  };
  using Options = render::FvvrOptions;
  add(Options());
  add(tuned);
  for (const float facing : {1.f, 2.f, 3.f, 4.f})
    for (const float view : {1.f, 2.f, 3.f, 4.f}) {
      render::FvvrOptions options = tuned;
      options.facing_exponent = facing, options.view_exponent = view;
      add(options);
    }
  addWith(&Options::closest, 3, 4, 0);
  addWith(&Options::min_cosine, 0.f, .1f, .2f, .3f);
  addWith(&Options::sharp, false, true);
  addWith(&Options::unseen, render::Unseen::BestFacing, render::Unseen::Neighbourhood);
  return out;
}

class FvvrScores {
 public:
  FvvrScores(const StudyContext& context, const capture::CaptureSequence& sequence, bool tunes)
      : context_(context), sequence_(sequence) {
    methods_ = {
        {kFvvr, {}, {}}, {kFvvrTuned, render::tunedFvvr(), {}}, {kFvvrClosest, {.closest = kClosestCameras}, {}}};
    if (tunes) tuning_ = tuningVariants();
  }
  Result<Rows> run(const std::vector<PinholeCamera>& held_out);

 private:
  Status frame(mattes::CaptureFrame& captured, const std::vector<PinholeCamera>& held_out);
  Status view(const PinholeCamera& camera, uint32_t frame);
  // Scores the papers' form on the unrefined mesh and cameras, if they differ.
  Status viewAsGiven(const PinholeCamera& camera, uint32_t frame);

  const StudyContext& context_;
  const capture::CaptureSequence& sequence_;
  std::vector<Variant> methods_, tuning_;
  measure::MeanScores given_;
  std::unique_ptr<render::Fvvr> fvvr_, given_fvvr_;
  Rows views_;
};

Status FvvrScores::view(const PinholeCamera& camera, uint32_t frame) {
  FOURDVT_ASSIGN(const auto truth, measure::heldOutTruth(sequence_, camera, frame));
  FOURDVT_ASSIGN(const auto seen, drawSeen(*fvvr_, camera));
  std::vector<Variant*> variants;
  for (auto* list : {&methods_, &tuning_})
    for (Variant& variant : *list) variants.push_back(&variant);
  measure::ScoreLane lane;
  for (const Variant* variant : variants) {
    FOURDVT_TRY(checkStop(context_));
    FOURDVT_ASSIGN(auto picture, fvvr_->renderStill(render::viewFromCamera(camera), variant->options));
    lane.addSeen(truth, std::move(picture), seenMask(seen));
  }
  const auto scores = lane.finish();
  for (size_t i = 0; i < scores.size(); ++i) variants[i]->scores.add(scores[i].second);
  for (size_t i = 0; i < methods_.size(); ++i) {
    measure::MeanScores one;
    one.add(scores[i].second);
    writeScores({views_, kHeldOutViews, sequence_.name, methods_[i].name, viewSetting(camera, frame)}, one);
  }
  return {};
}

Status FvvrScores::viewAsGiven(const PinholeCamera& camera, uint32_t frame) {
  FOURDVT_ASSIGN(const auto truth, measure::heldOutTruth(sequence_, camera, frame));
  FOURDVT_ASSIGN(const auto picture, given_fvvr_->renderStill(render::viewFromCamera(camera), {}));
  given_.add(measure::scorePicture(truth, picture));
  return {};
}

Status FvvrScores::frame(mattes::CaptureFrame& captured, const std::vector<PinholeCamera>& held_out) {
  if (given_fvvr_) {
    FOURDVT_ASSIGN(const auto positions, capture::readMeshFrame(*context_.given, sequence_, captured.index));
    FOURDVT_TRY(given_fvvr_->setFrame(positions, captured.pictures));
    for (const PinholeCamera& camera : held_out) FOURDVT_TRY(viewAsGiven(camera, captured.index));
  }
  cleanEdges(captured.pictures);
  FOURDVT_TRY(fvvr_->setFrame(captured.positions, captured.pictures));
  for (const PinholeCamera& camera : held_out) FOURDVT_TRY(view(camera, captured.index));
  return {};
}

Result<Rows> FvvrScores::run(const std::vector<PinholeCamera>& held_out) {
  FOURDVT_ASSIGN(fvvr_, makeFvvr(context_));
  if (context_.options.refine.any()) {
    std::vector<PinholeCamera> cameras;
    for (const auto& camera : context_.given->cameras) cameras.push_back(camera.pinhole);
    FOURDVT_ASSIGN(given_fvvr_, render::Fvvr::create(*context_.device, cameras, context_.given->topology));
  }
  FOURDVT_ASSIGN(const auto reader, mattes::FrameReader::open(*context_.capture, sequence_, context_.open_video));
  for (const uint32_t index : sequence_.test_frames) {
    reader->skipTo(index);
    FOURDVT_ASSIGN(auto captured, reader->next());
    FOURDVT_TRY(frame(captured, held_out));
  }
  Rows out;
  const auto add = [&](const std::string& method, const measure::MeanScores& scores) {
    writeScores({out, kHeldOut, sequence_.name, method, "views=" + std::to_string(scores.count())}, scores);
  };
  for (const Variant& variant : methods_) add(variant.name, variant.scores);
  add(kFvvrGiven, given_);
  for (const Variant& variant : tuning_)
    writeScores({out, kTuning, sequence_.name, kFvvr, variant.name}, variant.scores);
  out.insert(out.end(), views_.begin(), views_.end());
  return out;
}

}  // namespace

Result<Rows> runFvvr(const StudyContext& context) {
  FOURDVT_ASSIGN(const auto held_out, heldOutCameras(context));
  const auto sequences = studySequences(context);
  Rows out;
  for (const auto* sequence : sequences) {
    const bool is_first = sequence == sequences.front();
    reportProgress(context, "fvvr", sequence->name, is_first ? 0 : 0.5);
    FOURDVT_TRY(addPart(
        context, "fvvr-" + sequence->name, [&] { return FvvrScores(context, *sequence, is_first).run(held_out); },
        out));
  }
  return out;
}

}  // namespace fourdvt::study
