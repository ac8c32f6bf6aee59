// SPDX-License-Identifier: Apache-2.0
// Contact sheets: methods side by side on the given mesh, on hulls and with camera errors, whole and close up (Floating
// Textures, Eisemann et al. 2008, Fig. 8); each method's worst held-out view; and the pictures of Montage4D's
// cross-validation.
#include <algorithm>
#include <cmath>

#include "lab/measure/held_out_truth.h"
#include "lab/study/projective/projective_study.h"
#include "lab/study/projective/setup.h"
#include "lab/study/run/run_steps.h"
#include "report/document.h"
#include "report/picture_sheets.h"

namespace fourdvt::study {
namespace {

using namespace rows;

constexpr int kBody_px = 400, kCloseUp_px = 300, kMargin_px = 12;

// Held-out camera farthest in angle from the input cameras, as the viewpoints of Eisemann et al. 2008.
const PinholeCamera& farthestView(const std::vector<PinholeCamera>& test, const std::vector<PinholeCamera>& inputs) {
  const PinholeCamera* best = &test.front();
  double least = 2;  // cosine to the nearest input
  for (const PinholeCamera& view : test) {
    double nearest = -1;
    for (const PinholeCamera& input : inputs)
      nearest = std::max(nearest, glm::dot(view.forwardInWorld(), input.forwardInWorld()));
    if (nearest < least) least = nearest, best = &view;
  }
  return *best;
}

Image wholeCell(const Image& rgba, const std::array<int, 4>& box) {
  const Image part = report::overGrey(report::cropped(rgba, box[0], box[1], box[2], box[3]));
  return report::scaledTo(part, std::max(1, part.width * kBody_px / part.height), kBody_px);
}

// Head and shoulders: upper part of the body's box.
Image closeUpCell(const Image& rgba, const std::array<int, 4>& box) {
  const int side = std::min(box[2], box[3] / 3);
  const Image part = report::overGrey(report::cropped(rgba, box[0] + (box[2] - side) / 2, box[1], side, side));
  return report::scaledTo(part, kCloseUp_px, kCloseUp_px);
}

Image differenceTimes4(const Image& truth, const Image& drawn) {
  const Image a = report::overGrey(truth, 0), b = report::overGrey(drawn, 0);
  Image out(a.width, a.height, 3);
  for (size_t i = 0; i < a.pixels.size(); ++i)
    out.pixels[i] = uint8_t(std::min(255, 4 * std::abs(int(a.pixels[i]) - int(b.pixels[i]))));
  return out;
}

class MethodSheets {
 public:
  MethodSheets(const StudyContext& context, ProjectiveSetup& setup) : context_(context), setup_(setup) {}
  Result<Rows> run();

 private:
  std::vector<Condition> shownConditions() const;
  Status figure8(FrameWindow& frames);
  Status worst(FrameWindow& frames, const Condition& condition, const Rows& views);
  Status crossValidation(FrameWindow& frames);
  Status save(const std::string& file, const report::Sheet& sheet, const std::string& sequence,
              const std::string& setting, const char* caption);

