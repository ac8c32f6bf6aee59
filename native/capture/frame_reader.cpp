// SPDX-License-Identifier: Apache-2.0
// FrameReader: keeps all cameras in step and one frame in memory. Cameras are decoded in parallel on OpenCV's threads.
#include <cassert>
#include <opencv2/core/utility.hpp>
#include <utility>

#include "capture/matte_flaw.h"
#include "capture/matted_pictures.h"
#include "capture/mesh_sequence.h"
#include "capture/plate_key.h"
#include "capture/undistort.h"

namespace fourdvt::capture {
namespace {

// One camera: its pictures, and plates to key against where it has no mattes.
class CameraReader {
 public:
  static Result<CameraReader> open(const Capture& capture, const CaptureSequence& sequence, const CaptureCamera& camera,
                                   const OpenVideo& open_video, MatteNeed mattes, bool check_files) {
    FOURDVT_ASSIGN(auto pictures, MattedPictures::open(sequence, camera, open_video, mattes, check_files));
    CameraReader reader(camera, std::move(pictures));
    if (mattes == MatteNeed::Required && !reader.pictures_.hasMattes()) {
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
  CameraReader(const CaptureCamera& camera, MattedPictures pictures)
      : camera_(camera), undistorter_(camera), pictures_(std::move(pictures)) {}

  // The first matte shows whether plates do not fit. An empty one is fine.
  Status checkFirst(const Image& alpha, float residual_levels) {
    if (std::exchange(checked_, true)) return {};
    if (keepsTheBorder(alpha) || residual_levels > kMostResidual)
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

  CaptureCamera camera_;
  Undistorter undistorter_;
  MattedPictures pictures_;
  std::optional<PlateKey> key_;  // if there are no mattes, and they are needed
  bool checked_ = false;
};

class Reader final : public FrameReader {
 public:
  Reader(const Capture& capture, const CaptureSequence& sequence, uint32_t first_frame)
      : capture_(capture), sequence_(sequence), next_frame_(first_frame) {}

  // Files are looked for where reading begins with the first frame: later, others have done so.
  Status openCameras(const OpenVideo& open_video, MatteNeed mattes) {
    for (const CaptureCamera& camera : capture_.cameras) {
      FOURDVT_ASSIGN(auto reader,
                     CameraReader::open(capture_, sequence_, camera, open_video, mattes, next_frame_ == 0));
      cameras_.push_back(std::move(reader));
    }
    return {};
  }

  void skipTo(uint32_t frame) override {
    assert(frame >= next_frame_);
    next_frame_ = frame;
  }

  Result<CaptureFrame> next() override {
    CaptureFrame frame;
    frame.index = next_frame_;
    FOURDVT_TRY(readSurface(frame));
    frame.pictures.resize(cameras_.size());
    std::vector<Status> done(cameras_.size());
    cv::parallel_for_(cv::Range(0, static_cast<int>(cameras_.size())), [&](const cv::Range& range) {
      for (int i = range.start; i < range.end; ++i) {
        done[i] = cameras_[i].read(frame.index, frame.pictures[i]);
      }
    });
    for (const Status& status : done) {
      if (!status.ok()) return status.error();
    }
    ++next_frame_;
    return frame;
  }

 private:
  // The faces of constant topology are in the capture.
  Status readSurface(CaptureFrame& frame) const {
    if (capture_.meshes == CaptureMeshes::None) return checkFrame(sequence_, frame.index);
    if (capture_.meshes == CaptureMeshes::ConstantTopology) {
      FOURDVT_ASSIGN(frame.positions, readMeshFrame(capture_, sequence_, frame.index));
      return {};
    }
    FOURDVT_ASSIGN(auto mesh, readSurfaceFrame(capture_, sequence_, frame.index));
    frame.positions = std::move(mesh.positions);
    frame.faces = std::move(mesh.faces);
    return {};
  }

  const Capture capture_;
  const CaptureSequence sequence_;
  uint32_t next_frame_;
  std::vector<CameraReader> cameras_;
};

}  // namespace

Result<std::unique_ptr<FrameReader>> FrameReader::open(const Capture& capture, const CaptureSequence& sequence,
                                                       const OpenVideo& open_video, uint32_t first_frame,
                                                       MatteNeed mattes) {
  auto reader = std::make_unique<Reader>(capture, sequence, first_frame);
  FOURDVT_TRY(reader->openCameras(open_video, mattes));
  return std::unique_ptr<FrameReader>(std::move(reader));
}

}  // namespace fourdvt::capture
