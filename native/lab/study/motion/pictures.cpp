// SPDX-License-Identifier: Apache-2.0
// Pictures of the step "motion": columns of w from one member to the other (Casas et al. 2014, Fig. 7-8), crops half
// way between them, a transition tick by tick.
#include "lab/study/motion/motion.h"
#include "lab/study/motion/player.h"
#include "lab/study/run/picture_parts.h"
#include "lab/study/run/rows.h"
#include "lab/study/run/run_steps.h"
#include "lab/study/tables/report.h"
#include "report/picture_sheets.h"

namespace fourdvt::study {
namespace {

constexpr int kPictureWidth = 720, kPictureHeight = 960, kCropMargin = 12, kShownWidth = 200;
constexpr double kColumnWeights[] = {0, 0.2, 0.4, 0.5, 0.6, 0.8, 1};
constexpr int kTransitionCells = 9;

Image narrowed(const Image& rgba, const std::array<int, 4>& box) {
  const Image part = report::overGrey(report::cropped(rgba, box[0], box[1], box[2], box[3]));
  return report::scaledTo(part, kShownWidth, std::max(1, part.height * kShownWidth / part.width));
}

std::string columnTitle(double w) { return "w = " + fixedText(w, 1); }

class PicturePart {
 public:
  explicit PicturePart(const MotionSubject& subject) : subject_(subject), stage_(subject.stage) {}

  Result<Rows> run() {
    const auto phases = subject_.phases(6);
    int number = 0;
    for (const uint32_t phase : {phases[1], phases[phases.size() / 2]})
      for (const double azimuth : {25.0, 115.0}) {
        if (subject_.quick() && number > 0) break;
        FOURDVT_TRY(columns(phase, azimuth, ++number));
      }
    if (subject_.truth) FOURDVT_TRY(truthCrops());
    FOURDVT_TRY(transition());
    return std::move(out_);
  }

 private:
  std::vector<AlignMethod> methods() const {
    return subject_.methods({rows::kAlignNone, rows::kFlowGpu, rows::kAlignBaked});
  }
  Status columns(uint32_t phase, double azimuth, int number);
  Status truthCrops();
  Status transition();
  Status save(const std::string& file, const Image& sheet, const std::string& setting, const char* caption);

