// SPDX-License-Identifier: Apache-2.0
// OpenCV's FileStorage, one file per camera. World to camera, as returned by solvePnP.
#include "base/text.h"
#include "capture/import/camera_numbers.h"
#include "capture/import/readers.h"
#include "capture/import/storage.h"

namespace fourdvt::capture {
namespace {

const std::vector<std::string> kMatrix{
    "CameraIntrinsicMatrix", "CameraMatrix", "camera_matrix", "Camera_Matrix", "cameraMatrix", "intrinsic", "K", "M"};
const std::vector<std::string> kCoefficients{"DistortionCoeffs",
                                             "distortion_coefficients",
                                             "Distortion_Coefficients",
                                             "dist_coeffs",
                                             "distCoeffs",
                                             "distortion",
                                             "dist",
                                             "D"};
const std::vector<std::string> kRotation{"CameraRotationVecs", "Rotation", "rotation", "rvec", "R"};
const std::vector<std::string> kTranslation{"CameraTranslationVecs", "Translation", "translation", "tvec", "T"};
const std::vector<std::string> kWidth{"image_width", "image_Width", "width"};
const std::vector<std::string> kHeight{"image_height", "image_Height", "height"};
const std::vector<std::string> kSize{"image_size", "imageSize", "size"};

constexpr size_t kMaxCoefficients = 14;

bool saysFisheye(const Storage& storage) {
  const std::string model = storage.text({"distortion_model", "model"});
  const auto flag = storage.numbers({"fisheye_model", "fisheye"});
  return model == "fisheye" || model == "equidistant" || (!flag.empty() && flag[0] != 0);
}

void setStoredSize(const Storage& storage, PinholeCamera& camera) {
  auto size = storage.numbers(kSize);
  if (size.size() != 2) {
    size = storage.numbers(kWidth);
    const auto height = storage.numbers(kHeight);
    size.insert(size.end(), height.begin(), height.end());
  }
  if (size.size() != 2) return;
  const auto side = [](double pixels) { return pixels >= 0 && pixels < 1e6 ? static_cast<int>(pixels) : -1; };
  camera.width = side(size[0]);
  camera.height = side(size[1]);
}

Error lacks(const Storage& storage, const std::string& where, const char* what, const std::vector<std::string>& names,
            size_t wanted) {
  return {ErrorId::CameraPose,
          where + ": no " + what + storage.problem(names, wanted) + "; its node must be called " + joined(names)};
}

}  // namespace

Result<ImportedCamera> parseOpenCvCamera(const std::string& text, const std::string& name, const std::string& path) {
  FOURDVT_ASSIGN(const Storage storage, Storage::open(text, path));
  const auto matrix = storage.numbers(kMatrix), rotation = storage.numbers(kRotation);
  const auto translation = storage.numbers(kTranslation);
  if (matrix.size() != 9) return lacks(storage, path, "camera matrix of nine numbers", kMatrix, 9);
  if (rotation.size() != 3 && rotation.size() != 9)
    return lacks(storage, path, "rotation (a vector of three numbers or a matrix of nine)", kRotation, 9);
  if (translation.size() != 3) return lacks(storage, path, "translation of three numbers", kTranslation, 3);
  const auto coefficients = storage.numbers(kCoefficients);
  if (storage.has(kCoefficients) && coefficients.empty())
    return lacks(storage, path, "list of numbers as distortion", kCoefficients, kMaxCoefficients);
  ImportedCamera out;
  out.camera.pinhole.name = name;
  setStoredSize(storage, out.camera.pinhole);
  FOURDVT_ASSIGN(out.camera.distortion, distortionOf(coefficients, saysFisheye(storage), path));
  FOURDVT_TRY(setCameraMatrix(matrix, kFirstPixelAtZero, out.camera, path));
  FOURDVT_TRY(setPose(rotationOfNumbers(rotation), {translation[0], translation[1], translation[2]}, out.camera, path));
  FOURDVT_TRY(checkCameraNumbers(out.camera, path));
  return out;
}

}  // namespace fourdvt::capture
