// SPDX-License-Identifier: Apache-2.0
// The live server: cameras at /camera, viewers at /live, the console at /console (WebSockets); the cameras' last
// pictures under /cameras/, /status.json, and the files of a page (HTTP). Hands cameras' messages to the pipeline and
// its frames to viewers. Does NOT make frames.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "base/result.h"
#include "live/access.h"
#include "live/net/websocket.h"
#include "live/server/pipeline.h"
#include "live/sources.h"
#include "live/viewers.h"

namespace fourdvt::live {

// Close codes besides those of WebSocket; browsers do not show why an upgrade was refused.
constexpr uint16_t kCloseToken = 4401, kCloseOrigin = 4403, kCloseReplaced = 4409, kCloseInvalid = 1008;

using StartPipeline =
    std::function<Result<std::unique_ptr<Pipeline>>(const Rig&, const PipelineOptions&, PipelineEvents)>;

struct LiveOptions {
  ServerOptions server;
  AccessRules access;  // `loopback` is set by the server's address
  PipelineOptions pipeline;
  double tolerance_px = 0;    // that of the cameras at first; 0: by control
  std::string web_folder;     // served under "/"; empty: none
  bool reads_sources = true;  // the rig's own
  double hello_s = 10;        // a camera's connection without a Hello for so long is closed
  StartPipeline start_pipeline = Pipeline::start;
  StartWorker start_worker = CameraWorker::start;
};

struct LiveStatus {
  PipelineStatus pipeline;
  ViewerStatus viewers;
  uint64_t refused = 0;  // connections and messages
};

class LiveService {
 public:
  // say: warnings, one line each, on any thread. Errors: InvalidArgument (other machines reach the server, but it has
  // no certificate or no tokens), and those of Server::start, Pipeline::start and CameraWorker::start.
  static Result<std::unique_ptr<LiveService>> start(const Rig& rig, const LiveOptions& options, SayLine say);
  virtual ~LiveService() = default;  // ends all
  virtual uint16_t port() const = 0;
  virtual LiveStatus status() = 0;
};

// The console's messages and /status.json.
std::string statusJson(const LiveStatus& status);
// /cameras/NAME.json: "size", "crop", "rings" (pixels of the camera's picture) and "number".
std::string pictureJson(const CameraPicture& picture, int width, int height);

}  // namespace fourdvt::live
