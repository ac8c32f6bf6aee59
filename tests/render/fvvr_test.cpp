// SPDX-License-Identifier: Apache-2.0
// The free-viewpoint baseline: exact blends of two cameras, occlusion, choice of cameras, mattes, and the CPU
// yardstick.
#include "render/cameras/fvvr.h"

#include <cmath>

#include "bake/texels/picture_crop.h"
#include "capture/capture.h"
#include "gl_fixture.h"
#include "lab/measure/projective.h"
#include "mattes/frame_reader.h"
#include "measure/metrics.h"
#include "platform/ffmpeg_video.h"
#include "shadow_leak.h"

namespace fourdvt::testing {
namespace {

using glm::dvec3;

constexpr int kSide = 64;

Image filled(const PinholeCamera& camera, const glm::u8vec4& color) {
  Image image(camera.width, camera.height, 4);
  for (size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = color[i % 4];
  return image;
}

const glm::u8vec4 kRed(200, 40, 10, 255), kBlue(20, 60, 220, 255), kGreen(0, 255, 0, 255);

// Appends a quad of ±half metres in the plane z = centre.z, facing +Z.
void appendQuad(MeshTopology& topology, Positions& positions, dvec3 centre, double half) {
  const uint32_t first = static_cast<uint32_t>(positions.size());
  for (const glm::dvec2 corner : {glm::dvec2(-1, 1), glm::dvec2(-1, -1), glm::dvec2(1, -1), glm::dvec2(1, 1)})
    positions.emplace_back(centre + dvec3(half * corner, 0));
  topology.face_vertices.push_back({first, first + 1, first + 2});
  topology.face_vertices.push_back({first, first + 2, first + 3});
  topology.vertex_count = static_cast<uint32_t>(positions.size());
}

// LVDT Eq. 3-4 with the corrected sign for the plane z = const: `directions` are unit vectors towards the cameras,
// `to_eye` towards the eye. powers: of the cosines of surface and view.
dvec3 blend(const std::vector<dvec3>& directions, const std::vector<glm::u8vec4>& colors, const dvec3& to_eye,
            const glm::dvec2& powers = {1, 1}) {
  dvec3 sum(0);
  double total = 0;
  for (size_t i = 0; i < directions.size(); ++i) {
    const double weight = std::pow(std::max(directions[i].z, 0.0), powers.x) *
                          std::pow(std::max(glm::dot(directions[i], to_eye), 0.0), powers.y);
    sum += weight * dvec3(colors[i]);
    total += weight;
  }
  return sum / total;
}

class FvvrTest : public GlFixture {
 protected:
  void addQuad(dvec3 centre, double half) { appendQuad(topology, positions, centre, half); }

  Image still(const PinholeCamera& view, const std::vector<Image>& pictures, render::FvvrOptions options = {}) {
    auto fvvr = render::Fvvr::create(*device, cameras, topology);
    EXPECT_TRUE(fvvr) << fvvr.error().message;
    const Status set = fvvr.value()->setFrame(positions, pictures);
    EXPECT_TRUE(set) << set.error().message;
    auto image = fvvr.value()->renderStill(render::viewFromCamera(view), options);
    EXPECT_TRUE(image) << image.error().message;
    remember(image.value());
    return image.take();
  }

  // Expects the colour at the pixel that shows `point`.
  static void expectColor(const Image& image, const PinholeCamera& view, const dvec3& point, const dvec3& expected,
                          double tolerance = 1.0) {
    const dvec3 pixel = view.project(point);
    const uint8_t* p = image.at(static_cast<int>(pixel.x), static_cast<int>(pixel.y));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(p[c], expected[c], tolerance) << "channel " << c;
    EXPECT_EQ(p[3], 255);
  }

  MeshTopology topology;
  Positions positions;
  std::vector<PinholeCamera> cameras;
};

// Point in the plane z = 0 on the ray through the centre of the pixel that shows `near_point`.
dvec3 pointUnderPixel(const PinholeCamera& view, const dvec3& near_point) {
  const dvec3 pixel = view.project(near_point);
  const dvec3 in_cam((std::floor(pixel.x) + 0.5 - view.cx) / view.fx, (std::floor(pixel.y) + 0.5 - view.cy) / view.fy,
                     1);
  const dvec3 ray = glm::transpose(glm::dmat3(view.cam_from_world)) * in_cam, eye = view.centreInWorld();
  return eye - ray * (eye.z / ray.z);
}

TEST_F(FvvrTest, TwoCamerasBlendByEquations3And4) {
  addQuad({0, 1, 0}, 0.5);
  // Cameras of different sizes: the smaller one is padded.
  cameras = {lookAt({-1.5, 1.4, 3}, {0, 1, 0}, kSide, kSide, 60), lookAt({2, 0.6, 2.5}, {0, 1, 0}, 48, 80, 40)};
  const std::vector<Image> pictures = {filled(cameras[0], kRed), filled(cameras[1], kBlue)};
  for (const dvec3 eye : {dvec3(0, 1, 3), dvec3(-2, 1.5, 2), dvec3(2.5, 0.2, 1.5)}) {
    const PinholeCamera view = lookAt(eye, {0, 1, 0}, kSide, kSide, 60);
    const Image rays = still(view, pictures);
    for (const dvec3 near_point : {dvec3(-0.1, 0.9, 0), dvec3(-0.3, 1.1, 0), dvec3(0.3, 1.2, 0)}) {
      const dvec3 point = pointUnderPixel(view, near_point);
      std::vector<dvec3> directions;
      for (const PinholeCamera& camera : cameras) directions.push_back(glm::normalize(camera.centreInWorld() - point));
      expectColor(rays, view, point, blend(directions, {kRed, kBlue}, glm::normalize(eye - point)));
    }
  }
}

TEST_F(FvvrTest, PowersAndLimitOfTheAngleAreOptions) {
  addQuad({0, 1, 0}, 0.5);
  cameras = {lookAt({-2.6, 1.4, 1.5}, {0, 1, 0}, kSide, kSide, 60), lookAt({1, 0.6, 2.5}, {0, 1, 0}, kSide, kSide, 60)};
  const std::vector<Image> pictures = {filled(cameras[0], kRed), filled(cameras[1], kBlue)};
  const PinholeCamera view = lookAt({-0.5, 1, 3}, {0, 1, 0}, kSide, kSide, 60);
  const dvec3 point = pointUnderPixel(view, {0, 1, 0}), to_eye = glm::normalize(view.centreInWorld() - point);
  std::vector<dvec3> directions;
  for (const PinholeCamera& camera : cameras) directions.push_back(glm::normalize(camera.centreInWorld() - point));
  const auto expected = [&](const glm::dvec2& powers) { return blend(directions, {kRed, kBlue}, to_eye, powers); };
  ASSERT_GT(glm::distance(expected({2, 3}), expected({3, 2})), 5);
  expectColor(still(view, pictures, {.facing_exponent = 2, .view_exponent = 3}), view, point, expected({2, 3}));
  ASSERT_LT(directions[0].z, 0.55);
  ASSERT_GT(directions[1].z, 0.55);
  expectColor(still(view, pictures, {.min_cosine = 0.55f}), view, point, dvec3(kBlue));
}

// Catmull-Rom half-way between columns 30 and 31 weights four columns by -1/16, 9/16, 9/16, -1/16.
TEST_F(FvvrTest, SharpFilterLeavesOutTheBackground) {
  addQuad({0, 1, 0}, 0.5);
  cameras = {lookAt({0, 1, 3}, {0, 1, 0}, kSide, kSide, 150)};
  PinholeCamera view = cameras[0];
  view.cx += 0.5;
  Image picture = filled(cameras[0], {100, 100, 100, 255});
  const auto fillRight = [&](const glm::u8vec4& color) {
    for (int y = 0; y < kSide; ++y)
      for (int x = 32; x < kSide; ++x)
        for (int c = 0; c < 4; ++c) picture.at(x, y)[c] = color[c];
  };
  const auto redAt31 = [&](bool sharp) {
    return int(still(view, {picture}, {.samples = 0, .sharp = sharp}).at(31, 32)[0]);
  };
  fillRight({200, 200, 200, 255});
  EXPECT_EQ(redAt31(false), 100);
  EXPECT_NEAR(redAt31(true), 93.75, 1);
  fillRight({200, 200, 200, 0});
  EXPECT_EQ(redAt31(true), 100);
}

TEST_F(FvvrTest, EachCameraTexturesWithItsOwnPixels) {
  addQuad({0, 1, 0}, 0.5);
  cameras = {lookAt({0.8, 1.2, 3}, {0, 1, 0}, 96, 72, 80)};
  Image picture(96, 72, 4, 255);  // red rises with x, green with y: identifies the pixel
  for (int y = 0; y < 72; ++y)
    for (int x = 0; x < 96; ++x)
      picture.at(x, y)[0] = static_cast<uint8_t>(2 * x), picture.at(x, y)[1] = static_cast<uint8_t>(3 * y);
  const PinholeCamera view = lookAt({-0.5, 0.8, 2.5}, {0, 1, 0}, kSide, kSide, 60);
  const Image image = still(view, {picture});
  for (const dvec3 near_point : {dvec3(0, 1, 0), dvec3(-0.4, 1.4, 0), dvec3(0.4, 1.3, 0), dvec3(0.35, 0.6, 0)}) {
    const dvec3 point = pointUnderPixel(view, near_point), pixel = cameras[0].project(point);
    expectColor(image, view, point, {2 * (pixel.x - 0.5), 3 * (pixel.y - 0.5), 255}, 1.5);
  }
}

TEST_F(FvvrTest, OccludedCameraContributesNothing) {
  constexpr double kHalf = 0.2;
  const dvec3 occluder(-0.5, 1.1, 1);  // between the left camera and the quad, above its middle
  addQuad({0, 1, 0}, 0.5);
  addQuad(occluder, kHalf);
  cameras = {lookAt({-1.5, 1, 3}, {0, 1, 0}, 128, 128, 130), lookAt({1.5, 1, 3}, {0, 1, 0}, 128, 128, 130)};
  const std::vector<Image> pictures = {filled(cameras[0], kRed), filled(cameras[1], kBlue)};
  const PinholeCamera view = lookAt({0.6, 1, 3}, {0, 1, 0}, 512, 512, 520);
  const Image image = still(view, pictures);
  const dvec3 left_eye = cameras[0].centreInWorld();
  int shaded = 0, lit = 0;
  for (double x = -0.4; x < 0.45; x += 0.012) {
    for (double y = 0.6; y < 1.48; y += 0.012) {
      const dvec3 point = pointUnderPixel(view, {x, y, 0});
      const dvec3 crossing = left_eye + (point - left_eye) * ((left_eye.z - occluder.z) / left_eye.z);
      const double inside_m = kHalf - std::max(std::abs(crossing.x - occluder.x), std::abs(crossing.y - occluder.y));
      const double inside = inside_m * cameras[0].fx / cameras[0].project(crossing).z;  // the left camera's pixels
      if (inside > -0.4) expectColor(image, view, point, dvec3(kBlue)), ++shaded;  // grown by the offset multi-draw
      if (inside > -3) continue;
      const dvec3 both = blend({glm::normalize(left_eye - point), glm::normalize(cameras[1].centreInWorld() - point)},
                               {kRed, kBlue}, glm::normalize(view.centreInWorld() - point));
      expectColor(image, view, point, both, 1.5);
      ++lit;
    }
  }
  EXPECT_GT(shaded, 1000);
  EXPECT_GT(lit, 1000);
}

TEST_F(FvvrTest, ClosestTakesTheNearestCamerasOnly) {
  addQuad({0, 1, 0}, 0.5);
  cameras = {lookAt({-1.5, 1, 3}, {0, 1, 0}, kSide, kSide, 60), lookAt({1.5, 1, 3}, {0, 1, 0}, kSide, kSide, 60),
             lookAt({0, 3, 2}, {0, 1, 0}, kSide, kSide, 60)};
  const std::vector<Image> pictures = {filled(cameras[0], kRed), filled(cameras[1], kBlue), filled(cameras[2], kGreen)};
  const dvec3 middle(0, 1, 0);
  const PinholeCamera left = lookAt({-1, 1, 3}, middle, kSide, kSide, 60),
                      right = lookAt({0.4, 1, 3}, middle, kSide, kSide, 60);
  expectColor(still(left, pictures, {.closest = 1}), left, middle, dvec3(kRed));
  const Image one = still(right, pictures, {.closest = 1});
  expectColor(one, right, middle, dvec3(kBlue));
  const dvec3 point = pointUnderPixel(right, middle);
  expectColor(
      still(right, pictures, {.closest = 2}), right, middle,
      blend({glm::normalize(cameras[0].centreInWorld() - point), glm::normalize(cameras[1].centreInWorld() - point)},
            {kRed, kBlue}, glm::normalize(right.centreInWorld() - point)));
  EXPECT_EQ(still(right, pictures, {.closest = 9}).pixels, still(right, pictures).pixels);
}

// Cost of M < N: uploads and depth maps of the selected cameras only, with the picture that all uploads would give.
TEST_F(FvvrTest, ClosestCostsNoMoreThanItsCameras) {
  addQuad({0, 1, 0}, 0.5);
  for (double x : {-2.0, -1.0, 0.0, 1.0, 2.0}) cameras.push_back(lookAt({x, 1, 3}, {0, 1, 0}, kSide, kSide, 60));
  std::vector<Image> pictures;
  for (int c = 0; c < 5; ++c) pictures.push_back(filled(cameras[c], {50 * c, 255 - 50 * c, 10 * c, 255}));
  const render::View view = render::viewFromCamera(lookAt({0.9, 1.1, 3}, {0, 1, 0}, kSide, kSide, 60));
  auto fvvr = render::Fvvr::create(*device, cameras, topology).take();
  uint64_t bytes_of_one = 0;
  for (const int closest : {1, 2, 3, 4, 0, 9}) {
    const render::FvvrOptions options{.closest = closest};
    const size_t count = closest == 0 ? 5 : std::min(closest, 5);
    ASSERT_TRUE(fvvr->setFrame(positions, pictures));
    const Image expected = fvvr->renderStill(view, options).take();
    const std::vector<size_t> used = fvvr->camerasOf(view, options);
    ASSERT_EQ(used.size(), count);
    std::vector<Image> needed(5);  // other pictures are not read
    for (size_t c : used) needed[c] = pictures[c];
    ASSERT_TRUE(fvvr->setGeometry(positions, used));
    device->resetCounters();
    ASSERT_TRUE(fvvr->uploadPictures(needed));
    EXPECT_EQ(device->counters().texture_updates, count);
    if (closest == 1) bytes_of_one = device->counters().uploaded_bytes;
    EXPECT_NEAR(double(device->counters().uploaded_bytes) / bytes_of_one, count, 0.5 * count);  // crops differ a little
    fvvr->drawDepthMaps();
    EXPECT_EQ(device->counters().draws, count);
    EXPECT_EQ(device->counters().passes, count);
    EXPECT_EQ(device->counters().vertices, count * 5 * 3 * topology.faceCount());
    device->resetCounters();
    const Image image = fvvr->renderStill(view, options).take();
    EXPECT_EQ(device->counters().draws, 1u);
    EXPECT_EQ(device->counters().texture_updates, 0u);
    EXPECT_EQ(image.pixels, expected.pixels) << "closest " << closest;
  }
}

TEST_F(FvvrTest, CameraLeftOutOfTheFrameIsAnError) {
  addQuad({0, 1, 0}, 0.5);
  cameras = {lookAt({-1.5, 1, 3}, {0, 1, 0}, kSide, kSide, 60), lookAt({1.5, 1, 3}, {0, 1, 0}, kSide, kSide, 60)};
  const std::vector<Image> pictures = {filled(cameras[0], kRed), filled(cameras[1], kBlue)};
  const render::View left = render::viewFromCamera(cameras[0]), right = render::viewFromCamera(cameras[1]);
  const render::FvvrOptions one{.closest = 1};
  auto fvvr = render::Fvvr::create(*device, cameras, topology).take();
  ASSERT_TRUE(fvvr->setFrame(positions, pictures, fvvr->camerasOf(left, one)));
  EXPECT_TRUE(fvvr->renderStill(left, one));
  EXPECT_EQ(fvvr->renderStill(right, one).error().id, ErrorId::InvalidArgument);
  EXPECT_EQ(fvvr->renderStill(left, {}).error().id, ErrorId::InvalidArgument);
  ASSERT_TRUE(fvvr->setFrame(positions, pictures));
  EXPECT_TRUE(fvvr->renderStill(right, {}));
  const size_t wrong[] = {2};
  EXPECT_EQ(fvvr->setFrame(positions, pictures, wrong).error().id, ErrorId::InvalidArgument);
}

TEST_F(FvvrTest, BackdropIsNeverSampled) {
  addQuad({0, 1, 0}, 0.5);
  cameras = {lookAt({-0.8, 1, 3}, {0, 1, 0}, 128, 128, 120), lookAt({0.8, 1, 3}, {0, 1, 0}, 128, 128, 120)};
  const PinholeCamera view = lookAt({0, 1, 3}, {0, 1, 0}, 128, 128, 120);
  std::vector<Image> pictures = {filled(cameras[0], kRed), filled(cameras[1], kBlue)};
  const Image whole = still(view, pictures);
  // The left camera's matte ends in the middle; beyond it the picture is the green of the backdrop.
  for (int y = 0; y < 128; ++y)
    for (int x = 64; x < 128; ++x)
      for (int c = 0; c < 4; ++c) pictures[0].at(x, y)[c] = c == 3 ? 0 : kGreen[c];
  const Image image = still(view, pictures);
  expectColor(image, view, {0.3, 1, 0}, dvec3(kBlue));
  int blended = 0, blue = 0;
  for (size_t i = 0; i < image.pixels.size(); i += 4) {
    if (image.pixels[i + 3] != 255) continue;
    const uint8_t *p = &image.pixels[i], *q = &whole.pixels[i];  // either as without a matte, or the right camera's
    const int from_whole = std::abs(p[0] - q[0]) + std::abs(p[1] - q[1]) + std::abs(p[2] - q[2]);
    const int from_blue = std::abs(p[0] - kBlue[0]) + std::abs(p[1] - kBlue[1]) + std::abs(p[2] - kBlue[2]);
    EXPECT_LE(std::min(from_whole, from_blue), 6);
    ++(from_whole < from_blue ? blended : blue);
  }
  EXPECT_GT(blended, 500);
  EXPECT_GT(blue, 500);
}

TEST_F(FvvrTest, MatteDecidesAtOneHalf) {
  addQuad({0, 1, 0}, 0.5);
  cameras = {lookAt({-0.8, 1, 3}, {0, 1, 0}, kSide, kSide, 60), lookAt({0.8, 1, 3}, {0, 1, 0}, kSide, kSide, 60)};
  const PinholeCamera view = lookAt({0, 1, 3}, {0, 1, 0}, kSide, kSide, 60);
  const auto withAlpha = [&](uint8_t alpha) {
    const std::vector<Image> pictures = {filled(cameras[0], {kRed.x, kRed.y, kRed.z, alpha}),
                                         filled(cameras[1], kBlue)};
    return still(view, pictures);
  };
  const dvec3 point = pointUnderPixel(view, {0, 1, 0});
  expectColor(withAlpha(127), view, point, dvec3(kBlue));
  const dvec3 both =
      blend({glm::normalize(cameras[0].centreInWorld() - point), glm::normalize(cameras[1].centreInWorld() - point)},
            {kRed, kBlue}, glm::normalize(view.centreInWorld() - point));
  expectColor(withAlpha(129), view, point, both, 1.5);  // premultiplied in 8 bits
}

TEST_F(FvvrTest, FragmentThatNoCameraSeesTakesTheBestFacingOne) {
  addQuad({0, 1, 0}, 0.5);
  addQuad({0, 1, 1.5}, 0.4);  // hides the quad's middle from both cameras
  cameras = {lookAt({-0.3, 1, 4}, {0, 1, 0}, kSide, kSide, 60), lookAt({0.9, 1, 4}, {0.5, 1, 0}, kSide, kSide, 60)};
  const std::vector<Image> pictures = {filled(cameras[0], kRed), filled(cameras[1], kBlue)};
  const PinholeCamera view = lookAt({0, 3.5, 1.2}, {0, 1, 0}, kSide, kSide, 60);  // over the occluder
  expectColor(still(view, pictures), view, {0, 1, 0}, dvec3(kRed));
  // If the best-facing camera's matte excludes the point, the other camera fills it.
  const std::vector<Image> matted = {filled(cameras[0], {0, 255, 0, 0}), pictures[1]};
  expectColor(still(view, matted), view, {0, 1, 0}, dvec3(kBlue));
  // Seen from behind; no camera faces it.
  const PinholeCamera behind = lookAt({0, 1, -3}, {0, 1, 0}, kSide, kSide, 60);
  EXPECT_EQ(still(behind, pictures).at(32, 32)[3], 255);
}

// The occluder is red, and the camera sees blue around it.
TEST_F(FvvrTest, FragmentThatNoCameraSeesIsFilledFromTheSurfaceNearby) {
  addQuad({0, 1, 0}, 0.5);
  addQuad({0, 1, 1.5}, 0.2);
  cameras = {lookAt({0, 1, 4}, {0, 1, 0}, kSide, kSide, 60)};
  Image picture = filled(cameras[0], kBlue);
  for (int y = 26; y < 38; ++y)
    for (int x = 26; x < 38; ++x)
      for (int c = 0; c < 4; ++c) picture.at(x, y)[c] = kRed[c];
  const PinholeCamera view = lookAt({0, 3.5, 1.2}, {0, 1, 0}, kSide, kSide, 60);  // over the occluder
  const dvec3 hidden(0, 1, 0);
  expectColor(still(view, {picture}), view, hidden, dvec3(kRed));
  expectColor(still(view, {picture}, {.unseen = render::Unseen::Neighbourhood}), view, hidden, dvec3(kBlue), 2);
  const Image seen = still(view, {picture}, {.unseen = render::Unseen::Transparent});
  const dvec3 pixel = view.project(hidden);
  EXPECT_EQ(seen.at(int(pixel.x), int(pixel.y))[3], 0);
}

// OVH03 5.2.2: with a coarse depth map the arm's texture leaks onto the body beside its outline, with a fattened one it
// does not.
TEST_F(FvvrTest, FattenedDepthMapsLeakNothing) {
  const ArmScene arm;
  const OrbitView from_front{.azimuth_deg = 0, .elevation_deg = 10, .target_in_world = {0, 1, 0}};
  const PinholeCamera camera = cameraFromOrbit(from_front, 720, 960);
  OrbitView aside = from_front;
  aside.azimuth_deg = 25, aside.elevation_deg = 35;
  const PinholeCamera view = cameraFromOrbit(aside, 720, 960);
  const ViewTruth truth = truthOf(view, camera, arm.topology, arm.positions);
  const auto leak = [&](render::Visibility visibility, double texels_per_pixel) {
    auto out = leakOf(*device, view, camera, arm.topology, arm.positions, truth,
                      {.visibility = visibility, .texels_per_pixel = texels_per_pixel});
    EXPECT_TRUE(out) << out.error().message;
    return out.take();
  };
  constexpr double kSmall = 1.0 / 3;
  const Leak none = leak(render::Visibility::None, 1), plain = leak(render::Visibility::Plain, kSmall),
             offset = leak(render::Visibility::Offset, 1), fattened = leak(render::Visibility::Fattened, 1),
             small = leak(render::Visibility::Fattened, kSmall);
  ASSERT_GT(none.hidden, 2000u);
  ASSERT_GT(none.seen, 20000u);
  EXPECT_EQ(none.leaked, none.hidden);
  EXPECT_GT(plain.leaked, plain.hidden / 200);
  EXPECT_EQ(offset.leaked, 0u);
  EXPECT_EQ(fattened.leaked, 0u);
  EXPECT_EQ(small.leaked, 0u);
  // Only pixels beside the arm's outline and the contours may be lost.
  EXPECT_LT(double(none.lost), 0.01 * double(none.seen));
  EXPECT_LT(double(fattened.lost), 0.015 * double(fattened.seen));
  EXPECT_LT(double(small.lost), 0.04 * double(small.seen));
  EXPECT_EQ(render::Fvvr::create(*device, {&camera, 1}, arm.topology, {.texels_per_pixel = 0}).error().id,
            ErrorId::InvalidArgument);
}

TEST_F(FvvrTest, MisuseIsOneError) {
  addQuad({0, 1, 0}, 0.5);
  EXPECT_EQ(render::Fvvr::create(*device, cameras, topology).error().id, ErrorId::InvalidArgument);
  cameras = {lookAt({-1.5, 1, 3}, {0, 1, 0}, kSide, kSide, 60)};
  auto fvvr = render::Fvvr::create(*device, cameras, topology).take();
  const render::View view = render::viewFromCamera(cameras[0]);
  EXPECT_EQ(fvvr->renderStill(view, {}).error().id, ErrorId::InvalidArgument);
  EXPECT_EQ(fvvr->setFrame(Positions(3), {}).error().id, ErrorId::InvalidArgument);
  EXPECT_EQ(fvvr->setFrame(positions, {}).error().id, ErrorId::InvalidArgument);
  const std::vector<Image> small = {Image(8, 8, 4)};
  EXPECT_EQ(fvvr->setFrame(positions, small).error().id, ErrorId::InvalidArgument);
  const std::vector<Image> pictures = {filled(cameras[0], kRed)};
  ASSERT_TRUE(fvvr->setFrame(positions, pictures));
  using Options = render::FvvrOptions;
  for (const Options& wrong :
       {Options{.closest = -1}, Options{.facing_exponent = -1}, Options{.view_exponent = -1}, Options{.min_cosine = 1}})
    EXPECT_EQ(fvvr->renderStill(view, wrong).error().id, ErrorId::InvalidArgument);
}

// Same equations on the CPU, without matte tests and offset multi-draw.
TEST_F(FvvrTest, AgreesWithTheYardstickOnTheSample) {
  const OpenVideo open_video = [](const std::string& path, int channels) {
    return platform::openVideoFile(path, channels);
  };
  auto capture = mattes::openCapture(FOURDVT_SOURCE_DIR "/site/sample/actor_a", open_video, {"walk"});
  ASSERT_TRUE(capture) << capture.error().message;
  auto reader = mattes::FrameReader::open(capture.value(), capture.value().sequences[0], open_video);
  ASSERT_TRUE(reader) << reader.error().message;
  auto frame = reader.value()->next();
  ASSERT_TRUE(frame) << frame.error().message;
  for (Image& picture : frame.value().pictures) bake::replaceEdgeColours(picture);
  for (const auto& camera : capture.value().cameras) cameras.push_back(camera.pinhole);
  topology = capture.value().topology;
  positions = frame.value().positions;
  BoundingBox bounds{positions[0], positions[0]};
  for (const glm::vec3& p : positions) bounds = {glm::min(bounds.min, p), glm::max(bounds.max, p)};
  for (const double azimuth_deg : {25.0, 205.0}) {
    OrbitView orbit = defaultOrbit(bounds, 0.75);
    orbit.azimuth_deg = azimuth_deg;
    const PinholeCamera view = cameraFromOrbit(orbit, 480, 640);
    const Image drawn = still(view, frame.value().pictures);
    const Image truth =
        measure::renderProjective(view, cameras, frame.value().pictures, topology.face_vertices, positions);
    const double ssim = measure::ssim(measure::compositedOnBlack(truth), measure::compositedOnBlack(drawn),
                                      measure::unionOfSilhouettes(truth, drawn));
    RecordProperty("ssim_" + std::to_string(static_cast<int>(azimuth_deg)), std::to_string(ssim));
    printf("azimuth %.0f: SSIM %.4f\n", azimuth_deg, ssim);
    EXPECT_GE(ssim, 0.97);
  }
}

}  // namespace
}  // namespace fourdvt::testing
