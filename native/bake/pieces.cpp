// SPDX-License-Identifier: Apache-2.0
#include "bake/pieces.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "bake/run/job.h"
#include "bake/run/renditions.h"
#include "bake/stages/stages.h"
#include "bake/stages/survey.h"
#include "capture/input_files.h"

namespace fourdvt::bake {
namespace {

constexpr size_t kEvenWindows = 8;  // windows of labels in one piece: about a minute of work, at seconds per window

// [PieceKind]
constexpr const char* kPieceKinds[] = {"survey", "colours", "labels", "label",  "gop",        "align",
                                       "chunks", "graph",   "room",   "method", jobs::kFinish};

// Cost estimates, from pieces that were measured on the sample and on 31 cameras of 4K (site/measured/cluster.md);
// the seconds are for schedulers only.
class Costs {
 public:
  explicit Costs(const Job& job) : job_(job) {
    for (const PinholeCamera& camera : job.cameras) megapixels_ += double(camera.width) * camera.height / 1e6;
    megafaces_ = job.mesh.decoded.topology.faceCount() / 1e6;
  }
  double starting_s() const { return 1 + 0.05 * double(job_.cameras.size()); }
  double survey_s() const { return 0.02 + 0.03 * megapixels_ + 0.5 * megafaces_ * double(job_.cameras.size()); }
  double label_s() const { return 0.5 * megafaces_ * double(job_.cameras.size()) + 8 * megafaces_; }
  double gop_s(const StreamPlan& plan) const {
    double texels = 0;
    for (const RenditionPlan& r : plan.renditions) texels += double(r.encode.width) * r.encode.height / 1e6;
    return 0.03 * megapixels_ + 0.15 * texels;
  }
  double align_s() const { return infoOf(Stage::Align).work_s; }

  // Megabytes: the pictures of two frames and their parts on the GPU, decoders' reference pictures, and the rest of
  // the process.
  double frames_mb() const { return kProcess_mb + 16 * megapixels_ + 25 * double(job_.cameras.size()) + decoders_mb(); }
  double gop_mb(const StreamPlan& plan) const {
    const encode::EncodeSettings& highest = plan.encode();
    return frames_mb() + 200 * double(highest.width) * highest.height / 1e6;
  }
  double labels_mb(size_t frames) const {
    return kProcess_mb + double(frames) * megafaces_ * (double(job_.cameras.size()) * 8 + 100);
  }
  double motion_mb(const StreamPlan& plan) const {
    const double vertices = double(job_.mesh.decoded.topology.vertex_count),
                 members = double(plan.motion.members.size());
    return gop_mb(plan) + 40 * vertices * members * plan.frameCount() / 1e6;
  }
  double room_mb() const { return frames_mb() + 400; }
  double graph_mb() const {
    double mb = room_mb();
    for (const StreamPlan& plan : job_.streams) mb = std::max(mb, motion_mb(plan));
    return mb;
  }
  double finish_mb() const {
    double mb = room_mb();
    for (const StreamPlan& plan : job_.streams) mb = std::max(mb, plan.isClass() ? motion_mb(plan) : gop_mb(plan));
    return mb + 0.05 * job_.streamFrames();
  }

 private:
  static constexpr double kProcess_mb = 350;
  double decoders_mb() const { return 12 * megapixels_; }
  const Job& job_;
  double megapixels_ = 0, megafaces_ = 0;  // all cameras together; the mesh
};

size_t numberOf(const Job& job, const capture::CaptureSequence* sequence) {
  return size_t(sequence - job.capture.sequences.data());
}

class Cutter {
 public:
  explicit Cutter(const Job& job) : job_(job), costs_(job) {}

