// SPDX-License-Identifier: Apache-2.0
// Dialects of calibrations in practice: a world point projects to the pixel of the format's own formula.
#include "capture/import/camera_numbers.h"
#include "capture/import/import_capture.h"
#include "capture/import/readers.h"
#include "capture/pictures.h"
#include "import_fixture.h"
#include "mattes/frame_reader.h"

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

// Camera to world, row by row, 4 columns; axis signs of the format.
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
Image plain(int level, int width = 16) { return Image(width, 12, 3, static_cast<uint8_t>(level)); }

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

bool anyContains(const std::vector<std::string>& lines, const std::string& words) {
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
      files.write(std::string("in/seg/") + name + "_fg/" + number + ".png", framedMatte(16, 12));
    }
  }
  auto summary = files.run();
  ASSERT_TRUE(summary.ok()) << summary.error().message;
  EXPECT_TRUE(anyContains(summary.value().done, "2 frames, 2 cameras with mattes"));
  EXPECT_TRUE(files.has("take/mask01/000001.png"));
  auto capture = mattes::openCapture(files.options.folder, platform::openVideoFile, {}, MeshNeed::Nothing);
  ASSERT_TRUE(capture.ok()) << capture.error().message;
  EXPECT_NEAR(capture.value().cameras[0].pinhole.fx, 8 / std::tan(0.6), 1e-6) << "by the size of the pictures";
}

TEST(DialectNerfstudio, MattesOfAllCamerasMayLieInOneFolder) {
  Imported files;
  files.write("in/transforms.json", "{\"camera_angle_x\": 1.2, \"frames\": [" +
                                        frame("pics/left.png", "\"mask_path\": \"alpha/left_a.png\", ") + ", " +
                                        frame("pics/right.png", "\"mask_path\": \"alpha/right_a.png\", ") + "]}");
  for (const char* name : {"left", "right"}) {
    files.write(std::string("in/pics/") + name + ".png", plain(50));
    files.write(std::string("in/alpha/") + name + "_a.png", framedMatte(16, 12));
  }
  auto summary = files.run();
  ASSERT_TRUE(summary.ok()) << summary.error().message;
  EXPECT_TRUE(anyContains(summary.value().done, "1 frames, 2 cameras with mattes"));
  EXPECT_FALSE(anyContains(summary.value().warnings, "alpha")) << "they are used";
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
      files.write("in/masks/" + picture + ".png", framedMatte(16, 12));
    }
  }
  auto summary = files.run();
  ASSERT_TRUE(summary.ok()) << summary.error().message;
  EXPECT_TRUE(anyContains(summary.value().done, "2 frames, 2 cameras with mattes"));
  EXPECT_TRUE(anyContains(summary.value().done, "\"cam 00\" is cam_00"));
  EXPECT_TRUE(files.has("take/cam_01/000001.jpg"));
  EXPECT_TRUE(files.has("take/" + matteStem("cam_01") + "/000001.png"));
}

