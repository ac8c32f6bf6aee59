// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "lab/study/run/rows.h"
#include "lab/study/tables/sections.h"

namespace fourdvt::study {
namespace {

// Name of a rate curve: the method and its setting without crf, which varies along the curve. Without the number of
// layers it is the name of a family of curves.
std::string curveName(const Row& row, bool with_layers = true) {
  std::string name = row.method;
  for (const char* key : {"preset", "size", "layers", "layout"}) {
    const std::string value = rows::settingText(row.setting, key);
    if (value.empty() || (!with_layers && std::string(key) == "layers")) continue;
    name += std::string(key) == "layers" ? " L" + value : " " + value + (std::string(key) == "size" ? "²" : "");
  }
  return name;
}

struct CurvePoint {
  double bits_per_s, quality;
};
struct RateCurve {
  std::string name, family, layers;
  std::vector<CurvePoint> ssim, psnr;
  double encode_ms = 0;
  int encode_count = 0;
};

void sortByRate(RateCurve& curve) {
  for (auto* points : {&curve.ssim, &curve.psnr})
    std::sort(points->begin(), points->end(),
              [](const CurvePoint& a, const CurvePoint& b) { return a.bits_per_s < b.bits_per_s; });
}

std::vector<RateCurve> rateCurves(const StudyValues& v) {
  std::vector<RateCurve> curves;
  std::vector<std::string> done;
  for (const Row& row : v.rows()) {
    if (row.table != rows::kRate || row.quantity != rows::kVideoBps || matchesFilter(row.setting, "chosen=1")) continue;
    const std::string name = curveName(row), key = row.method + "|" + row.setting;
    if (std::find(done.begin(), done.end(), key) != done.end()) continue;
    done.push_back(key);
    auto it = std::find_if(curves.begin(), curves.end(), [&](const RateCurve& c) { return c.name == name; });
    if (it == curves.end())
      it = curves.insert(
          curves.end(),
          RateCurve{.name = name, .family = curveName(row, false), .layers = rows::settingText(row.setting, "layers")});
    const std::string filter = row.setting + " !chosen";
    const double rate = v.mean(rows::kRate, row.method, filter, rows::kVideoBps),
                 ssim = v.mean(rows::kRate, row.method, filter, rows::kSsimFg),
                 psnr = v.mean(rows::kRate, row.method, filter, rows::kPsnrFgDb),
                 ms = v.mean(rows::kRate, row.method, filter, rows::kEncodeMsFrame);
    if (!std::isnan(ssim)) it->ssim.push_back({rate, ssim});
    if (!std::isnan(psnr)) it->psnr.push_back({rate, psnr});
    if (!std::isnan(ms)) it->encode_ms += ms, ++it->encode_count;
  }
  for (RateCurve& curve : curves) sortByRate(curve);
  return curves;
}

// Rate at which the curve crosses a quality, interpolated in log rate; NaN outside it.
double rateAtQuality(const std::vector<CurvePoint>& points, double quality) {
  for (size_t i = 1; i < points.size(); ++i) {
    const CurvePoint &a = points[i - 1], &b = points[i];
    if ((a.quality - quality) * (b.quality - quality) > 0 || a.quality == b.quality) continue;
    const double share = (quality - a.quality) / (b.quality - a.quality);
    return std::exp(std::log(a.bits_per_s) + share * std::log(b.bits_per_s / a.bits_per_s));
  }
  return std::nan("");
}

// Quality of the curve at a rate, interpolated in log rate; NaN outside it. Points sorted by rate.
double qualityAtRate(const std::vector<CurvePoint>& points, double bits_per_s) {
  for (size_t i = 1; i < points.size(); ++i) {
    const CurvePoint &a = points[i - 1], &b = points[i];
    if (bits_per_s < a.bits_per_s || bits_per_s > b.bits_per_s || a.bits_per_s == b.bits_per_s) continue;
    const double share = std::log(bits_per_s / a.bits_per_s) / std::log(b.bits_per_s / a.bits_per_s);
    return a.quality + share * (b.quality - a.quality);
  }
  return std::nan("");
}

// Gain of additional layers at equal bitrate: evaluates a family's curves at the bitrates measured for the maximum
// number of layers. Requires a curve of one layer.
Table equalRateTable(const std::vector<RateCurve>& curves, const std::string& family) {
  std::vector<const RateCurve*> members;
  for (const RateCurve& curve : curves)
    if (curve.family == family && !curve.psnr.empty()) members.push_back(&curve);
  std::sort(members.begin(), members.end(), [](auto* a, auto* b) { return a->layers < b->layers; });
  if (members.size() < 2 || members.front()->layers != "1") return {};
  Table table{"What view dependence is worth: " + family,
              "Quality at the held-out cameras with one layer, which looks the same from everywhere, and with more, at "
              "the same bitrate of video. Interpolated between measured rates; “–”: beyond the range measured.",
              {"bitrate"},
              {}};
  for (const char* what : {"PSNR-FG, dB, L = ", "SSIM-FG, L = "})
    for (const RateCurve* curve : members) table.columns.push_back(what + curve->layers);
  for (const CurvePoint& point : members.back()->psnr) {
    std::vector<std::string> row{bitrateText(point.bits_per_s)};
    for (const RateCurve* curve : members) row.push_back(fixedText(qualityAtRate(curve->psnr, point.bits_per_s), 2));
    for (const RateCurve* curve : members) row.push_back(fixedText(qualityAtRate(curve->ssim, point.bits_per_s), 4));
    table.rows.push_back(std::move(row));
  }
  return table;
}

// Curve of FVVR from the decoded videos of all cameras, for the sequence of the measured rates.
RateCurve multiviewCurve(const StudyValues& v) {
  RateCurve out{.name = "FVVR from the multi-view's videos"};
  for (const std::string& sequence : v.sequences(rows::kRate))
    for (const double crf : v.numbers(rows::kMultiviewCodec, "h264", "crf")) {
      const auto at = [&](const char* quantity) {
        return v.of(rows::kMultiviewCodec, sequence, "h264", "crf=" + fixedText(crf, 0), quantity);
      };
      const double rate = at(rows::kVideoBps), ssim = at(rows::kHeldOutSsim), psnr = at(rows::kHeldOutPsnrDb);
      if (!std::isnan(rate + ssim)) out.ssim.push_back({rate, ssim});
      if (!std::isnan(rate + psnr)) out.psnr.push_back({rate, psnr});
    }
  sortByRate(out);
  return out;
}

Curve plotCurve(const std::string& name, const std::vector<CurvePoint>& points) {
  Curve curve{name, {}};
  for (const CurvePoint& p : points) curve.points.emplace_back(p.bits_per_s / 1e6, p.quality);
  return curve;
}

// Quality of the default, or the middle of the first curve if no default was chosen.
double commonQuality(const StudyValues& v, const std::vector<RateCurve>& curves) {
  for (const std::string& method : v.methods(rows::kRate)) {
    const double chosen = v.mean(rows::kRate, method, "chosen=1", rows::kSsimFg);
    if (!std::isnan(chosen)) return chosen;
  }
  const auto& points = curves.front().ssim;
  return points.empty() ? std::nan("") : points[points.size() / 2].quality;
}

// Speed-up of the layered renderer over FVVR with this many cameras.
double speedUp(const StudyValues& v, const Cell& cell) {
  return cell.method == rows::kFvvr ? v.mean(rows::kSpeed, rows::kMethodLayered, cell.filter, cell.quantity)
                                    : std::nan("");
}

void addFrameRates(Section& section, const StudyValues& v) {
  Cells renderers;
  for (const std::string& method : v.methods(rows::kSpeed))
    renderers.push_back(
        {{methodTitle(method) + (method == rows::kFvvr ? ", all cameras" : "")}, method, "!pass !closest"});
  for (const std::string& closest : v.settings(rows::kSpeed, rows::kFvvr, "closest"))
    renderers.push_back({{methodTitle(rows::kFvvr) + ", M = " + closest}, rows::kFvvr, "!pass closest=" + closest});
  addGrid(
      section, v,
      {rows::kSpeed,
       "Frame rate",
       "FVVR uploads and draws the depth maps of the cameras that it blends, no others. “Whole frame”: uploads, "
       "geometry and draws; “draws only”: depth maps and shading. Decoding is left out: one video here, one per "
       "camera there.",
       {"method"}},
      renderers,
      {{.title = {"frames per second"}, .quantity = rows::kFramesPerS, .text = fixed<1>},
       {.title = {"ms per frame"}, .quantity = rows::kFrameMs, .text = fixed<2>},
       {.title = {"layered is faster: whole frame"}, .quantity = rows::kRatioToFvvr, .text = times, .value = speedUp},
       {.title = {"draws only"}, .quantity = rows::kDrawRatioToFvvr, .text = times, .value = speedUp}});
}

// Adds a row per pass, a column per renderer; names of passes may contain spaces.
void addPasses(Section& section, const StudyValues& v) {
  Table passes{"Passes, ms per frame", "", {"pass", "layered", "FVVR, all cameras"}, {}};
  const auto closest = v.settings(rows::kSpeed, rows::kFvvr, "closest");
  for (const std::string& m : closest) passes.columns.push_back("FVVR, M = " + m);
  for (const Row& row : v.rows()) {
    if (row.table != rows::kSpeed || row.quantity != rows::kFrameMs) continue;
    const std::string pass = rows::settingText(row.setting, "pass"), m = rows::settingText(row.setting, "closest");
    if (pass.empty()) continue;
    auto it = std::find_if(passes.rows.begin(), passes.rows.end(), [&](const auto& r) { return r[0] == pass; });
    if (it == passes.rows.end()) {
      it = passes.rows.insert(passes.rows.end(), std::vector<std::string>(passes.columns.size(), "–"));
      it->front() = pass;
    }
    const size_t further = static_cast<size_t>(std::find(closest.begin(), closest.end(), m) - closest.begin());
    const size_t column = row.method != rows::kFvvr ? 1 : m.empty() ? 2 : 3 + further;
    (*it)[column] = fixedText(row.value, 3);
  }
  if (!passes.rows.empty()) section.tables.push_back(std::move(passes));
}

void addStages(Section& section, const StudyValues& v) {
  Cells stages;
  for (const std::string& stage : v.settings(rows::kBake, "", "stage"))
    stages.push_back({{stage}, rows::kJointDefault, "stage=" + stage});
  stages.push_back({{"whole bake"}, rows::kJointDefault, "!stage"});
  const double peak = v.mean(rows::kBake, rows::kJointDefault, "!stage", rows::kPeakRssBytes);
  addGrid(section, v,
          {rows::kBake,
           "Bake, by stage",
           std::isnan(peak) ? "" : "Stages overlap on several jobs. Peak memory " + bytesText(peak) + ".",
           {"stage"}},
          stages, {{{"a frame"}, "", "", rows::kSecondsFrame, secondsText}});
}

}  // namespace

void fillRate(Section& section, const StudyValues& v) {
  const auto curves = rateCurves(v);
  if (curves.empty()) return;
  std::vector<Curve> ssim, psnr;
  for (const RateCurve& curve : curves) {
    if (!curve.ssim.empty()) ssim.push_back(plotCurve(curve.name, curve.ssim));
    if (!curve.psnr.empty()) psnr.push_back(plotCurve(curve.name, curve.psnr));
  }
  const RateCurve multiview = multiviewCurve(v);
  if (!multiview.ssim.empty()) ssim.push_back(plotCurve(multiview.name, multiview.ssim));
  if (!multiview.psnr.empty()) psnr.push_back(plotCurve(multiview.name, multiview.psnr));
  if (!ssim.empty())
    section.plots.push_back({"SSIM against bitrate", "Mbit/s", "SSIM-FG of the rendered view", true, false, ssim});
  if (!psnr.empty())
    section.plots.push_back({"PSNR against bitrate", "Mbit/s", "PSNR-FG of the rendered view, dB", true, false, psnr});
  const double quality = commonQuality(v, curves);
  Table table{"The same quality",
              "Interpolated along each curve; “–”: the curve does not reach this quality.",
              {"curve", "bitrate at SSIM-FG " + fixedText(quality, 4), "encoding a frame"},
              {}};
  for (const RateCurve& c : curves)
    table.rows.push_back({c.name, bitrateText(rateAtQuality(c.ssim, quality)),
                          secondsText(c.encode_count ? c.encode_ms / c.encode_count / 1e3 : std::nan(""))});
  section.tables.push_back(std::move(table));
  std::vector<std::string> families;
  for (const RateCurve& curve : curves)
    if (std::find(families.begin(), families.end(), curve.family) == families.end()) families.push_back(curve.family);
  for (const std::string& family : families)
    if (Table worth = equalRateTable(curves, family); !worth.rows.empty()) section.tables.push_back(std::move(worth));
  for (const Row& row : v.rows())
    if (row.table == rows::kRate && row.quantity == rows::kVideoBps && matchesFilter(row.setting, "chosen=1")) {
      section.text += "\n\nThe default is " + curveName(row) + " at quality " + rows::settingText(row.setting, "crf") +
                      ": " + bitrateText(row.value) + ".";
      break;
    }
}

void fillSpeed(Section& section, const StudyValues& v) {
  addFrameRates(section, v);
  addPasses(section, v);
  addStages(section, v);
}

}  // namespace fourdvt::study
