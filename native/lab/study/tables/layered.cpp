// SPDX-License-Identifier: Apache-2.0
// Sections on layered characters: the papers' tables, layers and sizes, storage, labels, held-out cameras, seams.
#include <algorithm>
#include <cmath>

#include "lab/study/run/rows.h"
#include "lab/study/tables/sections.h"

namespace fourdvt::study {
namespace {

// Adds a table per sequence: a row per quantity, a column per method.
void addMethodTables(Section& section, const StudyValues& v, const char* table, const Cells& quantities) {
  for (const std::string& sequence : v.sequences(table))
    addGrid(section, v, {table, sequence, "", {""}, {.sequence = sequence}}, quantities, methodsOf(v, table));
}

// "FVVR, NO (naive): layers=3 size=512; ours, default: …"
std::string settingsNote(const StudyValues& v) {
  std::vector<std::pair<std::string, std::string>> groups;  // setting → methods
  for (const std::string& method : v.methods(rows::kTable1))
    for (const Row& row : v.rows()) {
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

// Sizes of a method's layers, for curves and columns.
Cells sizesOf(const StudyValues& v, const char* method) {
  Cells out = numbersOf(v, {rows::kLayers, method, "size", 0, "", "²"});
  for (Cell& cell : out) cell.method = method;
  return out;
}

// Curve of a quantity over the number of layers.
CurvesOptions overLayers(const char* quantity, const std::string& title, const std::string& y_label,
                         std::optional<double> reduction_from = {}) {
  return {rows::kLayers, quantity, "layers", 0, title, "layers L", y_label, "", reduction_from};
}

// Adds a table with a row per number of layers, a column per size.
void addLayersTable(Section& section, const StudyValues& v, const char* quantity, const std::string& title,
                    NumberText text) {
  addGrid(section, v, {rows::kLayers, title, "", {"L"}, {.quantity = quantity, .text = text}},
          numbersOf(v, {rows::kLayers, rows::kJoint, "layers"}), sizesOf(v, rows::kJoint));
}

// Bytes of the multi-view, or loaded bytes of a character.
double storedBytes(const StudyValues& v, const Cell& cell) {
  const char* table = cell.method == rows::kMethodMultiview ? rows::kMultiview : rows::kTable1;
  return v.of(table, cell.sequence, cell.method, "", cell.quantity);
}

// Reduction in percent against the multi-view's quantity `over`.
double lessStored(const StudyValues& v, const Cell& cell) {
  return 100 *
         (1 - storedBytes(v, cell) / v.of(rows::kMultiview, cell.sequence, rows::kMethodMultiview, "", cell.over));
}

void addMultiview(Section& section, const StudyValues& v) {
  const char* multiview = rows::kMethodMultiview;
  Cells stored{{{"Raw (RGB)"}, multiview, "", rows::kRawBytes, nullptr, "none above"},
               {{"Compressed (PNG)"}, multiview, "", rows::kCompressedBytes, nullptr, rows::kRawBytes},
               {{"Masked (PNG, foreground only)"}, multiview, "", rows::kMaskedBytes, nullptr, rows::kCompressedBytes}};
  for (const char* method : {rows::kJoint, rows::kJointDefault})
    stored.push_back({{"Layers, " + methodTitle(method) + ": all that is loaded"},
                      method,
                      "",
                      rows::kTotalBytes,
                      nullptr,
                      rows::kMaskedBytes});
  Cells columns;
  for (const std::string& name : v.sequences(rows::kMultiview)) {
    columns.push_back({.title = {name}, .text = bytesText, .sequence = name, .value = storedBytes});
    columns.push_back({.title = {"less"}, .text = percentText, .sequence = name, .value = lessStored});
  }
  addGrid(section, v,
          {rows::kMultiview,
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
  for (const std::string& crf : v.settings(rows::kMultiviewCodec, "", "crf")) {
    const double value = v.of(rows::kMultiviewCodec, sequence, "h264", "crf=" + crf, quantity);
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
                  ladderRange(v, sequence, rows::kHeldOutPsnrDb, 2) + " dB and SSIM-FG " +
                  ladderRange(v, sequence, rows::kHeldOutSsim, 4) + ".",
              {"method", "storage", "PSNR-FG, dB", "at equal PSNR", "SSIM-FG", "at equal SSIM"},
              {}};
  const auto of = [&](const char* name, const std::string& method, const char* quantity) {
    return v.of(name, sequence, method, "", quantity);
  };
  for (const std::string& m : v.methods(rows::kTable1)) {
    const auto equal = [&](const char* percent, const char* beyond) {
      return equalQualityText(of(rows::kTable1, m, percent), of(rows::kTable1, m, beyond));
    };
    const std::string psnr = equal(rows::kPercentAtPsnr, rows::kBeyondAtPsnr),
                      ssim = equal(rows::kPercentAtSsim, rows::kBeyondAtSsim);
    if (psnr == "–" && ssim == "–") continue;
    table.rows.push_back({methodTitle(m), bytesText(of(rows::kTable1, m, rows::kTotalBytes)),
                          fixedText(of(rows::kHeldOut, m, rows::kPsnrFgDb), 2), psnr,
                          fixedText(of(rows::kHeldOut, m, rows::kSsimFg), 4), ssim});
  }
  if (!table.rows.empty()) section.tables.push_back(std::move(table));
}

// Masked PNGs of the sequences with measured layers, mean per sequence.
double maskedSequenceBytes(const StudyValues& v) {
  double sum = 0;
  int count = 0;
  for (const std::string& name : v.sequences(rows::kLayers)) {
    const double bytes = v.of(rows::kMultiview, name, rows::kMethodMultiview, "", rows::kMaskedBytes);
    if (!std::isnan(bytes)) sum += bytes, ++count;
  }
  return count ? sum / count : v.mean(rows::kMultiview, rows::kMethodMultiview, "", rows::kMaskedBytes);
}

// Adds a table with a row per method, each quantity once per layer.
void addLabels(Section& section, const StudyValues& v, const char* table, const std::string& title,
               const Cells& quantities) {
  Cells columns;
  for (const Cell& quantity : quantities)
    for (Cell layer : numbersOf(v, {table, "", "layer", 0, quantity.title.front()})) {
      layer.quantity = quantity.quantity;
      layer.text = quantity.text;
      columns.push_back(std::move(layer));
    }
  addGrid(section, v, {table, title, "", {"method"}}, methodsOf(v, table), columns);
}

double seamExcess(const StudyValues& v, const Cell& cell) {
  return v.mean(rows::kSeams, cell.method, cell.filter, rows::kSeamContrast) -
         v.mean(rows::kSeams, cell.method, cell.filter, rows::kSeamControl);
}

double seamExcessAboveFvvr(const StudyValues& v, const Cell& cell) {
  Cell fvvr = cell;
  fvvr.method = rows::kFvvr;
  return cell.method == rows::kFvvr ? std::nan("") : seamExcess(v, cell) - seamExcess(v, fvvr);
}

}  // namespace

void fillTable1(Section& section, const StudyValues& v) {
  addMethodTables(section, v, rows::kTable1,
                  {{{"Loading, to the first picture"}, "", "", rows::kLoadingS, secondsText},
                   {{"Loading, whole sequence"}, "", "", rows::kLoadingAllS, secondsText},
                   {{"Storage"}, "", "", rows::kTotalBytes, bytesText},
                   {{"Storage: video"}, "", "", rows::kVideoBytes, bytesText},
                   {{"Storage: geometry"}, "", "", rows::kGeometryBytes, bytesText},
                   {{"Storage: labels"}, "", "", rows::kLabelBytes, bytesText},
                   {{"Storage: other"}, "", "", rows::kOtherBytes, bytesText},
                   {{"Video bitrate"}, "", "", rows::kVideoBps, bitrateText},
                   {{"% of the masked PNG"}, "", "", rows::kPercentOfMasked, percentText},
                   {{"SSIM, foreground"}, "", "", rows::kSsimFg, fixed<4>},
                   {{"SSIM, full frame"}, "", "", rows::kSsimFull, fixed<4>},
                   {{"PSNR, foreground, dB"}, "", "", rows::kPsnrFgDb, fixed<2>},
                   {{"PSNR, full frame, dB"}, "", "", rows::kPsnrFullDb, fixed<2>}});
  if (!section.tables.empty()) section.tables.back().note = settingsNote(v);
}

void fillLayers(Section& section, const StudyValues& v) {
  const std::string ssim = "SSIM-FG against FVVR";
  const CurvesOptions psnr =
      overLayers(rows::kPsnrFgDb, "PSNR against the number of layers", "PSNR-FG against FVVR, dB");
  addCurves(section, v, overLayers(rows::kSsimFg, "SSIM against the number of layers", ssim), sizesOf(v, rows::kJoint));
  addCurves(section, v, psnr, sizesOf(v, rows::kJoint));
  addCurves(section, v, overLayers(rows::kSsimFg, "SSIM with the papers' own labels (NO)", ssim),
            sizesOf(v, rows::kNaive));
  addLayersTable(section, v, rows::kSsimFg, ssim, fixed<4>);
}

void fillStorage(Section& section, const StudyValues& v) {
  addMultiview(section, v);
  for (const std::string& sequence : v.sequences(rows::kTable1)) addEqualQuality(section, v, sequence);
  const auto theirs = [&](const char* quantity) { return v.mean(rows::kLayers, rows::kFvvr, "", quantity); };
  const std::string less = "reduction, %";
  const Cells sizes = sizesOf(v, rows::kJoint);
  addCurves(section, v,
            overLayers(rows::kImageBytes, "Fig. 7a: less storage as images", less, theirs(rows::kMaskedBytes)), sizes);
  addCurves(section, v, overLayers(rows::kVideoBytes, "Fig. 7b: less storage as video", less, maskedSequenceBytes(v)),
            sizes);
  addCurves(section, v, overLayers(rows::kGpuBytes, "Fig. 7c: less GPU memory", less, theirs(rows::kGpuBytes)), sizes);
  addLayersTable(section, v, rows::kImageBytes, "Layers as PNG, a frame", bytesText);
  addLayersTable(section, v, rows::kVideoBps, "Layers as video", bitrateText);
  addLayersTable(section, v, rows::kGpuBytes, "GPU memory", bytesText);
}

void fillLabels(Section& section, const StudyValues& v) {
  const Cells all{{{"seams % L"}, "", "", rows::kSeamPercent, fixed<2>},
                  {{"flips % L"}, "", "", rows::kFlipPercent, fixed<2>}};
  const Cells seen{{{"seams % L"}, "", "", rows::kSeenSeamPercent, fixed<2>},
                   {{"flips % L"}, "", "", rows::kSeenFlipPercent, fixed<2>},
                   {{"penalty L"}, "", "", rows::kMeanPenalty, fixed<3>}};
  addLabels(section, v, rows::kLabels, "Over all faces", all);
  addLabels(section, v, rows::kLabels, "Over faces that a camera sees", seen);
  addGrid(section, v, {rows::kLabels, "Energy and cost", "", {"method"}, {.filter = "!layer !solve"}},
          methodsOf(v, rows::kLabels),
          {{{"energy"}, "", "", rows::kEnergy, fixed<0>},
           {{"empty %"}, "", "", rows::kEmptyPercent, fixed<2>},
           {{"per frame"}, "", "", rows::kLabelMsFrame, [](double ms) { return secondsText(ms / 1e3); }},
           {{"bitrate"}, "", "", rows::kLabelBps, bitrateText}});
  addLabels(section, v, rows::kLabelParts, "The parts of ours, over all faces, first frames of one sequence", all);
  addLabels(section, v, rows::kLabelParts, "The parts of ours, over faces that a camera sees", seen);
}

void fillHeldOut(Section& section, const StudyValues& v) {
  addMethodTables(section, v, rows::kHeldOut,
                  {{{"PSNR, foreground, dB"}, "", "", rows::kPsnrFgDb, fixed<2>},
                   {{"PSNR, common, dB"}, "", "", rows::kPsnrCommonDb, fixed<2>},
                   {{"PSNR, full frame, dB"}, "", "", rows::kPsnrFullDb, fixed<2>},
                   {{"SSIM, foreground"}, "", "", rows::kSsimFg, fixed<4>},
                   {{"SSIM, full frame"}, "", "", rows::kSsimFull, fixed<4>}});
}

void fillGrazing(Section& section, const StudyValues& v) {
  Cells looks;
  for (const std::string& view : v.settings(rows::kSeams, "", "view"))
    for (const std::string& method : v.methods(rows::kSeams))
      looks.push_back({{methodTitle(method), view}, method, "view=" + view});
  addGrid(section, v,
          {rows::kSeams,
           "Seam contrast",
           "Step and line across chart seams, and the same beside them, in levels of 255. Charts are cut along folds, "
           "where the surface itself has contrast: FVVR, which has no atlas, shows how much; what is above it is the "
           "atlas's. Fringe: share of the silhouette's pixels that are tinted towards the backdrop.",
           {"method", "view"},
           {.text = fixed<2>}},
          looks,
          {{.title = {"at seams"}, .quantity = rows::kSeamContrast},
           {.title = {"beside them"}, .quantity = rows::kSeamControl},
           {.title = {"excess"}, .value = seamExcess},
           {.title = {"above FVVR's"}, .value = seamExcessAboveFvvr},
           {.title = {"fringe"}, .quantity = rows::kFringePercent, .text = percentText}});
}

}  // namespace fourdvt::study
