// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/run/pieces.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <thread>

#include "capture/folder/linked_capture.h"
#include "capture/input_files.h"
#include "mattes/frame_reader.h"
#include "platform/files.h"
#include "platform/process.h"
#include "reconstruct/run/finish.h"
#include "reconstruct/run/prepare.h"
#include "reconstruct/run/sequence_frames.h"

namespace fourdvt::reconstruct {
namespace {

constexpr int kLooks = 5;  // attempts to find an identical result of another process
constexpr std::chrono::milliseconds kBetweenLooks(200);
constexpr const char* kFirst = "first";
constexpr const char* kFrames = "frames";

// Frames of a sequence computed by one piece.
struct Part {
  std::string sequence;
  bool first = false;   // frame 0 alone
  uint32_t window = 0;  // without `first`
};

std::string idOf(const Part& part) {
  return part.first ? std::string(kFirst) + "-" + part.sequence
                    : std::string(kFrames) + "-" + part.sequence + "-" + std::to_string(part.window);
}

uint32_t firstOf(const Part& part) { return part.window * kWindow; }
uint32_t endOf(const Part& part, const capture::CaptureSequence& sequence) {
  return part.first ? 1 : windowEnd(sequence, part.window);
}

jobs::Piece pieceOf(const char* kind, std::string id, const JobFile& file) {
  jobs::Piece out;
  out.kind = kind, out.id = std::move(id), out.inputs = file.common_input_digest;
  return out;
}

jobs::Piece pieceOf(const Part& part, const JobFile& file) {
  const capture::Capture& capture = file.job.capture;
  const capture::CaptureSequence& sequence = *capture.find(part.sequence);
  jobs::Piece out = pieceOf(part.first ? kFirst : kFrames, idOf(part), file);
  out.addInput(capture::inputDigest(capture, sequence, firstOf(part), endOf(part, sequence)));
  return out;
}

// Resource estimates for schedulers, measured on two cores, stereo with a software-rendered GPU. Memory is at least 1.5
// times the measured one. Explicit options with far smaller voxels can exceed it; Snakemake then restarts the piece
// with more.
class Costs {
 public:
  explicit Costs(const Prepared& job) : stereo_(job.options.stereo), megafaces_(job.options.faces / 1e6) {
    for (const capture::CaptureCamera& camera : job.capture.cameras)
      megapixels_ += double(camera.pinhole.width) * camera.pinhole.height / 1e6;
  }
  double frame_s() const { return 0.3 + 0.3 * megapixels_ + (stereo_ ? 3.5 * megapixels_ : 0); }
  double memory_mb() const { return 300 + 40 * megapixels_ + 1500 * megafaces_ + (stereo_ ? 100 * megapixels_ : 0); }
  double megapixels() const { return megapixels_; }

