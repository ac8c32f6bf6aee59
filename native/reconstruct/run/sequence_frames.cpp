// SPDX-License-Identifier: Apache-2.0
#include "reconstruct/run/sequence_frames.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <opencv2/core.hpp>

#include "base/hash.h"
#include "base/text.h"
#include "base/watch.h"
#include "capture/folder/linked_capture.h"
#include "capture/mesh_file.h"
#include "mattes/frame_reader.h"
#include "mattes/support.h"
#include "platform/files.h"
#include "store/folder.h"

namespace fourdvt::reconstruct {
namespace {

constexpr size_t kMinJudged = 3;  // silhouettes; two hardly contradict each other

bool wasJudged(const FrameFigures& figures) {
  return std::count_if(figures.overlap.begin(), figures.overlap.end(), [](double v) { return !std::isnan(v); }) >=
         std::ptrdiff_t(kMinJudged);
}

}  // namespace

Status SequenceFrames::makeFirst(const Made& made) { return store_.find(sequence_.name, 0) ? Status() : make(0, made); }

Result<uint32_t> SequenceFrames::makeWindow(uint32_t window, const Made& made) {
  const uint32_t first = window * kWindow, end = windowEnd(sequence_, window);
  std::vector<bool> there;
  const auto earliest = store_.find(sequence_.name, 0);
  agreed_ = earliest && wasJudged(*earliest);
  for (uint32_t frame = first; frame < end; ++frame) {
    const auto kept = store_.find(sequence_.name, frame);
    there.push_back(kept.has_value());
    agreed_ = agreed_ || (kept && !job_.options.stereo && wasJudged(*kept));
  }
  const auto count = uint32_t(std::count(there.begin(), there.end(), true));
  if (count == end - first) return count;
  for (uint32_t frame = first; frame < end; ++frame)
    if (job_.options.stereo || !there[frame - first]) FOURDVT_TRY(make(frame, made));
  return job_.options.stereo ? 0 : count;
}

// Sets the sequence's scale, that of its first frame.
Status SequenceFrames::begin(uint32_t frame) {
  const auto earliest = store_.find(sequence_.name, 0);
  if (!earliest && frame > 0)
    return Error{ErrorId::Internal, nameOf(frame) + "cannot be made before the sequence's first frame"};
  FOURDVT_TRY(maker_.begin(earliest ? &*earliest : nullptr));
  FOURDVT_ASSIGN(reader_, mattes::FrameReader::open(job_.capture, sequence_, environment_.open_video, frame));
  return {};
}

Status SequenceFrames::make(uint32_t frame, const Made& made) {
  if (environment_.stop && *environment_.stop) {
    return Error{ErrorId::Interrupted,
                 "stopped; finished frames are kept in " + resultFolder(job_.options).partFolder() + " for --resume"};
  }
  if (!reader_) FOURDVT_TRY(begin(frame));
  const Watch watch;
  reader_->skipTo(frame);
  FOURDVT_ASSIGN(const auto captured, reader_->next());
  const double read_ms = watch.ms();
  FOURDVT_TRY(checkAgreement(frame, captured.pictures));
  if (frame % kWindow == 0) maker_.forget();
  auto surface = maker_.make(captured.pictures);
  if (!surface.ok()) {
    return Error{surface.error().id,
                 nameOf(frame) + surface.error().message + "; finished frames are kept for --resume"};
  }
  surface.value().figures.read_ms = read_ms;
  FOURDVT_TRY(store_.save(sequence_.name, frame, surface.value().mesh, surface.value().figures));
  if (made) made(frame, captured, surface.value());
  return {};
}

// Checks the consistency of the silhouettes in the sequence's first frame; if these are too few there, in each window's
// first frame with enough of them. The result is independent of the windows' order.
Status SequenceFrames::checkAgreement(uint32_t frame, const std::vector<Image>& pictures) {
  if (job_.options.any_silhouettes || job_.options.mattes_alone || agreed_) return {};
  std::vector<capture::CaptureCamera> cameras;
  std::vector<cv::Mat> masks;
  size_t seeing = 0;
  for (size_t i = 0; i < pictures.size(); ++i) {
    cameras.push_back({job_.capture.cameras[i].pinhole, {}});
    cv::Mat mask(pictures[i].height, pictures[i].width, CV_8U);
    for (int k = 0; k < int(mask.total()); ++k)
      mask.at<uint8_t>(k) = pictures[i].pixels[4 * size_t(k) + 3] >= 128 ? 255 : 0;
    masks.push_back(mask);
    seeing += cv::countNonZero(mask) > 0;
  }
  if (seeing < kMinJudged) return {};
  agreed_ = true;
  const auto why = mattes::disagreement(cameras, masks);
  if (!why) return {};
  return Error{ErrorId::InvalidArgument,
               nameOf(frame) + *why +
                   "; check that camera's matte, calibration and synchronisation, leave it out (--leave-out NAME), "
                   "or go on all the same (--any-silhouettes; --mattes-alone: cameras do not help each other)"};
}

}  // namespace fourdvt::reconstruct

