// SPDX-License-Identifier: Apache-2.0
#include "capture/pictures.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "capture/mesh_sequence.h"
#include "capture/still_marks.h"
#include "capture/text.h"
#include "capture/upright.h"

namespace fourdvt::capture {

std::vector<std::filesystem::path> sortedEntries(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> out;
  std::error_code failed;
  for (std::filesystem::directory_iterator it(folder, failed), end; !failed && it != end; it.increment(failed))
    out.push_back(it->path());
  std::sort(out.begin(), out.end());
  return out;
}

bool isFile(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored);
}

bool isFolder(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::is_directory(path, ignored);
}

std::optional<PicturePlace> findPictures(const std::string& folder, const std::string& stem) {
  const std::string base = folder + "/" + stem;
  for (const char* extension : {".mp4", ".mkv", ".webm", ".mov", ".avi"}) {
    if (isFile(base + extension)) return PicturePlace{base + extension, false};
  }
  for (const char* extension : {".png", ".jpg"}) {
    if (isFile(base + "/000000" + extension)) return PicturePlace{base + "/%06d" + extension, true};
  }
  return std::nullopt;
}

Result<PicturePlace> colourPlace(const CaptureSequence& sequence, const CaptureCamera& camera) {
  if (auto place = findPictures(sequence.folder, camera.pinhole.name)) return *place;
  return Error{ErrorId::CameraMissingVideo, sequence.folder + "/" + camera.pinhole.name +
                                                ".mp4: no video (.mp4, .mkv, .webm, .mov, .avi) and no folder with " +
                                                "000000.png; add it, or remove the camera from images.txt"};
}

std::string matteStem(const std::string& camera_name) {
  return "mask" + (camera_name.starts_with("cam") ? camera_name.substr(3) : camera_name);
}

namespace {

// Decodes a matte to 8-bit grey: its alpha unless that is opaque throughout, as background removers write it, else
// grey.
cv::Mat decodeMatte(const cv::Mat& encoded) {
  cv::Mat decoded = cv::imdecode(encoded, cv::IMREAD_UNCHANGED);
  if (decoded.channels() == 1 && decoded.depth() == CV_8U) return decoded;
  if (decoded.channels() == 4) {
    cv::Mat alpha;
    cv::extractChannel(decoded, alpha, 3);
    const double opaque = alpha.depth() == CV_16U ? 65535 : 255;
    if (cv::countNonZero(alpha != opaque) > 0) {
      alpha.convertTo(alpha, CV_8U, 255 / opaque);
      return alpha;
    }
  }
  double most = 0;
  if (decoded.channels() == 1) cv::minMaxLoc(decoded, nullptr, &most);
  if (decoded.depth() == CV_16U && most > 0 && most < 256) {  // 8-bit values in 16 bits
    decoded.convertTo(decoded, CV_8U);
    return decoded;
  }
  return cv::imdecode(encoded, cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION);
}

constexpr uint32_t kMaxPlates = 100;  // more plates hardly improve the mean, and each takes memory while it is read

// Paths of one file, or of the numbered ones; the expected path if there are none.
std::vector<std::string> platePaths(const std::string& stem) {
  if (isFile(stem + ".png")) return {stem + ".png"};
  for (const char* extension : {".png", ".jpg"}) {
    std::vector<std::string> paths;
    while (paths.size() < kMaxPlates) {
      const std::string path = framePath(stem + "/%06d" + extension, static_cast<uint32_t>(paths.size()));
      if (!isFile(path)) break;
      paths.push_back(path);
    }
    if (!paths.empty()) return paths;
  }
  return {stem + ".png"};
}

}  // namespace

Result<Image> readPicture(const std::string& path, int channels, PictureMarks* marks) {
  const auto bytes = readText(path);
  if (!bytes) return Error{ErrorId::FileMissing, path + ": picture cannot be read; check that it is there"};
  const Error bad{ErrorId::FileUnreadable, path + ": not a readable picture; export it as 8-bit PNG again"};
  if (bytes->empty()) return bad;
  try {
    const StillMarks found = stillMarks(*bytes);
    if (marks) *marks = found.marks;
    const cv::Mat encoded(1, static_cast<int>(bytes->size()), CV_8U, const_cast<char*>(bytes->data()));
    const int mode = channels == 4 ? int(cv::IMREAD_UNCHANGED) : cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION;
    cv::Mat decoded = channels == 1 ? decodeMatte(encoded) : cv::imdecode(encoded, mode);
    if (decoded.empty()) return bad;
    if (channels == 4) {
      if (decoded.depth() == CV_16U) decoded.convertTo(decoded, CV_8U, 255.0 / 65535);
      if (decoded.depth() != CV_8U) return bad;
      if (decoded.channels() != 4)
        cv::cvtColor(decoded, decoded, decoded.channels() == 1 ? cv::COLOR_GRAY2BGRA : cv::COLOR_BGR2BGRA);
    }
    Image image(decoded.cols, decoded.rows, channels);
    cv::Mat out(decoded.rows, decoded.cols, CV_8UC(channels), image.pixels.data());
    if (channels == 1)
      decoded.copyTo(out);
    else if (channels == 4)
      cv::cvtColor(decoded, out, cv::COLOR_BGRA2RGBA);
    else
      cv::cvtColor(decoded, out, cv::COLOR_BGR2RGB);
    if (channels != 1) toSrgb(found.profile, image);
    return image;
  } catch (const cv::Exception&) {
    return bad;
  }
}

