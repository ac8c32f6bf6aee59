// SPDX-License-Identifier: Apache-2.0
// Messages between a camera process and the live server, one binary WebSocket message each, little-endian. Readers
// validate every value that later code uses as an index or size. Calibrations are not transmitted: both sides read the
// rig.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "base/result.h"
#include "package/character.h"

namespace fourdvt::live {

constexpr uint16_t kCameraProtocol = 1;
constexpr size_t kMaxCameraMessageBytes = 4u << 20, kMaxServerMessageBytes = 64;
constexpr size_t kMaxRings = 256, kMaxRingPoints = 8192;  // kMaxRingPoints: total over all rings
constexpr double kPointsPerPixel = 16;                    // positions are sent in sixteenths of a pixel

// --- from the camera ---

struct Hello {                // first message
  std::string camera;         // name in the rig, 1…128 bytes
  int width = 0, height = 0;  // size of its pictures, 1…4095 pixels
};

struct ClockAnswer {
  int64_t server_us = 0;  // copied from the question
  int64_t camera_us = 0;  // camera's clock at the time of the answer
};

// Ring of an outline: pixel positions, oriented as in silhouette/contour.h.
struct Point16 {
  uint16_t x = 0, y = 0;  // sixteenths of a pixel
  bool operator==(const Point16&) const = default;
};
using Ring16 = std::vector<Point16>;

struct CameraPicture {
  uint32_t number = 0;      // picture number of the camera, ascending
  int64_t captured_us = 0;  // camera's clock, since 1970
  uint32_t keyed_us = 0;    // duration of keying
  // Simplified outlines of visible background; empty: neither performer nor background is visible.
  std::vector<Ring16> rings;
  package::Rect crop;         // rectangle of the camera's picture that `jpeg` shows, pixels; no width: no picture
  std::vector<uint8_t> jpeg;  // 4:2:0, JFIF (BT.601, full range)
};

using FromCamera = std::variant<Hello, ClockAnswer, CameraPicture>;

// --- to the camera ---

struct ClockQuestion {
  int64_t server_us = 0;
};

struct CameraSettings {
  double tolerance_px = 1;  // simplification tolerance of outlines, 0…64
  int jpeg_quality = 85;    // 1…100
  package::Rect region;     // requested rectangle of the camera's picture; no width: all
};

using ToCamera = std::variant<ClockQuestion, CameraSettings>;

std::vector<uint8_t> writeFromCamera(const FromCamera& message);
std::vector<uint8_t> writeToCamera(const ToCamera& message);
// Errors: StreamInvalid; Unsupported (another version of the protocol).
Result<FromCamera> readFromCamera(std::span<const uint8_t> bytes);
Result<ToCamera> readToCamera(std::span<const uint8_t> bytes);

}  // namespace fourdvt::live