  const MotionSubject& subject_;
  MotionStage& stage_;
  Rows out_;
};

Status PicturePart::save(const std::string& file, const Image& sheet, const std::string& setting, const char* caption) {
  return addPicture(subject_.context, file, sheet,
                    {"", subject_.motion().name, "", setting + " " + sizeSetting(sheet), caption, 0, ""}, out_);
}

Status PicturePart::columns(uint32_t phase, double azimuth, int number) {
  FOURDVT_TRY(stage_.show(phase));
  const PinholeCamera camera = stage_.orbit(azimuth, kPictureWidth, kPictureHeight);
  FOURDVT_ASSIGN(auto middle, stage_.draw(camera, 0.5, rows::kAlignNone));
  const auto box = report::shownBox(middle, 4 * kCropMargin);
  report::Sheet sheet{subject_.motion().name + ", phase " + std::to_string(phase), {}, {}, {}};
  report::Sheet crops{sheet.title + ", w = 0.5", {"view", "crop", "crop", "crop"}, {}, {}};
  for (const double w : kColumnWeights) sheet.columns.push_back(columnTitle(w));
  for (const AlignMethod& method : methods()) {
    sheet.rows.push_back(method);
    crops.rows.push_back(method);
    std::vector<Image> row;
    for (const double w : kColumnWeights) {
      FOURDVT_TRY(checkStop(subject_.context));
      stage_.setMesh(stage_.blended(w));
      FOURDVT_ASSIGN(auto picture, stage_.draw(camera, w, method));
      row.push_back(narrowed(picture, box));
      if (w == 0.5) crops.cells.push_back(viewWithCrops(picture, report::shownBox(picture, kCropMargin)));
    }
    sheet.cells.push_back(std::move(row));
  }
  const std::string setting = "frame=" + std::to_string(phase) + " view=" + std::to_string(int(azimuth));
  FOURDVT_TRY(save("motion-columns-" + std::to_string(number) + ".jpg", report::drawSheet(sheet), setting,
                   rows::kPictureMotionColumns));
  return save("motion-crops-" + std::to_string(number) + ".jpg", report::drawSheet(crops), setting,
              rows::kPictureMotionCrops);
}

// Draws crops at the truth's step nearest to the middle, on its mesh, beside the rendered ones.
Status PicturePart::truthCrops() {
  const MotionTruth& truth = *subject_.truth;
  const MotionTruth::Instant instant = truth.instants()[truth.instants().size() / 2];
  const auto nearer = [](const auto& a, const auto& b) { return std::abs(a.w - 0.5) < std::abs(b.w - 0.5); };
  const MotionTruth::Step& step = *std::min_element(truth.steps().begin(), truth.steps().end(), nearer);
  const PinholeCamera& camera = truth.cameras().front();
  const uint32_t frame = truth.classFrame(step.w, instant);
  FOURDVT_TRY(stage_.show(frame));
  FOURDVT_ASSIGN(auto mesh, truth.mesh(step, instant));
  stage_.setMesh(std::move(mesh));
  FOURDVT_ASSIGN(auto exact, truth.picture(step, camera, instant));
  const auto box = report::shownBox(exact, kCropMargin);
  report::Sheet crops{subject_.motion().name + ", " + columnTitle(step.w) + ", on the true mesh",
                      {"view", "crop", "crop", "crop"},
                      {},
                      {}};
  for (const AlignMethod& method : methods()) {
    FOURDVT_ASSIGN(auto picture, stage_.draw(camera, step.w, method));
    crops.rows.push_back(method);
    crops.cells.push_back(viewWithCrops(picture, box));
  }
  crops.rows.push_back("truth");
  crops.cells.push_back(viewWithCrops(exact, box));
  return save("motion-truth.jpg", report::drawSheet(crops), "frame=" + std::to_string(frame) + " view=" + camera.name,
              rows::kPictureMotionCrops);
}

// Draws the transition from the first member's own sequence to the last one's.
Status PicturePart::transition() {
  const package::Character& character = stage_.character();
  const std::string from = subject_.motion().members.front().name;
  std::string to = subject_.motion().members.back().name;
  for (const package::Sequence& sequence : character.sequences)
    if (!sequence.isClass() && !sequence.loop) to = sequence.name;  // larger visible change
  if (character.graph_uri.empty() || !character.find(from) || !character.find(to)) return {};
  FOURDVT_ASSIGN(auto watched, WatchedPlayer::open(*subject_.context.device, subject_.folder, false));
  FOURDVT_TRY(watched->start(from, 0, std::nan("")));
  FOURDVT_TRY(watched->player().goTo(to));
  report::Sheet sheet{from + " to " + to + ", every second tick from the fade's first", {}, {}, {{}}};
  bool faded = false;
  for (int tick = 0, kept = 0; tick < 60 && kept < kTransitionCells; ++tick) {
    FOURDVT_TRY(watched->tick());
    faded |= watched->player().inTransition();
    if (!faded || tick % 2) continue;
    sheet.columns.push_back(std::to_string(80 * kept) + " ms");
    sheet.cells[0].push_back(report::overGrey(watched->picture()));
    ++kept;
  }
  if (sheet.cells[0].empty()) return {};
  return save("motion-transition.jpg", report::drawSheet(sheet), "from=" + from + " to=" + to,
              rows::kPictureTransition);
}

}  // namespace

Result<Rows> drawMotionPictures(const MotionSubject& subject) { return PicturePart(subject).run(); }

}  // namespace fourdvt::study
