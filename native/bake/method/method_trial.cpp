// SPDX-License-Identifier: Apache-2.0
#include "bake/method/method_trial.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <future>

#include "bake/method/camera_choice.h"
#include "bake/method/method_choice.h"
#include "bake/method/view_scores.h"
#include "bake/texels/picture_crop.h"
#include "encode/camera_layout.h"
#include "measure/picture_score.h"
#include "render/cameras/camera_method.h"

namespace fourdvt::bake {
namespace {

constexpr size_t kMinPixels = 400;  // minimum of blended pixels in a view
constexpr size_t kWaiting = 4;      // maximum number of pictures queued for scoring
constexpr uint8_t kInMatte = 128;

// Mean of factor² pixels each; RGBA with straight alpha.
Image shrunk(const Image& picture, int factor) {
  Image out(picture.width / factor, picture.height / factor, 4);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      uint32_t alpha = 0, colour[3] = {};
      for (int k = 0; k < factor * factor; ++k) {
        const uint8_t* p = picture.at(factor * x + k % factor, factor * y + k / factor);
        alpha += p[3];
        for (int c = 0; c < 3; ++c) colour[c] += uint32_t(p[3]) * p[c];
      }
      uint8_t* to = out.at(x, y);
      for (int c = 0; c < 3; ++c) to[c] = alpha ? uint8_t((colour[c] + alpha / 2) / alpha) : 0;
      to[3] = uint8_t(alpha / uint32_t(factor * factor));
    }
  return out;
}

Image cropped(const Image& picture, const package::Rect& box) {
  Image out(box.width, box.height, picture.channels);
  for (int y = 0; y < box.height; ++y)
    std::copy_n(picture.at(box.x, box.y + y), size_t(box.width) * size_t(picture.channels), out.at(0, y));
  return out;
}

// View of a left-out camera, its ground truth, and the mask of evaluated pixels.
struct TrialView {
  size_t camera = 0;
  PinholeCamera view;
  package::Rect box;  // bounds of the surface, to which the comparison is limited
  Image truth;        // cropped to the box
  measure::Mask blended;
};

struct ViewScore {
  measure::PictureScore picture;
  RegisteredScore registered;
};

ViewScore scored(const TrialView& view, const Image& drawn) {
  const Image shown = cropped(drawn, view.box);
  return {measure::scorePicture(view.truth, shown),
          registeredScore(measure::compositedOnBlack(view.truth), measure::compositedOnBlack(shown), view.blended)};
}

bool hasMatte(const Image& picture) {
  for (size_t i = 3; i < picture.pixels.size(); i += 4)
    if (picture.pixels[i] >= kInMatte) return true;
  return false;
}

// Empty where too little of the view is blended.
std::optional<TrialView> makeView(const TrialFrame& frame, const SharedSight& sight, size_t camera) {
  TrialView out{camera, frame.cameras[camera], {}, {}, {}};
  const int longest = std::max(out.view.width, out.view.height),
            factor = (longest + kMaxTrialSide_px - 1) / kMaxTrialSide_px;
  Image truth = frame.pictures[camera];
  replaceEdgeColours(truth);
  if (factor > 1) {
    truth = shrunk(truth, factor);
    out.view = scaledCamera(out.view, truth.width, truth.height);
  }
  out.box = encode::regionOfInterest(out.view, frame.surface.positions);
  if (out.box.width < measure::kSsimWindow || out.box.height < measure::kSsimWindow) return std::nullopt;
  out.truth = cropped(truth, out.box);
  const measure::Mask sees = sight.of(out.view, camera);
  size_t count = 0;
  out.blended.assign(size_t(out.box.width) * size_t(out.box.height), 0);
  for (int y = 0; y < out.box.height; ++y)
    for (int x = 0; x < out.box.width; ++x) {
      const bool counts = sees[size_t(out.box.y + y) * size_t(out.view.width) + size_t(out.box.x + x)] &&
                          out.truth.at(x, y)[3] >= kInMatte;
      out.blended[size_t(y) * size_t(out.box.width) + size_t(x)] = counts;
      count += counts;
    }
  if (count < kMinPixels) return std::nullopt;
  return out;
}

// Sums scores from other threads in the order of the views.
class Lane {
 public:
  Lane(MethodScore& score, double* shift_px) : score_(score), shift_px_(shift_px) {}
  // left_out: rendered without the view's own camera.
  void push(const TrialView& view, Image drawn, bool left_out) {
    if (running_.size() >= kWaiting) collect();
    running_.push_back(
        {left_out, std::async(std::launch::async, [&view, drawn = std::move(drawn)] { return scored(view, drawn); })});
  }
  void finish() {
    while (!running_.empty()) collect();
  }

