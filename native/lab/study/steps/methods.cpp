// SPDX-License-Identifier: Apache-2.0
// Table 1 of Casas et al. 2014: the same capture baked with each labelling mode at the papers' size, and with this
// project's defaults. Measures storage, loading, fidelity to FVVR on the ring and to ground truth at the held-out
// cameras, and label statistics.
#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "bake/bake.h"
#include "base/text.h"
#include "base/watch.h"
#include "lab/labels/paper_labellings.h"
#include "lab/measure/held_out.h"
#include "lab/study/run/row_writer.h"
#include "lab/study/run/rows.h"
#include "lab/study/run/run_steps.h"
#include "lab/study/run/scene.h"
#include "lab/study/steps/labels.h"
#include "lab/study/steps/steps.h"
#include "lab/study/tables/report.h"
#include "measure/metrics.h"
#include "measure/picture_score.h"
#include "platform/files.h"

namespace fourdvt::study {
namespace {

using namespace rows;

// Variant of the capture's bake.
struct Method {
  std::string name;  // name in the rows
  bake::BakeOptions options;
  std::string setting() const {
    return printed("layers=%d size=%d codec=%s crf=%d layout=%s", options.layers, options.texture,
                   encode::infoOf(options.codec).name, options.crf, options.equal_layers ? "equal" : "default");
  }
};

// Lists the variants, the default first: its time includes the survey, which the others share.
std::vector<Method> studyMethods(const StudyContext& context) {
  const bake::BakeOptions shared = studyBake(context, kJointDefault);
  bake::BakeOptions plain = defaultBake(context, shared.character_folder);
  plain.survey_folder = shared.survey_folder;
  plain.sequences = shared.sequences;
  plain.resume = false;
  std::vector<Method> out{{kJointDefault, plain}};
  for (const bake::Labelling* rule :
       {&lab::kNaive, &lab::kSpatial, &lab::kTemporalPaper, &lab::kPerTexel, &bake::kJoint}) {
    if (rule == &lab::kPerTexel && context.options.quick) continue;
    Method method{rule->name, studyBake(context, std::string(rule->name) + "-512")};
    lab::useLabelling(*rule, method.options);
    method.options.texture = kPaperTexture;
    method.options.equal_layers = true;
    out.push_back(std::move(method));
  }
  return out;
}

// Bakes one method, then measures all quantities that depend only on its character.
class MethodStudy {
 public:
  MethodStudy(const StudyContext& context, const Method& method, double before, double share)
      : context_(context), method_(method), before_(before), share_(share) {}
  Result<Rows> run();

 private:
  Status bakeCharacter();
  Status storage(const capture::CaptureSequence& sequence);
  Status loading(const capture::CaptureSequence& sequence);
  Status ring(const capture::CaptureSequence& sequence);
  Status heldOut(const capture::CaptureSequence& sequence);
  Status worstPicture(const capture::CaptureSequence& sequence, const PinholeCamera& camera, uint32_t frame,
                      double ssim);
  void labels(const capture::CaptureSequence& sequence);
  Result<Image> picture(const PinholeCamera& camera, const std::string& sequence, uint32_t frame) {
    FOURDVT_TRY(checkStop(context_));
    FOURDVT_TRY(player_->showFrame(sequence, frame));
    return player_->renderStill(render::viewFromCamera(camera), studyRecipe());
  }
  void tell(const std::string& what, double share) const {
    reportProgress(context_, "methods", method_.name + " " + what, before_ + share_ * share);
  }

