// SPDX-License-Identifier: Apache-2.0
// COLMAP's binary model: cameras.bin (intrinsics) and images.bin (poses, world to camera; points are skipped).
#include <map>
#include <set>

#include "base/bytes.h"
#include "capture/capture.h"
#include "capture/colmap_model.h"

namespace fourdvt::capture {
namespace {

constexpr uint64_t kPointBytes = 24;  // x, y, number of the point in space
constexpr uint64_t kMaxSideRead = 1 << 20;

Error cutOff(const std::string& file) {
  return {ErrorId::CameraPose, file + ": ends too early or is not COLMAP's binary model; export the calibration again"};
}

std::span<const uint8_t> bytesOf(std::string_view text) {
  return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

Result<std::map<uint32_t, ColmapIntrinsics>> binaryIntrinsics(std::string_view text, const std::string& file) {
  ByteReader in(bytesOf(text));
  std::map<uint32_t, ColmapIntrinsics> out;
  for (uint64_t left = in.u64(); in.ok() && left > 0; --left) {
    const uint32_t id = in.u32();
    const int number = static_cast<int>(in.u32());
    const uint64_t width = std::min(in.u64(), kMaxSideRead), height = std::min(in.u64(), kMaxSideRead);
    if (!in.ok()) break;
    const std::string where = file + ": camera " + std::to_string(id) + ": ";
    FOURDVT_ASSIGN(const ColmapModel* model, colmapModel(number, where));
    std::array<double, kMaxColmapParameters> parameters{};
    for (int i = 0; i < model->parameters; ++i) parameters[i] = in.f64();
    if (!in.ok()) break;
    FOURDVT_ASSIGN(out[id],
                   makeIntrinsics(*model, static_cast<int>(width), static_cast<int>(height), parameters.data(), where));
  }
  if (!in.ok()) return cutOff(file);
  if (out.empty()) return colmapPoseError(file + ": ", "no camera in it");
  return out;
}

std::string terminatedName(ByteReader& in) {
  std::string name;
  for (uint8_t c = in.u8(); in.ok() && c != 0; c = in.u8()) name += static_cast<char>(c);
  return name;
}

}  // namespace

Result<std::vector<CaptureCamera>> parseColmapBinary(std::string_view cameras_bytes, std::string_view images_bytes,
                                                     const std::string& path) {
  FOURDVT_ASSIGN(const auto intrinsics, binaryIntrinsics(cameras_bytes, path + "/cameras.bin"));
  const std::string file = path + "/images.bin";
  ByteReader in(bytesOf(images_bytes));
  std::vector<CaptureCamera> cameras;
  std::set<std::string> names;
  for (uint64_t left = in.u64(); in.ok() && left > 0; --left) {
    const std::string where = file + ": image " + std::to_string(in.u32()) + ": ";
    std::array<double, 7> pose{};
    for (double& value : pose) value = in.f64();
    const auto found = intrinsics.find(in.u32());
    const std::string name = terminatedName(in);
    const uint64_t points = in.u64();
    if (!in.ok() || points > in.remaining() / kPointBytes) return cutOff(file);
    in.bytes(points * kPointBytes);
    if (found == intrinsics.end())
      return colmapPoseError(where, "it refers to a camera that cameras.bin does not list");
    FOURDVT_ASSIGN(cameras.emplace_back(), makeColmapCamera(found->second, pose, name, where));
    if (!names.insert(cameras.back().pinhole.name).second)
      return colmapPoseError(where, "camera \"" + cameras.back().pinhole.name + "\" is listed twice");
  }
  if (!in.ok()) return cutOff(file);
  if (cameras.empty()) return colmapPoseError(file + ": ", "no image in it");
  return cameras;
}

}  // namespace fourdvt::capture