  std::vector<BakePiece> cut() {
    if (job_.fromCameras())
      cutCameras();
    else
      cutLayers();
    if (job_.capture.room) addWhole(PieceKind::Room, colours(), 8, costs_.room_mb());
    std::vector<std::string> everything;
    for (const BakePiece& piece : out_) everything.push_back(piece.piece.id);
    BakePiece& finish =
        addWhole(PieceKind::Finish, std::move(everything), 5 + 0.02 * job_.streamFrames(), costs_.finish_mb());
    if (job_.fromCameras()) readsFrames(finish, {{0, 0}});  // the poster
    for (const capture::CaptureSequence& s : job_.capture.sequences) readsMeshes(finish, s);
    finish.piece.addInput(job_.sound_digest);
    return std::move(out_);
  }

 private:
  using Frames = std::vector<std::pair<size_t, uint32_t>>;  // sequence, frame

  void cutLayers() {
    for (const capture::CaptureSequence& sequence : job_.capture.sequences) cutSurvey(sequence);
    addColours();
    for (const capture::CaptureSequence& sequence : job_.capture.sequences) cutLabels(sequence);
    for (size_t s = 0; s < job_.streams.size(); ++s) cutGops(s);
    for (size_t s = 0; s < job_.streams.size(); ++s)
      if (job_.streams[s].isClass()) cutClass(s);
    if (job_.streams.size() < 2) return;
    std::vector<std::string> needs;
    for (const BakePiece& piece : out_)
      if (piece.kind == PieceKind::Gop) needs.push_back(piece.piece.id);
    BakePiece& graph = addWhole(PieceKind::Graph, std::move(needs), 0.02 * job_.streamFrames(), costs_.graph_mb());
    for (const capture::CaptureSequence& s : job_.capture.sequences) readsMeshes(graph, s);
  }

  void cutCameras() {
    addColours();
    for (uint32_t i = 0; i < triedFrames(job_); ++i) {
      BakePiece& piece = add(PieceKind::Method, std::to_string(i), colours());
      piece.index = i;
      readsFrames(piece, {{0, 0}, triedFrame(job_, i)});  // the first frame gives the number of faces
      cost(piece, 60, costs_.room_mb());
    }
    for (size_t s = 0; s < job_.streams.size(); ++s) cutGops(s);
  }

  std::string surveyOf(const capture::CaptureSequence& sequence, uint32_t frame) const {
    return std::string("survey-") + sequence.name + "-" +
           std::to_string(frame / uint32_t(job_.options.survey_window_frames));
  }

  void cutSurvey(const capture::CaptureSequence& sequence) {
    const auto window = uint32_t(job_.options.survey_window_frames);
    for (uint32_t first = 0; first < sequence.frame_count; first += window) {
      BakePiece& piece = add(PieceKind::Survey, sequence.name + "-" + std::to_string(first / window), {});
      piece.number = numberOf(job_, &sequence), piece.index = first;
      Frames frames;
      for (uint32_t f = first; f < std::min(first + window, sequence.frame_count); ++f)
        frames.push_back({piece.number, f});
      readsFrames(piece, frames);
      cost(piece, costs_.survey_s() * double(frames.size()), costs_.frames_mb());
    }
  }

  // Even windows first, then the odd ones between them, each of which depends on both neighbours.
  void cutLabels(const capture::CaptureSequence& sequence) {
    const auto windows = planLabelWindows(job_, sequence);
    std::vector<std::string> all;
    if (windows.size() > 1 && windows[1].odd)
      for (const bool odd : {false, true}) cutLabelWindows(sequence, windows, odd, all);
    BakePiece& label = add(PieceKind::Label, sequence.name, std::move(all));
    label.number = numberOf(job_, &sequence);
    readsMeshes(label, sequence);
    const bool alone = label.piece.needs.empty();
    for (uint32_t f = 0; alone && f < sequence.frame_count; ++f) addOnce(label.piece.needs, surveyOf(sequence, f));
    cost(label, costs_.label_s() * sequence.frame_count * (alone ? 1 : 0.1), costs_.labels_mb(64));
  }

