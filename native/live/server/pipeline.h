// SPDX-License-Identifier: Apache-2.0
// From cameras' outlines and pictures to the frames of a live stream: brings what belongs to one instant together,
// carves the hull, packs and encodes the pictures, and says by which tolerance and in which region the cameras shall
// work. Works on a thread of its own and never blocks its caller. Does NOT know sockets.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/result.h"
#include "live/protocol/camera_messages.h"
#include "live/rig/rig.h"

namespace fourdvt::live {

struct PipelineOptions {
  double wait_s = 0.1;         // an instant is made of what has come so long after it
  double lost_s = 0.5;         // a camera without a picture for so long is not waited for
  double picture_share = 0.5;  // texels of the packed picture against the cameras' pixels
  int crf = 23;                // H.264
  int most_gop = 12;           // frames from key to key
  double least_tolerance_px = 0.5, most_tolerance_px = 16;
  double busy_share = 0.75;  // of a frame's time that a hull and its picture may take: the control's goal
  std::string record_folder;  // capture folder to write; empty: none
};

// Figures that the console and the page show; counts are since the start.
struct PipelineStatus {
  uint64_t frames = 0;      // made
  uint64_t incomplete = 0;  // of these, without a camera that was there
  uint64_t skipped = 0;     // instants that were due while the one before was still worked on
  uint64_t failed = 0;      // instants without a hull
  double frames_per_s = 0;  // over the last second, as all below
  double hull_ms = 0, picture_ms = 0, encode_ms = 0, latency_ms = 0;  // medians; latency: capture → frame made
  double triangles = 0, tolerance_px = 0;
  double surface_bytes_per_s = 0, picture_bytes_per_s = 0;
  uint64_t recorded = 0;
  struct CameraStatus {
    std::string name;
    bool connected = false, lost = false;  // lost: connected, but no picture for lost_s
    uint64_t pictures = 0, late = 0;       // late: after their instant was made
    double keyed_ms = 0, contour_bytes_per_s = 0, picture_bytes_per_s = 0;
    double clock_offset_ms = 0;  // camera's clock minus server's
  };
  std::vector<CameraStatus> cameras;  // as the rig's
};

struct PipelineEvents {  // called on the pipeline's thread
  std::function<void(std::shared_ptr<const std::vector<uint8_t>> frame, bool key)> on_frame;  // writeLiveFrame's
  std::function<void(size_t camera, const CameraSettings& settings)> on_settings;             // when they change
  std::function<void(const std::string& line)> on_warning;
};

class Pipeline {
 public:
  // Errors: InvalidArgument (rig or options, with the remedy), WriteFailed (record_folder).
  static Result<std::unique_ptr<Pipeline>> start(const Rig& rig, const PipelineOptions& options, PipelineEvents events);
  virtual ~Pipeline() = default;  // ends the recording; joins the thread
  // The manifest that viewers get first (package/live_manifest.h), JSON; the same for the pipeline's life.
  virtual const std::string& manifest() const = 0;
  virtual CameraSettings settings(size_t camera) const = 0;

  // On any thread. camera: index in the rig.
  virtual void setConnected(size_t camera, bool connected) = 0;  // a new connection begins with an unknown clock
  virtual void onClock(size_t camera, const ClockAnswer& answer, int64_t now_us) = 0;
  virtual void onPicture(size_t camera, CameraPicture picture, size_t message_bytes, int64_t now_us) = 0;
  virtual void wantKey() = 0;  // a viewer has joined: a key comes with one of the next few frames
  virtual void setTolerance(double tolerance_px) = 0;  // 0: by control
  virtual void setCrf(int crf) = 0;
  virtual PipelineStatus status() const = 0;
  // The camera's picture that came last, with its outline: for the console's page. Empty: none.
  virtual CameraPicture lastPicture(size_t camera) const = 0;
};

}  // namespace fourdvt::live
