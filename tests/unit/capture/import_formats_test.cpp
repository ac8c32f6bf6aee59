// SPDX-License-Identifier: Apache-2.0
// Calibrations of other programs: a world point projects to the pixel of the format's own formula.
#include <cstring>

#include "import_fixture.h"

namespace fourdvt::capture {
namespace {

const Vector kTurn{0.3, -0.2, 0.1}, kShift{0.05, -0.1, 3};
const Rows kRotation = rodrigues(kTurn);

Vector worldToCamera(const Vector& point) { return plus(times(kRotation, point), kShift); }

std::string list(const double* values, size_t count, const char* between = ", ") {
  std::string out;
  for (size_t i = 0; i < count; ++i) {
    char text[40];
    std::snprintf(text, sizeof text, "%.17g", values[i]);
    out += (i ? between : "") + std::string(text);
  }
  return out;
}
template <size_t N>
std::string list(const std::array<double, N>& values, const char* between = ", ") {
  return list(values.data(), N, between);
}

std::string xmlMatrix(const std::string& name, int rows, int columns, const std::string& data) {
  return "<" + name + " type_id=\"opencv-matrix\"><rows>" + std::to_string(rows) + "</rows><cols>" +
         std::to_string(columns) + "</cols><dt>d</dt><data>" + data + "</data></" + name + ">\n";
}

std::string openCvXml(const std::string& first = "<?xml version=\"1.0\"?>\n") {
  return first + "<opencv_storage>\n" + xmlMatrix("CameraIntrinsicMatrix", 3, 3, "500. 2. 320. 0. 510. 240. 0. 0. 1.") +
         xmlMatrix("DistortionCoeffs", 1, 5, "-0.3 0.1 0.002 -0.001 0.05") +
         xmlMatrix("CameraRotationVecs", 3, 1, list(kTurn, " ")) +
         xmlMatrix("CameraTranslationVecs", 3, 1, list(kShift, " ")) + "</opencv_storage>\n";
}

const Lens kOpenCvLens{500, 510, 320, 240, 2, {-0.3, 0.1, 0.002, -0.001, 0.05}};

TEST(ImportOpenCv, XmlWithAndWithoutItsFirstLine) {
  for (const char* first : {"<?xml version=\"1.0\"?>\n", ""}) {
    auto camera = parseOpenCvCamera(openCvXml(first), "cam1", "cam1.xml");
    ASSERT_TRUE(camera.ok()) << camera.error().message;
    EXPECT_EQ(camera.value().camera.pinhole.name, "cam1");
    EXPECT_EQ(camera.value().camera.pinhole.width, 0);
    expectImages(camera.value(), kOpenCvLens, 0.5, worldToCamera);
  }
}

TEST(ImportOpenCv, YamlWithOtherNamesMatricesAndSize) {
  const std::string yaml =
      "image_width: 640\nimage_height: 480\ncamera_matrix: !!opencv-matrix\n  rows: 3\n  cols: 3\n  dt: d\n  data: "
      "[500., "
      "0., 320., 0., 510., 240., 0., 0., 1.]\ndistortion_coefficients:\n  rows: 1\n  cols: 8\n  data: [0.3, -0.2, "
      "0.004, "
      "-0.003, 0.05, 0.25, -0.1, 0.02]\nR: [" +
      list(kRotation) + "]\nT: [" + list(kShift) + "]\n";
  for (const std::string& text : {yaml, "%YAML:1.0\n---\n" + yaml}) {
    auto camera = parseOpenCvCamera(text, "left", "left.yml");
    ASSERT_TRUE(camera.ok()) << camera.error().message;
    EXPECT_EQ(camera.value().camera.pinhole.width, 640);
    EXPECT_EQ(camera.value().camera.pinhole.height, 480);
    expectImages(camera.value(), {500, 510, 320, 240, 0, {0.3, -0.2, 0.004, -0.003, 0.05, 0.25, -0.1, 0.02}}, 0.5,
                 worldToCamera);
  }
}

TEST(ImportOpenCv, JsonOfAFisheye) {
  const std::string json = R"({"fisheye_model": 1, "K": [[500.0, 0.0, 320.0], [0.0, 510.0, 240.0], [0.0, 0.0, 1.0]],
    "D": [0.1, -0.05, 0.02, -0.01], "rvec": [)" +
                           list(kTurn) + R"(], "tvec": [)" + list(kShift) + "]}";
  auto camera = parseOpenCvCamera(json, "a", "a.json");
  ASSERT_TRUE(camera.ok()) << camera.error().message;
  expectImages(camera.value(), {500, 510, 320, 240, 0, {0.1, -0.05, 0.02, -0.01}, true}, 0.5, worldToCamera);
}

TEST(ImportOpenCv, WhatIsWrongIsNamed) {
  const std::string good = openCvXml();
  const auto wrong = [&](const std::string& text, ErrorId id, const std::string& named) {
    auto camera = parseOpenCvCamera(text, "cam1", "cam1.xml");
    expectError(camera, id, "cam1.xml");
    if (camera.ok()) return;
    EXPECT_NE(camera.error().message.find(named), std::string::npos) << camera.error().message;
  };
  wrong("", ErrorId::FileUnreadable, "FileStorage");
  wrong("hello: 1\n", ErrorId::CameraPose, "CameraMatrix");
  wrong(replaced(good, "500.", "nan"), ErrorId::CameraPose, "finite");
  wrong(replaced(good, "500.", "-500."), ErrorId::CameraPose, "positive");
  wrong(replaced(good, "500. 2. 320. 0. 510. 240. 0. 0. 1.", "\"text\""), ErrorId::CameraPose, "camera matrix");
  wrong(replaced(good, "-0.3 0.1 0.002 -0.001 0.05", "<a>1</a>"), ErrorId::CameraPose, "distortion");
  wrong(replaced(good, "-0.001 0.05", "-0.001 0.05 0 0 0 .1 0 0 0"), ErrorId::CameraModel, "thin prism");
  wrong(replaced(good, "CameraTranslationVecs type", "Else type"), ErrorId::FileUnreadable, "FileStorage");
  for (size_t kept = 0; kept + 20 < good.size(); kept += 7)
    EXPECT_FALSE(parseOpenCvCamera(good.substr(0, kept), "cam1", "cam1.xml").ok()) << kept;
  std::string nested = "{\"K\": ";
  for (int i = 0; i < 2000; ++i) nested += "[";
  EXPECT_FALSE(parseOpenCvCamera(nested, "cam1", "cam1.json").ok());
}

TEST(ImportOpenCv, ARotationMustBeOne) {
  const auto withR = [](const Rows& r) {
    return parseOpenCvCamera("K: [500, 0, 320, 0, 510, 240, 0, 0, 1]\nR: [" + list(r) + "]\nT: [0, 0, 3]\n", "a",
                             "a.yml");
  };
  EXPECT_TRUE(withR({1, 0, 0, 0, 1, 0, 0, 0, 1}).ok());
  expectError(withR({1, 0, 0, 0, 1, 0, 0, 0, -1}), ErrorId::CameraPose, "mirrored");
  expectError(withR({1, 0, 0, 0, 1, 0, 0, 0, 0.9}), ErrorId::CameraPose, "orthogonal");
}

// Camera axes as rows, looking along −z with y up; position in millimetres; lens in 1/64 pixel.
std::string qualisys(const std::string& x = "300") {
  const Rows axes = rodrigues({0.2, 0.1, -0.3});
  std::string rotation;
  const char* names[] = {"r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33"};
  for (size_t i = 0; i < 9; ++i) rotation += std::string(names[i]) + "=\"" + list(&axes[i], 1) + "\" ";
  return "<?xml version='1.0' encoding='ASCII'?>\n<calibration><cameras><camera serial=\"21234\">"
         "<fov_video left=\"8\" top=\"4\" right=\"647\" bottom=\"483\"/><transform " +
         rotation + "x=\"" + x + "\" y=\"-200\" z=\"2800\"/><intrinsic focalLengthU=\"32000\" focalLengthV=\"32640\" " +
         "centerPointU=\"20992\" centerPointV=\"15616\" skew=\"64\" radialDistortion1=\"-0.05\" " +
         "radialDistortion2=\"0.1\" radialDistortion3=\"0.02\" tangentalDistortion1=\"0.001\" " +
         "tangentalDistortion2=\"-0.002\"/></camera></cameras></calibration>\n";
}

TEST(ImportQualisys, AxesUnitsAndSubpixels) {
  auto calibration = parseQualisys(qualisys(), "Calib.qca.txt");
  ASSERT_TRUE(calibration.ok()) << calibration.error().message;
  EXPECT_EQ(calibration.value().metres_per_unit, 0.001);
  EXPECT_EQ(calibration.value().up, WorldAxis::Z);
  ASSERT_EQ(calibration.value().cameras.size(), 1u);
  const ImportedCamera& imported = calibration.value().cameras[0];
  EXPECT_EQ(imported.camera.pinhole.name, "21234");
  EXPECT_EQ(imported.camera.pinhole.width, 640);
  EXPECT_EQ(imported.camera.pinhole.height, 480);
  const Rows axes = rodrigues({0.2, 0.1, -0.3});
  const auto in_camera = [&](const Vector& point) {
    const Vector own = times(axes, plus(point, {300, -200, 2800}, -1));
    return Vector{own[0], -own[1], -own[2]};
  };
  // The field of view begins at (8, 4) of the sensor.
  expectImages(imported, {500, 510, 328 - 8, 244 - 4, 1, {-0.05, 0.1, 0.001, -0.002, 0.02}}, 0.5, in_camera, 1000);
}

TEST(ImportQualisys, WhatIsWrongIsNamed) {
  const std::string good = qualisys();
  expectError(parseQualisys("", "c.qca.txt"), ErrorId::FileUnreadable, "c.qca.txt");
  expectError(parseQualisys("<calibration/>", "c.qca.txt"), ErrorId::FileUnreadable, "no <camera>");
  expectError(parseQualisys(qualisys("nan"), "c.qca.txt"), ErrorId::CameraPose, "finite");
  expectError(parseQualisys(qualisys("left"), "c.qca.txt"), ErrorId::CameraPose, "transform x");
  expectError(parseQualisys(replaced(good, "focalLengthU", "focal"), "c.qca.txt"), ErrorId::CameraPose,
              "focalLengthU is missing");
  expectError(parseQualisys(replaced(good, "right=\"647\"", "right=\"1e9\""), "c.qca.txt"), ErrorId::CameraPose,
              "32768");
  for (size_t kept = 0; kept + 60 < good.size(); kept += 11)
    EXPECT_FALSE(parseQualisys(good.substr(0, kept), "c.qca.txt").ok()) << kept;
}

// Camera to world in OpenGL's axes: columns right, up, back, position.
std::string nerfstudio(const std::string& shared, const std::string& own) {
  const Rows r = rodrigues({0.2, 0.1, -0.3});
  const Vector p{0.3, -0.2, 2.8};
  std::string rows;
  for (int i = 0; i < 3; ++i) rows += (i ? ", [" : "[") + list(&r[3 * i], 3) + ", " + list(&p[i], 1) + "]";
  return "{" + shared + "\"frames\": [{\"file_path\": \"images/cam01.png\", " + own + "\"transform_matrix\": [" + rows +
         ", [0, 0, 0, 1]]}]}";
}

Vector fromOpenGl(const Vector& point) {
  const Vector own = times(transposed(rodrigues({0.2, 0.1, -0.3})), plus(point, {0.3, -0.2, 2.8}, -1));
  return {own[0], -own[1], -own[2]};
}

const char* const kShared =
    "\"w\": 640, \"h\": 480, \"fl_x\": 500, \"fl_y\": 510, \"cx\": 320, \"cy\": 240, \"k1\": -0.1, \"k2\": 0.02, ";

TEST(ImportNerfstudio, SharedAndOwnIntrinsics) {
  auto calibration = parseNerfstudio(
      nerfstudio(kShared, "\"camera_model\": \"OPENCV\", \"fl_x\": 480, \"p1\": 0.003, \"p2\": -0.002, "),
      "transforms.json");
  ASSERT_TRUE(calibration.ok()) << calibration.error().message;
  const ImportedCamera& imported = calibration.value().cameras[0];
  EXPECT_EQ(imported.camera.pinhole.name, "cam01");
  EXPECT_EQ(imported.pictures, "images/cam01.png");
  EXPECT_EQ(imported.camera.pinhole.height, 480);
  EXPECT_EQ(calibration.value().up, WorldAxis::Z);
  EXPECT_FALSE(calibration.value().metres_per_unit.has_value());
  expectImages(imported, {480, 510, 320, 240, 0, {-0.1, 0.02, 0.003, -0.002}}, 0, fromOpenGl);
}

TEST(ImportNerfstudio, Fisheye) {
  auto calibration = parseNerfstudio(
      nerfstudio(std::string(kShared) + "\"camera_model\": \"OPENCV_FISHEYE\", ", "\"k3\": 0.01, \"k4\": -0.005, "),
      "transforms.json");
  ASSERT_TRUE(calibration.ok()) << calibration.error().message;
  expectImages(calibration.value().cameras[0], {500, 510, 320, 240, 0, {-0.1, 0.02, 0.01, -0.005}, true}, 0,
               fromOpenGl);
}

TEST(ImportNerfstudio, FisheyeByFlagAndNamesFromWindows) {
  for (const bool flag : {true, false}) {
    const std::string text =
        replaced(nerfstudio(std::string(kShared) + "\"is_fisheye\": " + (flag ? "true, " : "false, "), ""),
                 "images/cam01.png", "images\\\\cam01.png");
    auto calibration = parseNerfstudio(text, "transforms.json");
    ASSERT_TRUE(calibration.ok()) << calibration.error().message;
    EXPECT_EQ(calibration.value().cameras[0].camera.distortion.fisheye, flag);
    EXPECT_EQ(calibration.value().cameras[0].camera.pinhole.name, "cam01");
    EXPECT_EQ(calibration.value().cameras[0].pictures, "images/cam01.png");
  }
}

TEST(ImportNerfstudio, AngleInPlaceOfFocalLength) {
  auto calibration = parseNerfstudio(nerfstudio("\"w\": 640, \"h\": 480, \"camera_angle_x\": 1.2, ", ""), "t.json");
  ASSERT_TRUE(calibration.ok()) << calibration.error().message;
  const double focal = 320 / std::tan(0.6);
  expectImages(calibration.value().cameras[0], {focal, focal, 320, 240}, 0, fromOpenGl);
}

TEST(ImportNerfstudio, WhatIsWrongIsNamed) {
  const std::string good = nerfstudio(kShared, "");
  ASSERT_TRUE(parseNerfstudio(good, "t.json").ok());
  expectError(parseNerfstudio("{}", "t.json"), ErrorId::FileUnreadable, "frames");
  expectError(parseNerfstudio(nerfstudio(kShared, "\"camera_model\": \"EQUIRECTANGULAR\", "), "t.json"),
              ErrorId::CameraModel, "EQUIRECTANGULAR");
  expectError(parseNerfstudio(nerfstudio(kShared, "\"k4\": 0.1, "), "t.json"), ErrorId::CameraModel, "k4");
  expectError(parseNerfstudio(nerfstudio(kShared, "\"fl_x\": \"x\", "), "t.json"), ErrorId::CameraPose, "numbers");
  expectError(parseNerfstudio(replaced(good, "transform_matrix", "matrix"), "t.json"), ErrorId::CameraPose,
              "transform_matrix");
  expectError(parseNerfstudio(replaced(good, "\"file_path\": \"images/cam01.png\"", "\"a\": 1"), "t.json"),
              ErrorId::CameraPose, "file_path");
  for (size_t kept = 0; kept < good.size(); kept += 5)
    EXPECT_FALSE(parseNerfstudio(good.substr(0, kept), "t.json").ok()) << kept;
}

std::string yamlMatrix(const std::string& name, int rows, int columns, const std::string& data) {
  return name + ": !!opencv-matrix\n  rows: " + std::to_string(rows) + "\n  cols: " + std::to_string(columns) +
         "\n  dt: d\n  data: [" + data + "]\n";
}

TEST(ImportEasyMocap, VectorsAndMatrices) {
  const std::string intri = "%YAML:1.0\n---\nnames:\n  - \"01\"\n  - \"02\"\n" +
                            yamlMatrix("K_01", 3, 3, "500., 0., 320., 0., 510., 240., 0., 0., 1.") +
                            yamlMatrix("dist_01", 1, 5, "-0.3, 0.1, 0.002, -0.001, 0.05") +
                            yamlMatrix("K_02", 3, 3, "400., 0., 300., 0., 410., 200., 0., 0., 1.") +
                            yamlMatrix("dist_02", 5, 1, "0., 0., 0., 0., 0.");
  const std::string extri = "%YAML:1.0\n---\nnames:\n  - \"01\"\n  - \"02\"\n" + yamlMatrix("R_01", 3, 1, list(kTurn)) +
                            yamlMatrix("Rot_02", 3, 3, list(kRotation)) + yamlMatrix("T_01", 3, 1, list(kShift)) +
                            yamlMatrix("T_02", 3, 1, list(kShift));
  auto calibration = parseEasyMocap(intri, extri, "data");
  ASSERT_TRUE(calibration.ok()) << calibration.error().message;
  ASSERT_EQ(calibration.value().cameras.size(), 2u);
  EXPECT_EQ(calibration.value().up, WorldAxis::Z);
  EXPECT_EQ(calibration.value().cameras[1].camera.pinhole.name, "02");
  expectImages(calibration.value().cameras[0], {500, 510, 320, 240, 0, {-0.3, 0.1, 0.002, -0.001, 0.05}}, 0.5,
               worldToCamera);
  expectImages(calibration.value().cameras[1], {400, 410, 300, 200}, 0.5, worldToCamera);

  expectError(parseEasyMocap(intri, replaced(extri, "T_02", "X_02"), "data"), ErrorId::CameraPose, "T_02");
  expectError(parseEasyMocap(replaced(intri, "K_02", "X_02"), extri, "data"), ErrorId::CameraPose, "camera 02");
  expectError(parseEasyMocap(intri, replaced(extri, "names", "other"), "data"), ErrorId::FileUnreadable, "names");
  expectError(parseEasyMocap(replaced(intri, "[-0.3", "[.nan"), extri, "data"), ErrorId::CameraPose, "finite");
  EXPECT_FALSE(parseEasyMocap(intri, extri.substr(0, 150), "data").ok());
}

TEST(ImportActorsHq, FractionsAndPositions) {
  const std::string header = "name,w,h,rx,ry,rz,tx,ty,tz,fx,fy,px,py\n";
  const std::string row = "Cam001,640,480,2.9,0.1,-0.3,0.3,-0.2,2.8,0.78125,1.0625,0.5,0.5";
  auto calibration = parseActorsHq(header + row + "\r\n", "calibration.csv");
  ASSERT_TRUE(calibration.ok()) << calibration.error().message;
  const auto in_camera = [](const Vector& point) {
    return times(transposed(rodrigues({2.9, 0.1, -0.3})), plus(point, {0.3, -0.2, 2.8}, -1));
  };
  EXPECT_EQ(calibration.value().cameras[0].camera.pinhole.name, "Cam001");
  EXPECT_EQ(calibration.value().metres_per_unit, 1);
  expectImages(calibration.value().cameras[0], {500, 510, 320, 240}, 0, in_camera);
  expectError(parseActorsHq(header, "c.csv"), ErrorId::FileUnreadable, "name,w,h");
  expectError(parseActorsHq(header + replaced(row, "640", "wide"), "c.csv"), ErrorId::CameraPose, "c.csv:2: column w");
  expectError(parseActorsHq(header + replaced(row, "2.9", "nan"), "c.csv"), ErrorId::CameraPose, "c.csv:2");
  expectError(parseActorsHq(header + row.substr(0, 40), "c.csv"), ErrorId::CameraPose, "c.csv:2");
}

std::string toml(const std::string& more = "fisheye = false\n") {
  return "[cam_01]\nname = \"left\"\nsize = [ 640.0, 480.0]\nmatrix = [ [ 500.0, 0.0, 320.0], [ 0.0, 510.0, 240.0], [ "
         "0.0, "
         "0.0, 1.0]]\ndistortions = [ -0.1, 0.02, 0.003, -0.002]\nrotation = [ " +
         list(kTurn) + "]\ntranslation = [ " + list(kShift) + "]\n" + more + "\n[metadata]\nadjusted = false\n";
}

TEST(ImportToml, PerspectiveAndFisheye) {
  auto calibration = parseToml(toml(), "Calib.toml");
  ASSERT_TRUE(calibration.ok()) << calibration.error().message;
  ASSERT_EQ(calibration.value().cameras.size(), 1u);
  EXPECT_EQ(calibration.value().cameras[0].camera.pinhole.name, "left");
  EXPECT_EQ(calibration.value().cameras[0].camera.pinhole.width, 640);
  expectImages(calibration.value().cameras[0], {500, 510, 320, 240, 0, {-0.1, 0.02, 0.003, -0.002}}, 0.5,
               worldToCamera);
  auto fisheye = parseToml(toml("fisheye = true\n"), "Calib.toml");
  ASSERT_TRUE(fisheye.ok()) << fisheye.error().message;
  expectImages(fisheye.value().cameras[0], {500, 510, 320, 240, 0, {-0.1, 0.02, 0.003, -0.002}, true}, 0.5,
               worldToCamera);
}

TEST(ImportToml, WhatIsWrongIsNamed) {
  const std::string good = toml();
  expectError(parseToml("= 3", "c.toml"), ErrorId::FileUnreadable, "c.toml");
  expectError(parseToml("[project]\nname = \"x\"\n", "c.toml"), ErrorId::FileUnreadable, "matrix");
  expectError(parseToml(replaced(good, "500.0", "nan"), "c.toml"), ErrorId::CameraPose, "[cam_01]");
  expectError(parseToml(replaced(good, "500.0", "\"wide\""), "c.toml"), ErrorId::CameraPose, "[cam_01]");
  expectError(parseToml(replaced(good, "translation", "shift"), "c.toml"), ErrorId::CameraPose, "translation");
  expectError(parseToml(replaced(good, "[ -0.1, 0.02, 0.003, -0.002]", "3"), "c.toml"), ErrorId::CameraPose,
              "distortions");
  for (size_t kept = 0; kept < good.size() - 60; kept += 9)
    EXPECT_FALSE(parseToml(good.substr(0, kept), "c.toml").ok()) << kept;
}

// P = −3 K [R | t]: scale and sign of a projection are free.
std::string projection(const char* before = "") {
  const Rows k{500, 2, 320, 0, 510, 240, 0, 0, 1};
  std::string out = before;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 4; ++j) {
      double sum = 0;
      for (int m = 0; m < 3; ++m) sum += k[3 * i + m] * (j < 3 ? kRotation[3 * m + j] : kShift[m]);
      sum *= -3;
      out += list(&sum, 1) + (j < 3 ? " " : "\n");
    }
  }
  return out;
}