Result<Image> readCalibrated(const std::string& path, int channels, const CaptureCamera& camera) {
  PictureMarks marks;
  FOURDVT_ASSIGN(auto picture, readPicture(path, channels, &marks));
  return asCalibrated(std::move(picture), marks, camera, path);
}

NeededPictures::NeededPictures(const CaptureSequence& sequence, const std::string& camera) {
  for (uint32_t frame = 0; frame < sequence.frame_count; ++frame) numbers.push_back(sequence.pictureOf(camera, frame));
  count = 1 + *std::max_element(numbers.begin(), numbers.end());
  as_declared = count == sequence.frame_count;
}

Error NeededPictures::tooFew(const std::string& path, const std::string& has) const {
  const std::string why = as_declared
                              ? " but capture.json says "
                              : " but \"frames\" with \"first_frame\" and \"offset_frames\" in capture.json asks for ";
  return {ErrorId::VideoTooShort,
          path + ": has " + has + why + std::to_string(count) + "; correct \"frames\" or export the video again"};
}

Result<PictureStream> PictureStream::open(const PicturePlace& place, const CaptureSequence& sequence,
                                          const CaptureCamera& camera, int channels, const OpenVideo& open_video,
                                          bool check_files) {
  PictureStream stream(place, camera, NeededPictures(sequence, camera.pinhole.name));
  stream.open_video_ = open_video;
  stream.channels_ = channels;
  if (place.numbered) {
    if (check_files) FOURDVT_TRY(stream.checkFiles());
    return stream;
  }
  FOURDVT_ASSIGN(stream.video_, open_video(place.path, channels));
  return stream;
}

Status PictureStream::checkFiles() const {
  for (const uint32_t number : needed_.numbers) {
    const std::string file = framePath(place_.path, number);
    if (isFile(file)) continue;
    return Error{ErrorId::VideoTooShort, file + ": missing; the sequence has " +
                                             std::to_string(needed_.numbers.size()) +
                                             " frames by capture.json: correct \"frames\" or export the picture"};
  }
  return {};
}

std::string PictureStream::pathOf(uint32_t frame) const {
  return place_.numbered ? framePath(place_.path, frame < needed_.numbers.size() ? needed_.numbers[frame] : frame)
                         : place_.path;
}

Result<Image> PictureStream::read(uint32_t frame) {
  const uint32_t number = frame < needed_.numbers.size() ? needed_.numbers[frame] : frame;
  if (place_.numbered) return readCalibrated(framePath(place_.path, number), channels_, camera_);
  if (number < next_) {
    FOURDVT_ASSIGN(video_, open_video_(place_.path, channels_));
    next_ = 0;
  }
  FOURDVT_TRY(video_->skip(number - next_));
  FOURDVT_ASSIGN(auto picture, video_->next());
  if (!picture)
    return needed_.tooFew(place_.path, (number == next_ ? "" : "at most ") + std::to_string(number) + " frames");
  next_ = number + 1;
  return asCalibrated(std::move(*picture), video_->marks(), camera_, place_.path);
}

Status checkSize(const Image& image, const CaptureCamera& camera, const std::string& path) {
  const PinholeCamera& p = camera.pinhole;
  if (image.width == p.width && image.height == p.height) return {};
  auto size = [](int w, int h) { return std::to_string(w) + "x" + std::to_string(h); };
  return Error{ErrorId::FrameSize, path + ": picture of " + size(image.width, image.height) + " pixels, but camera \"" +
                                       p.name + "\" is calibrated for " + size(p.width, p.height) +
                                       "; use the pictures that were calibrated"};
}

Result<Plates> readPlates(const Capture& capture, const CaptureCamera& camera, const std::string& otherwise) {
  Plates out;
  for (const std::string& path : platePaths(capture.background_folder + "/" + camera.pinhole.name)) {
    if (out.path.empty()) out.path = path;
    auto plate = readCalibrated(path, 3, camera);
    if (!plate.ok() && plate.error().id == ErrorId::FrameSize) return plate.error();
    if (!plate.ok()) return Error{plate.error().id, path + ": " + otherwise};
    out.pictures.push_back(plate.take());
  }
  return out;
}

}  // namespace fourdvt::capture
