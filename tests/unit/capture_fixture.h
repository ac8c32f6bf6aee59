// SPDX-License-Identifier: Apache-2.0
// A small valid capture in a temporary folder, which a test then breaks in one place.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "capture/capture.h"
#include "matte_with.h"
#include "mattes/frame_reader.h"
#include "platform/ffmpeg_video.h"
#include "platform/files.h"

namespace fourdvt::capture {

inline const std::string kSample = std::string(FOURDVT_SOURCE_DIR) + "/site/sample/actor_a";

class TempFolder {
 public:
  TempFolder() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::path(::testing::TempDir()).parent_path().string() + "/fourdvt_" + test->test_suite_name() +
            "_" + test->name() + "_" + std::to_string(::getpid());
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~TempFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  const std::string& path() const { return path_; }
  std::string operator/(const std::string& name) const { return path_ + "/" + name; }

  void write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories(std::filesystem::path(*this / name).parent_path());
    std::ofstream(*this / name, std::ios::binary) << text;
  }
  void write(const std::string& name, const Image& image) const {
    std::filesystem::create_directories(std::filesystem::path(*this / name).parent_path());
    ASSERT_TRUE(platform::writeImage(*this / name, image).ok());
  }
  void remove(const std::string& name) const { std::filesystem::remove_all(*this / name); }

 private:
  std::string path_;
};

inline std::string numbered(int frame, const char* extension) {
  std::string digits = std::to_string(frame);
  return std::string(6 - digits.size(), '0') + digits + extension;
}

// Matte of all but the outermost pixels.
inline Image framedMatte(int width, int height) { return matteWith(255, width, height); }

// Unit quad at z = depth.
inline std::string quadObj(double depth) {
  std::string z = std::to_string(depth);
  return "v 0 0 " + z + "\nv 1 0 " + z + "\nv 1 1 " + z + "\nv 0 1 " + z +
         "\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n";
}

// Capture with two cameras of 16x12, three frames, mattes, one quad; picture k of camera c is grey 10 * k + c.
class SmallCapture : public TempFolder {
 public:
  static constexpr int kWidth = 16, kHeight = 12, kFrames = 3, kCameras = 2;

  SmallCapture() {
    write("capture.json", json());
    write("cameras/cameras.txt", std::string("# comment\n1 PINHOLE 16 12 20 20 8 6\n"));
    write("cameras/images.txt", std::string("1 1 0 0 0 0 0 3 1 cam00.png\n\n2 1 0 0 0 0.5 0 3 1 cam01.png\n\n"));
    for (int frame = 0; frame < kFrames; ++frame) {
      for (int camera = 0; camera < kCameras; ++camera) {
        const std::string number = std::to_string(camera);
        write("walk/cam0" + number + "/" + numbered(frame, ".png"), grey(10 * frame + camera));
        write("walk/mask0" + number + "/" + numbered(frame, ".png"), framedMatte(kWidth, kHeight));
      }
      write("walk/mesh/" + numbered(frame, ".obj"), quadObj(0.1 * frame));
    }
  }
  static Image grey(int level) { return Image(kWidth, kHeight, 3, static_cast<uint8_t>(level)); }
  static std::string json(const std::string& sequence_extra = "", const std::string& units = "metre") {
    return R"({"fps": 25, "units": ")" + units +
           R"(", "sequences": [{"name": "walk", "frames": 3, "loop": true, "root_velocity": [0, 0, 1.5])" +
           sequence_extra + "}]}";
  }
  Result<Capture> open() const { return mattes::openCapture(path(), platform::openVideoFile); }
};

// SmallCapture without meshes; a test adds files and lines to capture.json.
class BareCapture : public SmallCapture {
 public:
  explicit BareCapture(const std::string& topology = "per-frame", const std::string& sequence_extra = "",
                       const std::string& units = "metre") {
    remove("walk/mesh");
    declare(topology, sequence_extra, units);
  }
  void declare(const std::string& topology, const std::string& sequence_extra = "",
               const std::string& units = "metre") const {
    write("capture.json", "{\"topology\": \"" + topology + "\", " + json(sequence_extra, units).substr(1));
  }
  Result<Capture> openAs(MeshNeed need) const { return mattes::openCapture(path(), platform::openVideoFile, {}, need); }
};

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

// Expects an error with this ID whose message is one line and names the file.
template <class T>
void expectError(const Result<T>& result, ErrorId id, const std::string& file) {
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(errorName(result.error().id), std::string(errorName(id))) << result.error().message;
  EXPECT_NE(result.error().message.find(file), std::string::npos) << result.error().message;
  EXPECT_EQ(result.error().message.find('\n'), std::string::npos);
}

}  // namespace fourdvt::capture