 private:
  void collect() {
    const bool left_out = running_.front().left_out;
    const ViewScore s = running_.front().score.get();
    running_.pop_front();
    if (!left_out) {
      score_.own_psnr_db += s.registered.psnr_db;
      return;
    }
    score_.psnr_db += s.registered.psnr_db, score_.ssim += s.registered.ssim;
    score_.psnr_fg_db += s.picture.psnr_fg_db, score_.ssim_fg += s.picture.ssim_fg;
    if (shift_px_) *shift_px_ += glm::length(s.registered.shift_px);
  }
  MethodScore& score_;
  double* shift_px_;
  struct Running {
    bool left_out;
    std::future<ViewScore> score;
  };
  std::deque<Running> running_;
};

// Angle to the nearest other camera, seen from the centre of the surface's box.
double gapOf(const TrialFrame& frame, size_t camera) {
  const glm::dvec3 middle = boundsOf(frame.surface.positions).middle();
  const auto direction = [&](size_t c) { return glm::normalize(frame.cameras[c].centreInWorld() - middle); };
  double largest_cosine = -1;
  for (size_t c = 0; c < frame.cameras.size(); ++c)
    if (c != camera) largest_cosine = std::max(largest_cosine, glm::dot(direction(c), direction(camera)));
  return glm::degrees(std::acos(std::clamp(largest_cosine, -1.0, 1.0)));
}

}  // namespace

std::vector<size_t> trialCameras(const TrialFrame& frame) {
  std::vector<size_t> useful;
  std::vector<PinholeCamera> cameras;
  for (size_t c = 0; c < frame.cameras.size(); ++c) {
    if (encode::regionOfInterest(frame.cameras[c], frame.surface.positions).width == 0 || !hasMatte(frame.pictures[c]))
      continue;
    useful.push_back(c);
    cameras.push_back(frame.cameras[c]);
  }
  std::vector<size_t> out;
  if (useful.size() < 3) return out;
  for (const size_t c : chooseCameras(cameras, frame.surface.positions, kMaxTrialCameras)) out.push_back(useful[c]);
  return out;
}

Result<TrialSums> tryMethods(gpu::Device& device, FrameDrawing& drawing, const TrialFrame& frame,
                             std::span<const size_t> left_out, const std::vector<std::string>& methods,
                             const render::MethodOptions& options) {
  TrialSums out;
  for (const std::string& method : methods) out.scores.emplace_back().method = method;
  std::vector<TrialView> views;
  {
    const SharedSight sight(frame.cameras, frame.surface, frame.length_scale);
    for (const size_t camera : left_out)
      if (auto view = makeView(frame, sight, camera)) views.push_back(std::move(*view));
  }
  out.views = views.size();
  for (const TrialView& view : views) out.gap_deg += gapOf(frame, view.camera);
  for (size_t m = 0; m < methods.size() && !views.empty(); ++m) {
    FOURDVT_ASSIGN(auto method, render::makeCameraMethod(device, methods[m]));
    drawing.setMethod(std::move(method));
    Lane lane(out.scores[m], m == 0 ? &out.shift_px : nullptr);
    for (const TrialView& view : views) {
      for (const size_t left_out : {1, 0}) {
        drawing.leaveOut({&view.camera, left_out});
        FOURDVT_ASSIGN(auto picture, drawing.render(view.view, options));
        lane.push(view, std::move(picture), left_out == 1);
      }
    }
    lane.finish();
  }
  drawing.leaveOut({});
  return out;
}

void add(const TrialSums& more, TrialSums& sums) {
  if (sums.scores.empty()) {
    sums = more;
    return;
  }
  sums.views += more.views;
  sums.shift_px += more.shift_px;
  sums.gap_deg += more.gap_deg;
  for (size_t m = 0; m < sums.scores.size(); ++m) {
    const auto values = measuredOf(more.scores[m]);
    const auto to = measuredOf(sums.scores[m]);
    for (size_t v = 0; v < to.size(); ++v) *to[v] += *values[v];
  }
}

LeftOut meanViews(const TrialSums& sums) {
  return {sums.shift_px / double(sums.views), sums.gap_deg / double(sums.views)};
}

std::vector<MethodScore> meanScores(const TrialSums& sums, size_t faces) {
  std::vector<MethodScore> out = sums.scores;
  for (MethodScore& s : out) {
    for (double* value : measuredOf(s)) *value /= double(sums.views);
    s.cost = methodCost(s.method, faces);
  }
  return out;
}

}  // namespace fourdvt::bake
