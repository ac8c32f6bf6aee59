// SPDX-License-Identifier: Apache-2.0
// From cameras' outlines and pictures to the frames of a live stream: synchronises instants, carves the hull, packs and
// encodes the pictures, and chooses the tolerance and region of each camera. Runs on threads of its own and never
// blocks its caller. Independent of sockets.
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
  double wait_s = 0.1;         // time after an instant at which it is made from the pictures that have arrived
  double lost_s = 0.5;         // time without a picture after which a camera is no longer waited for
  double picture_share = 0.5;  // texels of the packed picture over the cameras' pixels
  int crf = 23;                // H.264 rate factor
  int max_gop = 12;            // maximum frames from key to key
  double min_tolerance_px = 0.5, max_tolerance_px = 16;
  double busy_share = 0.75;   // target share of a frame's time for hull and picture
  std::string record_folder;  // capture folder to write; empty: none
};

// Figures for the console and the page; counts since the start.
struct PipelineStatus {
  uint64_t frames = 0;      // frames made
  uint64_t incomplete = 0;  // frames that lack an awaited camera
  uint64_t skipped = 0;     // instants that fell due while the previous one was in progress
  uint64_t failed = 0;      // instants without a hull
  double frames_per_s = 0;  // over the last second, as are all below
  double hull_ms = 0, picture_ms = 0, encode_ms = 0, latency_ms = 0;  // medians; latency: capture → frame made
  double triangles = 0, tolerance_px = 0;
  double surface_bytes_per_s = 0, picture_bytes_per_s = 0;
  uint64_t recorded = 0;
  struct CameraStatus {
    std::string name;
    bool connected = false, lost = false;  // lost: connected, but no picture for lost_s
    uint64_t pictures = 0, late = 0;       // late: arrived after their instant was made
    double keyed_ms = 0, contour_bytes_per_s = 0, picture_bytes_per_s = 0;
    double clock_offset_ms = 0;  // camera's clock minus server's
  };
  std::vector<CameraStatus> cameras;  // order of the rig
};

struct PipelineEvents {  // callbacks, on the pipeline's threads
  // frame: output of writeLiveFrame.
  std::function<void(std::shared_ptr<const std::vector<uint8_t>> frame, bool key)> on_frame;
  std::function<void(size_t camera, const CameraSettings& settings)> on_settings;  // called when settings change
  std::function<void(const std::string& line)> on_warning;
};

class Pipeline {
 public:
  // Errors: InvalidArgument (rig or options, with the remedy), WriteFailed (record_folder).
  static Result<std::unique_ptr<Pipeline>> start(const Rig& rig, const PipelineOptions& options, PipelineEvents events);
  virtual ~Pipeline() = default;  // ends the recording; joins the threads
  // Manifest that viewers receive first (FORMAT.md, "A live stream"), JSON; constant for the pipeline's lifetime.
  virtual const std::string& manifest() const = 0;
  virtual CameraSettings settings(size_t camera) const = 0;

  // Callable on any thread. camera: index in the rig.
  virtual void setConnected(size_t camera, bool connected) = 0;  // a new connection resets the clock offset
  virtual void onClock(size_t camera, const ClockAnswer& answer, int64_t now_us) = 0;
  virtual void onPicture(size_t camera, CameraPicture picture, size_t message_bytes, int64_t now_us) = 0;
  virtual void wantKey() = 0;                          // a viewer has joined: one of the next few frames is a key
  virtual void setTolerance(double tolerance_px) = 0;  // 0: automatic
  virtual void setCrf(int crf) = 0;
  virtual PipelineStatus status() const = 0;
  // Camera's latest picture with its outline, for the console's page; empty: none.
  virtual CameraPicture lastPicture(size_t camera) const = 0;
};

}  // namespace fourdvt::live
