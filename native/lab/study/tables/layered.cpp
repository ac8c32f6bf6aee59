// SPDX-License-Identifier: Apache-2.0
// Sections on layered characters: the papers' tables, layers and sizes, storage, labels, held-out cameras, seams.
#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "lab/study/run/rows.h"
#include "lab/study/tables/sections.h"

namespace fourdvt::study {
namespace {

using namespace rows;

// Adds a table per sequence: a row per quantity, a column per method.
void addMethodTables(Section& section, const StudyValues& v, const char* table, const std::vector<Shown>& quantities) {
  for (const std::string& sequence : v.sequences(table))
    addGrid(section, v, {table, sequence, "", {""}, {.sequence = sequence}}, cellsOf(quantities), methodsOf(v, table));
}

// "FVVR, NO (naive): layers=3 size=512; ours, default: …"
std::string settingsNote(const StudyValues& v) {
  std::vector<std::pair<std::string, std::string>> groups;  // setting → methods
  for (const std::string& method : v.methods(kTable1))
    for (const Row& row : v.rows()) {
      if (row.table != kTable1 || row.method != method || row.setting.empty()) continue;
      auto it = std::find_if(groups.begin(), groups.end(), [&](const auto& g) { return g.first == row.setting; });
      if (it == groups.end()) it = groups.insert(groups.end(), {row.setting, ""});
      it->second += (it->second.empty() ? "" : ", ") + methodTitle(method);
      break;
    }
  return joined(groups, "; ", [](const auto& group) { return group.second + ": " + group.first; });
}

// Sizes of a method's layers, for curves and columns.
Cells sizesOf(const StudyValues& v, const char* method) {
  Cells out = numbersOf(v, {kLayers, method, "size", 0, "", "²"});
  for (Cell& cell : out) cell.method = method;
  return out;
}

// Curve of a quantity over the number of layers.
CurvesOptions overLayers(const char* quantity, const std::string& title, const std::string& y_label,
                         std::optional<double> reduction_from = {}) {
  return {kLayers, quantity, "layers", 0, title, "layers L", y_label, "", reduction_from};
}

// Adds a table with a row per number of layers, a column per size.
void addLayersTable(Section& section, const StudyValues& v, const char* quantity, const std::string& title) {
  addGrid(section, v, {kLayers, title, "", {"L"}, {.quantity = quantity}}, numbersOf(v, {kLayers, kJoint, "layers"}),
          sizesOf(v, kJoint));
}

// Bytes of the multi-view, or loaded bytes of a character.
double storedBytes(const StudyValues& v, const Cell& cell) {
  const char* table = cell.method == kMethodMultiview ? kMultiview : kTable1;
  return v.of(table, cell.sequence, cell.method, "", cell.quantity);
}

// Reduction in percent against the multi-view's quantity `over`.
double lessStored(const StudyValues& v, const Cell& cell) {
  return 100 * (1 - storedBytes(v, cell) / v.of(kMultiview, cell.sequence, kMethodMultiview, "", cell.over));
}

void addMultiview(Section& section, const StudyValues& v) {
  Cells stored = cellsOf({{"Raw (RGB)", kRawBytes, nullptr, "none above"},
                          {"Compressed (PNG)", kCompressedBytes, nullptr, kRawBytes},
                          {"Masked (PNG, foreground only)", kMaskedBytes, nullptr, kCompressedBytes}});
  for (Cell& cell : stored) cell.method = kMethodMultiview;
  for (const char* method : {kJoint, kJointDefault}) {
    const std::string title = "Layers, " + methodTitle(method) + ": all that is loaded";
    stored.push_back({{title}, method, "", kTotalBytes, nullptr, kMaskedBytes});
  }
  Cells columns;
  for (const std::string& name : v.sequences(kMultiview)) {
    columns.push_back({.title = {name}, .text = bytesText, .sequence = name, .value = storedBytes});
    columns.push_back({.title = {"less"}, .text = percentText, .sequence = name, .value = lessStored});
  }
  addGrid(section, v,
          {kMultiview,
           "LVDT Table 1: storage of the multi-view",
           "Percentages: reduction against the row above, as in the paper; the last rows against the masked PNG.",
           {"Storage"}},
          stored, columns);
}

// Text of a share at equal quality; "–" if neither was measured.
std::string equalQualityText(double percent, double beyond) {
  if (!std::isnan(percent)) return percentText(percent);
  if (std::isnan(beyond)) return "–";
  return std::string("beyond the range measured: ") + (beyond > 0 ? "better" : "worse") +
         " than FVVR at every rate measured";
}

// "22.10 to 24.50"
std::string ladderRange(const StudyValues& v, const std::string& sequence, const char* quantity, int decimals) {
  double low = std::nan(""), high = low;
  for (const std::string& crf : v.settings(kMultiviewCodec, "", "crf")) {
    const double value = v.of(kMultiviewCodec, sequence, "h264", "crf=" + crf, quantity);
    low = std::fmin(low, value);
    high = std::fmax(high, value);
  }
  return fixedText(low, decimals) + " to " + fixedText(high, decimals);
}

void addEqualQuality(Section& section, const StudyValues& v, const std::string& sequence) {
  Table table{"Storage at equal quality at the held-out cameras: " + sequence,
              "All that the method loads, in percent of the multi-view's H.264 videos from which FVVR shows the "
              "held-out cameras as well as the method does; FVVR's mattes and meshes are not counted. Interpolated "
              "between the measured rates, never beyond them. FVVR from decoded videos reaches PSNR-FG " +
                  ladderRange(v, sequence, kHeldOutPsnrDb, 2) + " dB and SSIM-FG " +
                  ladderRange(v, sequence, kHeldOutSsim, 4) + ".",
              {"method", "storage", "PSNR-FG, dB", "at equal PSNR", "SSIM-FG", "at equal SSIM",
               "at equal PSNR of FVVR at its best", "at equal SSIM of FVVR at its best"},
              {}};
  const auto of = [&](const char* name, const std::string& method, const char* quantity) {
    return v.of(name, sequence, method, "", quantity);
  };
  for (const std::string& m : v.methods(kTable1)) {
    const auto equal = [&](const char* percent, const char* beyond) {
      return equalQualityText(of(kTable1, m, percent), of(kTable1, m, beyond));
    };
    const std::string psnr = equal(kPercentAtPsnr, kBeyondAtPsnr), ssim = equal(kPercentAtSsim, kBeyondAtSsim);
    if (psnr == "–" && ssim == "–") continue;
    table.rows.push_back({methodTitle(m), bytesText(of(kTable1, m, kTotalBytes)),
                          fixedText(of(kHeldOut, m, kPsnrFgDb), 2), psnr, fixedText(of(kHeldOut, m, kSsimFg), 4), ssim,
                          equal(kPercentAtTunedPsnr, kBeyondAtTunedPsnr),
                          equal(kPercentAtTunedSsim, kBeyondAtTunedSsim)});
  }
  addTable(section, std::move(table));
}

// Masked PNGs of the sequences with measured layers, mean per sequence.
double maskedSequenceBytes(const StudyValues& v) {
  double sum = 0;
  int count = 0;
  for (const std::string& name : v.sequences(kLayers)) {
    const double bytes = v.of(kMultiview, name, kMethodMultiview, "", kMaskedBytes);
    if (!std::isnan(bytes)) sum += bytes, ++count;
  }
  return count ? sum / count : v.mean(kMultiview, kMethodMultiview, "", kMaskedBytes);
}

// Adds a table with a row per method, each quantity once per layer.
void addLabels(Section& section, const StudyValues& v, const char* table, const std::string& title,
               const std::vector<Shown>& quantities) {
  Cells columns;
  for (const Shown& quantity : quantities)
    for (Cell layer : numbersOf(v, {table, "", "layer", 0, quantity.title})) {
      layer.quantity = quantity.quantity;
      layer.text = quantity.text;
      columns.push_back(std::move(layer));
    }
  addGrid(section, v, {table, title, "", {"method"}}, methodsOf(v, table), columns);
}

double seamExcess(const StudyValues& v, const Cell& cell) {
  return v.mean(kSeams, cell.method, cell.filter, kSeamContrast) -
         v.mean(kSeams, cell.method, cell.filter, kSeamControl);
}

double seamExcessAboveFvvr(const StudyValues& v, const Cell& cell) {
  Cell fvvr = cell;
  fvvr.method = kFvvr;
  return cell.method == kFvvr ? std::nan("") : seamExcess(v, cell) - seamExcess(v, fvvr);
}

}  // namespace

void fillTable1(Section& section, const StudyValues& v) {
  addMethodTables(section, v, kTable1,
                  {{"Loading, to the first picture", kLoadingS},
                   {"Loading, whole sequence", kLoadingAllS},
                   {"Storage", kTotalBytes},
                   {"Storage: video", kVideoBytes},
                   {"Storage: geometry", kGeometryBytes},
                   {"Storage: labels", kLabelBytes},
                   {"Storage: other", kOtherBytes},
                   {"Video bitrate", kVideoBps},
                   {"% of the masked PNG", kPercentOfMasked},
                   {"SSIM, foreground", kSsimFg},
                   {"SSIM, full frame", kSsimFull},
                   {"PSNR, foreground, dB", kPsnrFgDb},
                   {"PSNR, full frame, dB", kPsnrFullDb}});
  if (!section.tables.empty()) section.tables.back().note = settingsNote(v);
}

void fillLayers(Section& section, const StudyValues& v) {
  const std::string ssim = "SSIM-FG against FVVR";
  const CurvesOptions psnr = overLayers(kPsnrFgDb, "PSNR against the number of layers", "PSNR-FG against FVVR, dB");
  addCurves(section, v, overLayers(kSsimFg, "SSIM against the number of layers", ssim), sizesOf(v, kJoint));
  addCurves(section, v, psnr, sizesOf(v, kJoint));
  addCurves(section, v, overLayers(kSsimFg, "SSIM with the papers' own labels (NO)", ssim), sizesOf(v, kNaive));
  addLayersTable(section, v, kSsimFg, ssim);
}

void fillStorage(Section& section, const StudyValues& v) {
  addMultiview(section, v);
  for (const std::string& sequence : v.sequences(kTable1)) addEqualQuality(section, v, sequence);
  const auto theirs = [&](const char* quantity) { return v.mean(kLayers, kFvvr, "", quantity); };
  const std::string less = "reduction, %";
  const Cells sizes = sizesOf(v, kJoint);
  addCurves(section, v, overLayers(kImageBytes, "Fig. 7a: less storage as images", less, theirs(kMaskedBytes)), sizes);
  addCurves(section, v, overLayers(kVideoBytes, "Fig. 7b: less storage as video", less, maskedSequenceBytes(v)), sizes);
  addCurves(section, v, overLayers(kGpuBytes, "Fig. 7c: less GPU memory", less, theirs(kGpuBytes)), sizes);
  addLayersTable(section, v, kImageBytes, "Layers as PNG, a frame");
  addLayersTable(section, v, kVideoBps, "Layers as video");
  addLayersTable(section, v, kGpuBytes, "GPU memory");
}

void fillLabels(Section& section, const StudyValues& v) {
  const std::vector<Shown> all{{"seams % L", kSeamPercent, fixed<2>}, {"flips % L", kFlipPercent, fixed<2>}};
  const std::vector<Shown> seen{{"seams % L", kSeenSeamPercent, fixed<2>},
                                {"flips % L", kSeenFlipPercent, fixed<2>},
                                {"penalty L", kMeanPenalty, fixed<3>}};
  addLabels(section, v, kLabels, "Over all faces", all);
  addLabels(section, v, kLabels, "Over faces that a camera sees", seen);
  addGrid(section, v, {kLabels, "Energy and cost", "", {"method"}, {.filter = "!layer !solve"}}, methodsOf(v, kLabels),
          cellsOf({{"energy", kEnergy, fixed<0>},
                   {"empty %", kEmptyPercent, fixed<2>},
                   {"per frame", kLabelMsFrame, [](double ms) { return secondsText(ms / 1e3); }},
                   {"bitrate", kLabelBps}}));
  addLabels(section, v, kLabelParts, "The parts of ours, over all faces, first frames of one sequence", all);
  addLabels(section, v, kLabelParts, "The parts of ours, over faces that a camera sees", seen);
}

void fillHeldOut(Section& section, const StudyValues& v) {
  addMethodTables(section, v, kHeldOut,
                  {{"PSNR, foreground, dB", kPsnrFgDb},
                   {"PSNR, common, dB", kPsnrCommonDb},
                   {"PSNR, seen by a camera, dB", kPsnrSeenDb},
                   {"PSNR, full frame, dB", kPsnrFullDb},
                   {"SSIM, foreground", kSsimFg},
                   {"SSIM, seen by a camera", kSsimSeen},
                   {"SSIM, full frame", kSsimFull}});
}

void fillGrazing(Section& section, const StudyValues& v) {
  Cells looks;
  for (const std::string& view : v.settings(kSeams, "", "view"))
    for (const std::string& method : v.methods(kSeams))
      looks.push_back({{methodTitle(method), view}, method, "view=" + view});
  addGrid(section, v,
          {kSeams,
           "Seam contrast",
           "Step and line across chart seams, and the same beside them, in levels of 255. Charts are cut along folds, "
           "where the surface itself has contrast: FVVR, which has no atlas, shows how much; what is above it is the "
           "atlas's. Fringe: share of the silhouette's pixels that are tinted towards the backdrop.",
           {"method", "view"},
           {.text = fixed<2>}},
          looks,
          {{.title = {"at seams"}, .quantity = kSeamContrast},
           {.title = {"beside them"}, .quantity = kSeamControl},
           {.title = {"excess"}, .value = seamExcess},
           {.title = {"above FVVR's"}, .value = seamExcessAboveFvvr},
           {.title = {"fringe"}, .quantity = kFringePercent, .text = percentText}});
}

}  // namespace fourdvt::study