namespace fourdvt::store {

void fields(Archive& a, reconstruct::FrameFigures& f) {
  a(f.vertices, f.triangles, f.triangles_made, f.footprint_m, f.person_metre_m, f.voxel_m, f.parts_left_out, f.fallback,
    f.volume_m3, f.seen_m3, f.cover, f.overlap, f.outline_px, f.hull_overlap, f.believed, f.moved, f.read_ms,
    f.silhouettes_ms, f.hull_ms, f.stereo_ms, f.fairing_ms, f.check_ms);
}

}  // namespace fourdvt::store

namespace fourdvt::reconstruct {
namespace {

namespace fs = std::filesystem;

constexpr const char* kVersion = "reconstruct 5";  // increment when the same options give other meshes

}  // namespace

std::string settingsKey(const ReconstructOptions& o, const capture::Capture& capture) {
  const std::string line = printed(
      "%s times %d cameras %d hull %d tolerance %.9g voxel %.9g adaptivity %.9g stereo %d fairing %d planes "
      "%d faces %d%s",
      kVersion, int(o.synchronise), int(o.refine_cameras), int(o.hull), o.contour_tolerance_px, o.voxel_m, o.adaptivity,
      int(o.stereo), o.fairing, o.planes, o.faces, o.mattes_alone ? " mattes alone" : "");
  return capture::inputsKey(capture) + " " + line + "\n";
}

FrameStore::FrameStore(const capture::ResultFolder& folder, const capture::Capture& capture, const std::string& key)
    : folder_(folder), key_(key), metres_per_unit_(capture.metres_per_unit) {
  for (const capture::CaptureSequence& sequence : capture.sequences)
    first_frames_[sequence.name] = sequence.first_frame;
}

Status FrameStore::makeFolders(const std::string& sequence) const {
  FOURDVT_TRY(platform::makeFolder(folder_.partFolder() + "/" + sequence + "/" + capture::kMeshFolder));
  return platform::makeFolder(figuresFolder(sequence));
}

std::string FrameStore::figuresFolder(const std::string& sequence) const {
  return folder_.workFolder() + "/figures_" + hexDigits(fnv1a(key_)) + "/" + sequence;
}

Status FrameStore::checkFolder() const {
  if (folder_.holds(key_)) return {};
  return Error{ErrorId::InvalidArgument, folder_.workFolder() +
                                             ": belongs to a run with other settings now; run the command again, or "
                                             "`fourdvt plan`"};
}

std::string FrameStore::meshPath(const std::string& sequence, uint32_t frame) const {
  return folder_.partFolder() + "/" + sequence + "/" + capture::kMeshFolder + "/" +
         capture::frameName(first_frames_.at(sequence) + frame) + ".ply";
}

std::string FrameStore::figuresPath(const std::string& sequence, uint32_t frame) const {
  return figuresFolder(sequence) + "/" + capture::frameName(frame) + ".bin";
}

std::optional<FrameFigures> FrameStore::find(const std::string& sequence, uint32_t frame) const {
  std::error_code failed;
  if (!fs::exists(meshPath(sequence, frame), failed)) return std::nullopt;
  auto figures = store::load<FrameFigures>(figuresPath(sequence, frame));
  return figures ? std::optional(figures.take()) : std::nullopt;
}

Status FrameStore::save(const std::string& sequence, uint32_t frame, const TriangleMesh& mesh,
                        const FrameFigures& figures) const {
  FOURDVT_TRY(checkFolder());
  TriangleMesh in_units = mesh;
  for (glm::vec3& p : in_units.positions) p /= float(metres_per_unit_);
  FOURDVT_TRY(platform::writeFileAtomic(meshPath(sequence, frame), capture::plyBytes(in_units)));
  return store::save(figuresPath(sequence, frame), figures);
}

void FrameStore::removeLeftovers(const std::string& sequence) const {
  platform::removeEntries(fs::path(meshPath(sequence, 0)).parent_path().string(),
                          [](const std::string& name) { return !name.ends_with(".ply"); });
}

Result<TriangleMesh> FrameStore::loadMesh(const std::string& sequence, uint32_t frame) const {
  FOURDVT_ASSIGN(auto mesh, capture::readMeshFile(meshPath(sequence, frame)));
  for (glm::vec3& p : mesh.positions) p *= float(metres_per_unit_);
  return mesh;
}

}  // namespace fourdvt::reconstruct
