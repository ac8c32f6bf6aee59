// SPDX-License-Identifier: Apache-2.0
#include "lab/measure/drift_report.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "platform/files.h"

namespace fourdvt::measure {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();

struct Pair {
  const capture::CaptureSequence *tracked, *reference;
};

Error lacks(const capture::Capture& capture, const std::string& what) {
  return Error{ErrorId::InvalidArgument, capture.folder + ": has no " + what};
}

Result<Pair> pairOf(const capture::Capture& tracked, const capture::Capture& reference, const std::string& name) {
  const Pair pair{tracked.find(name), reference.find(name)};
  if (!pair.tracked) return lacks(tracked, "sequence \"" + name + "\"");
  if (!pair.reference || pair.reference->frame_count != pair.tracked->frame_count)
    return lacks(reference, "sequence \"" + name + "\" of as many frames as the tracked capture");
  return pair;
}

Result<SurfaceBinding> bind(const capture::Capture& tracked, const capture::Capture& reference,
                            const FrameOfSequence& at, const BindingLimits& limits) {
  FOURDVT_ASSIGN(const Pair pair, pairOf(tracked, reference, at.sequence));
  if (at.frame >= pair.tracked->frame_count)
    return lacks(tracked, "frame " + std::to_string(at.frame) + " of \"" + at.sequence + "\" to bind at");
  FOURDVT_ASSIGN(const auto mesh, capture::readSurfaceFrame(tracked, *pair.tracked, at.frame));
  FOURDVT_ASSIGN(const auto truth, capture::readSurfaceFrame(reference, *pair.reference, at.frame));
  SurfaceBinding out(mesh, truth, limits);
  if (out.vertices().empty())
    return Error{ErrorId::InvalidArgument,
                 tracked.folder + printed(": no vertex lies within %g mm of the reference; check that both captures "
                                          "have one world and one unit",
                                          1e3 * limits.within_m)};
  return out;
}

FrameDrift frameFigures(const std::vector<glm::dvec3>& errors) {
  DriftSamples samples;
  samples.add(errors);
  const DriftFigures figures = samples.figures();
  return {figures.mean_m, figures.p95_m, figures.max_m, kUndefined};
}

// Measures one sequence after another.
class Measurement {
 public:
  Measurement(const capture::Capture& tracked, const capture::Capture& reference, const SurfaceBinding& binding)
      : tracked_(tracked), reference_(reference), binding_(binding) {}

  Status add(const Pair& pair, const std::function<void(const std::string&, uint32_t)>& on_frame) {
    SequenceDrift out{pair.tracked->name, {}, {}, pair.tracked->loop};
    DriftSamples samples;
    std::vector<glm::dvec3> first, before;
    const auto addChange = [&](const std::vector<glm::dvec3>& next) {
      out.frames.back().change_m = errorChange_m(before, next);
      samples.addChange(out.frames.back().change_m);
    };
    for (uint32_t frame = 0; frame < pair.tracked->frame_count; ++frame) {
      FOURDVT_ASSIGN(const auto positions, capture::readMeshFrame(tracked_, *pair.tracked, frame));
      FOURDVT_ASSIGN(const auto truth, capture::readMeshFrame(reference_, *pair.reference, frame));
      auto errors = binding_.errors(positions, truth);
      if (frame > 0) addChange(errors);
      samples.add(errors);
      out.frames.push_back(frameFigures(errors));
      noteLargest({out.sequence, frame}, errors, positions);
      if (frame == 0) first = errors;
      before = std::move(errors);
      if (on_frame) on_frame(out.sequence, frame);
    }
    if (out.loop && out.frames.size() > 1) addChange(first);
    out.figures = samples.figures();
    sequences_.push_back(std::move(out));
    all_.add(samples);
    return {};
  }

  void finish(DriftReport& report) {
    report.sequences = std::move(sequences_);
    report.all = {"all", all_.figures(), {}, false};
    report.largest = std::move(largest_);
  }

 private:
  void noteLargest(const FrameOfSequence& at, const std::vector<glm::dvec3>& errors, const Positions& positions) {
    for (size_t i = 0; i < errors.size(); ++i) {
      const double error = glm::length(errors[i]);
      const uint32_t vertex = binding_.vertices()[i];
      if (largest_.sequence.empty() || error > largest_.error_m)
        largest_ = {at.sequence, at.frame, vertex, positions[vertex], error};
    }
  }

  const capture::Capture &tracked_, &reference_;
  const SurfaceBinding& binding_;
  std::vector<SequenceDrift> sequences_;
  DriftSamples all_;
  LargestError largest_;
};

Json figuresJson(const DriftFigures& f) {
  return {{"mean_mm", 1e3 * f.mean_m},
          {"median_mm", 1e3 * f.median_m},
          {"p95_mm", 1e3 * f.p95_m},
          {"p99_mm", 1e3 * f.p99_m},
          {"max_mm", 1e3 * f.max_m},
          {"tangential_mean_mm", 1e3 * f.tangential_mean_m},
          {"normal_mean_mm", 1e3 * f.normal_mean_m},
          {"change_mean_mm", 1e3 * f.change_mean_m},
          {"change_p95_mm", 1e3 * f.change_p95_m}};
}

// Change from the last frame to the first, NaN without a loop.
double closure_m(const SequenceDrift& drift) {
  return drift.loop && !drift.frames.empty() ? drift.frames.back().change_m : kUndefined;
}

}  // namespace