  void cutLabelWindows(const capture::CaptureSequence& sequence, const std::vector<LabelWindow>& windows, bool odd,
                       std::vector<std::string>& all) {
    const auto idOf = [&](bool of_odd, size_t group) {
      return sequence.name + (of_odd ? "-odd-" : "-even-") + std::to_string(group);
    };
    for (size_t first = odd ? 1 : 0, group = 0; first < windows.size(); first += 2 * kEvenWindows, ++group) {
      std::vector<size_t> chosen;
      for (size_t w = first; w < std::min(first + 2 * kEvenWindows, windows.size()); w += 2)
        if (windows[w].odd == odd) chosen.push_back(w);
      if (chosen.empty()) continue;
      BakePiece& piece = add(PieceKind::Labels, idOf(odd, group), {});
      piece.number = numberOf(job_, &sequence);
      const size_t before = odd ? 1 : 0;
      const uint32_t low = windows[chosen.front() - before].frozen_first,
                     high = windows[chosen.back() + before].frozen_end;
      Frames frames;
      for (uint32_t f = low; f < high; ++f) frames.push_back({piece.number, f});
      for (uint32_t f = low - std::min(low, kHysteresisFrames);
           f < std::min(high + kHysteresisFrames, sequence.frame_count); ++f)
        addOnce(piece.piece.needs, surveyOf(sequence, f));
      if (odd)
        for (const size_t even : {(chosen.front() - 1) / (2 * kEvenWindows), (chosen.back() + 1) / (2 * kEvenWindows)})
          addOnce(piece.piece.needs, "labels-" + idOf(false, even));
      readsFrames(piece, frames);
      cost(piece, costs_.label_s() * double(frames.size()), costs_.labels_mb(64));
      piece.windows = std::move(chosen);
      all.push_back(piece.piece.id);
    }
  }

  // A class shows frames that its members' own streams have rendered.
  void cutGops(size_t stream) {
    const StreamPlan& plan = job_.streams[stream];
    for (uint32_t g = 0; g < plan.gop_first_frames.size(); ++g) {
      BakePiece& piece = add(PieceKind::Gop, plan.name + "-" + std::to_string(g), colours());
      piece.number = stream, piece.index = g;
      Frames frames;
      for (size_t m = 0; m < plan.motion.members.size(); ++m) {
        const size_t source = numberOf(job_, plan.motion.members[m].source);
        for (uint32_t f = plan.gop_first_frames[g]; f < plan.gopEnd(g); ++f) {
          const uint32_t frame = job_.fromCameras() ? f : plan.sourceFrame(m, f);
          frames.push_back({source, frame});
          if (plan.isClass()) addOnce(piece.piece.needs, gopOf(source, frame));
        }
        if (!job_.fromCameras()) addOnce(piece.piece.needs, "label-" + plan.motion.members[m].source->name);
      }
      readsFrames(piece, frames);
      cost(piece, costs_.gop_s(plan) * double(plan.gopEnd(g) - plan.gop_first_frames[g]), costs_.gop_mb(plan));
    }
  }

  // Piece of the sequence's own stream that renders a frame: streams begin with the sequences.
  std::string gopOf(size_t sequence, uint32_t frame) const {
    const StreamPlan& plan = job_.streams[sequence];
    const auto after = std::upper_bound(plan.gop_first_frames.begin(), plan.gop_first_frames.end(), frame);
    return "gop-" + plan.name + "-" + std::to_string(after - plan.gop_first_frames.begin() - 1);
  }

  void cutClass(size_t stream) {
    const StreamPlan& plan = job_.streams[stream];
    std::vector<std::string> needs;
    for (uint32_t g = 0; g < plan.gop_first_frames.size(); ++g) {
      std::string gop = "gop-" + plan.name + "-" + std::to_string(g);
      if (!job_.options.classes.align) {
        needs.push_back(std::move(gop));
        continue;
      }
      BakePiece& piece = add(PieceKind::Align, plan.name + "-" + std::to_string(g), {std::move(gop)});
      piece.number = stream, piece.index = g;
      cost(piece,
           costs_.align_s() * (plan.gopEnd(g) - plan.gop_first_frames[g]) * double(plan.motion.members.size() - 1),
           costs_.gop_mb(plan));
      needs.push_back(piece.piece.id);
    }
    BakePiece& chunks = add(PieceKind::Chunks, plan.name, std::move(needs));
    chunks.number = stream;
    cost(chunks, 0.05 * plan.frameCount(), costs_.motion_mb(plan));
  }

