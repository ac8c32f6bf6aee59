// SPDX-License-Identifier: Apache-2.0
#include "evaluate/study_report.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "evaluate/study_report_sections.h"
#include "evaluate/study_rows.h"

namespace fourdvt::evaluate {
namespace {

bool measured(const Section& section) {
  return !section.tables.empty() || !section.plots.empty() || !section.pictures.empty() || !section.tiles.empty();
}

void addTile(Section& section, double value, const std::string& text, const std::string& meaning) {
  if (!std::isnan(value)) section.tiles.push_back({text, meaning});
}

Section summarySection(const StudyValues& v) {
  Section section{"summary", "Summary", "", {}, {}, {}, {}};
  const double ours = v.sum(rows::kTable1, rows::kJoint, "", rows::kTotalBytes),
               masked = v.sum(rows::kTable1, rows::kFvvr, "", rows::kTotalBytes), smaller = 100 * (1 - ours / masked);
  addTile(section, smaller, percentText(smaller), "less than the foreground-only multi-view, at L = 3, 512²");
  const double ssim = v.mean(rows::kTable1, rows::kJointDefault, "", rows::kSsimFg);
  addTile(section, ssim, fixedText(ssim, 4), "SSIM-FG against FVVR, default settings");
  const double ratio = v.mean(rows::kSpeed, rows::kMethodLayered, "!pass !closest", rows::kRatioToFvvr);
  addTile(section, ratio, fixedText(ratio, 2) + " ×", "FVVR's frame rate");
  const double gap = v.mean(rows::kHeldOut, rows::kJointDefault, "", rows::kPsnrFgDb) -
                     v.mean(rows::kHeldOut, rows::kFvvr, "", rows::kPsnrFgDb);
  addTile(section, gap, (gap > 0 ? "+" : "") + fixedText(gap, 2) + " dB", "against FVVR at the held-out cameras");
  const double bake = v.mean(rows::kBake, rows::kJointDefault, "!stage", rows::kSecondsFrame);
  addTile(section, bake, secondsText(bake), "a frame, whole bake");
  section.tables.push_back(judgementTable(judgeGoals(v), "Goals"));
  return section;
}

struct Line {
  const char *title, *quantity;
  std::string (*text)(double value);
};
std::string ssimText(double s) { return fixedText(s, 4); }
std::string decibelText(double d) { return fixedText(d, 2); }

// A row a line, a column a method; lines without any figure are left out.
Table methodTable(const StudyValues& v, const std::string& name, const std::string& sequence, const std::string& title,
                  const std::vector<Line>& lines) {
  Table table{title, "", {""}, {}};
  const auto methods = v.methods(name);
  for (const std::string& method : methods) table.columns.push_back(methodTitle(method));
  for (const Line& line : lines) {
    std::vector<std::string> row{line.title};
    bool any = false;
    for (const std::string& method : methods) {
      const double value = v.of(name, sequence, method, "", line.quantity);
      any |= !std::isnan(value);
      row.push_back(line.text(value));
    }
    if (any) table.rows.push_back(std::move(row));
  }
  return table;
}

std::vector<std::string> sequencesOrWhole(const StudyValues& v, const std::string& table) {
  auto names = v.sequences(table);
  for (const Figure& row : v.rows())
    if (row.table == table && row.sequence.empty()) {
      names.push_back("");
      break;
    }
  return names;
}

// "FVVR, NO (naive): layers=3 size=512; ours, default: …"
std::string settingsNote(const StudyValues& v) {
  std::vector<std::pair<std::string, std::string>> groups;  // setting → methods
  for (const std::string& method : v.methods(rows::kTable1))
    for (const Figure& row : v.rows()) {
      if (row.table != rows::kTable1 || row.method != method || row.setting.empty()) continue;
      auto it = std::find_if(groups.begin(), groups.end(), [&](const auto& g) { return g.first == row.setting; });
      if (it == groups.end()) it = groups.insert(groups.end(), {row.setting, ""});
      it->second += (it->second.empty() ? "" : ", ") + methodTitle(method);
      break;
    }
  std::string note;
  for (const auto& [setting, methods] : groups) note += (note.empty() ? "" : "; ") + methods + ": " + setting;
  return note;
}

Section table1Section(const StudyValues& v) {
  Section section{"table1", "4DVT Table 1", "", {}, {}, {}, {}};
  section.text =
      "Loading, storage and quality of FVVR, 4DVT's three labellings and ours, in the papers' protocol: the reference "
      "of SSIM and PSNR is FVVR's picture from the same ring views, not the truth. FVVR's storage is the "
      "foreground-only multi-view as PNG. Storage of the layers counts everything that is loaded; against the "
      "multi-view as video, at equal quality, it stands under “Storage and memory”.\n\nLoading, whole sequence: every "
      "picture is decoded and uploaded, as the papers measure it. To the first picture: what a viewer waits for, since "
      "both can show one before the rest has come.\n\n“Per texel” takes each texel's camera as LVDT does, but weights "
      "it at run time by the cameras of its face, for the streamed labels are per face. LVDT's camera maps are per "
      "texel: it is no measurement of LVDT's method.";
  static const std::vector<Line> kLines{{"Loading, to the first picture", rows::kLoadingS, secondsText},
                                        {"Loading, whole sequence", rows::kLoadingAllS, secondsText},
                                        {"Storage", rows::kTotalBytes, bytesText},
                                        {"Storage: video", rows::kVideoBytes, bytesText},
                                        {"Storage: geometry", rows::kGeometryBytes, bytesText},
                                        {"Storage: labels", rows::kLabelBytes, bytesText},
                                        {"Storage: other", rows::kOtherBytes, bytesText},
                                        {"Video bitrate", rows::kVideoBps, bitrateText},
                                        {"% of the masked PNG", rows::kPercentOfMasked, percentText},
                                        {"SSIM, foreground", rows::kSsimFg, ssimText},
                                        {"SSIM, full frame", rows::kSsimFull, ssimText},
                                        {"PSNR, foreground, dB", rows::kPsnrFgDb, decibelText},
                                        {"PSNR, full frame, dB", rows::kPsnrFullDb, decibelText}};
  for (const std::string& sequence : sequencesOrWhole(v, rows::kTable1)) {
    Table table = methodTable(v, rows::kTable1, sequence, sequence.empty() ? "all sequences" : sequence, kLines);
    if (!table.rows.empty()) section.tables.push_back(std::move(table));
  }
  if (!section.tables.empty()) section.tables.back().note = settingsNote(v);
  return section;
}

struct LabelColumn {
  const char *title, *quantity;
  int decimals;
};
constexpr LabelColumn kAllFaces[] = {{"seams % L", rows::kSeamPercent, 2}, {"flips % L", rows::kFlipPercent, 2}};
constexpr LabelColumn kSeenFaces[] = {{"seams % L", rows::kSeenSeamPercent, 2},
                                      {"flips % L", rows::kSeenFlipPercent, 2},
                                      {"penalty L", rows::kMeanPenalty, 3}};

// A row per method, the columns once per layer.
Table labelTable(const StudyValues& v, const char* name, const std::string& title,
                 std::span<const LabelColumn> columns) {
  Table table{title, "", {"method"}, {}};
  const auto layers = v.numbers(name, "", "layer");
  for (const LabelColumn& column : columns)
    for (const double layer : layers) table.columns.push_back(column.title + fixedText(layer, 0));
  for (const std::string& method : v.methods(name)) {
    std::vector<std::string> row{methodTitle(method)};
    for (const LabelColumn& column : columns)
      for (const double layer : layers)
        row.push_back(
            fixedText(v.mean(name, method, "layer=" + fixedText(layer, 0), column.quantity), column.decimals));
    table.rows.push_back(std::move(row));
  }
  return table;
}

Table labelCostTable(const StudyValues& v) {
  Table table{"Energy and cost", "", {"method", "energy", "empty %", "per frame", "bitrate"}, {}};
  for (const std::string& method : v.methods(rows::kLabels)) {
    const auto at = [&](const char* quantity) { return v.mean(rows::kLabels, method, "!layer !solve", quantity); };
    table.rows.push_back({methodTitle(method), fixedText(at(rows::kEnergy), 0), fixedText(at(rows::kEmptyPercent), 2),
                          secondsText(at(rows::kLabelMsFrame) / 1e3), bitrateText(at(rows::kLabelBps))});
  }
  return table;
}

Section labelsSection(const StudyValues& v) {
  Section section{"labels", "Labels", "", {}, {}, {}, {}};
  section.text =
      "Seams: share of mesh edges whose faces differ in this layer. Flips: share of faces that differ from the frame "
      "before. Penalty: 4DVT Eq. 1, mean over the filled slots of faces that a camera sees. Energy: of the joint "
      "formulation with our weights, whatever the method. Means over the sequences.\n\nThe papers' methods leave a "
      "face empty that no camera sees, ours goes on with its neighbours' label, which alone makes fewer seams where "
      "nothing was filmed. What shows is the second table: edges between two faces, and faces in two frames, that at "
      "least one camera sees. The last table takes ours apart.";
  for (Table table :
       {labelTable(v, rows::kLabels, "Over all faces", kAllFaces),
        labelTable(v, rows::kLabels, "Over faces that a camera sees", kSeenFaces), labelCostTable(v),
        labelTable(v, rows::kLabelParts, "The parts of ours, over all faces, first frames of one sequence", kAllFaces),
        labelTable(v, rows::kLabelParts, "The parts of ours, over faces that a camera sees", kSeenFaces)})
    if (!table.rows.empty()) section.tables.push_back(std::move(table));
  return section;
}

Section heldOutSection(const StudyValues& v) {
  Section section{"held-out", "Held-out cameras", "", {}, {}, {}, {}};
  section.text =
      "Against pictures of cameras that no method has seen: the truth. Foreground: the union of both silhouettes; "
      "“common”: where both are, without the outline's error.";
  static const std::vector<Line> kLines{{"PSNR, foreground, dB", rows::kPsnrFgDb, decibelText},
                                        {"PSNR, common, dB", rows::kPsnrCommonDb, decibelText},
                                        {"PSNR, full frame, dB", rows::kPsnrFullDb, decibelText},
                                        {"SSIM, foreground", rows::kSsimFg, ssimText},
                                        {"SSIM, full frame", rows::kSsimFull, ssimText}};
  for (const std::string& sequence : sequencesOrWhole(v, rows::kHeldOut)) {
    Table table = methodTable(v, rows::kHeldOut, sequence, sequence.empty() ? "all sequences" : sequence, kLines);
    if (!table.rows.empty()) section.tables.push_back(std::move(table));
  }
  section.pictures = picturesOf(v, {rows::kPictureWorst});
  return section;
}

Section mapsSection(const StudyValues& v) {
  Section section{"camera-maps", "Layers and camera maps", "", {}, {}, {}, {}};
  section.text =
      "LVDT Fig. 3–4, 4DVT Fig. 4–5. A column a layer: the texture in UV space, its camera map (a colour a camera), "
      "the "
      "same two on the body, and the share of the layer in the blend. Large patches of one colour are what the codec "
      "and the seams want.";
  section.pictures = picturesOf(v, {rows::kPictureLayers, rows::kPictureChanges});
  return section;
}

Section grazingSection(const StudyValues& v) {
  Section section{"grazing", "Grazing views and seams", "", {}, {}, {}, {}};
  section.text =
      "Views from far above and below and midway between two cameras, where seams and green fringes would show.";
  Table table{
      "Seam contrast",
      "Step and line across chart seams, and the same beside them, in levels of 255. Charts are cut along folds, "
      "where the surface itself has contrast: FVVR, which has no atlas, shows how much; what is above it is the "
      "atlas's. Fringe: share of the silhouette's pixels that are tinted towards the backdrop.",
      {"method", "view", "at seams", "beside them", "excess", "above FVVR's", "fringe"},
      {}};
  for (const std::string& view : v.settings(rows::kSeams, "", "view")) {
    const auto at = [&](const std::string& method, const char* quantity) {
      return v.mean(rows::kSeams, method, "view=" + view, quantity);
    };
    const auto excess = [&](const std::string& m) { return at(m, rows::kSeamContrast) - at(m, rows::kSeamControl); };
    for (const std::string& m : v.methods(rows::kSeams))
      table.rows.push_back({methodTitle(m), view, fixedText(at(m, rows::kSeamContrast), 2),
                            fixedText(at(m, rows::kSeamControl), 2), fixedText(excess(m), 2),
                            m == rows::kFvvr ? "–" : fixedText(excess(m) - excess(rows::kFvvr), 2),
                            percentText(at(m, rows::kFringePercent))});
  }
  if (!table.rows.empty()) section.tables.push_back(std::move(table));
  section.pictures = picturesOf(v, {rows::kPictureGrazing});
  return section;
}

Section trendsSection(const StudyValues& v) {
  Section section{"trends", "The papers' trends", "", {}, {}, {}, {}};
  section.text =
      "What the papers report, and whether this capture shows it. Reasons that begin with “Likely” are an "
      "interpretation; the others are figures of this run.";
  section.tables.push_back(judgementTable(judgeTrends(v), ""));
  return section;
}

// As the comments beside the constants say.
Table constantsTable() {
  return {"What the constants were chosen on",
          "Figures of a motion that constants were chosen on flatter them; those of the other motions do not. All "
          "motions are of one performer under one rig, so that no figure here shows another performer or another rig.",
          {"constants", "chosen on", "by"},
          {{"quality presets: CRF and encoder preset (bake/quality.cpp)", "walk of the sample",
            "rate and held-out quality of rendered views"},
           {"encoder parameters (bake/encode_setup.cpp)", "not recorded", "bitrate at equal SSIM of rendered views"},
           {"resampling: filter, matte and contour distances (bake/resample.h)", "walk and run of the sample",
            "held-out SSIM and PSNR, no codec"},
           {"weights of the joint labels (bake/labelling.h)", "not recorded",
            "flips and seams of one sequence at a layer-1 penalty within 10 % of naive's"},
           {"detail put back in aligned blends (render/layered_pass.cpp)", "nothing: measured per class by the bake",
            "correlation of the members' detail"}}};
}

Section settingsSection(const StudyValues& v, const StudyOptions& options, const std::vector<std::string>& missing) {
  Section section{"settings", "Settings and versions", "", {}, {}, {}, {}};
  section.text = "Every figure of this page, and more, is in `evaluate.csv` beside it.";
  if (!missing.empty()) {
    section.text += "\n\nNot measured in this run: ";
    for (size_t i = 0; i < missing.size(); ++i) section.text += (i ? ", " : "") + missing[i];
    section.text += options.quick ? " (quick run)." : ".";
  }
  Table table{"", "", {"", "value"}, {}};
  std::string sequences;
  for (const std::string& name : options.sequences) sequences += (sequences.empty() ? "" : ", ") + name;
  table.rows.push_back({"sequences", sequences.empty() ? "all" : sequences});
  table.rows.push_back({"mode", options.quick ? "quick" : "full"});
  table.rows.push_back({"jobs", options.jobs > 0 ? std::to_string(options.jobs) : "as many as cores"});
  auto add = [&](bool first) {
    for (const Figure& row : v.rows()) {
      const bool is_first = row.quantity == rows::kAboutCommand || row.quantity == rows::kAboutDevice ||
                            row.quantity == rows::kAboutEncoder;
      if (row.table != rows::kAbout || is_first != first) continue;
      const std::string text = rows::settingText(row.setting, "text");
      table.rows.push_back({row.quantity, text.empty() ? fixedText(row.value, 3) + " " + row.unit : text});
    }
  };
  add(true), add(false);
  section.tables.push_back(std::move(table));
  section.tables.push_back(constantsTable());
  return section;
}

}  // namespace

Table judgementTable(const std::vector<Judgement>& judgements, const std::string& title) {
  Table table{title, "", {"claim", "verdict", "measured", "why not"}, {}};
  for (const Judgement& j : judgements) {
    const char* verdict = j.verdict == Judgement::Verdict::Holds   ? "✓ holds"
                          : j.verdict == Judgement::Verdict::Fails ? "✗ does not hold"
                                                                   : "not measured";
    table.rows.push_back({j.claim, verdict, j.measured, j.reason});
  }
  return table;
}

Document makeStudyDocument(const Figures& rows, const StudyOptions& options, const std::string& capture_name) {
  const StudyValues values(rows);
  Document document{capture_name + ": evaluation", "", {}};
  document.subtitle = "Layered view-dependent texture of " + capture_name +
                      " against free-viewpoint video rendering and held-out cameras: the tables and figures of the two "
                      "papers on this capture. Made by `fourdvt evaluate" +
                      std::string(options.quick ? " --quick`." : "`.");
  std::vector<std::string> missing;
  for (const Section& section : std::vector<Section>{
           summarySection(values), table1Section(values), layersSection(values), storageSection(values),
           speedSection(values), labelsSection(values), heldOutSection(values), rateSection(values),
           mapsSection(values), grazingSection(values), motionSection(values), trendsSection(values)}) {
    if (measured(section)) {
      document.sections.push_back(section);
    } else {
      missing.push_back(section.title);
    }
  }
  document.sections.push_back(settingsSection(values, options, missing));
  return document;
}

}  // namespace fourdvt::evaluate
