// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "live/service.h"

namespace fourdvt::live {

std::string statusJson(const ServiceStatus& status) {
  const PipelineStatus& p = status.pipeline;
  nlohmann::json out = {{"type", "status"},
                        {"frames", p.frames},
                        {"incomplete", p.incomplete},
                        {"skipped", p.skipped},
                        {"failed", p.failed},
                        {"frames_per_s", p.frames_per_s},
                        {"hull_ms", p.hull_ms},
                        {"picture_ms", p.picture_ms},
                        {"encode_ms", p.encode_ms},
                        {"latency_ms", p.latency_ms},
                        {"triangles", p.triangles},
                        {"tolerance_px", p.tolerance_px},
                        {"surface_bytes_per_s", p.surface_bytes_per_s},
                        {"picture_bytes_per_s", p.picture_bytes_per_s},
                        {"recorded", p.recorded},
                        {"viewers", status.viewers},
                        {"viewers_skipped", status.skipped},
                        {"viewer_bytes_per_s", status.viewer_bytes_per_s},
                        {"refused", status.refused},
                        {"cameras", nlohmann::json::array()}};
  for (const PipelineStatus::CameraStatus& c : p.cameras)
    out["cameras"].push_back({{"name", c.name},
                              {"connected", c.connected},
                              {"lost", c.lost},
                              {"pictures", c.pictures},
                              {"late", c.late},
                              {"keyed_ms", c.keyed_ms},
                              {"contour_bytes_per_s", c.contour_bytes_per_s},
                              {"picture_bytes_per_s", c.picture_bytes_per_s},
                              {"clock_offset_ms", c.clock_offset_ms}});
  return out.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace fourdvt::live