TEST(ImportProjection, IsDecomposed) {
  for (const char* before : {"", "CONTOUR\n"}) {
    const std::string text = projection(before);
    EXPECT_TRUE(looksLikeProjection(text));
    auto camera = parseProjection(text, "v0", "v0.txt");
    ASSERT_TRUE(camera.ok()) << camera.error().message;
    expectImages(camera.value(), {500, 510, 320, 240, 2}, 0.5, worldToCamera);
    EXPECT_NEAR(camera.value().camera.distortion.skew, 2, 1e-6);
  }
  const std::string parts = "500 0 320 0 510 240 0 0 1\n" + list(kRotation, " ") + "\n" + list(kShift, " ") + "\n";
  auto camera = parseProjection(parts, "v0", "v0.txt");
  ASSERT_TRUE(camera.ok()) << camera.error().message;
  expectImages(camera.value(), {500, 510, 320, 240}, 0.5, worldToCamera);
}

TEST(ImportProjection, WhatIsWrongIsNamed) {
  EXPECT_FALSE(looksLikeProjection("Read me: 12 numbers"));
  EXPECT_FALSE(looksLikeProjection("1 2 3"));
  expectError(parseProjection("1 2 3", "v", "v.txt"), ErrorId::CameraPose, "v.txt");
  expectError(parseProjection("1 0 0 0 0 1 0 0 0 0 0 0", "v", "v.txt"), ErrorId::CameraPose, "no length");
  expectError(parseProjection("1 0 0 0 1 0 0 0 0 0 1 0", "v", "v.txt"), ErrorId::CameraPose, "v.txt");
  expectError(parseProjection("nan 0 0 0 0 1 0 0 0 0 1 0", "v", "v.txt"), ErrorId::CameraPose, "finite");
}

TEST(ImportAxes, EveryAxisBecomesY) {
  const std::array<glm::dvec3, 6> axes{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};
  for (int i = 0; i < 6; ++i) {
    const auto axis = static_cast<WorldAxis>(i);
    const glm::dmat3 turn = turnToY(axis);
    EXPECT_EQ(turn * axes[i], glm::dvec3(0, 1, 0)) << axisName(axis);
    EXPECT_EQ(glm::determinant(turn), 1) << axisName(axis);
    EXPECT_EQ(axisNamed(axisName(axis)), axis);
  }
  EXPECT_FALSE(axisNamed("W").has_value());
}

}  // namespace
}  // namespace fourdvt::capture
