// SPDX-License-Identifier: Apache-2.0
// EasyMocap: K_NAME and dist_NAME in intri.yml; R_NAME (vector) or Rot_NAME (matrix) and T_NAME in extri.yml.
#include "capture/import/camera_numbers.h"
#include "capture/import/readers.h"
#include "capture/import/storage.h"

namespace fourdvt::capture {
namespace {

Result<ImportedCamera> easyMocapCamera(const Storage& intri, const Storage& extri, const std::string& name,
                                       const std::string& path) {
  ImportedCamera out;
  PinholeCamera& pinhole = out.camera.pinhole;
  pinhole.name = name;
  const std::string where = path + ": camera " + name;
  const auto coefficients = intri.numbers({"dist_" + name, "D_" + name});
  if (coefficients.empty() && intri.has({"dist_" + name, "D_" + name}))
    return badCalibration(
        path, "dist_" + name + " must be a list of numbers" + intri.problem({"dist_" + name, "D_" + name}, 14));
  FOURDVT_ASSIGN(out.camera.distortion, distortionOf(coefficients, false, where));
  const auto lens = intri.numbers({"K_" + name});
  if (lens.size() != 9)
    return badCalibration(where, "no K_" + name + " of nine numbers" + intri.problem({"K_" + name}, 9));
  FOURDVT_TRY(setCameraMatrix(lens, kFirstPixelAtZero, out.camera, where));
  const auto width = intri.numbers({"W_" + name}), height = intri.numbers({"H_" + name});
  if (width.size() == 1 && height.size() == 1 && width[0] > 0 && height[0] > 0 && width[0] < 1e6 && height[0] < 1e6)
    pinhole.width = static_cast<int>(width[0]), pinhole.height = static_cast<int>(height[0]);
  const auto matrix = extri.numbers({"Rot_" + name}), vector = extri.numbers({"R_" + name});
  const auto translation = extri.numbers({"T_" + name});
  if (matrix.size() != 9 && vector.size() != 3)
    return badCalibration(path, "no Rot_" + name + " of nine numbers and no R_" + name + " of three" +
                                    extri.problem({"Rot_" + name, "R_" + name}, 9));
  if (translation.size() != 3)
    return badCalibration(path, "no T_" + name + " of three numbers" + extri.problem({"T_" + name}, 3));
  FOURDVT_TRY(setPose(rotationOfNumbers(matrix.size() == 9 ? matrix : vector),
                      {translation[0], translation[1], translation[2]}, out.camera, where));
  FOURDVT_TRY(checkCameraNumbers(out.camera, where));
  return out;
}

}  // namespace

Result<ImportedCalibration> parseEasyMocap(const std::string& intri, const std::string& extri,
                                           const std::string& path) {
  FOURDVT_ASSIGN(const Storage lenses, Storage::open(intri, path + "/intri.yml"));
  FOURDVT_ASSIGN(const Storage poses, Storage::open(extri, path + "/extri.yml"));
  ImportedCalibration out{"EasyMocap", path, {}, 1, WorldAxis::Z, {}, {}};
  for (const std::string& name : poses.texts({"names"})) {
    FOURDVT_ASSIGN(out.cameras.emplace_back(), easyMocapCamera(lenses, poses, name, path));
  }
  if (!out.cameras.empty()) return out;
  return Error{ErrorId::FileUnreadable,
               path + "/extri.yml: no list \"names\" of cameras; export the calibration again"};
}

}  // namespace fourdvt::capture