  const StudyContext& context_;
  ProjectiveSetup& setup_;
  Rows out_;
};

Status MethodSheets::save(const std::string& file, const report::Sheet& sheet, const std::string& sequence,
                          const std::string& setting, const char* caption) {
  const Image picture = report::drawSheet(sheet);
  return addPicture(context_, file, picture, {"", sequence, "", setting + " " + sizeSetting(picture), caption, 1, ""},
                    out_);
}

std::vector<Condition> MethodSheets::shownConditions() const {
  std::vector<Condition> out;
  for (const Condition& condition : proxyConditions(context_.options.quick))
    for (const char* at : {kProxyGiven, "given-500", kProxyRefined, kProxyHull, kProxyPlane})
      if (condition.at == at) out.push_back(condition);
  for (const Condition& condition : calibrationConditions(context_.options.quick))
    if (condition.axis == kAxisRotation && condition.at == "0.1") out.push_back(condition);
  return out;
}

Status MethodSheets::figure8(FrameWindow& frames) {
  const std::vector<std::string>& names = setup_.methods();
  const uint32_t frame = spreadTestFrames(frames.sequence(), 1).front();
  const PinholeCamera& view = farthestView(setup_.testCameras(), setup_.cameras());
  FOURDVT_ASSIGN(const Image truth, measure::heldOutTruth(frames.sequence(), view, frame));
  const auto box = report::shownBox(truth, kMargin_px);
  report::Sheet whole{
      frames.sequence().name + ", frame " + std::to_string(frame) + ", " + view.name, {"truth"}, {}, {}};
  whole.columns.insert(whole.columns.end(), names.begin(), names.end());
  report::Sheet close = whole;
  for (const Condition& condition : shownConditions()) {
    FOURDVT_TRY(checkStop(context_));
    FOURDVT_ASSIGN(auto methods, setup_.make(names));
    FOURDVT_ASSIGN(const FrameScene scene, setup_.scene(condition, frames, frame));
    FOURDVT_TRY(setup_.show(condition, scene, view));
    setup_.stage().leaveOut({});
    const std::string title = condition.axis == kAxisProxy ? condition.at : "off by .1 deg";
    whole.rows.push_back(title), close.rows.push_back(title);
    whole.cells.push_back({wholeCell(truth, box)}), close.cells.push_back({closeUpCell(truth, box)});
    for (const std::string& name : names) {
      FOURDVT_ASSIGN(const Image drawn, setup_.draw(methods[name], condition, scene, view, truth, kStill));
      whole.cells.back().push_back(wholeCell(drawn, box));
      close.cells.back().push_back(closeUpCell(drawn, box));
    }
  }
  const std::string setting = "view=" + view.name + " frame=" + std::to_string(frame);
  const std::string stem = "-" + frames.sequence().name + ".jpg";
  FOURDVT_TRY(save("methods" + stem, whole, frames.sequence().name, setting, kPictureMethods));
  return save("close-ups" + stem, close, frames.sequence().name, setting, kPictureCloseUps);
}

Status MethodSheets::worst(FrameWindow& frames, const Condition& condition, const Rows& views) {
  const std::string& sequence = frames.sequence().name;
  report::Sheet sheet{sequence + ", " + condition.at + ": worst views by SSIM-FG",
                      {},
                      {"truth", "drawn", "difference x 4"},
                      std::vector<std::vector<Image>>(3)};
  for (const std::string& name : setup_.methods()) {
    const Row* least = nullptr;
    for (const Row& row : views)
      if (row.table == kConditionView && row.sequence == sequence && row.method == name && row.quantity == kSsimFg &&
          settingText(row.setting, "axis") == condition.axis && settingText(row.setting, "at") == condition.at &&
          (!least || row.value < least->value))
        least = &row;
    if (!least) continue;
    FOURDVT_TRY(checkStop(context_));
    const auto frame = static_cast<uint32_t>(settingNumber(least->setting, "frame"));
    const std::string camera = settingText(least->setting, "view");
    const auto view = std::find_if(setup_.testCameras().begin(), setup_.testCameras().end(),
                                   [&](const PinholeCamera& c) { return c.name == camera; });
    if (view == setup_.testCameras().end()) continue;
    FOURDVT_ASSIGN(auto methods, setup_.make({name}));
    FOURDVT_ASSIGN(const FrameScene scene, setup_.scene(condition, frames, frame));
    FOURDVT_TRY(setup_.show(condition, scene, *view));
    setup_.stage().leaveOut({});
    FOURDVT_ASSIGN(const Image truth, measure::heldOutTruth(frames.sequence(), *view, frame));
    FOURDVT_ASSIGN(const Image drawn, setup_.draw(methods[name], condition, scene, *view, truth, kStill));
    const Image difference = differenceTimes4(truth, drawn);
    const auto box = report::shownBox(truth, kMargin_px);
    sheet.columns.push_back(name + " " + report::fixedText(least->value, 3));
    const Image* shown[] = {&truth, &drawn, &difference};
    for (size_t row = 0; row < 3; ++row) sheet.cells[row].push_back(wholeCell(*shown[row], box));
  }
  if (sheet.columns.empty()) return {};
  return save("worst-" + condition.at + "-" + sequence + ".jpg", sheet, sequence, "at=" + condition.at,
              kPictureWorstViews);
}

// Draws the first input camera's view without its picture and with it.
Status MethodSheets::crossValidation(FrameWindow& frames) {
  std::vector<std::string> names;
  for (const char* name : {kMethodHoloportation, kMethodMontage})
    for (const std::string& known : setup_.methods())
      if (known == name) names.push_back(known);
  if (names.empty()) return {};
  constexpr size_t kCamera = 0;
  const uint32_t frame = spreadTestFrames(frames.sequence(), 1).front();
  const PinholeCamera& view = setup_.cameras()[kCamera];
  FOURDVT_ASSIGN(const auto* captured, frames.at(frame));
  const Image truth = inputTruth(captured->pictures[kCamera]);
  const auto box = report::shownBox(truth, kMargin_px);
  report::Sheet sheet{frames.sequence().name + ", frame " + std::to_string(frame) + ", " + view.name +
                          ", drawn without its picture and with it (+)",
                      {"truth"},
                      {},
                      {}};
  for (const char* own : {"", " +"})
    for (const std::string& name : names) sheet.columns.push_back(name + own);
  for (const Condition& condition : proxyConditions(context_.options.quick)) {
    if (condition.at != kProxyGiven && condition.at != kProxyHull) continue;
    FOURDVT_TRY(checkStop(context_));
    FOURDVT_ASSIGN(auto methods, setup_.make(names));
    FOURDVT_ASSIGN(const FrameScene scene, setup_.scene(condition, frames, frame));
    FOURDVT_TRY(setup_.show(condition, scene, view));
    sheet.rows.insert(sheet.rows.end(), {condition.at, "difference x 4"});
    std::vector<Image> drawn_cells{wholeCell(truth, box)}, difference_cells{Image()};
    for (const bool own : {false, true}) {
      setup_.stage().leaveOut(own ? std::span<const size_t>() : std::span<const size_t>(&kCamera, 1));
      for (const std::string& name : names) {
        FOURDVT_ASSIGN(const Image drawn, setup_.draw(methods[name], condition, scene, view, truth, kStill));
        drawn_cells.push_back(wholeCell(drawn, box));
        difference_cells.push_back(wholeCell(differenceTimes4(truth, drawn), box));
      }
    }
    sheet.cells.push_back(std::move(drawn_cells));
    sheet.cells.push_back(std::move(difference_cells));
  }
  setup_.stage().leaveOut({});
  return save("cross-" + frames.sequence().name + ".jpg", sheet, frames.sequence().name, "view=" + view.name,
              kPictureCross);
}

Result<Rows> MethodSheets::run() {
  FOURDVT_ASSIGN(const Rows views, rowsOfStep(context_, "proxies"));
  const auto sequences = projectiveSequences(context_);
  double done = 0;
  for (const auto* sequence : sequences) {
    FrameWindow frames(*context_.capture, *sequence, context_.open_video);
    reportProgress(context_, "", sequence->name, done++ / double(sequences.size()));
    FOURDVT_TRY(figure8(frames));
    FOURDVT_TRY(crossValidation(frames));
    for (const Condition& condition : proxyConditions(context_.options.quick))
      if (condition.at == kProxyGiven || condition.at == kProxyHull) FOURDVT_TRY(worst(frames, condition, views));
  }
  return std::move(out_);
}

}  // namespace

Result<Rows> runMethodPictures(const StudyContext& context) {
  FOURDVT_ASSIGN(auto setup, ProjectiveSetup::create(context, *context.device));
  return MethodSheets(context, *setup).run();
}

}  // namespace fourdvt::study
