// SPDX-License-Identifier: Apache-2.0
// The rig's own sources, read by this process with one worker per camera. A source that ends is reopened, with retries
// until that succeeds.
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "live/camera/camera_worker.h"
#include "live/server/pipeline.h"

namespace fourdvt::live {

using StartWorker = std::function<Result<std::unique_ptr<CameraWorker>>(
    const Rig&, const std::string& camera, std::function<void(CameraPicture)>, std::function<void(const Error&)>)>;
using SayLine = std::function<void(const std::string&)>;  // callable on any thread

int64_t serverNow_us();  // time since 1970

class Sources {
 public:
  // rig, pipeline: borrowed.
  Sources(const Rig& rig, StartWorker start, Pipeline& pipeline, SayLine say);
  ~Sources();
  // Errors: those of CameraWorker::start.
  Status open();
  bool has(size_t camera) const { return static_cast<bool>(rig_.cameras[camera].source); }
  void set(size_t camera, const CameraSettings& settings);  // callable on any thread
  void tellClock();  // reports an offset of zero, since both use one clock; once per second

 private:
  struct Source {
    std::shared_ptr<CameraWorker> worker;
    bool has_ended = false;
  };

  Status open(size_t camera);
  void reopen();

  const Rig& rig_;
  const StartWorker start_;
  Pipeline& pipeline_;
  const SayLine say_;
  std::mutex mutex_;  // guards the members below
  std::condition_variable changed_;
  std::vector<Source> sources_;  // order of the rig's cameras
  bool is_stopping_ = false;
  std::thread thread_;
};

}  // namespace fourdvt::live
