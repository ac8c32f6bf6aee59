// SPDX-License-Identifier: Apache-2.0
// Pictures of the study: layers with their camera maps, label changes over frames, grazing views with crops, and the
// seam contrast of these views.
#include <algorithm>
#include <cmath>
#include <map>

#include "lab/labels/paper_labellings.h"
#include "lab/measure/character_frame.h"
#include "lab/study/run/picture_parts.h"
#include "lab/study/run/row_writer.h"
#include "lab/study/run/rows.h"
#include "lab/study/run/run_steps.h"
#include "lab/study/run/scene.h"
#include "lab/study/steps/steps.h"
#include "mattes/frame_reader.h"
#include "platform/files.h"
#include "report/picture_sheets.h"

namespace fourdvt::study {
namespace {

constexpr int kSheetLayers = 4;
constexpr double kGrazing_deg = 40;

// Baked character of the study, and its title on the sheets.
struct Subject {
  std::string method, title, folder;
  int layers = 0;
};

class PictureStep {
 public:
  explicit PictureStep(const StudyContext& context)
      : context_(context), sequence_(shortestSequence(context)), frame_(sequence_.frame_count / 2) {}
  Result<Rows> run();

 private:
  void tell(const std::string& what, double share) const { reportProgress(context_, "pictures", what, share); }
  Status findSubjects();
  Status bakeSheetCharacter(const bake::Labelling& rule, double from);
  Status layersSheet(const Subject& subject);
  Status changesSheet();
  Status grazing();
  Status seamRows();
  Result<Image> draw(const Subject& subject, const PinholeCamera& camera, render::RecipeOptions recipe);
  Result<Image> drawFvvr(const PinholeCamera& camera);
  PinholeCamera orbit(double azimuth_deg, double elevation_deg, int width, int height) const;
  Status save(const std::string& file, const Image& sheet, const Row& row);