TEST(DialectColmap, MasksOfStills) {
  Imported files;
  files.write("in/cameras.txt", std::string("1 PINHOLE 16 12 20 20 8 6\n"));
  files.write("in/images.txt", std::string("1 1 0 0 0 0 0 3 1 cam00.jpg\n\n2 1 0 0 0 1 0 3 1 cam01\n\n"));
  for (const char* name : {"cam00", "cam01"}) {
    files.write(std::string("in/images/") + name + ".jpg", plain(50));
    files.write(std::string("in/masks/") + name + ".jpg.png", framedMatte(16, 12));
  }
  auto summary = files.run();
  ASSERT_TRUE(summary.ok()) << summary.error().message;
  EXPECT_TRUE(anyContains(summary.value().done, "1 frames, 2 cameras with mattes"));
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
  EXPECT_TRUE(anyContains(summary.value().warnings, "are left out: cameras.2, cameras.3"));
  EXPECT_TRUE(anyContains(summary.value().details, "error, rotation_count"));
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

TEST(DialectMiddlebury, ListsPictures) {
  const Rows r = rodrigues(kAxis);
  std::string line = "500 2 320 0 510 240 0 0 1";
  for (const double value : r) line += " " + spaced({value});
  line += " " + spaced({kPlace[0], kPlace[1], kPlace[2]});
  const std::string text = "2\r\ndino0001.png " + line + "\r\ndino0002.png " + line + "5\r\n";
  auto read = parseMiddlebury(text, "dino_par.txt");
  ASSERT_TRUE(read.ok()) << read.error().message;
  ASSERT_EQ(read.value().cameras.size(), 2u);
  EXPECT_EQ(read.value().cameras[1].camera.pinhole.name, "dino0002");
  EXPECT_EQ(read.value().cameras[1].listed, "dino0002.png");
  expectImages(read.value().cameras[0], {500, 510, 320, 240, 2}, 0.5, seenByDialect);
  expectError(parseMiddlebury("3\na.png " + line + "\n", "d_par.txt"), ErrorId::CameraPose,
              "d_par.txt: its first line counts 3");
  expectError(parseMiddlebury("1\na.png 1,5 " + line + "\n", "d_par.txt"), ErrorId::CameraPose, "d_par.txt:2: ");
  expectError(parseMiddlebury("1\na.png " + line + " 7\n", "d_par.txt"), ErrorId::CameraPose, "21 numbers");
  expectError(parseMiddlebury("a.png\n", "d_par.txt"), ErrorId::FileUnreadable, "d_par.txt:1");
  for (size_t kept = 0; kept + 8 < text.size(); kept += 5)
    EXPECT_FALSE(parseMiddlebury(text.substr(0, kept), "d_par.txt").ok()) << kept;
}

std::string metashape(const std::string& type, const std::string& lens, const std::string& world = "") {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<document version=\"1.5.0\">\n<chunk label=\"Chunk 1\">\n"
         "<sensors><sensor id=\"0\" type=\"" +
         type +
         "\"><resolution width=\"640\" height=\"480\"/>\n"
         "<calibration type=\"" +
         type + "\" class=\"adjusted\"><resolution width=\"640\" height=\"480\"/>\n" + lens +
         "<covariance/></calibration></sensor></sensors>\n" + world +
         "<cameras><camera id=\"0\" sensor_id=\"0\" label=\"cam00.jpg\"><transform>" + cameraToWorld(1, 4, " ") +
         "</transform></camera>\n<camera id=\"1\" sensor_id=\"0\" "
         "label=\"cam01.jpg\"/></cameras>\n</chunk></document>\n";
}

const char* const kMetashapeLens =
    "<f>500</f><cx>3</cx><cy>-2</cy><b1>10</b1><b2>1</b2><k1>-0.1</k1><k2>0.02</k2><k3>0.003</k3><p1>0.004</"
    "p1><p2>-0.002</p2>";

TEST(DialectMetashape, FramesAndFisheyes) {
  std::string without_size = metashape("frame", kMetashapeLens);
  while (without_size.find("<resolution") != std::string::npos)
    without_size.replace(without_size.find("<resolution"), 11, "<size");
  expectError(parseMetashape(without_size, "c.xml"), ErrorId::CameraModel, "c.xml");
  auto read = parseMetashape(metashape("frame", kMetashapeLens), "c.xml");
  ASSERT_TRUE(read.ok()) << read.error().message;
  ASSERT_EQ(read.value().cameras.size(), 1u);
  EXPECT_EQ(read.value().cameras[0].camera.pinhole.name, "cam00");
  EXPECT_TRUE(anyContains(read.value().warnings, "left out: cam01.jpg"));
  EXPECT_FALSE(read.value().up.has_value());
  // Its P1 is OpenCV's p2.
  expectImages(read.value().cameras[0], {510, 500, 323, 238, 1, {-0.1, 0.02, -0.002, 0.004, 0.003}}, 0, seenByDialect);
  auto fisheye = parseMetashape(
      metashape("fisheye", "<f>500</f><k1>-0.1</k1><k2>0.02</k2><k3>0.003</k3><k4>-0.001</k4>"), "c.xml");
  ASSERT_TRUE(fisheye.ok()) << fisheye.error().message;
  expectImages(fisheye.value().cameras[0], {500, 500, 320, 240, 0, {-0.1, 0.02, 0.003, -0.001}, true}, 0,
               seenByDialect);
}

TEST(DialectMetashape, TheChunkIsScaledAndTurned) {
  const std::string world =
      "<transform><rotation>0 -1 0 1 0 0 0 0 1</rotation><translation>5 6 "
      "7</translation><scale>2</scale></transform>\n";
  auto read = parseMetashape(metashape("frame", "<f>500</f>", world), "c.xml");
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(read.value().metres_per_unit, 1);
  EXPECT_EQ(read.value().up, WorldAxis::Z);
  // Back from metres into the chunk's own world.
  const auto in_camera = [](const Vector& p) {
    const Vector own{(p[1] - 6) / 2, -(p[0] - 5) / 2, (p[2] - 7) / 2};
    return seenByDialect(own);
  };
  for (const Vector& own : kPoints) {
    const Vector point{5 - 2 * own[1], 6 + 2 * own[0], 7 + 2 * own[2]};
    const glm::dvec3 got = read.value().cameras[0].camera.pinhole.project({point[0], point[1], point[2]});
    const glm::dvec2 expected = throughLens({500, 500, 320, 240}, in_camera(point));
    EXPECT_NEAR(got.x, expected.x, 1e-6);
    EXPECT_NEAR(got.y, expected.y, 1e-6);
  }
  auto earth =
      parseMetashape(metashape("frame", "<f>500</f>", world + "<reference>GEOGCS[\"WGS 84\"]</reference>"), "c.xml");
  ASSERT_TRUE(earth.ok()) << earth.error().message;
  EXPECT_TRUE(anyContains(earth.value().warnings, "only the scale"));
  EXPECT_FALSE(earth.value().up.has_value());
}

TEST(DialectMetashape, WhatIsWrongIsNamed) {
  const std::string good = metashape("frame", kMetashapeLens);
  EXPECT_TRUE(looksLikeMetashape(good));
  expectError(parseMetashape(metashape("spherical", "<f>500</f>"), "c.xml"), ErrorId::CameraModel,
              "c.xml:4: sensors of type \"spherical\"");
  expectError(parseMetashape(metashape("frame", "<f>500</f><p3>0.1</p3>"), "c.xml"), ErrorId::CameraModel, "P3 and P4");
  expectError(parseMetashape(metashape("frame", "<f>500,5</f>"), "c.xml"), ErrorId::CameraPose,
              "c.xml:4: <f> must be 1 numbers, but \"500,5\" has a decimal comma");
  expectError(parseMetashape(metashape("frame", "<f>-5</f>"), "c.xml"), ErrorId::CameraPose, "positive");
  expectError(parseMetashape("<document><chunk><cameras><camera id=\"0\"/></cameras></chunk></document>", "c.xml"),
              ErrorId::FileUnreadable, "align the photos");
  for (size_t kept = 0; kept + 20 < good.size(); kept += 13)
    EXPECT_FALSE(parseMetashape(good.substr(0, kept), "c.xml").ok()) << kept;
}

TEST(DialectLens, AFourthRadialCoefficientIsFitted) {
  const Brown4 lens{-0.12, 0.03, -0.01, 0.004, 0.001, -0.002};
  const LensFit fit = fitBrown4(lens, 0.8);
  EXPECT_LT(fit.residual, 2e-6) << "a thousandth of a pixel at a focal length of 500";
  EXPECT_EQ(fit.distortion.p1, 0.001);
  for (const double r : {0.1, 0.45, 0.8}) {
    const double s = r * r, exact = 1 + s * (lens.k1 + s * (lens.k2 + s * (lens.k3 + s * lens.k4)));
    const Distortion& d = fit.distortion;
    EXPECT_NEAR((1 + s * (d.k1 + s * (d.k2 + s * d.k3))) / (1 + s * (d.k4 + s * (d.k5 + s * d.k6))), exact, 1e-5) << r;
  }
  EXPECT_EQ(fitBrown4({-0.12, 0.03, -0.01, 0, 0, 0}, 0.8).residual, 0);
}

TEST(DialectRealityCapture, TableOfAngles) {
  const std::string head = "#cameras 1\n#name,x,y,alt,heading,pitch,roll,f,px,py,k1,k2,k3,k4,t1,t2\n";
  const std::string row = "cam00.jpg,1,2,3,30,60,-20,27,0.36,-0.18,-0.1,0.02,0.003,0,0.001,-0.002\n";
  auto read = parseRealityCaptureCsv(head + row, "c.csv");
  ASSERT_TRUE(read.ok()) << read.error().message;
  ImportedCamera camera = read.value().cameras[0];
  EXPECT_EQ(camera.camera.pinhole.name, "cam00");
  EXPECT_EQ(camera.listed, "cam00.jpg");
  camera.camera.pinhole.width = 480, camera.camera.pinhole.height = 640;
  setLens(*camera.relative, camera.camera.pinhole);
  // Independent formula: Rz(-30°) Rx(60°) Ry(-20°) maps the camera's x right, y up, z back to the world.
  const double k = std::acos(-1.0) / 180;
  const auto turned = [&](const Vector& p) {
    const Vector off = plus(p, {1, 2, 3}, -1);
    const Vector own =
        times(transposed(rodrigues({0, -20 * k, 0})),
              times(transposed(rodrigues({60 * k, 0, 0})), times(transposed(rodrigues({0, 0, -30 * k})), off)));
    return Vector{own[0], -own[1], -own[2]};
  };
  const Lens lens{480, 480, 240 + 6.4, 320 - 3.2, 0, {-0.1, 0.02, 0.001, -0.002, 0.003}};
  for (const Vector& own : kPoints) {
    // Points in front of the camera: 4 ahead along its −z.
    const Vector ahead{own[0], own[1], own[2] - 4};
    const Vector world = plus(
        times(rodrigues({0, 0, -30 * k}), times(rodrigues({60 * k, 0, 0}), times(rodrigues({0, -20 * k, 0}), ahead))),
        {1, 2, 3});
    const Vector seen = turned(world);
    ASSERT_GT(seen[2], 0);
    const glm::dvec2 got =
        filmedPixel(camera.camera, glm::dvec2(camera.camera.pinhole.project({world[0], world[1], world[2]})));
    const glm::dvec2 expected = throughLens(lens, seen);
    EXPECT_NEAR(got.x, expected.x, 1e-6);
    EXPECT_NEAR(got.y, expected.y, 1e-6);
  }
  expectError(parseRealityCaptureCsv(head, "c.csv"), ErrorId::FileUnreadable, "c.csv");
  expectError(parseRealityCaptureCsv(head + "a.jpg,1,2,3,x,0,0,27\n", "c.csv"), ErrorId::CameraPose,
              "c.csv:3: column heading");
  expectError(parseRealityCaptureCsv("#name,x,y\na,1,2\n", "c.csv"), ErrorId::FileUnreadable, "heading");
}

std::string xmp(const std::string& model = "brown3", const std::string& skew = "0") {
  const Rows r = rodrigues(kAxis);
  const Vector centre = times(transposed(r), {-kPlace[0], -kPlace[1], -kPlace[2]});
  return "<x:xmpmeta xmlns:x=\"adobe:ns:meta/\"><rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\">\n"
         "<rdf:Description xcr:Version=\"3\" xcr:DistortionModel=\"" +
         model + "\" xcr:FocalLength35mm=\"27\" xcr:Skew=\"" + skew +
         "\" xcr:PrincipalPointU=\"0.01\" xcr:PrincipalPointV=\"-0.005\" "
         "xmlns:xcr=\"http://www.capturingreality.com/ns/xcr/1.1#\">\n"
         "<xcr:Rotation>" +
         spaced({r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8]}) + "</xcr:Rotation>\n<xcr:Position>" +
         spaced({centre[0], centre[1], centre[2]}) +
         "</xcr:Position>\n<xcr:DistortionCoeficients>-0.1 0.02 0.003 0 0 0"
         "</xcr:DistortionCoeficients></rdf:Description></rdf:RDF></x:xmpmeta>\n";
}

