// SPDX-License-Identifier: Apache-2.0
// COLMAP's binary model: cameras.bin (intrinsics) and images.bin (poses, world to camera; points are skipped).
#include <map>

#include "base/bytes.h"
#include "capture/capture.h"
#include "capture/colmap_model.h"

namespace fourdvt::capture {
namespace {

constexpr uint64_t kPointBytes = 24;  // x, y, index of the 3D point
constexpr uint64_t kMaxSideRead = 1 << 20;

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
  if (!in.ok()) return colmapCutOff(file);
  if (out.empty()) return colmapPoseError(file + ": ", "no camera in it");
  return out;
}

std::string terminatedName(ByteReader& in) {
  std::string name;
  for (uint8_t c = in.u8(); in.ok() && c != 0; c = in.u8()) name += static_cast<char>(c);
  return name;
}

}  // namespace

Result<std::vector<ListedPicture>> colmapBinaryPictures(std::string_view cameras_bytes, std::string_view images_bytes,
                                                        const RigPoses& rigs, const std::string& path) {
  FOURDVT_ASSIGN(const auto intrinsics, binaryIntrinsics(cameras_bytes, path + "/cameras.bin"));
  const std::string file = path + "/images.bin";
  ByteReader in(bytesOf(images_bytes));
  std::vector<ListedPicture> pictures;
  for (uint64_t left = in.u64(); in.ok() && left > 0; --left) {
    const uint32_t id = in.u32();
    const std::string where = file + ": image " + std::to_string(id) + ": ";
    std::array<double, 7> pose{};
    for (double& value : pose) value = in.f64();
    const auto found = intrinsics.find(in.u32());
    const std::string name = terminatedName(in);
    const uint64_t points = in.u64();
    if (!in.ok() || points > in.remaining() / kPointBytes) return colmapCutOff(file);
    in.bytes(points * kPointBytes);
    if (found == intrinsics.end())
      return colmapPoseError(where, "it refers to a camera that cameras.bin does not list");
    const auto by_rig = rigs.find(id);
    FOURDVT_ASSIGN(auto camera, makeColmapCamera(found->second, by_rig == rigs.end() ? pose : by_rig->second, where));
    FOURDVT_TRY(checkListedPath(name, where));
    pictures.push_back({std::move(camera), name, where});
  }
  if (!in.ok()) return colmapCutOff(file);
  if (pictures.empty()) return colmapPoseError(file + ": ", "no image in it");
  return pictures;
}

}  // namespace fourdvt::capture
