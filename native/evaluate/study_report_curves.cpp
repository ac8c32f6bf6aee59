// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "evaluate/study_report_sections.h"
#include "evaluate/study_rows.h"

namespace fourdvt::evaluate {
namespace {

std::string layersSize(double layers, double size) {
  return "layers=" + fixedText(layers, 0) + " size=" + fixedText(size, 0);
}

// A curve a layer size over the number of layers, of value(layers, size); sizes without any figure are left out.
template <class Value>
std::vector<Curve> curvesOverLayers(const StudyValues& v, const std::string& method, const std::string& suffix,
                                    const Value& value) {
  std::vector<Curve> curves;
  for (const double size : v.numbers(rows::kLayers, method, "size")) {
    Curve curve{fixedText(size, 0) + "²" + suffix, {}};
    for (const double layers : v.numbers(rows::kLayers, method, "layers")) {
      const double y = value(layers, size);
      if (!std::isnan(y)) curve.points.emplace_back(layers, y);
    }
    if (!curve.points.empty()) curves.push_back(std::move(curve));
  }
  return curves;
}

std::vector<Curve> quantityOverLayers(const StudyValues& v, const std::string& method, const std::string& suffix,
                                      const char* quantity) {
  return curvesOverLayers(v, method, suffix, [&](double layers, double size) {
    return v.mean(rows::kLayers, method, layersSize(layers, size), quantity);
  });
}

void addPlot(Section& section, const std::string& title, const std::string& x, const std::string& y,
             std::vector<Curve> curves, bool log_x = false) {
  if (!curves.empty()) section.plots.push_back({title, x, y, log_x, false, std::move(curves)});
}

Table layersTable(const StudyValues& v, const char* quantity, const std::string& title,
                  std::string (*text)(double value)) {
  Table table{title, "", {"L"}, {}};
  const auto sizes = v.numbers(rows::kLayers, rows::kJoint, "size");
  for (const double size : sizes) table.columns.push_back(fixedText(size, 0) + "²");
  for (const double layers : v.numbers(rows::kLayers, rows::kJoint, "layers")) {
    std::vector<std::string> row{fixedText(layers, 0)};
    bool any = false;
    for (const double size : sizes) {
      const double value = v.mean(rows::kLayers, rows::kJoint, layersSize(layers, size), quantity);
      any |= !std::isnan(value);
      row.push_back(text(value));
    }
    if (any) table.rows.push_back(std::move(row));
  }
  return table;
}

void addTable(Section& section, Table table) {
  if (!table.rows.empty()) section.tables.push_back(std::move(table));
}

Table multiviewTable(const StudyValues& v) {
  Table table{"LVDT Table 1: storage of the multi-view",
              "Percentages: reduction against the row above, as in the paper; the last rows against the masked PNG.",
              {"Storage"},
              {}};
  const auto sequences = v.sequences(rows::kMultiview);
  for (const std::string& name : sequences) {
    table.columns.push_back(name);
    table.columns.push_back("less");
  }
  struct Row {
    const char *title, *quantity;
  };
  static constexpr Row kRows[] = {{"Raw (RGB)", rows::kRawBytes},
                                  {"Compressed (PNG)", rows::kCompressedBytes},
                                  {"Masked (PNG, foreground only)", rows::kMaskedBytes}};
  std::vector<double> above(sequences.size(), std::nan("")), masked(sequences.size(), std::nan(""));
  auto addRow = [&](const std::string& title, const std::vector<double>& bytes, const std::vector<double>& against) {
    std::vector<std::string> row{title};
    for (size_t i = 0; i < sequences.size(); ++i) {
      row.push_back(bytesText(bytes[i]));
      row.push_back(percentText(100 * (1 - bytes[i] / against[i])));
    }
    if (std::any_of(bytes.begin(), bytes.end(), [](double b) { return !std::isnan(b); }))
      table.rows.push_back(std::move(row));
  };
  for (const Row& row : kRows) {
    std::vector<double> bytes;
    for (const std::string& name : sequences)
      bytes.push_back(v.of(rows::kMultiview, name, rows::kMethodMultiview, "", row.quantity));
    addRow(row.title, bytes, above);
    above = bytes;
    if (row.quantity == std::string(rows::kMaskedBytes)) masked = bytes;
  }
  for (const char* method : {rows::kJoint, rows::kJointDefault}) {
    std::vector<double> bytes;
    for (const std::string& name : sequences) bytes.push_back(v.of(rows::kTable1, name, method, "", rows::kTotalBytes));
    addRow("Layers, " + methodTitle(method) + ": all that is loaded", bytes, masked);
  }
  return table;
}

// "–" where neither was measured.
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

Table equalQualityTable(const StudyValues& v, const std::string& sequence) {
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
  return table;
}

// Reduction in percent against FVVR's figure.
std::vector<Curve> reductionOverLayers(const StudyValues& v, const char* quantity, double theirs) {
  if (std::isnan(theirs)) return {};
  return curvesOverLayers(v, rows::kJoint, "", [&](double layers, double size) {
    return 100 * (1 - v.mean(rows::kLayers, rows::kJoint, layersSize(layers, size), quantity) / theirs);
  });
}

// Masked PNGs of the sequences whose layers were measured, mean a sequence.
double maskedSequenceBytes(const StudyValues& v) {
  double sum = 0;
  int count = 0;
  for (const std::string& name : v.sequences(rows::kLayers)) {
    const double bytes = v.of(rows::kMultiview, name, rows::kMethodMultiview, "", rows::kMaskedBytes);
    if (!std::isnan(bytes)) sum += bytes, ++count;
  }
  return count ? sum / count : v.mean(rows::kMultiview, rows::kMethodMultiview, "", rows::kMaskedBytes);
}

}  // namespace

std::vector<Picture> picturesOf(const StudyValues& values, const std::vector<std::string>& keys) {
  std::vector<Picture> out;
  for (const Figure& row : values.rows()) {
    if (row.table != rows::kPictures || std::find(keys.begin(), keys.end(), row.quantity) == keys.end()) continue;
    Picture picture;
    const std::string file = rows::settingText(row.setting, "file");
    if (file.empty()) continue;
    picture.file = "pictures/" + file;
    const double width = rows::settingNumber(row.setting, "width"), height = rows::settingNumber(row.setting, "height");
    if (width > 0 && height > 0) picture.width = static_cast<int>(width), picture.height = static_cast<int>(height);
    static const std::pair<const char*, const char*> kKinds[] = {
        {rows::kPictureLayers, "Layers and their camera maps"},
        {rows::kPictureChanges, "Layer 1's camera maps in three frames; faces that change are white"},
        {rows::kPictureErrorMap, "Reference, ours, difference × 4"},
        {rows::kPictureGrazing, "View with crops, FVVR above"},
        {rows::kPictureWorst, "Worst held-out view: truth, ours, FVVR where kept, differences × 4"},
        {rows::kPictureMotionColumns, "From one member (w = 0) to the other (w = 1)"},
        {rows::kPictureMotionCrops, "Half way between the members"},
        {rows::kPictureTransition, "A transition"}};
    for (const auto& [key, caption] : kKinds)
      if (row.quantity == key) picture.caption = caption;
    for (const std::string& part : {row.sequence, row.method.empty() ? "" : methodTitle(row.method)})
      if (!part.empty()) picture.caption += ", " + part;
    static const std::pair<const char*, const char*> kParts[] = {
        {"layers", "L = "}, {"size", "size "}, {"frame", "frame "},  {"view", ""},
        {"from", "from "},  {"to", "to "},     {"score", "SSIM-FG "}};
    for (const auto& [key, prefix] : kParts)
      if (const std::string text = rows::settingText(row.setting, key); !text.empty())
        picture.caption += std::string(", ") + prefix + text;
    out.push_back(std::move(picture));
  }
  return out;
}

Section layersSection(const StudyValues& v) {
  Section section{"layers", "Quality against layers and size", "", {}, {}, {}, {}};
  section.text =
      "LVDT Fig. 5 and 4DVT Fig. 9: the layered render against FVVR's picture from the same viewpoint, a curve a layer "
      "size; all layers of one size, as in the papers. SSIM over the foreground of the ring views, on black. "
      "The difference maps are LVDT Fig. 6.";
  addPlot(section, "SSIM against the number of layers", "layers L", "SSIM-FG against FVVR",
          quantityOverLayers(v, rows::kJoint, "", rows::kSsimFg));
  addPlot(section, "PSNR against the number of layers", "layers L", "PSNR-FG against FVVR, dB",
          quantityOverLayers(v, rows::kJoint, "", rows::kPsnrFgDb));
  addPlot(section, "SSIM with the papers' own labels (NO)", "layers L", "SSIM-FG against FVVR",
          quantityOverLayers(v, rows::kNaive, "", rows::kSsimFg));
  addTable(section, layersTable(v, rows::kSsimFg, "SSIM-FG against FVVR", [](double s) { return fixedText(s, 4); }));
  section.pictures = picturesOf(v, {rows::kPictureErrorMap});
  return section;
}

Section storageSection(const StudyValues& v) {
  Section section{"storage", "Storage and memory", "", {}, {}, {}, {}};
  section.text =
      "LVDT Table 1 and Fig. 7a–c. Reductions of the layers as images and as video are against the foreground-only "
      "multi-view as PNG; that of the GPU memory is against FVVR's pictures and depth maps.";
  addTable(section, multiviewTable(v));
  for (const std::string& sequence : v.sequences(rows::kTable1)) addTable(section, equalQualityTable(v, sequence));
  addPlot(section, "Fig. 7a: less storage as images", "layers L", "reduction, %",
          reductionOverLayers(v, rows::kImageBytes, v.mean(rows::kLayers, rows::kFvvr, "", rows::kMaskedBytes)));
  addPlot(section, "Fig. 7b: less storage as video", "layers L", "reduction, %",
          reductionOverLayers(v, rows::kVideoBytes, maskedSequenceBytes(v)));
  addPlot(section, "Fig. 7c: less GPU memory", "layers L", "reduction, %",
          reductionOverLayers(v, rows::kGpuBytes, v.mean(rows::kLayers, rows::kFvvr, "", rows::kGpuBytes)));
  addTable(section, layersTable(v, rows::kImageBytes, "Layers as PNG, a frame", bytesText));
  addTable(section, layersTable(v, rows::kVideoBps, "Layers as video", bitrateText));
  addTable(section, layersTable(v, rows::kGpuBytes, "GPU memory", bytesText));
  return section;
}

}  // namespace fourdvt::evaluate
