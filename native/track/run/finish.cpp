// SPDX-License-Identifier: Apache-2.0
#include "track/run/finish.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "capture/folder/linked_capture.h"
#include "capture/mesh_file.h"
#include "platform/files.h"
#include "track/run/report.h"
#include "track/time.h"

namespace fourdvt::track {
namespace {

constexpr double kMaxUnits = 32000;                                                // largest packed coordinate
constexpr double kMinOverlap = 0.85, kMaxStretched = 0.05, kMaxDistance_m = 0.04;  // gates of a fit
constexpr double kMaxFailed = 0.34;                                                // share of a sequence's frames

constexpr double kMaxMisfitShare = 0.3;  // Cycle::error_share of a loop
constexpr double kMaxStay_m = 0.05;      // way of one pass that counts as staying in place
constexpr double kMinAlike = 0.9;        // cosine between the directions in which a class's members travel
constexpr double kSlow_mps = 0.1;        // speed below which a direction means nothing
constexpr double kBlend_s = 0.2;         // fade at a loop's end

// Finds a cycle of a sequence and closes it. Errors: InvalidArgument.
Result<CycleOfSequence> cycleOf(const Prepared& job, const capture::CaptureSequence& sequence,
                                std::span<const Positions> frames) {
  const std::string where = job.options.capture_folder + "/" + sequence.name + ": ",
                    keep = ", or leave out --loop " + sequence.name + " (--resume keeps all fits)";
  const double fps = job.capture.fps;
  const auto cycle = findCycle(frames, uint32_t(std::ceil(kMinCycle_s * fps)), uint32_t(kMaxCycle_s * fps));
  if (!cycle)
    return Error{ErrorId::InvalidArgument,
                 where +
                     printed("no cycle of %.1f to %.0f s is found in %zu frames; film two whole strides or more",
                             kMinCycle_s, kMaxCycle_s, frames.size()) +
                     keep};
  if (cycle->error_share > kMaxMisfitShare)
    return Error{ErrorId::InvalidArgument,
                 where +
                     printed("no motion repeats: frame %u resembles frame %u most and differs by %.0f mm, %.0f %% "
                             "of what changes in between; film two even strides or more",
                             cycle->last, cycle->first, 1e3 * cycle->error_m, 100 * cycle->error_share) +
                     keep};
  const uint32_t beyond = std::max(cycle->first, uint32_t(frames.size()) - cycle->last);
  CycleOfSequence out{*cycle, closeCycle(frames, *cycle, std::min(beyond, uint32_t(std::lround(kBlend_s * fps)))), {}};
  out.travel = travelOf(out.loop, fps);
  return out;
}

// Frames that the new capture shows.
const std::vector<Positions>& shownFrames(const TrackedSequence& s) {
  return s.cycle ? s.cycle->loop.frames : s.positions;
}

// The capture with its loops' frames alone, and their travel, which positions keep. A velocity of a belt adds to it.
capture::Capture shownCapture(const capture::Capture& given, std::span<const TrackedSequence> sequences) {
  capture::Capture out = given;
  for (size_t s = 0; s < sequences.size(); ++s) {
    if (!sequences[s].cycle) continue;
    const Cycle& cycle = sequences[s].cycle->cycle;
    out.sequences[s].first_frame += cycle.first;
    out.sequences[s].frame_count = cycle.last - cycle.first;
    out.sequences[s].loop = true;
    const Travel& travel = sequences[s].cycle->travel;
    capture::CaptureTravel& written =
        out.sequences[s].travel.emplace(capture::CaptureTravel{sequences[s].cycle->loop.travel, {}});
    if (glm::length(travel.velocity_mps) * out.sequences[s].frame_count / given.fps <= kMaxStay_m) continue;
    written.place_m = {travel.place_m.x, travel.place_m.z};
    out.sequences[s].root_velocity_mps += travel.velocity_mps;
  }
  return out;
}

// One line for every class whose members travel in different directions: blends mix poses in their own headings.
std::vector<std::string> directionWarnings(std::span<const capture::CaptureClass> classes,
                                           std::span<const TrackedSequence> sequences) {
  std::vector<std::string> out;
  for (const capture::CaptureClass& c : classes) {
    const TrackedSequence* first = nullptr;
    for (const TrackedSequence& s : sequences) {
      const auto isMember = [&](const auto& member) { return member.sequence == s.name; };
      if (!s.cycle || std::none_of(c.members.begin(), c.members.end(), isMember)) continue;
      if (!first) first = &s;
      const glm::dvec3 &a = first->cycle->travel.velocity_mps, &b = s.cycle->travel.velocity_mps;
      if (glm::dot(a, b) < kMinAlike * glm::length(a) * glm::length(b) &&
          std::min(glm::length(a), glm::length(b)) > kSlow_mps)
        out.push_back("class " + c.name + ": " + first->name + " and " + s.name +
                      " travel in different directions, so that their blends turn; film both in one direction");
    }
  }
  return out;
}

// Reason why a fit failed; empty: it holds.
std::string failureOf(const TrackedFrame& frame, uint32_t faces) {
  const FitFigures& f = frame.figures;
  if (f.overlap.mean < kMinOverlap) return printed("covers the mattes by %.2f only (1 is perfect)", f.overlap.mean);
  if (f.stretched_faces > kMaxStretched * faces)
    return printed("%u of %u triangles are stretched", f.stretched_faces, faces);
  if (f.distance_95_m > kMaxDistance_m)
    return printed("lies %.0f mm off the surface, most at (%.2f, %.2f, %.2f) m", 1e3 * f.distance_95_m, f.farthest.x,
                   f.farthest.y, f.farthest.z);
  return {};
}

}  // namespace

Result<TrackSummary> writeResult(const Prepared& job, const Work& work, const ChosenTemplate& chosen,
                                 std::span<const TrackingStep> steps, const std::string& part) {
  const FrameList& list = work.frames();
  TrackSummary out;
  out.faces = chosen.mesh.topology.faceCount();
  out.vertices = chosen.mesh.topology.vertex_count;
  const uint32_t s0 = list.sequenceOf(chosen.frame);
  out.template_frame = {job.capture.sequences[s0].name, chosen.frame - list.starts[s0]};

  std::vector<TrackedSequence> sequences;
  float farthest = 0;
  for (uint32_t s = 0; s < job.capture.sequences.size(); ++s) {
    const capture::CaptureSequence& sequence = job.capture.sequences[s];
    TrackedSequence& tracked = sequences.emplace_back();
    tracked.name = sequence.name;
    std::vector<double> trust;
    for (uint32_t f = 0; f < sequence.frame_count; ++f) {
      FOURDVT_ASSIGN(TrackedFrame frame, work.requireTracked(list.starts[s] + f));
      const std::string failure = failureOf(frame, out.faces);
      if (!failure.empty()) tracked.failures[f] = failure;
      trust.push_back(failure.empty() ? 1 : 0);
      out.wall_s += frame.seconds;
      tracked.figures.push_back(std::move(frame.figures));
      tracked.seconds.push_back(frame.seconds);
      tracked.positions.push_back(std::move(frame.fit.positions));
    }
    if (double(tracked.failures.size()) > kMaxFailed * sequence.frame_count)
      return Error{ErrorId::InvalidArgument,
                   job.options.capture_folder + "/" + sequence.name + ": the template fits " +
                       std::to_string(sequence.frame_count - tracked.failures.size()) + " of " +
                       std::to_string(sequence.frame_count) + " frames; in frame " +
                       std::to_string(tracked.failures.begin()->first) + " it " + tracked.failures.begin()->second +
                       ". A coat taken off or a prop put down is another mesh: leave out or split the sequence there, "
                       "or give a --template frame that shows all parts"};
    smoothInTime(tracked.positions, trust, sequence.loop && !sequence.travel, TimeOptions{});
    const auto& loops = job.options.loops;
    if (!sequence.loop && std::find(loops.begin(), loops.end(), sequence.name) != loops.end()) {
      FOURDVT_ASSIGN(tracked.cycle, cycleOf(job, sequence, tracked.positions));
    }
    for (const Positions& positions : shownFrames(tracked))
      for (const glm::vec3& p : positions) farthest = std::max({farthest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  }

  capture::LinkOptions link;
  link.sequences = job.options.sequences;
  link.meshes = capture::LinkedMeshes::Packed;
  link.units_per_metre = std::min(10'000.0, std::floor(kMaxUnits / std::max(farthest, 0.001f)));
  link.classes = job.options.classes;
  link.own_calibration = link.own_times = link.own_motion = true;
  const capture::Capture shown = shownCapture(job.capture, sequences);
  FOURDVT_TRY(capture::linkCapture(shown, part, link));
  FOURDVT_TRY(platform::writeFileAtomic(
      part + "/" + capture::kMeshTopology,
      capture::objText(chosen.mesh.topology, chosen.mesh.positions, 1 / job.capture.metres_per_unit)));
  for (uint32_t s = 0; s < sequences.size(); ++s) {
    const capture::CaptureSequence& sequence = shown.sequences[s];
    std::vector<uint8_t> bytes;
    for (uint32_t i = 0; i < sequence.first_frame; ++i)
      capture::appendPacked(shownFrames(sequences[s])[0], link.units_per_metre, bytes);
    for (const Positions& positions : shownFrames(sequences[s]))
      capture::appendPacked(positions, link.units_per_metre, bytes);
    const std::string folder = part + "/" + sequence.name + "/" + capture::kMeshFolder;
    FOURDVT_TRY(platform::makeFolder(folder));
    FOURDVT_TRY(platform::writeFileAtomic(folder + "/" + capture::kPackedPositions, bytes));
  }
  out.warnings = directionWarnings(job.options.classes, sequences);
  summarise(sequences, out);
  FOURDVT_TRY(writeTrackReport(part, job, work, chosen, steps, sequences, out));
  return out;
}

}  // namespace fourdvt::track
