// SPDX-License-Identifier: Apache-2.0
// Live server: cameras at /camera, viewers at /live, the console at /console (WebSockets); the cameras' last pictures
// under /cameras/, /status.json, and the files of a page (HTTP). Passes cameras' messages to the pipeline and its
// frames to viewers.
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

// Close codes besides those of WebSocket, since browsers hide the reason of a refused upgrade.
constexpr uint16_t kCloseToken = 4401, kCloseOrigin = 4403, kCloseReplaced = 4409, kCloseInvalid = 1008;

using StartPipeline =
    std::function<Result<std::unique_ptr<Pipeline>>(const Rig&, const PipelineOptions&, PipelineEvents)>;

struct LiveOptions {
  ServerOptions server;
  AccessRules access;  // `loopback` is set from the server's address
  PipelineOptions pipeline;
  double tolerance_px = 0;    // initial tolerance of the cameras; 0: automatic
  std::string web_folder;     // folder published under "/"; empty: none
  bool reads_sources = true;  // reads the rig's own sources
  double hello_s = 10;        // timeout of a camera's Hello
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
  // say: prints one warning line, on any thread. Errors: InvalidArgument (reachable from other machines without a
  // certificate or tokens), and those of Server::start, Pipeline::start and CameraWorker::start.
  static Result<std::unique_ptr<LiveService>> start(const Rig& rig, const LiveOptions& options, SayLine say);
  virtual ~LiveService() = default;  // closes all connections, stops all threads
  virtual uint16_t port() const = 0;
  virtual LiveStatus status() = 0;
};

// JSON of the console's messages and /status.json.
std::string statusJson(const LiveStatus& status);
// JSON of /cameras/NAME.json: "size", "crop", "rings" (pixels of the camera's picture) and "number".
std::string pictureJson(const CameraPicture& picture, int width, int height);

}  // namespace fourdvt::live
