// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "capture/camera_names.h"
#include "capture/import/camera_numbers.h"
#include "capture/import/readers.h"
#include "capture/text.h"

namespace fourdvt::capture {

Result<ImportedCalibration> parseMiddlebury(const std::string& text, const std::string& path) {
  TextLines lines(text);
  std::string_view line;
  Fields head(lines.next(line) ? line : std::string_view());
  const auto count = head.number<uint32_t>();
  if (!head.problem().empty() || !head.rest().empty()) {
    return Error{ErrorId::FileUnreadable,
                 path + ":1: must be the count of cameras and nothing else; export the calibration again"};
  }
  std::vector<ListedPicture> pictures;
  while (lines.next(line)) {
    const std::string where = atLine(path, lines.number()), camera = where.substr(0, where.size() - 2);
    Fields fields(line);
    ListedPicture picture{{}, std::string(fields.word()), where};
    std::array<double, 21> n{};
    for (double& value : n) value = fields.number<double>();
    if (!fields.problem().empty() || !fields.rest().empty()) {
      return badCalibration(camera, "must be a picture's name and 21 numbers (K, R and t)" +
                                        (fields.problem().empty() ? "" : ", but " + fields.problem()));
    }
    FOURDVT_TRY(setCameraMatrix(std::span(n).first(9), kFirstPixelAtZero, picture.camera, camera));
    FOURDVT_TRY(setPose(rowByRow(std::span(n).subspan(9, 9)), {n[18], n[19], n[20]}, picture.camera, camera));
    FOURDVT_TRY(checkCameraNumbers(picture.camera, camera));
    pictures.push_back(std::move(picture));
  }
  if (pictures.size() != count || pictures.empty()) {
    return badCalibration(path, "its first line counts " + std::to_string(count) + " cameras, but it has " +
                                    std::to_string(pictures.size()));
  }
  FOURDVT_ASSIGN(const auto cameras, camerasOfPictures(pictures));
  ImportedCalibration out{"Middlebury", path, {}, {}, {}, {}, {}};
  addListed(cameras, out);
  return out;
}

}  // namespace fourdvt::capture
