// SPDX-License-Identifier: Apache-2.0
// A projection matrix P = K [R | t], up to scale: K is upper triangular with positive focal lengths.
#include <cmath>

#include "capture/import/camera_numbers.h"
#include "capture/import/readers.h"
#include "capture/text.h"

namespace fourdvt::capture {
namespace {

constexpr size_t kOfProjection = 12, kOfParts = 21;
constexpr size_t kMaxProjectionText = 4096;  // bytes

Error badProjection(const std::string& path, const std::string& what) {
  return {ErrorId::CameraPose, path + ": " + what + "; export the matrix again"};
}

struct Numbers {
  std::vector<double> values;
  std::string problem;  // first malformed number
  int line = 0;         // line of `problem`
};

// Parses numbers; skips a first word "CONTOUR".
Numbers numbersOf(std::string_view text) {
  Numbers out;
  if (text.size() > kMaxProjectionText) return {{}, "more than 4096 bytes", 1};
  TextLines lines(text, {.comment_behind = true});
  bool first = true;
  for (std::string_view line; lines.next(line);) {
    for (std::string_view word = takeWord(line); !word.empty(); word = takeWord(line)) {
      const auto value = toNumber<double>(word);
      if (value && std::isfinite(*value))
        out.values.push_back(*value);
      else if (!(first && word == "CONTOUR") && out.problem.empty())
        out.problem = numberProblem(word), out.line = lines.number();
      first = false;
    }
  }
  return out;
}

// Orthogonalises the rows of K R from the last to the first: r3 ∥ m3, r2 ∥ m2 − (m2·r3) r3, r1 the remainder.
Status decompose(const glm::dmat3& given, glm::dvec3 last, CaptureCamera& camera, const std::string& path) {
  glm::dmat3 rows = glm::transpose(given);  // rows[i]: row i
  const double scale = glm::length(rows[2]);
  const double sign = glm::determinant(given) < 0 ? -1 : 1;
  if (!(scale > 0) || !std::isfinite(scale)) return badProjection(path, "the last row of the matrix has no length");
  for (int i = 0; i < 3; ++i) rows[i] *= sign / scale;
  last *= sign / scale;
  const glm::dvec3 r3 = rows[2];
  const double cy = glm::dot(rows[1], r3);
  const glm::dvec3 of_y = rows[1] - cy * r3;
  const double fy = glm::length(of_y);
  const glm::dvec3 r2 = of_y / fy, r1 = glm::cross(r2, r3);
  const double fx = glm::dot(rows[0], r1), skew = glm::dot(rows[0], r2), cx = glm::dot(rows[0], r3);
  if (!(fy > 0) || !(fx > 0)) return badProjection(path, "the matrix is singular");
  const double k[] = {fx, std::abs(skew) < 1e-9 * fx ? 0 : skew, cx, 0, fy, cy, 0, 0, 1};
  FOURDVT_TRY(setCameraMatrix(k, kFirstPixelAtZero, camera, path));
  const glm::dvec3 t((last.x - skew * (last.y - cy * last.z) / fy - cx * last.z) / fx, (last.y - cy * last.z) / fy,
                     last.z);
  return setPose(glm::transpose(glm::dmat3(r1, r2, r3)), t, camera, path);
}

}  // namespace

bool looksLikeProjection(const std::string& text) {
  if (text.size() > kMaxProjectionText) return false;
  size_t words = 0, numbers = 0;
  TextLines lines(text, {.comment_behind = true});
  for (std::string_view line; lines.next(line);) {
    for (std::string_view word = takeWord(line); !word.empty(); word = takeWord(line)) {
      if (words == 0 && word == "CONTOUR") continue;
      ++words;
      numbers += toNumber<double>(word).has_value() || hasDecimalComma(word);
    }
  }
  return words == numbers && (words == kOfProjection || words == kOfParts);
}

Result<ImportedCamera> parseProjection(const std::string& text, const std::string& name, const std::string& path) {
  const Numbers read = numbersOf(text);
  if (!read.problem.empty()) return badProjection(path + ":" + std::to_string(read.line), read.problem);
  const std::vector<double>& n = read.values;
  ImportedCamera out;
  out.camera.pinhole.name = name;
  if (n.size() == kOfProjection) {
    const glm::dmat3 left({n[0], n[4], n[8]}, {n[1], n[5], n[9]}, {n[2], n[6], n[10]});
    FOURDVT_TRY(decompose(left, {n[3], n[7], n[11]}, out.camera, path));
  } else if (n.size() == kOfParts) {
    FOURDVT_TRY(setCameraMatrix(std::span(n).first(9), kFirstPixelAtZero, out.camera, path));
    FOURDVT_TRY(setPose(rowByRow(std::span(n).subspan(9, 9)), {n[18], n[19], n[20]}, out.camera, path));
  } else {
    return badProjection(path, "must hold 12 numbers (a projection matrix) or 21 (K, R and t)");
  }
  FOURDVT_TRY(checkCameraNumbers(out.camera, path));
  return out;
}

}  // namespace fourdvt::capture
