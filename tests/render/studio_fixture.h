// SPDX-License-Identifier: Apache-2.0
// Gives each test a folder for its captures, small options, and the bytes of a folder's files.
#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "gl_fixture.h"
#include "lab/studio/studio.h"

namespace fourdvt::studio {

namespace fs = std::filesystem;

inline std::map<std::string, std::string> filesOf(const std::string& folder) {
  std::map<std::string, std::string> out;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    std::stringstream bytes;
    bytes << std::ifstream(entry.path(), std::ios::binary).rdbuf();
    out[fs::relative(entry.path(), folder).string()] = bytes.str();
  }
  return out;
}

class StudioTest : public fourdvt::testing::GlFixture {
 protected:
  void SetUp() override {
    GlFixture::SetUp();
    folder_ = ::testing::TempDir() + "/fourdvt_studio_" +
              ::testing::UnitTest::GetInstance()->current_test_info()->name() + "_" + std::to_string(::getpid());
    fs::create_directories(folder_);
  }
  void TearDown() override {
    fs::remove_all(folder_);
    GlFixture::TearDown();
  }

  // Small pictures at 5 frames a second: 6 and 4 frames.
  StudioOptions small(const std::string& name) const {
    StudioOptions o;
    o.folder = folder_ + "/" + name;
    o.cameras = 3;
    o.width = 96;
    o.height = 128;
    o.fps = 5;
    o.test_every = 2;
    o.truth_at = {0, 0.5, 1};
    o.truth_phases = 2;
    o.truth_ring = 1;
    o.images = true;
    return o;
  }
  Result<StudioReport> run(const StudioOptions& options) { return runStudio(options, {device.get(), {}, nullptr}); }

  std::string folder_;
};

}  // namespace fourdvt::studio
