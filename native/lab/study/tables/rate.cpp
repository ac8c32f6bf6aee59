// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "lab/study/run/rows.h"
#include "lab/study/tables/sections.h"

namespace fourdvt::study {
namespace {

using namespace rows;

// Name of a rate curve: the method and its setting without crf, which varies along the curve. Without the number of
// layers it is the name of a family of curves.
std::string curveName(const Row& row, bool with_layers = true) {
  std::string name = row.method;
  for (const std::string key : {"preset", "size", "layers", "layout"}) {
    const std::string value = settingText(row.setting, key);
    if (value.empty() || (!with_layers && key == "layers")) continue;
    name += key == "layers" ? " L" + value : " " + value + (key == "size" ? "²" : "");
  }
  return name;
}

// Qualities over the rate: of the layers' rows, and of those of the multi-view's videos.
struct Quality {
  const char *ours, *theirs, *name, *unit;
};
constexpr Quality kQualities[] = {{kSsimFg, kHeldOutSsim, "SSIM", ""}, {kPsnrFgDb, kHeldOutPsnrDb, "PSNR", ", dB"}};
constexpr size_t kSsim = 0, kPsnr = 1;

using Points = std::vector<std::pair<double, double>>;  // bit/s and quality, ascending
struct RateCurve {
  std::string name, family, layers;
  std::array<Points, 2> points = {};  // of kQualities
  std::vector<double> encode_ms = {};

