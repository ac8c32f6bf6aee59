// SPDX-License-Identifier: Apache-2.0
#include "track/run/work.h"

#include <filesystem>

#include "base/hash.h"
#include "platform/files.h"
#include "store/folder.h"

namespace fourdvt::store {
namespace {

void fieldsOf(Archive& a, cv::Mat& picture) {
  int height = picture.rows, width = picture.cols, type = picture.type();
  std::vector<uint8_t> bytes;
  if (!a.reads() && !picture.empty()) {
    const cv::Mat whole = picture.isContinuous() ? picture : picture.clone();
    bytes.assign(whole.data, whole.data + whole.total() * whole.elemSize());
  }
  a(height, width, type, bytes);
  if (!a.reads()) return;
  if (bytes.empty() || bytes.size() != size_t(height) * size_t(width) * CV_ELEM_SIZE(type)) return picture.release();
  picture = cv::Mat(height, width, type, bytes.data()).clone();
}

}  // namespace

void fields(Archive& a, track::View& v) {
  a(v.camera);
  fieldsOf(a, v.grey);
  fieldsOf(a, v.matte);
}
void fields(Archive& a, track::FrameThumbnails& t) {
  auto count = uint32_t(t.pictures.size());
  a(count);
  if (a.reads()) t.pictures.resize(std::min(count, 1024u));
  for (cv::Mat& picture : t.pictures) fieldsOf(a, picture);
}
void fields(Archive& a, track::FramePictures& f) { a(f.views); }
void fields(Archive& a, track::ChosenTemplate& t) {
  a(t.frame, t.mesh.topology, t.mesh.positions, t.fitness, t.judged);
}
void fields(Archive& a, track::FitFigures& f) {
  a(f.overlap, f.distance_95_m, f.distance_max_m, f.farthest, f.seen_share, f.stretched_faces, f.flipped_faces,
    f.vertex_distance_m, f.lost_share, f.colour_error);
}
void fields(Archive& a, track::TrackedFrame& f) {
  a(f.fit.pose.rotations, f.fit.pose.shifts, f.fit.offsets, f.fit.positions, f.figures, f.seconds);
}

}  // namespace fourdvt::store

namespace fourdvt::track {
namespace {

constexpr const char* kPictures = "pictures";
constexpr const char* kThumbnails = "thumbnails";
constexpr const char* kFits = "fits";

}  // namespace

Work::Work(const capture::ResultFolder& folder, const capture::Capture& capture, const std::string& key)
    : folder_(folder.workFolder() + "/" + hexDigits(fnv1a(key))), frames_(capture) {
  for (const capture::CaptureSequence& sequence : capture.sequences) names_.push_back(sequence.name);
}

Status Work::makeFolders() const {
  for (const char* kind : {kPictures, kThumbnails, kFits})
    for (const std::string& name : names_) FOURDVT_TRY(platform::makeFolder(folder_ + "/" + kind + "/" + name));
  return {};
}

std::string Work::nameOf(uint32_t frame) const {
  const uint32_t s = frames_.sequenceOf(frame);
  return names_[s] + ", frame " + std::to_string(frame - frames_.starts[s]);
}

std::string Work::path(const char* kind, uint32_t frame) const {
  const uint32_t s = frames_.sequenceOf(frame);
  return folder_ + "/" + kind + "/" + names_[s] + "/" + capture::frameName(frame - frames_.starts[s]) + ".bin";
}

bool Work::hasPictures(uint32_t frame) const {
  std::error_code none;
  return std::filesystem::exists(path(kPictures, frame), none) &&
         std::filesystem::exists(path(kThumbnails, frame), none);
}
Status Work::save(uint32_t frame, const FramePictures& pictures, const FrameThumbnails& thumbnails) const {
  FOURDVT_TRY(store::save(path(kThumbnails, frame), thumbnails));
  return store::save(path(kPictures, frame), pictures);
}
Result<FrameThumbnails> Work::thumbnails(uint32_t frame) const {
  return store::load<FrameThumbnails>(path(kThumbnails, frame));
}
Result<FramePictures> Work::pictures(uint32_t frame) const {
  return store::load<FramePictures>(path(kPictures, frame));
}

std::optional<ChosenTemplate> Work::chosenTemplate() const {
  auto found = store::load<ChosenTemplate>(folder_ + "/template.bin");
  return found ? std::optional(found.take()) : std::nullopt;
}
Status Work::save(const ChosenTemplate& chosen) const { return store::save(folder_ + "/template.bin", chosen); }

std::optional<TrackedFrame> Work::tracked(uint32_t frame) const {
  if (const auto repair = repairs_.find(frame); repair != repairs_.end()) return repair->second;
  auto found = store::load<TrackedFrame>(path(kFits, frame));
  return found ? std::optional(found.take()) : std::nullopt;
}
Result<TrackedFrame> Work::requireTracked(uint32_t frame) const {
  if (auto found = tracked(frame)) return std::move(*found);
  return Error{ErrorId::InvalidArgument,
               nameOf(frame) + ": is not fitted; run `fourdvt track --resume`, or `fourdvt plan` again"};
}
Status Work::save(uint32_t frame, const TrackedFrame& tracked) const {
  return store::save(path(kFits, frame), tracked);
}

}  // namespace fourdvt::track