Result<std::optional<FrameOfSequence>> readTemplateFrame(const std::string& folder) {
  const std::string path = folder + "/track.json";
  if (!std::filesystem::exists(path)) return std::optional<FrameOfSequence>();
  FOURDVT_ASSIGN(const auto text, platform::readText(path));
  const auto root = Json::parse(text, nullptr, false);
  if (!root.is_object()) return Error{ErrorId::FileUnreadable, path + ": is not a JSON object; track again"};
  if (!root.contains("template")) return std::optional<FrameOfSequence>();
  const Json& at = root["template"];
  if (!at.is_object() || !at.contains("sequence") || !at["sequence"].is_string() || !at.contains("frame") ||
      !at["frame"].is_number_unsigned())
    return Error{ErrorId::FileUnreadable,
                 path + ": \"template\" is not like {\"sequence\": \"walk\", \"frame\": 0}; track again"};
  return std::optional(FrameOfSequence{at["sequence"], at["frame"]});
}

Result<DriftReport> measureDrift(const capture::Capture& tracked, const capture::Capture& reference,
                                 const DriftOptions& options,
                                 const std::function<void(const std::string& sequence, uint32_t frame)>& on_frame) {
  std::vector<std::string> names = options.sequences;
  if (names.empty())
    for (const capture::CaptureSequence& sequence : tracked.sequences) names.push_back(sequence.name);
  std::optional<FrameOfSequence> at = options.bind_at;
  if (!at) {
    FOURDVT_ASSIGN(at, readTemplateFrame(tracked.folder));
  }
  DriftReport report;
  report.bound_at = at.value_or(FrameOfSequence{tracked.sequences.front().name, 0});
  report.limits = options.limits;
  FOURDVT_ASSIGN(const SurfaceBinding binding, bind(tracked, reference, report.bound_at, options.limits));
  report.bound = binding.vertices().size();
  report.far = binding.far();
  report.facing_away = binding.facingAway();
  Measurement measurement(tracked, reference, binding);
  for (const std::string& name : names) {
    FOURDVT_ASSIGN(const Pair pair, pairOf(tracked, reference, name));
    FOURDVT_TRY(measurement.add(pair, on_frame));
  }
  measurement.finish(report);
  return report;
}

std::string driftTable(const DriftReport& report) {
  std::string out = printed(
      "%zu of %zu vertices are bound to the reference at frame %u of %s; %zu are farther than %g mm, %zu face away\n",
      report.bound, report.bound + report.far + report.facing_away, report.bound_at.frame,
      report.bound_at.sequence.c_str(), report.far, 1e3 * report.limits.within_m, report.facing_away);
  out +=
      "sequence     frames  error mm: mean median   95 %   99 %     max  tangential  normal  change mm a frame: mean"
      "   95 %  last to first\n";
  const auto add = [&](const SequenceDrift& drift, size_t frames) {
    const DriftFigures& f = drift.figures;
    out += printed("%-12s %6zu %15.2f %6.2f %6.2f %6.2f %7.2f %11.2f %7.2f %24.3f %6.3f", drift.sequence.c_str(),
                   frames, 1e3 * f.mean_m, 1e3 * f.median_m, 1e3 * f.p95_m, 1e3 * f.p99_m, 1e3 * f.max_m,
                   1e3 * f.tangential_mean_m, 1e3 * f.normal_mean_m, 1e3 * f.change_mean_m, 1e3 * f.change_p95_m);
    const double closure = closure_m(drift);
    out += std::isnan(closure) ? std::string("\n") : printed(" %14.3f\n", 1e3 * closure);
  };
  size_t frames = 0;
  for (const SequenceDrift& drift : report.sequences) {
    add(drift, drift.frames.size());
    frames += drift.frames.size();
  }
  if (report.sequences.size() > 1) add(report.all, frames);
  const LargestError& l = report.largest;
  out += printed("largest error: %.2f mm at frame %u of %s, vertex %u at (%.3f, %.3f, %.3f) m\n", 1e3 * l.error_m,
                 l.frame, l.sequence.c_str(), l.vertex, l.position_m.x, l.position_m.y, l.position_m.z);
  return out;
}

std::string driftJson(const DriftReport& report) {
  Json root;
  root["binding"] = {{"sequence", report.bound_at.sequence},
                     {"frame", report.bound_at.frame},
                     {"within_mm", 1e3 * report.limits.within_m},
                     {"vertices", report.bound},
                     {"far", report.far},
                     {"facing_away", report.facing_away}};
  root["all"] = figuresJson(report.all.figures);
  const LargestError& l = report.largest;
  root["largest"] = {{"sequence", l.sequence},
                     {"frame", l.frame},
                     {"vertex", l.vertex},
                     {"position_m", {l.position_m.x, l.position_m.y, l.position_m.z}},
                     {"error_mm", 1e3 * l.error_m}};
  root["sequences"] = Json::array();
  for (const SequenceDrift& drift : report.sequences) {
    Json row{{"name", drift.sequence}};
    row.update(figuresJson(drift.figures));
    if (drift.loop) row["last_to_first_mm"] = 1e3 * closure_m(drift);
    row["frames"] = Json::array();
    for (const FrameDrift& f : drift.frames)  // NaN is written as null
      row["frames"].push_back({{"mean_mm", 1e3 * f.mean_m},
                               {"p95_mm", 1e3 * f.p95_m},
                               {"max_mm", 1e3 * f.max_m},
                               {"change_mm", 1e3 * f.change_m}});
    root["sequences"].push_back(std::move(row));
  }
  return root.dump(1) + "\n";
}

}  // namespace fourdvt::measure