  std::vector<std::string> colours() const {
    for (const BakePiece& piece : out_)
      if (piece.kind == PieceKind::Colours) return {piece.piece.id};
    return {};
  }

  void addColours() {
    if (!job_.options.colour_calibration || job_.cameras.size() < 2) return;
    BakePiece& piece = add(PieceKind::Colours, "", {});
    Frames frames;
    for (const capture::CaptureSequence& s : job_.capture.sequences)
      for (uint32_t f = 0; f < std::min(kColourFrames, s.frame_count); ++f) {
        if (!job_.fromCameras()) addOnce(piece.piece.needs, surveyOf(s, f));
        frames.push_back({numberOf(job_, &s), f});
      }
    readsFrames(piece, frames);
    cost(piece, costs_.survey_s() * double(frames.size()) / kColourEvery, costs_.frames_mb());
  }

  BakePiece& add(PieceKind kind, const std::string& name, std::vector<std::string> needs) {
    BakePiece& piece = out_.emplace_back();
    piece.kind = kind;
    piece.piece.kind = kPieceKinds[size_t(kind)];
    piece.piece.id = piece.piece.kind + (name.empty() ? "" : "-" + name);
    piece.piece.needs = std::move(needs);
    piece.piece.inputs = job_.common_input_digest;
    return piece;
  }
  BakePiece& addWhole(PieceKind kind, std::vector<std::string> needs, double seconds, double memory_mb) {
    BakePiece& piece = add(kind, "", std::move(needs));
    cost(piece, seconds, memory_mb);
    return piece;
  }
  static void addOnce(std::vector<std::string>& list, std::string id) {
    if (std::find(list.begin(), list.end(), id) == list.end()) list.push_back(std::move(id));
  }
  void cost(BakePiece& piece, double seconds, double memory_mb) const {
    piece.piece.setCost(costs_.starting_s() + seconds, memory_mb);
  }
  void readsFrames(BakePiece& piece, const Frames& frames) const {
    std::set<std::pair<size_t, uint32_t>> windows;
    for (const auto& [sequence, frame] : frames) windows.insert({sequence, frame / kInputWindow});
    piece.reads.assign(windows.begin(), windows.end());
    for (const auto& [sequence, window] : windows)
      piece.piece.addInput(job_.input_digests.at(job_.capture.sequences[sequence].name)[window]);
  }
  void readsMeshes(BakePiece& piece, const capture::CaptureSequence& sequence) const {
    piece.reads_meshes.push_back(numberOf(job_, &sequence));
    piece.piece.addInput(job_.mesh_digests.at(sequence.name));
  }

