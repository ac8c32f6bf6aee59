// SPDX-License-Identifier: Apache-2.0
#include "jobs/videos.h"

#include "platform/ffmpeg_video.h"
#include "platform/folders.h"

namespace fourdvt::jobs {

std::string videoIndexFolder(const std::string& job_folder) { return job_folder + "/videos"; }

Status indexVideos(const std::string& job_folder, const std::vector<std::string>& paths,
                   const std::atomic<bool>* stop) {
  const std::string folder = videoIndexFolder(job_folder);
  FOURDVT_TRY(platform::makeFolder(folder));
  for (const std::string& path : paths) {
    if (stop && *stop) return Error{ErrorId::Interrupted, "stopped while listing the pictures of " + path};
    FOURDVT_TRY(platform::indexVideo(path, folder));
  }
  return {};
}

}  // namespace fourdvt::jobs
