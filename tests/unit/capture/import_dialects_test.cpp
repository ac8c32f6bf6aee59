// SPDX-License-Identifier: Apache-2.0
// Dialects of calibrations as people bring them: a point of the world comes to the pixel of the format's own formula.
#include "capture/import/import_capture.h"
#include "capture/pictures.h"
#include "import_fixture.h"

namespace fourdvt::capture {
namespace {

std::string spaced(std::initializer_list<double> values, const char* between = " ") {
  std::string out;
  for (const double value : values) {
    char text[40];
    std::snprintf(text, sizeof text, "%s%.17g", out.empty() ? "" : between, value);
    out += text;
  }
  return out;
}

const Vector kAxis{0.3, -0.2, 0.1}, kPlace{0.05, -0.1, 3};  // world to camera

Vector seenByDialect(const Vector& point) { return plus(times(rodrigues(kAxis), point), kPlace); }

// Camera to world, row by row, 4 columns; the axes' signs as the format has them.
std::string cameraToWorld(double y_and_z, int rows, const char* between) {
  const Rows back = transposed(rodrigues(kAxis));
  const Vector centre = times(back, {-kPlace[0], -kPlace[1], -kPlace[2]});
  std::string out;
  for (int i = 0; i < 3; ++i)
    out += (i ? between : "") +
           spaced({back[3 * i], y_and_z * back[3 * i + 1], y_and_z * back[3 * i + 2], centre[i]}, between);
  return rows == 4 ? out + between + "0" + between + "0" + between + "0" + between + "1" : out;
}

std::string frame(const std::string& path, const std::string& more = "") {
  const std::string numbers = cameraToWorld(-1, 3, ",");
  std::string rows;
  size_t at = 0;
  for (int i = 0; i < 12; ++i) {
    const size_t end = std::min(numbers.find(',', at), numbers.size());
    rows += (i % 4 == 0 ? (i ? "],[" : "[") : ",") + numbers.substr(at, end - at);
    at = end + 1;
  }
  return "{\"file_path\": \"" + path + "\", " + more + "\"transform_matrix\": [" + rows + "]]}";
}

TEST(DialectNerfstudio, AnAngleWaitsForTheSizeOfPictures) {
  auto read = parseNerfstudio("{\"camera_angle_x\": 1.2, \"frames\": [" + frame("./train/r_0") + "]}", "t.json");
  ASSERT_TRUE(read.ok()) << read.error().message;
  ImportedCamera camera = read.value().cameras[0];
  EXPECT_EQ(camera.camera.pinhole.name, "r_0");
  EXPECT_EQ(camera.camera.pinhole.width, 0);
  ASSERT_TRUE(camera.relative.has_value());
  camera.camera.pinhole.width = 640, camera.camera.pinhole.height = 480;
  setLens(*camera.relative, camera.camera.pinhole);
  const double focal = 320 / std::tan(0.6);
  expectImages(camera, {focal, focal, 320, 240}, 0, seenByDialect);
  for (const char* angle : {"0", "-1", "4", "1e9"})
    expectError(parseNerfstudio(
                    std::string("{\"camera_angle_x\": ") + angle + ", \"frames\": [" + frame("a.png") + "]}", "t.json"),
                ErrorId::CameraPose, "t.json: frame 0: camera_angle_x");
  expectError(parseNerfstudio("{\"frames\": [" + frame("a.png") + "]}", "t.json"), ErrorId::CameraPose, "no fl_x");
}

TEST(DialectNerfstudio, KeysThatAreNotReadAreNamedOnce) {
  auto read = parseNerfstudio("{\"camera_angle_x\": 1.2, \"aabb_scale\": 4, \"applied_scale\": 2, \"frames\": [" +
                                  frame("a.png", "\"time\": 0, \"sharpness\": 3, ") + "]}",
                              "t.json");
  ASSERT_TRUE(read.ok()) << read.error().message;
  ASSERT_EQ(read.value().warnings.size(), 1u);
  EXPECT_NE(read.value().warnings[0].find("t.json: not read: applied_scale, time"), std::string::npos);
  ASSERT_EQ(read.value().details.size(), 1u);
  EXPECT_NE(read.value().details[0].find("aabb_scale, sharpness"), std::string::npos);
}

// `width` x 12 pixels, all of one grey.
Image plain(int level, int width = 16, int channels = 3) {
  return Image(width, 12, channels, static_cast<uint8_t>(level));
}

struct Imported : TempFolder {
  Imported() {
    options.source = *this / "in";
    options.folder = *this / "out";
    options.fps = 25;
  }
  Result<ImportSummary> run() {
    remove("out");
    return importCapture(options, platform::openVideoFile);
  }
  bool has(const std::string& file) const { return std::filesystem::exists(options.folder + "/" + file); }
  ImportOptions options;
};

bool says(const std::vector<std::string>& lines, const std::string& words) {
  return std::any_of(lines.begin(), lines.end(), [&](const auto& line) { return line.find(words) != line.npos; });
}

TEST(DialectNerfstudio, MattesAreWhereMaskPathNamesThem) {
  Imported files;
  std::string shifted = frame("cam01/0.png", "\"mask_path\": \"seg/cam01_fg/0.png\", ");
  shifted.replace(shifted.rfind("],["), 3, "],[");
  files.write("in/transforms.json", "{\"camera_angle_x\": 1.2, \"frames\": [" +
                                        frame("cam00/0.png", "\"mask_path\": \"seg\\\\cam00_fg\\\\0.png\", ") + ", " +
                                        shifted + "]}");
  for (const char* name : {"cam00", "cam01"}) {
    for (const char* number : {"0", "1"}) {
      files.write(std::string("in/") + name + "/" + number + ".png", plain(50));
      files.write(std::string("in/seg/") + name + "_fg/" + number + ".png", plain(255, 16, 1));
    }
  }
  auto summary = files.run();
  ASSERT_TRUE(summary.ok()) << summary.error().message;
  EXPECT_TRUE(says(summary.value().done, "2 frames, 2 cameras with mattes"));
  EXPECT_TRUE(files.has("take/mask01/000001.png"));
  auto capture = openCapture(files.options.folder, platform::openVideoFile, {}, MeshNeed::Nothing);
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  EXPECT_NEAR(capture.value().cameras[0].pinhole.fx, 8 / std::tan(0.6), 1e-6) << "by the size of the pictures";
}

TEST(DialectColmap, RigFoldersMasksAndBlanks) {
  Imported files;
  files.options.up = WorldAxis::Y;
  files.write("in/sparse/0/cameras.txt", std::string("1 PINHOLE 16 12 20 20 8 6\n"));
  files.write(
      "in/sparse/0/images.txt",
      std::string("1 1 0 0 0 0 0 3 1 rig 1/cam 00/image0001.jpg\n\n2 1 0 0 0 1 0 3 1 rig 1/cam 01/image0001.jpg\n\n"
                  "3 1 0 0 0 0 0 3 1 rig 1/cam 00/image0002.jpg\n\n"));
  for (const char* name : {"cam 00", "cam 01"}) {
    for (const char* number : {"1", "2"}) {
      const std::string picture = std::string("rig 1/") + name + "/image000" + number + ".jpg";
      files.write("in/images/" + picture, plain(50));
      files.write("in/masks/" + picture + ".png", plain(255, 16, 1));
    }
  }
  auto summary = files.run();
  ASSERT_TRUE(summary.ok()) << summary.error().message;
  EXPECT_TRUE(says(summary.value().done, "2 frames, 2 cameras with mattes"));
  EXPECT_TRUE(says(summary.value().done, "\"cam 00\" is cam_00"));
  EXPECT_TRUE(files.has("take/cam_01/000001.jpg"));
  EXPECT_TRUE(files.has("take/" + matteStem("cam_01") + "/000001.png"));
}

TEST(DialectColmap, MasksOfStills) {
  Imported files;
  files.write("in/cameras.txt", std::string("1 PINHOLE 16 12 20 20 8 6\n"));
  files.write("in/images.txt", std::string("1 1 0 0 0 0 0 3 1 cam00.jpg\n\n2 1 0 0 0 1 0 3 1 cam01.jpg\n\n"));
  for (const char* name : {"cam00", "cam01"}) {
    files.write(std::string("in/images/") + name + ".jpg", plain(50));
    files.write(std::string("in/masks/") + name + ".jpg.png", plain(255, 16, 1));
  }
  auto summary = files.run();
  ASSERT_TRUE(summary.ok()) << summary.error().message;
  EXPECT_TRUE(says(summary.value().done, "1 frames, 2 cameras with mattes"));
}

std::string table(const std::string& head, const std::string& more = "") {
  return head + "\nsize = [16, 12]\nmatrix = [[20.0, 0.0, 8.0], [0.0, 20.0, 6.0], [0.0, 0.0, 1.0]]\n" +
         "distortions = [0.0, 0.0, 0.0, 0.0, 0.0]\n" + more;
}
const char* const kPosed = "rotation = [0.0, 0.1, 0.0]\ntranslation = [0.0, 0.0, 3.0]\n";

TEST(DialectToml, CaliscopesOwnTablesAndItsClips) {
  Imported files;
  files.write("in/camera_array.toml", table("[cameras.0]\nport = 0\nrotation_count = 1\nerror = 0.2", kPosed) +
                                          table("[cameras.1]\ncam_id = 1", kPosed) + table("[cameras.2]") +
                                          table("[cameras.3]\nignore = true", kPosed));
  files.write("in/port_0.png", plain(50));
  files.write("in/cam_1.png", plain(50));
  auto summary = files.run();
  ASSERT_TRUE(summary.ok()) << summary.error().message;
  EXPECT_TRUE(says(summary.value().warnings, "are left out: cameras.2, cameras.3"));
  EXPECT_TRUE(says(summary.value().details, "error, rotation_count"));
  EXPECT_TRUE(files.has("take/port_0/000000.png") && files.has("take/cam_1/000000.png"));
}

TEST(DialectToml, Pose2SimsNamesAndFolders) {
  Imported files;
  files.write("in/Config.toml", std::string("[project]\nframe_rate = 60\n"));
  files.write("in/calibration/Calib_scene.toml", table("[int_cam01_img]\nname = \"int_cam01_img\"", kPosed) +
                                                     table("[int_cam02_img]\nname = \"int_cam02_img\"", kPosed) +
                                                     "[metadata]\nadjusted = false\n");
  files.write("in/videos/cam01.png", plain(50));
  files.write("in/videos/int_cam02_img.png", plain(50));
  auto summary = files.run();
  ASSERT_TRUE(summary.ok()) << summary.error().message;
  EXPECT_TRUE(files.has("take/cam01/000000.png") && files.has("take/int_cam02_img/000000.png"));
}

}  // namespace
}  // namespace fourdvt::capture