  const Job& job_;
  const Costs costs_;
  std::vector<BakePiece> out_;
};

template <class T>
Status statusOf(const Result<T>& result) {
  return result.ok() ? Status() : Status(result.error());
}

Status runLayers(BakeRun& run, const BakePiece& piece) {
  Job& job = run.job;
  if (piece.kind == PieceKind::Align) return alignGop(run, job.streams[piece.number], piece.index);
  if (piece.kind == PieceKind::Chunks) return alignClass(run, job.streams[piece.number]);
  if (piece.kind == PieceKind::Graph) return statusOf(makeGraph(run));
  FOURDVT_ASSIGN(Survey survey, Survey::open(run));
  if (piece.kind == PieceKind::Gop || piece.kind == PieceKind::Room) FOURDVT_TRY(survey.matchColours(run));
  switch (piece.kind) {
    case PieceKind::Survey:
      return survey.measureFrom(run, job.capture.sequences[piece.number], piece.index);
    case PieceKind::Colours:
      return survey.matchColours(run);
    case PieceKind::Labels:
      return survey.labelWindows(run, job.capture.sequences[piece.number], piece.windows);
    case PieceKind::Label:
      return survey.labelSequence(run, job.capture.sequences[piece.number]);
    case PieceKind::Gop:
      return bakeGop(run, survey, job.streams[piece.number], piece.index);
    case PieceKind::Room:
      return statusOf(makeRoom(run, survey.colourMaps()));
    default:
      return Error{ErrorId::Internal, "piece " + piece.piece.id + " is none of a character from layers"};
  }
}

Status runCameras(BakeRun& run, const BakePiece& piece) {
  FOURDVT_ASSIGN(const auto maps, calibrateColours(run));
  switch (piece.kind) {
    case PieceKind::Colours:
      return {};
    case PieceKind::Method:
      return tryMethodsOn(run, maps, piece.index);
    case PieceKind::Gop:
      return bakeGop(run, maps, run.job.streams[piece.number], piece.index);
    case PieceKind::Room:
      return statusOf(makeRoom(run, maps));
    default:
      return Error{ErrorId::Internal, "piece " + piece.piece.id + " is none of a character from cameras"};
  }
}

}  // namespace

std::vector<BakePiece> bakePieces(const Job& job) { return Cutter(job).cut(); }

Result<std::vector<bool>> lostPieces(BakeRun& run, const std::vector<BakePiece>& pieces) {
  const Job& job = run.job;
  std::vector<bool> lost(pieces.size(), false);
  std::optional<Survey> survey;
  if (!job.fromCameras()) {
    FOURDVT_ASSIGN(survey, Survey::open(run));
  }
  for (size_t p = 0; p < pieces.size(); ++p) {
    const BakePiece& piece = pieces[p];
    switch (piece.kind) {
      case PieceKind::Survey:
        lost[p] = !survey->isMeasuredFrom(job.capture.sequences[piece.number], piece.index);
        break;
      case PieceKind::Label:
        lost[p] = !survey->isLabelled(job.capture.sequences[piece.number]);
        break;
      case PieceKind::Gop: {
        const StreamPlan& plan = job.streams[piece.number];
        lost[p] = !run.work.has(gopFile(plan.name, piece.index)) ||
                  (!plan.isClass() && !run.work.has(chunkFile(plan.name, piece.index)));
        break;
      }
      case PieceKind::Graph:
      case PieceKind::Room:
        lost[p] = !run.work.has(piece.piece.kind + ".result");
        break;
      default:  // the remaining kinds compute missing inputs on demand
        break;
    }
  }
  return lost;
}

Status checkPieceInputs(const BakeRun& run, const BakePiece& piece) {
  const Job& job = run.job;
  if (capture::commonInputDigest(job.capture) != job.common_input_digest)
    return jobs::changedSincePlan(job.capture.folder + ": capture.json, cameras or plates");
  for (const auto& [number, window] : piece.reads) {
    const capture::CaptureSequence& sequence = job.capture.sequences[number];
    const uint32_t first = window * kInputWindow, end = std::min(first + kInputWindow, sequence.frame_count);
    if (capture::inputDigest(job.capture, sequence, first, end) != job.input_digests.at(sequence.name)[window])
      return jobs::changedSincePlan(sequence.folder + ": files of frames " + std::to_string(first) + " to " +
                                    std::to_string(end - 1));
  }
  for (const size_t number : piece.reads_meshes) {
    const capture::CaptureSequence& sequence = job.capture.sequences[number];
    if (capture::meshDigest(sequence) != job.mesh_digests.at(sequence.name))
      return jobs::changedSincePlan(sequence.folder + ": its meshes");
  }
  if (piece.kind == PieceKind::Finish && capture::soundDigest(job.capture) != job.sound_digest)
    return jobs::changedSincePlan(job.capture.folder + ": its sounds");
  return {};
}

Status runPiece(BakeRun& run, const BakePiece& piece) {
  FOURDVT_TRY(checkPieceInputs(run, piece));
  return run.job.fromCameras() ? runCameras(run, piece) : runLayers(run, piece);
}

}  // namespace fourdvt::bake