 private:
  bool stereo_;
  double megapixels_ = 0, megafaces_ = 0;  // sum over the cameras; largest surface
};

std::vector<jobs::Piece> piecesOf(const JobFile& file, uint32_t frames) {
  const Costs costs(file.job);
  const auto& sequences = file.job.capture.sequences;
  std::vector<jobs::Piece> out;
  const auto add = [&](jobs::Piece piece, double seconds) -> jobs::Piece& {
    piece.setCost(1 + seconds, costs.memory_mb());
    return out.emplace_back(std::move(piece));
  };
  for (const capture::CaptureSequence& sequence : sequences) {
    const Part first{sequence.name, true, 0};
    add(pieceOf(first, file), costs.frame_s());
    for (uint32_t window = 0; window < windowsOf(sequence); ++window) {
      const Part part{sequence.name, false, window};
      add(pieceOf(part, file), costs.frame_s() * (endOf(part, sequence) - firstOf(part))).needs = {idOf(first)};
    }
  }
  jobs::Piece finish = pieceOf(jobs::kFinish, jobs::kFinish, file);
  for (const jobs::Piece& piece : out) finish.needs.push_back(piece.id);
  add(std::move(finish), 0.3 * costs.megapixels() * double(sequences.size()) + 0.001 * frames);
  return out;
}

std::optional<Part> partOf(const jobs::Piece& piece) {
  if (piece.kind == kFirst) return Part{piece.id.substr(std::string(kFirst).size() + 1), true, 0};
  if (piece.kind != kFrames) return std::nullopt;
  const size_t start = std::string(kFrames).size() + 1, dash = piece.id.rfind('-');
  return Part{piece.id.substr(start, dash - start), false, uint32_t(std::strtoul(&piece.id[dash + 1], nullptr, 10))};
}

// True if frames of a piece are missing, as they are once the new folder is in place.
bool isLost(const FrameStore& store, const Prepared& job, const jobs::Piece& piece) {
  const auto part = partOf(piece);
  const uint32_t end = part ? endOf(*part, *job.capture.find(part->sequence)) : 0;
  for (uint32_t frame = part ? firstOf(*part) : 0; frame < end; ++frame)
    if (!store.find(part->sequence, frame)) return true;
  return false;
}

// Adds the warnings of the calibration, which is computed once and stored with them.
void addEarlierWarnings(const std::string& job_folder, Prepared& job) {
  const auto earlier = readJobFile(job_folder);
  if (!earlier || earlier.value().job.settings_key != job.settings_key) return;
  std::vector<std::string> all = earlier.value().job.warnings;
  for (const std::string& warning : job.warnings)
    if (std::find(all.begin(), all.end(), warning) == all.end()) all.push_back(warning);
  job.warnings = std::move(all);
}

Status checkInputs(const JobFile& file, const Part& part, const jobs::Piece& piece) {
  const Prepared& job = file.job;
  if (capture::commonInputDigest(job.capture) != file.common_input_digest)
    return jobs::changedSincePlan(job.options.capture_folder + ": capture.json, cameras or plates");
  if (pieceOf(part, file).inputs == piece.inputs) return {};
  const uint32_t end = endOf(part, *job.capture.find(part.sequence));
  return jobs::changedSincePlan(job.folderOf(part.sequence) + ": files of frames " + std::to_string(firstOf(part)) +
                                " to " + std::to_string(end - 1));
}

// Opens the capture for one sequence only; planning has validated all pictures.
Result<capture::Capture> openForPiece(const ReconstructOptions& options, const std::string& sequence) {
  auto opened = capture::openDescription(resultFolder(options).partFolder(), {sequence}, capture::MeshNeed::Nothing);
  if (opened.ok()) return opened;
  return jobs::changedSincePlan(options.capture_folder + ": its files (" + opened.error().message + ")");
}

// Path of a copy of the report, written before the result is put into place: a result with an identical report belongs
// to this job.
std::string keptReport(const std::string& job_folder) { return job_folder + "/" + kReportJson; }

// True if the result is already in place, by a process that ended before recording it or by a concurrent one.
bool isPlaced(const std::string& job_folder, const ReconstructOptions& options) {
  std::error_code none;
  if (std::filesystem::exists(resultFolder(options).partFolder(), none)) return false;
  const auto kept = platform::readFile(keptReport(job_folder));
  const auto report = platform::readFile(options.folder + "/" + kReportJson);
  return kept.ok() && report.ok() && kept.value() == report.value();
}

Result<ReconstructSummary> writeAndPlace(const std::string& job_folder, Prepared& job, const OpenVideo& open_video) {
  const capture::ResultFolder folder = resultFolder(job.options);
  FOURDVT_ASSIGN(job.capture, mattes::openLinked(folder.partFolder(), job.options.capture_folder, job.options.sequences,
                                                 open_video));
  job.capture.name = job.name;
  const FrameStore store(folder, job.capture, job.settings_key);
  ReportPictures pictures;
  for (const capture::CaptureSequence& sequence : job.capture.sequences)
    FOURDVT_TRY(drawKept(job, store, sequence, shownFrame(sequence), open_video, pictures));
  FOURDVT_ASSIGN(const auto summary, writeResult(job, store, pictures, std::nullopt));
  FOURDVT_ASSIGN(const auto report, platform::readFile(folder.partFolder() + "/" + kReportJson));
  FOURDVT_TRY(platform::writeFileAtomic(keptReport(job_folder), report));
  FOURDVT_TRY(store.checkFolder());
  FOURDVT_TRY(folder.place());
  return summary;
}

}  // namespace

Result<jobs::Plan> planReconstruct(const ReconstructOptions& options, std::vector<std::string> arguments,
                                   const ReconstructEnvironment& environment) {
  const Threads threads(options.jobs);
  Preparation preparation(options, environment);
  FOURDVT_TRY(preparation.link(Earlier::KeptIfSame));
  FOURDVT_TRY(preparation.addMattes());
  JobFile file{preparation.take(), 0};
  const Prepared& job = file.job;
  FOURDVT_TRY(jobs::checkSequenceNames(job.options.sequences, job.options.capture_folder, "reconstruct"));
  const std::string job_folder = resultFolder(job.options).workFolder();
  addEarlierWarnings(job_folder, file.job);
  file.common_input_digest = capture::commonInputDigest(job.capture);
  uint32_t count = 0;
  for (const capture::CaptureSequence& sequence : job.capture.sequences) count += sequence.frame_count;
  jobs::Plan plan{.command = "reconstruct",
                  .arguments = std::move(arguments),
                  .capture = job.options.capture_folder,
                  .result = job.options.folder,
                  .frames = count,
                  .capture_s = count / job.capture.fps,
                  .pieces = piecesOf(file, count)};
  FOURDVT_TRY(jobs::settleHashes(job.settings_key, plan));
  FOURDVT_TRY(jobs::indexVideos(job_folder, capture::videoFiles(job.capture), environment.stop));
  FOURDVT_TRY(writeJobFile(job_folder, file));
  const FrameStore store(resultFolder(job.options), job.capture, job.settings_key);
  jobs::dropRecords(job_folder, plan, [&](size_t piece) { return isLost(store, job, plan.pieces[piece]); });
  FOURDVT_TRY(jobs::writePlan(job_folder, plan));
  return plan;
}

Result<bool> piecesNeedDevice(const std::string& job_folder) {
  FOURDVT_ASSIGN(const auto file, readJobFile(job_folder));
  return file.job.options.stereo;
}

Status reconstructPiece(const std::string& job_folder, const jobs::Piece& piece, int threads,
                        const ReconstructEnvironment& environment) {
  FOURDVT_ASSIGN(auto file, readJobFile(job_folder));
  const auto part = partOf(piece);
  if (!part) return Error{ErrorId::InvalidArgument, job_folder + ": piece " + piece.id + " makes no frames"};
  Prepared& job = file.job;
  const Threads limit(threads);
  platform::keepFreedMemory();
  FOURDVT_ASSIGN(job.capture, openForPiece(job.options, part->sequence));
  FOURDVT_TRY(checkInputs(file, *part, piece));
  const capture::CaptureSequence& sequence = job.capture.sequences[0];
  const FrameStore store(resultFolder(job.options), job.capture, job.settings_key);
  FOURDVT_TRY(store.makeFolders(sequence.name));
  FOURDVT_ASSIGN(auto maker, SurfaceMaker::create(job.options, job.capture.cameras, environment.device));
  SequenceFrames frames(job, environment, store, maker, sequence);
  uint32_t done = 0;
  const auto made = [&](uint32_t frame, const mattes::CaptureFrame&, const FrameSurface&) {
    if (environment.progress)
      environment.progress(
          {sequence.name + " " + std::to_string(frame + 1) + "/" + std::to_string(sequence.frame_count), ++done,
           endOf(*part, sequence) - firstOf(*part), 0, 0});
  };
  if (part->first) return frames.makeFirst(made);
  const auto kept = frames.makeWindow(part->window, made);
  return kept.ok() ? Status() : Status(kept.error());
}

Result<ReconstructSummary> finishReconstruct(const std::string& job_folder, const ReconstructEnvironment& environment) {
  FOURDVT_ASSIGN(auto file, readJobFile(job_folder));
  const ReconstructOptions options = file.job.options;
  if (isPlaced(job_folder, options)) return readSummary(options.folder);
  auto written = writeAndPlace(job_folder, file.job, environment.open_video);
  for (int look = 0; look < kLooks && !written.ok(); ++look) {
    if (isPlaced(job_folder, options)) return readSummary(options.folder);
    std::this_thread::sleep_for(kBetweenLooks);
  }
  return written;
}

}  // namespace fourdvt::reconstruct
