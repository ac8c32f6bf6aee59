// SPDX-License-Identifier: Apache-2.0
// COLMAP text: cameras.txt and images.txt in one input, separated by the first NUL or form feed.
#include <cmath>
#include <cstdlib>

#include "capture/capture.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const size_t split = text.find_first_of(std::string_view("\f\0", 2));
  const std::string_view images = split == std::string_view::npos ? std::string_view() : text.substr(split + 1);
  const auto cameras = fourdvt::capture::parseColmapText(text.substr(0, split), images, "fuzz");
  if (!cameras.ok()) {
    if (cameras.error().message.rfind("fuzz/", 0) != 0) std::abort();
    return 0;
  }
  for (const auto& camera : cameras.value()) {
    const double determinant = glm::determinant(camera.pinhole.cam_from_world);
    if (!(std::abs(determinant - 1) < 1e-6) || camera.pinhole.name.empty()) std::abort();
  }
  return 0;
}
