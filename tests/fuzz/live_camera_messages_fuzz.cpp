// SPDX-License-Identifier: Apache-2.0
// Live messages: "C" + one from a camera, "S" + one to a camera, "F" + a frame of the stream. Accepted messages are
// within the limits and are written back as the same bytes.
#include <cstdlib>

#include "live/protocol/camera_messages.h"
#include "package/live_stream.h"

using namespace fourdvt;
using namespace fourdvt::live;

namespace {

void require(bool holds) {
  if (!holds) std::abort();
}

bool same(const std::vector<uint8_t>& a, std::span<const uint8_t> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end());
}

void fuzzFromCamera(std::span<const uint8_t> bytes) {
  const auto read = readFromCamera(bytes);
  if (!read.ok()) return;
  require(same(writeFromCamera(read.value()), bytes));
  if (const auto* m = std::get_if<Hello>(&read.value()))
    require(!m->camera.empty() && m->camera.size() <= 128 && m->width >= 1 && m->width <= 4095 && m->height >= 1);
  if (const auto* m = std::get_if<CameraPicture>(&read.value())) {
    size_t points = 0;
    for (const Ring16& ring : m->rings) require(ring.size() >= 3), points += ring.size();
    require(m->rings.size() <= kMaxRings && points <= kMaxRingPoints && m->jpeg.empty() == (m->crop.width == 0));
    require(m->crop.x + m->crop.width <= 4095 && m->crop.y + m->crop.height <= 4095);
  }
}

void fuzzToCamera(std::span<const uint8_t> bytes) {
  const auto read = readToCamera(bytes);
  if (!read.ok()) return;
  require(same(writeToCamera(read.value()), bytes));
  if (const auto* m = std::get_if<CameraSettings>(&read.value()))
    require(m->tolerance_px >= 0 && m->tolerance_px <= 64 && m->jpeg_quality >= 1 && m->jpeg_quality <= 100);
}

void fuzzFrame(std::span<const uint8_t> bytes) {
  const auto read = package::readLiveFrame(bytes);
  if (!read.ok()) return;
  require(!read.value().chunk.empty() && !read.value().sample.empty());
  require(same(package::writeLiveFrame(read.value()), bytes));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size == 0) return 0;
  const std::span<const uint8_t> rest(data + 1, size - 1);
  if (data[0] == 'C') fuzzFromCamera(rest);
  if (data[0] == 'S') fuzzToCamera(rest);
  if (data[0] == 'F') fuzzFrame(rest);
  return 0;
}
