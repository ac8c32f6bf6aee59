// SPDX-License-Identifier: Apache-2.0
// Goals and trends: each is a claim, the measured values, and, if it fails, the cause by the rows.
#include <algorithm>
#include <cmath>

#include "lab/study/run/rows.h"
#include "lab/study/tables/sections.h"

namespace fourdvt::study {
namespace {

using namespace rows;

using Verdict = Judgement::Verdict;

// Sums of a quantity per method, over the sequences measured for both; {NaN, NaN} without such sequences.
struct Pair {
  double a = kNaN, b = kNaN;
};
Pair pairedSums(const StudyValues& v, const std::string& table, const std::string& a, const std::string& b,
                const std::string& quantity) {
  Pair sums;
  std::vector<std::string> names = v.sequences(table);
  if (!std::isnan(v.of(table, "", a, "", quantity) + v.of(table, "", b, "", quantity))) names = {""};
  for (const std::string& name : names) {
    const double x = v.of(table, name, a, "", quantity), y = v.of(table, name, b, "", quantity);
    if (std::isnan(x + y)) continue;
    sums.a = std::isnan(sums.a) ? x : sums.a + x;
    sums.b = std::isnan(sums.b) ? y : sums.b + y;
  }
  return sums;
}

double labelValue(const StudyValues& v, const std::string& method, const char* quantity) {
  return v.mean(kLabels, method, "layer=1", quantity);
}

// "layer-1 flips 10.1 % → 4.9 %, seams 16.8 % → 6.8 %"
std::string labelChange(const StudyValues& v, const std::string& a, const std::string& b) {
  return "layer-1 flips " + percentText(labelValue(v, a, kFlipPercent)) + " → " +
         percentText(labelValue(v, b, kFlipPercent)) + ", seams " + percentText(labelValue(v, a, kSeamPercent)) +
         " → " + percentText(labelValue(v, b, kSeamPercent));
}

Judgement storageGoal(const StudyValues& v) {
  const Pair all = pairedSums(v, kTable1, kJoint, kFvvr, kTotalBytes);
  const double smaller = 100 * (1 - all.a / all.b);
  const auto part = [&](const char* quantity) { return v.sum(kTable1, kJoint, "", quantity); };
  const std::string split = "video " + bytesText(part(kVideoBytes)) + ", geometry " + bytesText(part(kGeometryBytes)) +
                            ", labels " + bytesText(part(kLabelBytes)) + ", other " + bytesText(part(kOtherBytes));
  const bool geometry = part(kGeometryBytes) > part(kVideoBytes);
  return judged("Storage at L = 3, 512²: at least 97 % below the foreground-only multi-view (masked PNG)", smaller,
                smaller >= 97, percentText(smaller) + " below (" + split + ")",
                std::string("The larger part is the ") + (geometry ? "geometry, not the codec." : "video codec's.") +
                    " " + split + " of " + bytesText(all.a) + "; masked PNG " + bytesText(all.b) + ".");
}

Judgement qualityGoal(const StudyValues& v) {
  double at_1024 = v.mean(kLayers, kJoint, "layers=3 size=1024", kSsimFg);
  if (std::isnan(at_1024)) at_1024 = v.mean(kTable1, kJointDefault, "", kSsimFg);
  const double truth = v.mean(kHeldOut, kJointDefault, "", kSsimFg);
  const double fvvr = v.mean(kHeldOut, kFvvr, "", kSsimFg);
  std::string reason = "FVVR is the reference here, not the truth.";
  if (!std::isnan(truth + fvvr))
    reason += " At the held-out cameras ours has " + fixedText(truth, 4) + ", FVVR " + fixedText(fvvr, 4) +
              (truth >= fvvr ? ": the difference from FVVR is not an error of the layers."
                             : ": part of the difference is the layers' own loss.");
  return judged("SSIM-FG against FVVR at 1024², before the codec: at least 0.93", at_1024, at_1024 >= 0.93,
                fixedText(at_1024, 4), reason);
}

Judgement heldOutGoal(const StudyValues& v, const char* method) {
  const Pair sums = pairedSums(v, kHeldOut, method, kFvvr, kPsnrFgDb);
  const double count = sums.b / v.mean(kHeldOut, kFvvr, "", kPsnrFgDb);
  const double gap = (sums.a - sums.b) / std::max(1.0, std::round(count));
  const double common_gap = v.mean(kHeldOut, method, "", kPsnrCommonDb) - v.mean(kHeldOut, kFvvr, "", kPsnrCommonDb);
  return judged("Held-out truth, " + methodTitle(method) + ": PSNR-FG no more than 0.1 dB below FVVR's", gap,
                gap >= -0.1, fixedText(gap, 2) + " dB against FVVR",
                std::isnan(common_gap)
                    ? "See the worst views below."
                    : "Inside both silhouettes the gap is " + fixedText(common_gap, 2) + " dB: " +
                          (common_gap >= -0.1 ? "the loss is at the outline." : "the loss is in the texture."));
}

struct FewerGoal {
  const char *what, *quantity;
  double percent;
  const char *where, *reason;  // face selection; possible cause of failure
};

Judgement fewerThanSpatial(const StudyValues& v, const FewerGoal& goal) {
  const double spatial = labelValue(v, kSpatial, goal.quantity), joint = labelValue(v, kJoint, goal.quantity);
  const double fewer = 100 * (1 - joint / spatial);
  const std::string claim = "Labels: joint has at least " + fixedText(goal.percent, 0) + " % fewer " + goal.what +
                            " in layer 1 than spatial" + goal.where,
                    change = percentText(spatial) + " → " + percentText(joint);
  return judged(claim, fewer, fewer >= goal.percent, percentText(fewer) + " fewer (" + change + ")", goal.reason);
}

void labellingGoals(const StudyValues& v, std::vector<Judgement>& out) {
  constexpr const char* kSeen = ", counted on faces that a camera sees";
  constexpr const char* kUnseen =
      "The gain over all faces is in part that of faces that no camera sees: the papers' methods leave them empty, "
      "ours goes on with the neighbours' label.";
  constexpr const char* kMustFlip = "A face whose camera stops seeing it has to flip.";
  for (const FewerGoal& goal :
       {FewerGoal{"flips", kFlipPercent, 50, "", kMustFlip}, FewerGoal{"flips", kSeenFlipPercent, 50, kSeen, kMustFlip},
        FewerGoal{"seam edges", kSeamPercent, 30, "", "See the tables of the labels."},
        FewerGoal{"seam edges", kSeenSeamPercent, 30, kSeen, kUnseen}})
    out.push_back(fewerThanSpatial(v, goal));
  const double naive = labelValue(v, kNaive, kMeanPenalty), joint = labelValue(v, kJoint, kMeanPenalty);
  const double more = 100 * (joint / naive - 1);
  out.push_back(judged("Labels: joint's mean layer-1 penalty within 10 % of naive's", more, more <= 10,
                       fixedText(naive, 4) + " → " + fixedText(joint, 4) + " (" + fixedText(more, 1) + " %)",
                       "The weights trade penalty for smoothness: " + labelChange(v, kNaive, kJoint) + "."));
  const Pair energy{v.mean(kLabels, kJoint, "solve=global", kEnergy),
                    v.mean(kLabels, kJoint, "solve=windowed", kEnergy)};
  const double excess = 100 * (energy.b / energy.a - 1);
  out.push_back(judged("Labels: energy of the windowed solve within 1 % of the global solve's", excess, excess <= 1,
                       fixedText(excess, 2) + " % above", "Longer windows would come nearer."));
  const double ms = v.mean(kLabels, kJoint, "", kLabelMsFrame);
  out.push_back(judged("Labels: at most 0.1 s a frame", ms, ms <= 100, secondsText(ms / 1000) + " a frame",
                       "Wall clock of this run on this machine, whatever else ran on it."));
}

// Quantity of the joint labels with this many layers of this size.
double layersValue(const StudyValues& v, double layers, double size, const char* quantity) {
  return v.mean(kLayers, kJoint, "layers=" + fixedText(layers, 0) + " size=" + fixedText(size, 0), quantity);
}

Judgement gainOverLayers(const StudyValues& v, double size) {
  const auto at = [&](double layers) { return layersValue(v, layers, size, kSsimFg); };
  const auto counts = v.numbers(kLayers, kJoint, "layers");
  const double most = counts.empty() ? 0 : counts.back();
  const double first = at(1), third = at(3), last = most > 3 ? at(most) : kNaN;
  const double rise = third - first, after = last - third;
  const std::string measured = "L = 1: " + fixedText(first, 4) + ", 3: " + fixedText(third, 4) + ", " +
                               fixedText(most, 0) + ": " + fixedText(last, 4);
  const bool flat = std::abs(after) <= std::max(0.25 * std::abs(rise), 0.002);
  std::string reason;
  if (rise <= 0)
    reason = "One layer already gives " + fixedText(first, 4) + "; the second and third camera of a face take " +
             fixedText(-rise, 4) + " off it. Likely: they see it from further aside and blur the blend.";
  else if (!flat && after > 0)
    reason = "Layers beyond the third still add " + fixedText(after, 4) + " to a rise of " + fixedText(rise, 4) +
             ". Likely: the reference blends every camera that sees a point, and these are more than three here.";
  else
    reason = "Beyond L = 3 the figure falls by " + fixedText(-after, 4) + " after a rise of " + fixedText(rise, 4) +
             ". Likely: the cameras left see a face at a flat angle and blur the blend.";
  return judged("SSIM rises to L = 3 and flattens, size " + fixedText(size, 0) + "²  (LVDT Fig. 5, 4DVT Fig. 9)",
                rise + after, rise > 0 && flat, measured, reason);
}

Judgement gainOverSizes(const StudyValues& v) {
  const auto at = [&](double size) { return layersValue(v, 3, size, kSsimFg); };
  const double q256 = at(256), q512 = at(512), q1024 = at(1024), q2048 = at(2048);
  const bool holds = q256 < q512 && q512 < q1024 && std::abs(q2048 - q1024) < 0.5 * (q1024 - q512);
  return judged("SSIM at L = 3 rises with the layer size up to 1024² and little beyond (LVDT 4.1)",
                q256 + q512 + q1024 + q2048, holds,
                "256: " + fixedText(q256, 4) + ", 512: " + fixedText(q512, 4) + ", 1024: " + fixedText(q1024, 4) +
                    ", 2048: " + fixedText(q2048, 4),
                q1024 <= q512 ? "Likely: the cameras of this capture resolve no more than 512² texels hold."
                              : "1024² to 2048² changes it by " + fixedText(q2048 - q1024, 4) + ", 512² to 1024² by " +
                                    fixedText(q1024 - q512, 4) + ".");
}

Judgement storageOrder(const StudyValues& v, const char* more, const char* less) {
  const Pair total = pairedSums(v, kTable1, more, less, kTotalBytes);
  const Pair video = pairedSums(v, kTable1, more, less, kVideoBytes);
  const Pair labels = pairedSums(v, kTable1, more, less, kLabelBytes);
  const double flips_more = labelValue(v, more, kFlipPercent), flips_less = labelValue(v, less, kFlipPercent);
  std::string reason = labelChange(v, more, less) + "; video " + bytesText(video.a) + " → " + bytesText(video.b) +
                       ", labels " + bytesText(labels.a) + " → " + bytesText(labels.b) + ". ";
  if (std::string(less) == kTemporalPaper && flips_less > 0.9 * flips_more)
    reason += "Eq. 5 as printed divides the temporal term by the number of faces: its labels are nearly those of SO.";
  else if (flips_less < 0.9 * flips_more && video.b >= video.a)
    reason += "Fewer label changes do not make the video smaller here: its bits go into other things than flips.";
  else if (labels.b > labels.a && video.b < video.a)
    reason += "The video is smaller, but the labels cost more than that saves.";
  else
    reason += "The labels are not steadier, so that the codec gains nothing.";
  return judged(
      "Storage " + methodTitle(more) + " > " + methodTitle(less) + " at the same codec settings (4DVT Table 1)",
      total.a + total.b, total.a > total.b, bytesText(total.a) + " → " + bytesText(total.b), reason);
}

Judgement sameQuality(const StudyValues& v) {
  double low = kNaN, high = kNaN;
  for (const char* method : {kNaive, kSpatial, kTemporalPaper, kJoint}) {
    const double ssim = v.mean(kTable1, method, "", kSsimFg);
    if (std::isnan(ssim)) return judged("SSIM is the same for NO, SO, TO and ours (4DVT Table 1)", kNaN, false, "");
    low = std::isnan(low) ? ssim : std::min(low, ssim);
    high = std::isnan(high) ? ssim : std::max(high, ssim);
  }
  return judged("SSIM is the same for NO, SO, TO and ours within 0.02 (4DVT Table 1)", high - low, high - low <= 0.02,
                fixedText(low, 4) + " to " + fixedText(high, 4),
                "Smoother labels take worse cameras: mean layer-1 penalty " +
                    fixedText(labelValue(v, kNaive, kMeanPenalty), 3) + " (NO) → " +
                    fixedText(labelValue(v, kJoint, kMeanPenalty), 3) + " (ours).");
}

// Verdict: bytes grow with L, and the last layer adds less than the second one.
Judgement slowingGrowth(const StudyValues& v, const char* quantity, const std::string& what, double size) {
  std::vector<double> steps;
  double before = kNaN;
  const auto counts = v.numbers(kLayers, kJoint, "layers");
  for (const double layers : counts) {
    const double bytes = layersValue(v, layers, size, quantity);
    if (!std::isnan(before + bytes)) steps.push_back(bytes - before);
    before = bytes;
  }
  const double decisive = steps.size() < 2 ? kNaN : steps.front() + steps.back();
  const bool rising = std::all_of(steps.begin(), steps.end(), [](double s) { return s > 0; });
  std::string list;
  for (const double step : steps) list += (list.empty() ? "+" : ", +") + bytesText(step);
  const bool holds = rising && steps.size() > 1 && steps.back() < steps.front();
  return judged("Storage as " + what + " grows with L, ever slower, size " + fixedText(size, 0) + "² (LVDT Fig. 7)",
                decisive, holds, list + " a layer",
                rising ? "The last layer costs as much as the second. Likely: its empty texels are filled from layer 1 "
                         "before coding, so that it is not sparse as in the paper."
                       : "A further layer makes the whole smaller here: constant quality is not constant rate.");
}

Judgement loadingTrend(const StudyValues& v, const char* quantity, const std::string& what) {
  const Pair load = pairedSums(v, kTable1, kJoint, kFvvr, quantity);
  const double saved = 100 * (1 - load.a / load.b);
  return judged("Loading takes a small part of FVVR's time, " + what + " (4DVT Table 1: 98 % less)", saved, saved >= 90,
                secondsText(load.a) + " against " + secondsText(load.b) + ": " + percentText(saved) + " less",
                "Decoding " + bytesText(v.sum(kTable1, kJoint, "", kTotalBytes)) + " against " +
                    bytesText(v.sum(kTable1, kFvvr, "", kTotalBytes)) + " of pictures.");
}

}  // namespace

std::vector<Judgement> judgeGoals(const StudyValues& v) {
  std::vector<Judgement> out{storageGoal(v), qualityGoal(v)};
  const double ratio = v.mean(kSpeed, kMethodLayered, "!pass !closest", kRatioToFvvr);
  const std::string three = "closest=" + std::to_string(kClosestCameras) + " !pass";
  const double fewer = v.mean(kSpeed, kMethodLayered, three, kRatioToFvvr);
  out.push_back(judged("Layered rendering at least 4 × the frame rate of FVVR from all cameras in the same run", ratio,
                       ratio >= 4, fixedText(ratio, 2) + " ×", "See the passes for where the time goes."));
  out.push_back(judged(
      "Layered rendering faster than FVVR from the " + std::to_string(kClosestCameras) + " cameras nearest to the view",
      fewer, fewer > 1, fixedText(fewer, 2) + " ×", "See the passes for where the time goes."));
  labellingGoals(v, out);
  for (const char* method : {kJoint, kJointDefault}) out.push_back(heldOutGoal(v, method));
  const double bake_s = v.mean(kBake, kJointDefault, "!stage", kSecondsFrame);
  out.push_back(judged("Whole bake at most 1 s a frame", bake_s, bake_s <= 1, secondsText(bake_s) + " a frame",
                       "See the stages; wall clock of this run on this machine, whatever else ran on it."));
  return out;
}

std::vector<Judgement> judgeTrends(const StudyValues& v) {
  std::vector<Judgement> out;
  const auto sizes = v.numbers(kLayers, kJoint, "size");
  for (const double size : sizes) out.push_back(gainOverLayers(v, size));
  if (sizes.empty()) out.push_back(judged("SSIM rises to L = 3 and flattens (LVDT Fig. 5)", kNaN, false, ""));
  out.push_back(gainOverSizes(v));
  out.push_back(storageOrder(v, kNaive, kSpatial));
  out.push_back(storageOrder(v, kSpatial, kTemporalPaper));
  out.push_back(storageOrder(v, kTemporalPaper, kJoint));
  out.push_back(sameQuality(v));
  const double size = std::find(sizes.begin(), sizes.end(), 512) != sizes.end() ? 512 : sizes.empty() ? 0 : sizes[0];
  out.push_back(slowingGrowth(v, kImageBytes, "images", size));
  out.push_back(slowingGrowth(v, kVideoBytes, "video", size));
  const double ours = v.mean(kLayers, kJoint, "layers=3 size=512", kGpuBytes),
               theirs = v.mean(kLayers, kFvvr, "", kGpuBytes);
  out.push_back(judged("GPU memory at L = 3, 512² is below FVVR's (LVDT Fig. 7c)", ours + theirs, ours < theirs,
                       bytesText(ours) + " against " + bytesText(theirs),
                       "The layers' textures outweigh " + bytesText(theirs) + " of pictures and depth maps."));
  out.push_back(loadingTrend(v, kLoadingAllS, "the whole sequence, as the papers measure it"));
  out.push_back(loadingTrend(v, kLoadingS, "to the first picture"));
  return out;
}

}  // namespace fourdvt::study