  const StudyContext& context_;
  const Method& method_;
  double before_, share_;
  bake::BakeReport baked_;
  FlatJson report_;
  std::unique_ptr<edge::CharacterPlayer> player_;
  std::vector<PinholeCamera> held_out_;
  Rows out_;
};

Status MethodStudy::bakeCharacter() {
  const bool timed = method_.name == kJointDefault;
  if (timed) platform::removeFolder(method_.options.survey_folder);
  FOURDVT_ASSIGN(baked_, runBake(context_, method_.options,
                                 [this](const std::string& stage, double share) { tell(stage, 0.6 * share); }));
  FOURDVT_ASSIGN(report_,
                 platform::readJsonFlat(bake::reportFolderOf(method_.options.character_folder) + "/report.json"));
  if (!timed) return {};
  RowWriter(out_, kBake, "", kJointDefault, "").add({{kSecondsFrame, report_.number("/wall_s_per_frame").value_or(0)}});
  for (const auto& [stage, seconds] : baked_.seconds_by_stage)
    RowWriter(out_, kBake, "", kJointDefault, "stage=" + stage).add({{kSecondsFrame, seconds / baked_.frames}});
  std::string encoder = std::string(encode::infoOf(method_.options.codec).name);
  if (const auto version = report_.string("/versions/libavcodec")) encoder += ", libavcodec " + *version;
  RowWriter(out_, kAbout, "", "", "text=" + encoder + ", crf " + std::to_string(method_.options.crf))
      .add({{kAboutEncoder, 0}});
  return {};
}

Status MethodStudy::storage(const capture::CaptureSequence& sequence) {
  std::string at;
  for (int i = 0; at.empty() && report_.has("/sequences/" + std::to_string(i)); ++i)
    if (report_.string("/sequences/" + std::to_string(i) + "/name") == sequence.name)
      at = "/sequences/" + std::to_string(i) + "/";
  const auto bytes = [&](const char* key) { return report_.number(at + key).value_or(0); };
  FOURDVT_ASSIGN(const auto gltf, platform::readJsonFlat(method_.options.character_folder + "/character.gltf"));
  const double shared =
      gltf.number("/buffers/0/byteLength").value_or(0) + report_.number("/bytes_by_part/character.gltf").value_or(0);
  const double video = bytes("video_bytes"), geometry = bytes("geometry_bytes"), labels = bytes("label_bytes"),
               other = bytes("index_bytes") + shared;
  if (at.empty() || video <= 0 || geometry <= 0)
    return Error{ErrorId::Internal,
                 bake::reportFolderOf(method_.options.character_folder) + "/report.json: no sizes of " + sequence.name};
  const RowWriter row(out_, kTable1, sequence.name, method_.name, method_.setting());
  row.add({{kTotalBytes, video + geometry + labels + other},
           {kVideoBytes, video},
           {kGeometryBytes, geometry},
           {kLabelBytes, labels},
           {kOtherBytes, other}});
  const double seconds = sequence.frame_count / context_.capture->fps;
  row.add({{kVideoBps, 8 * video / seconds}});
  RowWriter(out_, kLabels, sequence.name, method_.name, "").add({{kLabelBps, 8 * labels / seconds}});
  return {};
}

// Times opening, decoding, uploading and drawing: until the first picture and, unless `quick`, until all pictures of
// the sequence have been loaded.
Status MethodStudy::loading(const capture::CaptureSequence& sequence) {
  player_.reset();
  const Watch watch;
  FOURDVT_ASSIGN(player_, edge::CharacterPlayer::open(*context_.device, method_.options.character_folder));
  FOURDVT_ASSIGN(auto first, picture(captureCameras(context_)[0], sequence.name, 0));
  const double first_s = watch.seconds();
  const RowWriter row(out_, kTable1, sequence.name, method_.name, method_.setting());
  row.add({{kLoadingS, first_s}});
  if (context_.options.quick) return {};
  for (uint32_t f = 1; f < sequence.frame_count; ++f) FOURDVT_TRY(player_->showFrame(sequence.name, f));
  row.add({{kLoadingAllS, watch.seconds()}});
  return {};
}

Status MethodStudy::ring(const capture::CaptureSequence& sequence) {
  FOURDVT_ASSIGN(auto views, studyRing(context_, sequence));
  measure::ScoreLane lane;
  for (const RingView& view : views) {
    FOURDVT_ASSIGN(auto reference, readReference(referencePath(context_, sequence.name, view)));
    FOURDVT_ASSIGN(auto drawn, picture(view.camera, sequence.name, view.frame));
    lane.add(std::move(reference), std::move(drawn));
  }
  writeScores({out_, kTable1, sequence.name, method_.name, method_.setting()}, lane.finishMean());
  return {};
}

Status MethodStudy::heldOut(const capture::CaptureSequence& sequence) {
  measure::ScoreLane lane;
  std::vector<std::pair<const PinholeCamera*, uint32_t>> views;
  for (uint32_t frame : sequence.test_frames)
    for (const PinholeCamera& camera : held_out_) {
      FOURDVT_ASSIGN(auto truth, measure::heldOutTruth(sequence, camera, frame));
      FOURDVT_ASSIGN(auto drawn, picture(camera, sequence.name, frame));
      FOURDVT_ASSIGN(const auto seen, readReference(seenPath(context_, sequence.name, camera.name, frame)));
      lane.addSeen(std::move(truth), std::move(drawn), seenMask(seen), viewSetting(camera, frame));
      views.emplace_back(&camera, frame);
    }
  if (views.empty()) return {};
  measure::MeanScores mean;
  const auto scores = lane.finish();
  size_t worst = 0;
  for (size_t i = 0; i < scores.size(); ++i) {
    mean.add(scores[i].second);
    measure::MeanScores one;
    one.add(scores[i].second);
    writeScores({out_, kHeldOutViews, sequence.name, method_.name, scores[i].first}, one);
    if (scores[i].second.ssim_fg < scores[worst].second.ssim_fg) worst = i;
  }
  writeScores({out_, kHeldOut, sequence.name, method_.name, "views=" + std::to_string(views.size())}, mean);
  if (method_.name != kJointDefault) return {};
  return worstPicture(sequence, *views[worst].first, views[worst].second, scores[worst].second.ssim_fg);
}

Status MethodStudy::worstPicture(const capture::CaptureSequence& sequence, const PinholeCamera& camera, uint32_t frame,
                                 double ssim) {
  FOURDVT_ASSIGN(auto truth, measure::heldOutTruth(sequence, camera, frame));
  FOURDVT_ASSIGN(auto drawn, picture(camera, sequence.name, frame));
  FOURDVT_ASSIGN(auto fvvr, readReference(referencePath(context_, sequence.name, camera.name, frame)));
  const auto scored = [&](const Image& picture) -> measure::ViewQuality {
    const measure::PictureScore score = measure::scorePicture(truth, picture);
    return {score.psnr_fg_db, score.ssim_fg, score.psnr_common_db};
  };
  const measure::WorstView view{{sequence.name, camera.name, frame, true, scored(drawn), scored(fvvr)},
                                measure::compositedOnBlack(truth),
                                measure::compositedOnBlack(drawn),
                                measure::compositedOnBlack(fvvr)};
  const std::string setting =
      "frame=" + std::to_string(frame) + " view=" + camera.name + " score=" + std::to_string(ssim);
  return addPicture(context_, "worst-held-out-" + sequence.name + ".jpg", measure::contactSheet({view}, "FVVR"),
                    {"", sequence.name, kJointDefault, setting, kPictureWorst, ssim, ""}, out_);
}

void MethodStudy::labels(const capture::CaptureSequence& sequence) {
  const auto it = baked_.labels_by_sequence.find(sequence.name);
  if (it == baked_.labels_by_sequence.end()) return;
  const bake::LabelStatistics& s = it->second;
  writeLabelRows(s, kLabels, sequence.name, method_.name, out_);
  const RowWriter row(out_, kLabels, sequence.name, method_.name, "");
  row.add({{kEnergy, s.energy},
           {kEmptyPercent, s.empty_percent},
           {kLabelMsFrame, s.frames ? 1000 * s.seconds / s.frames : 0}});
}

Result<Rows> MethodStudy::run() {
  FOURDVT_ASSIGN(held_out_, heldOutCameras(context_));
  FOURDVT_TRY(bakeCharacter());
  double done = 0;
  const auto sequences = studySequences(context_);
  for (const auto* sequence : sequences) {
    tell(sequence->name + " pictures", 0.6 + 0.4 * done++ / sequences.size());
    FOURDVT_TRY(storage(*sequence));
    FOURDVT_TRY(loading(*sequence));
    FOURDVT_TRY(ring(*sequence));
    FOURDVT_TRY(heldOut(*sequence));
    labels(*sequence);
  }
  return std::move(out_);
}

// Quality measure at the held-out cameras, with the names of the quantities "bytes of FVVR's videos at equal quality"
// and "a method's share of these".
struct EqualQuality {
  const char *theirs, *ours;     // quantities: multi-view videos, held-out table
  const char *percent, *beyond;  // quantities of table1
};
constexpr EqualQuality kEqualQualities[] = {{kHeldOutPsnrDb, kPsnrFgDb, kPercentAtPsnr, kBeyondAtPsnr},
                                            {kHeldOutSsim, kSsimFg, kPercentAtSsim, kBeyondAtSsim},
                                            {kTunedPsnrDb, kPsnrFgDb, kPercentAtTunedPsnr, kBeyondAtTunedPsnr},
                                            {kTunedSsim, kSsimFg, kPercentAtTunedSsim, kBeyondAtTunedSsim}};

std::vector<RatePoint> multiviewLadder(const Rows& reference, const std::string& sequence, const char* quality) {
  std::vector<RatePoint> ladder;
  for (const Row& row : reference) {
    if (row.table != kMultiviewCodec || row.sequence != sequence || row.quantity != kVideoBytes) continue;
    const double value = StudyValues(reference).of(row.table, sequence, row.method, row.setting, quality);
    if (!std::isnan(value)) ladder.push_back({row.value, value});
  }
  return ladder;
}

// Compares a method's total loaded bytes with the foreground-only multi-view: as pictures, and as the videos from which
// FVVR, the papers' and at its best, reaches the same quality at the held-out cameras. No extrapolation beyond the
// measured rates.
void compareStorage(const Rows& reference, const std::string& sequence, const std::vector<Method>& methods, Rows& out) {
  const StudyValues measured(out);
  const double masked = StudyValues(reference).of(kMultiview, sequence, kMethodMultiview, "", kMaskedBytes);
  for (const Method& method : methods) {
    const double total = measured.of(kTable1, sequence, method.name, "", kTotalBytes);
    if (std::isnan(total)) continue;
    const RowWriter row(out, kTable1, sequence, method.name, method.setting());
    if (!std::isnan(masked)) row.add({{kPercentOfMasked, 100 * total / masked}});
    for (const EqualQuality& equal : kEqualQualities) {
      const double quality = measured.of(kHeldOut, sequence, method.name, "", equal.ours);
      const auto [bytes, beyond] = bytesAtQuality(multiviewLadder(reference, sequence, equal.theirs), quality);
      if (bytes) row.add({{equal.percent, 100 * total / *bytes}});
      if (beyond) row.add({{equal.beyond, beyond}});
    }
  }
}

}  // namespace

Result<Rows> runMethods(const StudyContext& context) {
  const std::vector<Method> methods = studyMethods(context);
  const auto sequences = studySequences(context);
  Rows out;
  const double share = 1 / static_cast<double>(methods.size());
  for (size_t m = 0; m < methods.size(); ++m) {
    const auto measure = [&] { return MethodStudy(context, methods[m], share * double(m), share).run(); };
    FOURDVT_TRY(addPart(context, "method-" + methods[m].name, measure, out));
  }
  FOURDVT_ASSIGN(auto reference, rowsOfStep(context, "reference"));
  for (const auto* sequence : sequences) compareStorage(reference, sequence->name, methods, out);
  for (const Method& method : methods)
    if (method.name != kJointDefault && method.name != kJoint) platform::removeFolder(method.options.character_folder);
  return out;
}

Result<Rows> runLabels(const StudyContext& context) { return measureLabels(context); }

}  // namespace fourdvt::study
