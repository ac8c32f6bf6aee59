// SPDX-License-Identifier: Apache-2.0
// Appearance between the members: against the studio's truth (Casas et al. 2014, Fig. 8), and its sharpness against the
// members' own.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "lab/study/motion/motion.h"
#include "lab/study/run/row_writer.h"
#include "lab/study/run/rows.h"
#include "lab/study/run/run_steps.h"
#include "lab/study/tables/report.h"
#include "measure/picture_score.h"

namespace fourdvt::study {
namespace {

using namespace rows;

constexpr int kSharpWidth = 600, kSharpHeight = 800;
constexpr int kEdge = 4;  // border along the outline excluded from sharpness

constexpr size_t kCameras = 3;  // truth cameras; the held-out ones come first

// Selects the alignments to draw. Both are measured with and without restored contrast, for a fair comparison. OpenCV's
// flow is slow to read back and is limited to the most relevant cases.
std::vector<AlignMethod> shownMethods(const MotionSubject& subject, bool with_opencv) {
  std::vector<AlignMethod> methods{kAlignNone, kAlignBaked, kFlowGpu};
  if (subject.stage.aligned()) {
    methods.insert(methods.begin() + 2, kAlignBakedMean);
    methods.push_back(kFlowGpuDetail);
  }
  if (with_opencv && !subject.quick()) methods.push_back(kFlowOpencv);
  return subject.methods(methods);
}

void addDistances(const Positions& a, const Positions& b, measure::ErrorSamples& millimetres) {
  for (size_t v = 0; v < a.size(); ++v) millimetres.add(1e3f * glm::distance(a[v], b[v]));
}

Image restricted(const Image& rgba, const measure::Mask& inside) {
  Image out = rgba;
  for (size_t i = 0; i < inside.size(); ++i)
    if (!inside[i]) std::fill_n(&out.pixels[4 * i], 4, uint8_t{0});
  return out;
}

std::string settingOf(double w) { return "w=" + fixedText(w, 2); }

class TruthPart {
 public:
  explicit TruthPart(const MotionSubject& subject) : subject_(subject), truth_(*subject.truth) {}

  Result<Rows> run() {
    const size_t instants = subject_.quick() ? 1 : truth_.instants().size();
    for (size_t i = 0; i < instants; ++i)
      for (const MotionTruth::Step& step : truth_.steps())
        if (step.w > 0.01 && step.w < 0.99 && (!subject_.quick() || std::abs(step.w - 0.5) < 0.15))
          FOURDVT_TRY(measure(step, truth_.instants()[i]));
    return rows();
  }

 private:
  Status measure(const MotionTruth::Step& step, const MotionTruth::Instant& instant) {
    FOURDVT_TRY(subject_.stage.show(truth_.classFrame(step.w, instant)));
    FOURDVT_ASSIGN(auto exact, truth_.mesh(step, instant));
    FOURDVT_ASSIGN(auto blended, subject_.stage.blendedAt(step.w, truth_.classPhase(step.w, instant)));
    addDistances(exact, blended, apart_[step.w]);
    for (const bool exactly : {false, true}) {
      subject_.stage.setMesh(exactly ? exact : blended);
      const size_t cameras = std::min(truth_.cameras().size(), subject_.quick() ? 1 : kCameras);
      for (size_t c = 0; c < cameras; ++c) {
        FOURDVT_TRY(checkStop(subject_.context));
        const PinholeCamera& camera = truth_.cameras()[c];
        FOURDVT_ASSIGN(auto truth, truth_.picture(step, camera, instant));
        for (const AlignMethod& method : shownMethods(subject_, exactly)) {
          FOURDVT_ASSIGN(auto picture, subject_.stage.draw(camera, step.w, method));
          const std::string setting = settingOf(step.w) + " mesh=" + (exactly ? "truth" : "blend");
          const measure::Mask common = measure::commonSilhouette(truth, picture);
          lane_.add(restricted(truth, common), restricted(picture, common), method + "|" + setting + " region=common");
          lane_.add(truth, std::move(picture), method + "|" + setting + " region=whole");
        }
      }
    }
    return {};
  }

