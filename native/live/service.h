// SPDX-License-Identifier: Apache-2.0
// A live stage as a server: cameras at /camera, pages at /live, the console at
// /console, its pictures and files by GET. Passes messages between sockets and
// the pipeline; keeps slow viewers from slowing others. Does NOT make frames.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "live/access.h"
#include "live/net/websocket.h"
#include "live/server/pipeline.h"

namespace fourdvt::live {

// Close codes beside WebSocket's own; browsers do not show why a handshake was
// refused.
constexpr uint16_t kCloseToken = 4401, kCloseOrigin = 4403, kCloseInvalid = 1008, kCloseReplaced = 4409;

using MakePipeline =
    std::function<Result<std::unique_ptr<Pipeline>>(const Rig&, const PipelineOptions&, PipelineEvents)>;

struct ServiceOptions {
  ServerOptions server;
  PipelineOptions pipeline;
  AccessRules access;
  std::string web_folder;     // files under "/"; empty: none
  bool local_sources = true;  // the rig's own sources are read by this process
  MakePipeline make_pipeline = Pipeline::start;
};

struct ServiceStatus {
  PipelineStatus pipeline;
  uint64_t viewers = 0,
           skipped = 0;           // skipped: frames that viewers could not take, in all
  double viewer_bytes_per_s = 0;  // to all viewers, over the last second
  uint64_t refused = 0;           // connections and messages
};

class LiveService {
 public:
  // on_line: warnings, on any thread. Errors: those of Server, Pipeline and
  // CameraWorker.
  static Result<std::unique_ptr<LiveService>> start(const Rig& rig, const ServiceOptions& options,
                                                    std::function<void(const std::string&)> on_line);
  virtual ~LiveService() = default;
  virtual uint16_t port() const = 0;
  virtual ServiceStatus status() const = 0;
};

// As the console and GET /status.json have it.
std::string statusJson(const ServiceStatus& status);

}  // namespace fourdvt::live