  void add(size_t quality, double bits_per_s, double value) {
    if (!std::isnan(bits_per_s + value)) points[quality].emplace_back(bits_per_s, value);
  }
  void sort() {
    for (Points& p : points) std::sort(p.begin(), p.end());
  }
};

std::vector<RateCurve> rateCurves(const StudyValues& v) {
  std::vector<RateCurve> curves;
  std::vector<std::string> done;
  for (const Row& row : v.rows()) {
    if (row.table != kRate || row.quantity != kVideoBps || matchesFilter(row.setting, "chosen=1")) continue;
    const std::string name = curveName(row), key = row.method + "|" + row.setting;
    if (std::find(done.begin(), done.end(), key) != done.end()) continue;
    done.push_back(key);
    auto it = std::find_if(curves.begin(), curves.end(), [&](const RateCurve& c) { return c.name == name; });
    if (it == curves.end())
      it = curves.insert(curves.end(), RateCurve{name, curveName(row, false), settingText(row.setting, "layers")});
    const auto at = [&](const char* quantity) { return v.mean(kRate, row.method, row.setting + " !chosen", quantity); };
    for (size_t q : {kSsim, kPsnr}) it->add(q, at(kVideoBps), at(kQualities[q].ours));
    if (const double ms = at(kEncodeMsFrame); !std::isnan(ms)) it->encode_ms.push_back(ms);
  }
  for (RateCurve& curve : curves) curve.sort();
  return curves;
}

// Rate at which the curve crosses a quality, interpolated in log rate; NaN outside it.
double rateAtQuality(const Points& points, double quality) {
  for (size_t i = 1; i < points.size(); ++i) {
    const auto [rate_a, a] = points[i - 1];
    const auto [rate_b, b] = points[i];
    if ((a - quality) * (b - quality) > 0 || a == b) continue;
    return std::exp(std::log(rate_a) + (quality - a) / (b - a) * std::log(rate_b / rate_a));
  }
  return std::nan("");
}

// Quality of the curve at a rate, interpolated in log rate; NaN outside it.
double qualityAtRate(const Points& points, double bits_per_s) {
  for (size_t i = 1; i < points.size(); ++i) {
    const auto [rate_a, a] = points[i - 1];
    const auto [rate_b, b] = points[i];
    if (bits_per_s < rate_a || bits_per_s > rate_b || rate_a == rate_b) continue;
    return a + std::log(bits_per_s / rate_a) / std::log(rate_b / rate_a) * (b - a);
  }
  return std::nan("");
}

// Adds the gain of additional layers at equal bitrate: evaluates a family's curves at the bitrates measured for the
// maximum number of layers. Requires a curve of one layer.
void addEqualRates(Section& section, const std::vector<RateCurve>& curves, const std::string& family) {
  std::vector<const RateCurve*> members;
  for (const RateCurve& curve : curves)
    if (curve.family == family && !curve.points[kPsnr].empty()) members.push_back(&curve);
  std::sort(members.begin(), members.end(), [](auto* a, auto* b) { return a->layers < b->layers; });
  if (members.size() < 2 || members.front()->layers != "1") return;
  Table table{"What view dependence is worth: " + family,
              "Quality at the held-out cameras with one layer, which looks the same from everywhere, and with more, at "
              "the same bitrate of video. Interpolated between measured rates; “–”: beyond the range measured.",
              {"bitrate"},
              {}};
  for (const auto& [rate, psnr] : members.back()->points[kPsnr]) table.rows.push_back({bitrateText(rate)});
  for (const size_t q : {kPsnr, kSsim})
    for (const RateCurve* curve : members) {
      table.columns.push_back(kQualities[q].name + std::string("-FG") + kQualities[q].unit + ", L = " + curve->layers);
      for (size_t i = 0; i < table.rows.size(); ++i)
        table.rows[i].push_back(
            textOf(kQualities[q].ours)(qualityAtRate(curve->points[q], members.back()->points[kPsnr][i].first)));
    }
  addTable(section, std::move(table));
}

// Curve of FVVR from the decoded videos of all cameras, for the sequence of the measured rates.
RateCurve multiviewCurve(const StudyValues& v) {
  RateCurve out{"FVVR from the multi-view's videos", "", ""};
  for (const std::string& sequence : v.sequences(kRate))
    for (const double crf : v.numbers(kMultiviewCodec, "h264", "crf")) {
      const auto at = [&](const char* quantity) {
        return v.of(kMultiviewCodec, sequence, "h264", "crf=" + fixedText(crf, 0), quantity);
      };
      for (size_t q : {kSsim, kPsnr}) out.add(q, at(kVideoBps), at(kQualities[q].theirs));
    }
  out.sort();
  return out;
}

// Quality of the default, or the middle of the first curve if no default was chosen.
double commonQuality(const StudyValues& v, const std::vector<RateCurve>& curves) {
  for (const std::string& method : v.methods(kRate)) {
    const double chosen = v.mean(kRate, method, "chosen=1", kSsimFg);
    if (!std::isnan(chosen)) return chosen;
  }
  const Points& points = curves.front().points[kSsim];
  return points.empty() ? std::nan("") : points[points.size() / 2].second;
}

// Speed-up of the layered renderer over FVVR with this many cameras.
double speedUp(const StudyValues& v, const Cell& cell) {
  return cell.method == kFvvr ? v.mean(kSpeed, kMethodLayered, cell.filter, cell.quantity) : std::nan("");
}

void addFrameRates(Section& section, const StudyValues& v) {
  Cells renderers;
  for (const std::string& method : v.methods(kSpeed))
    renderers.push_back({{methodTitle(method) + (method == kFvvr ? ", all cameras" : "")}, method, "!pass !closest"});
  for (Cell fewer : settingsOf(v, kSpeed, kFvvr, "closest", "FVVR, M = ")) {
    fewer.filter += " !pass";
    renderers.push_back(std::move(fewer));
  }
  addGrid(section, v,
          {kSpeed,
           "Frame rate",
           "FVVR uploads and draws the depth maps of the cameras that it blends, no others. “Whole frame”: uploads, "
           "geometry and draws; “draws only”: depth maps and shading. Decoding is left out: one video here, one per "
           "camera there.",
           {"method"}},
          renderers,
          {{.title = {"frames per second"}, .quantity = kFramesPerS},
           {.title = {"ms per frame"}, .quantity = kFrameMs},
           {.title = {"layered is faster: whole frame"}, .quantity = kRatioToFvvr, .text = times, .value = speedUp},
           {.title = {"draws only"}, .quantity = kDrawRatioToFvvr, .text = times, .value = speedUp}});
}

// Adds a row per pass, a column per renderer; names of passes may contain spaces.
void addPasses(Section& section, const StudyValues& v) {
  Cells renderers{{{"layered"}, kMethodLayered}, {{"FVVR, all cameras"}, kFvvr, "!closest"}};
  for (Cell& fewer : settingsOf(v, kSpeed, kFvvr, "closest", "FVVR, M = ")) renderers.push_back(std::move(fewer));
  addGrid(section, v, {kSpeed, "Passes, ms per frame", "", {"pass"}, {.quantity = kFrameMs, .text = fixed<3>}},
          settingsOf(v, kSpeed, "", "pass"), renderers);
}

void addStages(Section& section, const StudyValues& v) {
  Cells stages = settingsOf(v, kBake, "", "stage");
  stages.push_back({{"whole bake"}, "", "!stage"});
  const double peak = v.mean(kBake, kJointDefault, "!stage", kPeakRssBytes);
  addGrid(section, v,
          {kBake,
           "Bake, by stage",
           std::isnan(peak) ? "" : "Stages overlap on several jobs. Peak memory " + bytesText(peak) + ".",
           {"stage"},
           {.method = kJointDefault}},
          stages, cellsOf({{"a frame", kSecondsFrame}}));
}

}  // namespace

void fillRate(Section& section, const StudyValues& v) {
  const auto curves = rateCurves(v);
  if (curves.empty()) return;
  auto plotted = curves;
  plotted.push_back(multiviewCurve(v));
  for (const size_t q : {kSsim, kPsnr}) {
    const std::string name = kQualities[q].name;
    Plot plot{
        name + " against bitrate", "Mbit/s", name + "-FG of the rendered view" + kQualities[q].unit, true, false, {}};
    for (const RateCurve& curve : plotted) {
      if (curve.points[q].empty()) continue;
      Curve& shown = plot.curves.emplace_back(Curve{curve.name, {}});
      for (const auto& [rate, quality] : curve.points[q]) shown.points.emplace_back(rate / 1e6, quality);
    }
    if (!plot.curves.empty()) section.plots.push_back(std::move(plot));
  }
  const double quality = commonQuality(v, curves);
  Table table{"The same quality",
              "Interpolated along each curve; “–”: the curve does not reach this quality.",
              {"curve", "bitrate at SSIM-FG " + fixedText(quality, 4), "encoding a frame"},
              {}};
  for (const RateCurve& c : curves) {
    const double sum_ms = std::accumulate(c.encode_ms.begin(), c.encode_ms.end(), 0.0);
    table.rows.push_back({c.name, bitrateText(rateAtQuality(c.points[kSsim], quality)),
                          secondsText(sum_ms / double(c.encode_ms.size()) / 1e3)});
  }
  addTable(section, std::move(table));
  std::vector<std::string> families;
  for (const RateCurve& curve : curves)
    if (std::find(families.begin(), families.end(), curve.family) == families.end()) families.push_back(curve.family);
  for (const std::string& family : families) addEqualRates(section, curves, family);
  for (const Row& row : v.rows())
    if (row.table == kRate && row.quantity == kVideoBps && matchesFilter(row.setting, "chosen=1")) {
      section.text += "\n\nThe default is " + curveName(row) + " at quality " + settingText(row.setting, "crf") + ": " +
                      bitrateText(row.value) + ".";
      break;
    }
}

void fillSpeed(Section& section, const StudyValues& v) {
  addFrameRates(section, v);
  addPasses(section, v);
  addStages(section, v);
}

}  // namespace fourdvt::study