TEST(DialectRealityCapture, FilesBesideThePictures) {
  EXPECT_TRUE(looksLikeRealityCaptureXmp(xmp()));
  auto read = parseRealityCaptureXmp(xmp(), "cam00", "cam00.xmp");
  ASSERT_TRUE(read.ok()) << read.error().message;
  ImportedCamera camera = read.value();
  camera.camera.pinhole.width = 640, camera.camera.pinhole.height = 480;
  setLens(*camera.relative, camera.camera.pinhole);
  expectImages(camera, {480, 480, 326.4, 236.8, 0, {-0.1, 0.02, 0, 0, 0.003}}, 0, seenByDialect);
  expectError(parseRealityCaptureXmp(xmp("division"), "a", "a.xmp"), ErrorId::CameraModel,
              "a.xmp: distortion model \"division\"");
  expectError(parseRealityCaptureXmp(xmp("brown3", "1"), "a", "a.xmp"), ErrorId::CameraModel, "skew");
  expectError(parseRealityCaptureXmp("<a/>", "a", "a.xmp"), ErrorId::CameraPose, "xcr:Rotation");
  for (size_t kept = 0; kept + 30 < xmp().size(); kept += 17)
    EXPECT_FALSE(parseRealityCaptureXmp(xmp().substr(0, kept), "a", "a.xmp").ok()) << kept;
}