  const StudyContext& context_;
  const capture::CaptureSequence& sequence_;
  const uint32_t frame_;
  std::vector<Subject> subjects_;  // the product's own first
  std::map<std::string, std::unique_ptr<edge::CharacterPlayer>> players_;
  std::map<std::string, measure::CharacterFrame> frames_;  // by folder
  std::unique_ptr<render::Fvvr> fvvr_;
  std::vector<double> middles_deg_;  // azimuths midway between neighbouring cameras
  BoundingBox bounds_;               // all characters
  Rows out_;
};

PinholeCamera PictureStep::orbit(double azimuth_deg, double elevation_deg, int width, int height) const {
  OrbitView view = defaultOrbit(bounds_, static_cast<double>(width) / height);
  view.azimuth_deg = azimuth_deg, view.elevation_deg = elevation_deg;
  return cameraFromOrbit(view, width, height);
}

Result<Image> PictureStep::draw(const Subject& subject, const PinholeCamera& camera, render::RecipeOptions recipe) {
  auto& player = players_[subject.folder];
  if (!player) {
    FOURDVT_ASSIGN(player, edge::CharacterPlayer::open(*context_.device, subject.folder));
  }
  FOURDVT_TRY(player->showFrame(sequence_.name, frame_));
  return player->renderStill(render::viewFromCamera(camera), recipe);
}

Result<Image> PictureStep::drawFvvr(const PinholeCamera& camera) {
  if (!fvvr_) {
    FOURDVT_ASSIGN(auto fvvr, makeFvvr(context_));
    FOURDVT_ASSIGN(auto reader, mattes::FrameReader::open(*context_.capture, sequence_, context_.open_video, frame_));
    FOURDVT_ASSIGN(auto frame, nextCleanFrame(*reader));
    FOURDVT_TRY(fvvr->setFrame(frame.positions, frame.pictures));
    fvvr_ = std::move(fvvr);
  }
  return fvvr_->renderStill(render::viewFromCamera(camera), {});
}

Status PictureStep::save(const std::string& file, const Image& sheet, const Row& shown) {
  const std::string setting = shown.setting + (shown.setting.empty() ? "" : " ") + "frame=" + std::to_string(frame_);
  return addPicture(context_, file, sheet,
                    {"", sequence_.name, shown.method, setting + " " + sizeSetting(sheet), shown.quantity, 0, ""},
                    out_);
}

Status PictureStep::bakeSheetCharacter(const bake::Labelling& rule, double from) {
  const std::string name = rule.name;
  const int cameras = static_cast<int>(context_.capture->cameras.size());
  bake::BakeOptions options = studyBake(context_, name);
  options.character_folder = context_.work() + "/pictures/" + name;
  options.sequences = {sequence_.name};
  options.layers = std::min(kSheetLayers, cameras);
  lab::useLabelling(rule, options);
  FOURDVT_TRY(bakeOnce(context_, options,
                       [&](const std::string& stage, double share) { tell(name + ", " + stage, from + 0.3 * share); }));
  subjects_.push_back(
      {name, name + ", L = " + std::to_string(options.layers), options.character_folder, options.layers});
  return {};
}

// Finds the default character of runMethods; unless `quick`, also four layers with our labels and with the naive ones.
Status PictureStep::findSubjects() {
  const std::string folder = context_.work() + "/methods/" + rows::kJointDefault;
  auto product = measure::readCharacter(folder);
  if (product.ok() && product.value().find(sequence_.name))
    subjects_.push_back({rows::kJointDefault, "ours, default", folder, product.value().layer_count});
  if (!context_.options.quick || subjects_.empty()) FOURDVT_TRY(bakeSheetCharacter(bake::kJoint, 0));
  if (!context_.options.quick) FOURDVT_TRY(bakeSheetCharacter(lab::kNaive, 0.3));
  bool first = true;
  for (const Subject& subject : subjects_) {
    FOURDVT_ASSIGN(auto character, measure::readCharacter(subject.folder));
    const BoundingBox& b = character.bounds;
    bounds_ = first ? b : BoundingBox{glm::min(bounds_.min, b.min), glm::max(bounds_.max, b.max)};
    first = false;
    FOURDVT_ASSIGN(auto frame,
                   measure::readCharacterFrame(subject.folder, sequence_.name, frame_, context_.open_video));
    frames_.emplace(subject.folder, std::move(frame));
  }
  return {};
}

// Draws the layers with camera maps (Volino and Hilton 2013, Fig. 3-4; Casas et al. 2014, Fig. 4-5).
Status PictureStep::layersSheet(const Subject& subject) {
  const measure::CharacterFrame& frame = frames_.at(subject.folder);
  const PinholeCamera view = orbit(25, 8, 960, 1280);
  report::Sheet sheet{subject.title + ": " + sequence_.name + ", frame " + std::to_string(frame_),
                      {},
                      {"texture", "camera map", "on the body", "camera map", "share of blend"},
                      std::vector<std::vector<Image>>(5)};
  render::RecipeOptions recipe = studyRecipe();
  FOURDVT_ASSIGN(auto blended, draw(subject, view, recipe));
  const auto box = report::shownBox(blended, 16);
  recipe.debug = render::DebugView::Weights;
  FOURDVT_ASSIGN(auto shares, draw(subject, view, recipe));
  const int shown = std::min(subject.layers, kSheetLayers);
  for (int l = 0; l < shown; ++l) {
    const auto at = static_cast<size_t>(l);
    sheet.columns.push_back("layer " + std::to_string(l + 1));
    sheet.cells[0].push_back(report::scaledTo(frame.layers[at], kCell, kCell));
    sheet.cells[1].push_back(
        report::scaledTo(report::cameraMap(frame.topology, frame.labels[at], 2 * kCell), kCell, kCell));
    recipe.debug_layer = l;
    for (const auto& [row, debug] : {std::pair{2, render::DebugView::Layer}, {3, render::DebugView::Labels}}) {
      recipe.debug = debug;
      FOURDVT_ASSIGN(auto picture, draw(subject, view, recipe));
      sheet.cells[static_cast<size_t>(row)].push_back(bodyCell(report::overGrey(picture), box));
    }
    sheet.cells[4].push_back(bodyCell(report::shareMap(shareOf(shares, l), shares), box));
  }
  sheet.columns.push_back("all layers");
  std::vector<std::string> names;
  for (const auto& camera : context_.capture->cameras) names.push_back(camera.pinhole.name);
  sheet.cells[0].emplace_back();
  sheet.cells[1].push_back(report::cameraLegend(names, kCell, kCell));
  sheet.cells[2].push_back(bodyCell(report::overGrey(blended), box));
  return save("layers-" + subject.method + ".jpg", report::drawSheet(sheet),
              {"", "", subject.method, "layers=" + std::to_string(shown), rows::kPictureLayers, 0, ""});
}

// Draws layer 1's camera map in three frames and the faces that change between them.
Status PictureStep::changesSheet() {
  const uint32_t first = frame_ > 0 && frame_ + 1 < sequence_.frame_count ? frame_ - 1 : 0;
  if (sequence_.frame_count < 3) return {};
  report::Sheet sheet{"Layer 1: camera maps of three frames; faces that change are white", {}, {}, {}};
  for (const char* column : {"frame t - 1", "frame t", "frame t + 1", "t - 1 to t", "t to t + 1"})
    sheet.columns.push_back(column);
  for (const Subject& subject : subjects_) {
    FOURDVT_ASSIGN(auto labels, measure::readCharacterLabels(subject.folder, sequence_.name, first, 3));
    const MeshTopology& topology = frames_.at(subject.folder).topology;
    std::vector<Image> row;
    for (size_t f = 0; f < 3; ++f)
      row.push_back(report::scaledTo(report::cameraMap(topology, labels[f][0], 2 * kCell), kCell, kCell));
    for (size_t f = 0; f < 2; ++f)
      row.push_back(
          report::scaledTo(report::changeMap(topology, labels[f][0], labels[f + 1][0], 2 * kCell), kCell, kCell));
    sheet.rows.push_back(subject.method);
    sheet.cells.push_back(std::move(row));
  }
  return save("label-changes.jpg", report::drawSheet(sheet), {"", "", "", "", rows::kPictureChanges, 0, ""});
}

Status PictureStep::grazing() {
  const size_t count = middles_deg_.size();
  struct View {
    const char *key, *name;
    double azimuth_deg, elevation_deg;
  };
  const View views[] = {{"above", "from above", middles_deg_[0], kGrazing_deg},
                        {"below", "from below", middles_deg_[count / 2], -kGrazing_deg},
                        {"between", "between two cameras", middles_deg_[count - 1], 0}};
  for (size_t i = 0; i < std::size(views); ++i) {
    const View& view = views[i];
    const PinholeCamera camera = orbit(view.azimuth_deg, view.elevation_deg, 720, 960);
    FOURDVT_ASSIGN(auto reference, drawFvvr(camera));
    const auto box = report::shownBox(reference, 12);
    report::Sheet sheet{sequence_.name + ", frame " + std::to_string(frame_) + ", " + view.name,
                        {"view", "crop", "crop", "crop"},
                        {"FVVR"},
                        {viewWithCrops(reference, box)}};
    for (const Subject& subject : subjects_) {
      FOURDVT_ASSIGN(auto picture, draw(subject, camera, studyRecipe()));
      sheet.rows.push_back(subject.method);
      sheet.cells.push_back(viewWithCrops(picture, box));
    }
    FOURDVT_TRY(save("grazing-" + std::to_string(i + 1) + ".jpg", report::drawSheet(sheet),
                     {"", "", "", std::string("view=") + view.key, rows::kPictureGrazing, 0, ""}));
  }
  return {};
}

Status PictureStep::seamRows() {
  const measure::CharacterFrame& mesh = frames_.begin()->second;
  SeamTable table(backdropColour(*context_.capture));
  for (size_t i = 0; i < middles_deg_.size(); i += context_.options.quick ? 2 : 1)
    for (const double elevation_deg : {0.0, kGrazing_deg, -kGrazing_deg}) {
      FOURDVT_TRY(checkStop(context_));
      const PinholeCamera camera = orbit(middles_deg_[i], elevation_deg, 720, 960);
      const std::string view = elevation_deg == 0 ? "mid" : "grazing";
      FOURDVT_ASSIGN(auto reference, drawFvvr(camera));
      table.add(rows::kFvvr, view, mesh, camera, reference);
      for (const Subject& subject : subjects_) {
        FOURDVT_ASSIGN(auto picture, draw(subject, camera, studyRecipe()));
        table.add(subject.method, view, frames_.at(subject.folder), camera, picture);
      }
    }
  table.write(out_, sequence_.name);
  return {};
}

Result<Rows> PictureStep::run() {
  FOURDVT_TRY(platform::makeFolder(context_.pictures()));
  FOURDVT_TRY(findSubjects());
  middles_deg_ = middleAzimuths_deg(captureCameras(context_));
  tell("layers and camera maps", 0.6);
  for (const Subject& subject : subjects_) {
    FOURDVT_TRY(checkStop(context_));
    // Skips three layers of the default beside four of the same labels, which would be redundant.
    if (subject.method == rows::kJointDefault && subjects_.size() > 1) continue;
    FOURDVT_TRY(layersSheet(subject));
  }
  FOURDVT_TRY(changesSheet());
  tell("grazing views", 0.7);
  FOURDVT_TRY(grazing());
  tell("seams", 0.8);
  FOURDVT_TRY(seamRows());
  return std::move(out_);
}

}  // namespace

Result<Rows> runPictures(const StudyContext& context) { return PictureStep(context).run(); }

}  // namespace fourdvt::study