  Rows rows() {
    std::map<std::string, measure::MeanScores> means;
    for (const auto& [tag, score] : lane_.finish()) means[tag].add(score);
    Rows out;
    for (const auto& [tag, scores] : means) {
      const size_t bar = tag.find('|');
      const measure::PictureScore mean = scores.mean();
      const RowWriter row(out, kMotionAppearance, subject_.motion().name, tag.substr(0, bar), tag.substr(bar + 1));
      row.add({{kPsnrFgDb, mean.psnr_fg_db}, {kSsimFg, mean.ssim_fg}});
    }
    for (const auto& [w, millimetres] : apart_) {
      const RowWriter row(out, kMotionAppearance, subject_.motion().name, "", settingOf(w));
      row.add({{kMeshMeanMm, millimetres.mean()}, {kMeshTailMm, millimetres.tail()}});
    }
    return out;
  }

  const MotionSubject& subject_;
  const MotionTruth& truth_;
  measure::ScoreLane lane_;
  std::map<double, measure::ErrorSamples> apart_;  // by w: distance of the blended mesh from the true one
};

struct RatioSum {
  double gradient = 0, detail = 0, least = 1e9;
  int count = 0;
};

// Measures sharpness against the w-weighted mean of the members' own pictures on the same mesh and view.
Status addSharpness(const MotionSubject& subject, const PinholeCamera& camera, double w,
                    const std::array<Image, 2>& looks, std::map<AlignMethod, RatioSum>& sums) {
  for (const AlignMethod& method : shownMethods(subject, false)) {
    FOURDVT_ASSIGN(auto blend, subject.stage.draw(camera, w, method));
    measure::Mask inside = measure::commonSilhouette(blend, looks[0]);
    inside = measure::eroded(inside, camera.width, camera.height, kEdge);
    const measure::Sharpness shown = measure::sharpness(measure::compositedOnBlack(blend), inside),
                             first = measure::sharpness(measure::compositedOnBlack(looks[0]), inside),
                             second = measure::sharpness(measure::compositedOnBlack(looks[1]), inside);
    const double ratio = shown.gradient / ((1 - w) * first.gradient + w * second.gradient);
    RatioSum& sum = sums[method];
    sum.gradient += ratio;
    sum.detail += shown.detail / ((1 - w) * first.detail + w * second.detail);
    sum.least = std::min(sum.least, ratio);
    ++sum.count;
  }
  return {};
}

Status measureSharpness(const MotionSubject& subject, Rows& out) {
  std::map<double, std::map<AlignMethod, RatioSum>> sums;  // by w
  for (const uint32_t phase : subject.phases(subject.quick() ? 1 : 5)) {
    FOURDVT_TRY(subject.stage.show(phase));
    for (const double azimuth : motionAzimuths_deg(subject.quick() ? 2 : 4))
      for (const double w : {0.25, 0.5, 0.75}) {
        if (subject.quick() && w != 0.5) continue;
        FOURDVT_TRY(checkStop(subject.context));
        subject.stage.setMesh(subject.stage.blended(w));
        const PinholeCamera camera = subject.stage.orbit(azimuth, kSharpWidth, kSharpHeight);
        std::array<Image, 2> looks;
        for (size_t m = 0; m < 2; ++m) {
          FOURDVT_ASSIGN(looks[m], subject.stage.draw(camera, double(m), kAlignNone));
        }
        FOURDVT_TRY(addSharpness(subject, camera, w, looks, sums[w]));
      }
  }
  for (const auto& [w, methods] : sums)
    for (const auto& [method, sum] : methods) {
      const RowWriter row(out, kMotionSharpness, subject.motion().name, method, settingOf(w));
      row.add({{kGradientRatio, sum.gradient / sum.count},
               {kGradientRatioLeast, sum.least},
               {kDetailRatio, sum.detail / sum.count}});
    }
  return {};
}

}  // namespace

Result<Rows> measureAppearance(const MotionSubject& subject) {
  Rows out;
  if (subject.truth) {
    FOURDVT_ASSIGN(out, TruthPart(subject).run());
  }
  FOURDVT_TRY(measureSharpness(subject, out));
  return out;
}

}  // namespace fourdvt::study
