// SPDX-License-Identifier: Apache-2.0
#include "mattes/frame_reader.h"

#include <cassert>
#include <optional>
#include <utility>

#include "base/parallel.h"
#include "capture/matte_flaw.h"
#include "capture/matted_pictures.h"
#include "capture/mesh_sequence.h"
#include "capture/pictures.h"
#include "capture/undistort.h"
#include "mattes/plate_key.h"

namespace fourdvt::mattes {

// One camera: its pictures, and plates for keying where it has no mattes.
class FrameReader::Camera {
 public:
  static Result<Camera> open(const capture::Capture& capture, const capture::CaptureSequence& sequence,
                             const capture::CaptureCamera& camera, const OpenVideo& open_video,
                             capture::MatteNeed mattes, bool check_files) {
    FOURDVT_ASSIGN(auto pictures, capture::MattedPictures::open(sequence, camera, open_video, mattes, check_files));
    Camera reader(camera, std::move(pictures));
    if (mattes == capture::MatteNeed::Required && !reader.pictures_.hasMattes()) {
      FOURDVT_ASSIGN(reader.key_, PlateKey::open(capture, camera));
    }
    return reader;
  }

  // RGBA, undistorted.
  Status read(uint32_t frame, Image& out) {
    FOURDVT_ASSIGN(auto read, pictures_.read(frame));
    auto& [colour, alpha] = read;
    if (key_) {
      float residual = 0;
      alpha = key_->matte(colour, &residual);
      FOURDVT_TRY(checkFirst(alpha, residual));
    } else if (!pictures_.hasMattes()) {
      alpha = Image(colour.width, colour.height, 1, 255);
    }
    out = joined(undistorter_.apply(std::move(colour)), undistorter_.apply(std::move(alpha)));
    return {};
  }

 private:
  Camera(const capture::CaptureCamera& camera, capture::MattedPictures pictures)
      : camera_(camera), undistorter_(camera), pictures_(std::move(pictures)) {}

  // Detects plates that do not fit by the first matte. An empty matte passes.
  Status checkFirst(const Image& alpha, float residual_levels) {
    if (std::exchange(checked_, true)) return {};
    if (capture::keepsTheBorder(alpha) || residual_levels > kMaxResidual)
      return plateDoesNotFit(key_->path(), pictures_.path(), camera_.pinhole.name);
    return {};
  }

  static Image joined(const Image& colour, const Image& alpha) {
    Image out(colour.width, colour.height, 4);
    for (size_t i = 0; i < alpha.pixels.size(); ++i) {
      const uint8_t* rgb = &colour.pixels[i * 3];
      uint8_t* rgba = &out.pixels[i * 4];
      rgba[0] = rgb[0];
      rgba[1] = rgb[1];
      rgba[2] = rgb[2];
      rgba[3] = alpha.pixels[i];
    }
    return out;
  }

  capture::CaptureCamera camera_;
  capture::Undistorter undistorter_;
  capture::MattedPictures pictures_;
  std::optional<PlateKey> key_;  // set if mattes are required and there are none
  bool checked_ = false;
};

FrameReader::FrameReader(const capture::Capture& capture, const capture::CaptureSequence& sequence, uint32_t first)
    : capture_(capture), sequence_(sequence), next_frame_(first) {}
FrameReader::~FrameReader() = default;

Result<std::unique_ptr<FrameReader>> FrameReader::open(const capture::Capture& capture,
                                                       const capture::CaptureSequence& sequence,
                                                       const OpenVideo& open_video, uint32_t first_frame,
                                                       capture::MatteNeed mattes) {
  std::unique_ptr<FrameReader> reader(new FrameReader(capture, sequence, first_frame));
  // Missing files are detected only when reading begins with the first frame; later, other readers have done so.
  for (const capture::CaptureCamera& camera : capture.cameras) {
    FOURDVT_ASSIGN(auto opened, Camera::open(capture, sequence, camera, open_video, mattes, first_frame == 0));
    reader->cameras_.push_back(std::move(opened));
  }
  return reader;
}

void FrameReader::skipTo(uint32_t frame) {
  assert(frame >= next_frame_);
  next_frame_ = frame;
}

Result<CaptureFrame> FrameReader::next() {
  CaptureFrame frame;
  frame.index = next_frame_;
  FOURDVT_TRY(readSurface(frame));
  frame.pictures.resize(cameras_.size());
  std::vector<Status> done(cameras_.size());
  inParallel(cameras_.size(), [&](size_t i) { done[i] = cameras_[i].read(frame.index, frame.pictures[i]); });
  for (const Status& status : done) FOURDVT_TRY(status);
  ++next_frame_;
  return frame;
}

// Faces of constant topology are part of the capture.
Status FrameReader::readSurface(CaptureFrame& frame) const {
  if (capture_.meshes == capture::CaptureMeshes::None) return capture::checkFrame(sequence_, frame.index);
  if (capture_.meshes == capture::CaptureMeshes::ConstantTopology) {
    FOURDVT_ASSIGN(frame.positions, capture::readMeshFrame(capture_, sequence_, frame.index));
    return {};
  }
  FOURDVT_ASSIGN(auto mesh, capture::readSurfaceFrame(capture_, sequence_, frame.index));
  frame.positions = std::move(mesh.positions);
  frame.faces = std::move(mesh.faces);
  return {};
}

Result<capture::Capture> openCapture(const std::string& folder, const OpenVideo& open_video,
                                     const std::vector<std::string>& only, capture::MeshNeed need,
                                     capture::MatteNeed mattes) {
  FOURDVT_ASSIGN(auto capture, capture::openDescription(folder, only, need));
  for (const capture::CaptureSequence& sequence : capture.sequences) {
    FOURDVT_TRY(capture::checkClips(capture, sequence, open_video, mattes));
    // Opening the reader checks that files exist; reading the first frame checks decoding and sizes.
    FOURDVT_ASSIGN(const auto reader, FrameReader::open(capture, sequence, open_video, 0, mattes));
    if (auto frame = reader->next(); !frame.ok()) return frame.error();
  }
  return capture;
}

Result<capture::Capture> openLinked(const std::string& folder, const std::string& linked_capture,
                                    const std::vector<std::string>& sequences, const OpenVideo& open_video) {
  auto opened = openCapture(folder, open_video, sequences, capture::MeshNeed::Nothing, capture::MatteNeed::None);
  if (opened.ok()) return opened;
  return Error{opened.error().id, linked_capture +
                                      "/capture.json: names files outside of the capture or in a sequence that is "
                                      "left out; move them into folders of their own inside it (" +
                                      opened.error().message + ")"};
}

}  // namespace fourdvt::mattes
