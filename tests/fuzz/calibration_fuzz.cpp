// SPDX-License-Identifier: Apache-2.0
// Calibrations of other programs: the first byte selects the reader, the rest is the file. A form feed separates
// EasyMocap's two files, and COLMAP's rigs and frames.
#include <cmath>
#include <cstdlib>

#include "capture/colmap_model.h"
#include "capture/import/csv.h"
#include "capture/import/readers.h"

namespace {

using namespace fourdvt;
using namespace fourdvt::capture;

// Checks that a message names the file, and that an accepted camera has finite numbers and a rotation.
template <class T>
bool named(const Result<T>& result) {
  if (!result.ok() && !result.error().message.starts_with("fuzz")) std::abort();
  return result.ok();
}

void check(ImportedCamera camera) {
  PinholeCamera& pinhole = camera.camera.pinhole;
  if (pinhole.width == 0) pinhole.width = 640, pinhole.height = 480;
  if (camera.relative) setLens(*camera.relative, pinhole);
  const double determinant = glm::determinant(pinhole.cam_from_world);
  if (!(std::abs(determinant - 1) < 1e-6) || !(pinhole.fx > 0) || !std::isfinite(pinhole.cx)) std::abort();
}

void check(const Result<ImportedCalibration>& read) {
  if (!named(read)) return;
  for (const ImportedCamera& camera : read.value().cameras) check(camera);
}

void check(const Result<ImportedCamera>& read) {
  if (named(read)) check(read.value());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size == 0) return 0;
  const std::string text(reinterpret_cast<const char*>(data) + 1, size - 1);
  const size_t split = std::min(text.find('\f'), text.size());
  const std::string first = text.substr(0, split), second = split < text.size() ? text.substr(split + 1) : "";
  switch (data[0]) {
    case 'q':
      check(parseQualisys(text, "fuzz"));
      break;
    case 'o':
      check(parseOpenCvCamera(text, "cam", "fuzz"));
      break;
    case 'n':
      check(parseNerfstudio(text, "fuzz"));
      break;
    case 'e':
      check(parseEasyMocap(first, second, "fuzz"));
      break;
    case 'a':
      check(parseActorsHq(text, "fuzz"));
      break;
    case 't':
      check(parseToml(text, "fuzz"));
      break;
    case 'p':
      check(parseProjection(text, "cam", "fuzz"));
      break;
    case 'm':
      check(parseMiddlebury(text, "fuzz"));
      break;
    case 's':
      check(parseMetashape(text, "fuzz"));
      break;
    case 'r':
      check(parseRealityCaptureCsv(text, "fuzz"));
      break;
    case 'x':
      check(parseRealityCaptureXmp(text, "cam", "fuzz"));
      break;
    case 'f':
      named(parseRigsText(first, second, "fuzz"));
      break;
    case 'b':
      named(parseRigsBinary(first, second, "fuzz"));
      break;
    default:
      break;
  }
  return 0;
}