TEST(DialectFiles, EveryKindIsFoundInItsFolder) {
  const TempFolder files;
  files.write("a/transforms_train.json", "{\"camera_angle_x\": 1.2, \"frames\": [" + frame("./train/r_0") + "]}");
  files.write("a/transforms_test.json", std::string("{}"));
  files.write("b/calib.xml", metashape("frame", kMetashapeLens));
  files.write("c/cams.csv", std::string("#name,x,y,alt,heading,pitch,roll,f\ncam00.jpg,1,2,3,30,60,-20,27\n"));
  files.write("d/images/cam00.xmp", xmp());
  const Rows r = rodrigues(kAxis);
  files.write("e/x_par.txt", "1\na.png 20 0 8 0 20 6 0 0 1 " +
                                 spaced({r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8]}) + " 0 0 3\n");
  for (const auto& [folder, kind] : {std::pair{"a", "nerfstudio"},
                                     {"b", "Metashape"},
                                     {"c", "RealityCapture"},
                                     {"d", "RealityCapture"},
                                     {"e", "Middlebury"}}) {
    auto read = readCalibration(files / folder);
    ASSERT_TRUE(read.ok()) << folder << read.error().message;
    EXPECT_EQ(read.value().kind, kind);
    EXPECT_EQ(anyContains(read.value().warnings, "transforms_test.json"), std::string(folder) == "a");
  }
}

}  // namespace
}  // namespace fourdvt::capture
