// SPDX-License-Identifier: Apache-2.0
// Stereo refinement of the hull on analytic scenes: eight cameras round a ball with a concave bowl, which is invisible
// in silhouettes.
#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "base/face_buffer.h"
#include "gl_fixture.h"
#include "reconstruct/carve.h"
#include "reconstruct/stereo/steady.h"
#include "reconstruct/stereo/stereo_refiner.h"
#include "reconstruct/surface_cleaning.h"

namespace fourdvt::testing {
namespace {

using glm::dvec3;
using namespace reconstruct;

constexpr int kSide = 260;
constexpr double kFocal = 560, kDistance_m = 2.2, kVoxel_m = 0.006;
constexpr double kBall_m = 0.25, kBowl_m = 0.16;
const dvec3 kBowlCentre(0, 0, 0.30);

double ball(const dvec3& p) { return glm::length(p) - kBall_m; }
double bowlInBall(const dvec3& p) { return std::max(ball(p), kBowl_m - glm::distance(p, kBowlCentre)); }

double hashed(const glm::ivec3& cell, int channel) {
  uint32_t h = uint32_t(cell.x) * 73856093u ^ uint32_t(cell.y) * 19349663u ^ uint32_t(cell.z) * 83492791u ^
               uint32_t(channel + 1) * 2654435761u;
  h = (h ^ h >> 15) * 2246822519u;
  h = (h ^ h >> 13) * 3266489917u;
  return double(h >> 8 & 0xffff) / 65535;
}

// Smooth noise in space, cells of 14 mm.
dvec3 texture(const dvec3& point) {
  const dvec3 at = point / 0.014, low = glm::floor(at);
  const dvec3 f = glm::smoothstep(dvec3(0), dvec3(1), at - low);
  dvec3 out(0);
  for (int k = 0; k < 8; ++k) {
    const glm::ivec3 corner(k & 1, k >> 1 & 1, k >> 2);
    const dvec3 w = glm::mix(dvec3(1) - f, f, dvec3(corner));
    for (int c = 0; c < 3; ++c) out[c] += w.x * w.y * w.z * hashed(glm::ivec3(low) + corner, c);
  }
  return 30.0 + 200.0 * out;
}

using Shape = std::function<double(const dvec3&)>;                 // signed distance, metres, negative inside
using Colour = std::function<dvec3(size_t camera, const dvec3&)>;  // 0 … 255

// RGBA picture of the shape in front of a backdrop of one colour per camera.
Image traced(const PinholeCamera& camera, size_t index, const Shape& shape, const Colour& colour,
             const dvec3& backdrop) {
  Image out(camera.width, camera.height, 4);
  const glm::dmat3 world_from_cam = glm::transpose(glm::dmat3(camera.cam_from_world));
  const dvec3 eye = camera.centreInWorld();
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      const dvec3 ray = glm::normalize(world_from_cam *
                                       dvec3((x + 0.5 - camera.cx) / camera.fx, (y + 0.5 - camera.cy) / camera.fy, 1));
      double t = kDistance_m - 0.5, d = 1;
      for (int k = 0; k < 96 && d > 1e-5 && t < kDistance_m + 0.5; ++k) t += d = shape(eye + t * ray);
      const bool hit = d < 1e-3;
      const dvec3 rgb = hit ? colour(index, eye + t * ray) : backdrop;
      for (int c = 0; c < 3; ++c) out.at(x, y)[c] = uint8_t(rgb[c] + 0.5);
      out.at(x, y)[3] = hit ? 255 : 0;
    }
  return out;
}

struct Hull {
  std::vector<silhouette::Silhouette> silhouettes;
  std::vector<CarvingView> views;
  SparseDistance distance;
  TriangleMesh mesh;
};

class StereoTest : public GlFixture {
 protected:
  void SetUp() override {
    GlFixture::SetUp();
    for (int k = 0; k < 8; ++k) {
      const double angle = glm::radians(45.0 * k);
      cameras.push_back(
          lookAt({kDistance_m * std::sin(angle), 0.4, kDistance_m * std::cos(angle)}, {0, 0, 0}, kSide, kSide, kFocal));
      cameras.back().name = "cam" + std::to_string(k);
    }
    options.reduction = 1;
    options.adaptivity = 0;
  }

  std::vector<Image> pictures(const Shape& shape, const Colour& colour, const dvec3& backdrop = dvec3(90)) const {
    std::vector<Image> out;
    for (size_t c = 0; c < cameras.size(); ++c) out.push_back(traced(cameras[c], c, shape, colour, backdrop));
    return out;
  }

  Hull hullOf(const std::vector<Image>& pictures) const {
    Hull out;
    for (size_t c = 0; c < cameras.size(); ++c) {
      Image coverage(kSide, kSide, 1);
      for (size_t i = 0; i < coverage.pixels.size(); ++i) coverage.pixels[i] = pictures[c].pixels[4 * i + 3];
      out.silhouettes.push_back({cameras[c], coverage});
    }
    for (const silhouette::Silhouette& s : out.silhouettes)
      out.views.push_back({&s, silhouette::SilhouetteDistance(s.coverage)});
    out.distance = carve(out.views, kVoxel_m).take();
    out.mesh = zeroSurface(out.distance, 0);
    dropSpecks(out.mesh, 27 * kVoxel_m * kVoxel_m * kVoxel_m);
    return out;
  }

  std::unique_ptr<StereoRefiner> refiner() {
    auto made = StereoRefiner::create(*device, cameras, options);
    EXPECT_TRUE(made) << made.error().message;
    return made.take();
  }

  static TriangleMesh refined(StereoRefiner& stereo, const Hull& hull, const std::vector<Image>& pictures) {
    auto mesh = stereo.refine(hull.distance, hull.mesh, pictures, hull.views);
    EXPECT_TRUE(mesh) << mesh.error().message;
    return mesh.take();
  }

  std::vector<PinholeCamera> cameras;
  StereoOptions options;
};

const Colour kTextured = [](size_t, const dvec3& p) { return texture(p); };

// Mean distance of a region's vertices from the shape, metres.
double meanError_m(const TriangleMesh& mesh, const Shape& shape, const std::function<bool(const dvec3&)>& inside) {
  double sum = 0;
  size_t count = 0;
  for (const glm::vec3& p : mesh.positions)
    if (inside(p)) sum += std::abs(shape(p)), ++count;
  return count ? sum / double(count) : std::numeric_limits<double>::infinity();
}
const auto kInBowl = [](const dvec3& p) { return p.z > 0.1 && std::hypot(p.x, p.y) < 0.08; };
const auto kBehind = [](const dvec3& p) { return p.z < 0; };
const auto kEverywhere = [](const dvec3&) { return true; };

// Mean difference between the depths of two surfaces in a camera, metres.
double meanMotion_m(const PinholeCamera& camera, const TriangleMesh& a, const TriangleMesh& b) {
  const auto in_a = rasterise(camera, a.faces, a.positions, 1), in_b = rasterise(camera, b.faces, b.positions, 1);
  double sum = 0;
  size_t count = 0;
  for (size_t i = 0; i < in_a.depth_m.size(); ++i) {
    const double d = std::abs(double(in_a.depth_m[i]) - double(in_b.depth_m[i]));
    if (d < 0.1) sum += d, ++count;
  }
  return sum / double(count);
}

// Area of the faces whose first corner lies in a region, square metres.
double areaOf(const TriangleMesh& mesh, const std::function<bool(const dvec3&)>& inside) {
  double sum = 0;
  for (const glm::uvec3& f : mesh.faces) {
    const dvec3 a(mesh.positions[f.x]), b(mesh.positions[f.y]), c(mesh.positions[f.z]);
    if (inside(a)) sum += glm::length(glm::cross(b - a, c - a)) / 2;
  }
  return sum;
}

void addNoise(std::vector<Image>& pictures, unsigned seed) {
  std::mt19937 random(seed);
  for (Image& image : pictures)
    for (size_t i = 0; i < image.pixels.size(); ++i)
      if (i % 4 != 3) image.pixels[i] = uint8_t(std::clamp(int(image.pixels[i]) + int(random() % 5) - 2, 0, 255));
}

TEST_F(StereoTest, FindsTheBowlThatTheHullFills) {
  const std::vector<Image> seen = pictures(bowlInBall, kTextured);
  remember(seen[0]);
  const Hull hull = hullOf(seen);
  const TriangleMesh mesh = refined(*refiner(), hull, seen);
  EXPECT_GT(meanError_m(hull.mesh, bowlInBall, kInBowl), 0.030);
  EXPECT_LT(meanError_m(mesh, bowlInBall, kInBowl), 0.004);
  // The hull is unchanged where it is right.
  EXPECT_LT(meanError_m(mesh, bowlInBall, kBehind), meanError_m(hull.mesh, bowlInBall, kBehind) + 0.001);
}

TEST_F(StereoTest, HullStaysWithoutTexture) {
  std::vector<Image> seen = pictures(bowlInBall, [](size_t, const dvec3&) { return dvec3(160, 120, 80); });
  addNoise(seen, 5);
  const Hull hull = hullOf(seen);
  const auto stereo = refiner();
  const TriangleMesh mesh = refined(*stereo, hull, seen);
  EXPECT_EQ(mesh.positions, hull.mesh.positions);
  EXPECT_EQ(mesh.faces, hull.mesh.faces);
  for (const double believed : stereo->believed()) EXPECT_LT(believed, 0.01);
}

// A drum whose contrast-rich top all cameras see within 8 degrees of edge-on: patches there are compressed to a
// seventh. The result must be the hull, which is right there, without holes or noise.
TEST_F(StereoTest, GrazingCamerasEndInTheHull) {
  const double up = glm::radians(8.0);
  for (size_t k = 0; k < cameras.size(); ++k) {
    const double round = glm::radians(45.0 * double(k));
    cameras[k] =
        lookAt(kDistance_m * dvec3(std::sin(round) * std::cos(up), std::sin(up), std::cos(round) * std::cos(up)),
               {0, 0, 0}, kSide, kSide, kFocal);
  }
  const Shape drum = [](const dvec3& p) {
    const glm::dvec2 d(std::hypot(p.x, p.z) - 0.25, std::abs(p.y) - 0.15);
    return glm::length(glm::max(d, glm::dvec2(0))) + std::min(std::max(d.x, d.y), 0.0);
  };
  std::vector<Image> seen = pictures(drum, kTextured);
  addNoise(seen, 3);
  const Hull hull = hullOf(seen);
  const TriangleMesh mesh = refined(*refiner(), hull, seen);
  const auto onTop = [](const dvec3& p) { return p.y > 0.1 && std::hypot(p.x, p.z) < 0.22; };
  EXPECT_LT(meanError_m(mesh, drum, onTop), meanError_m(hull.mesh, drum, onTop) + 0.0005);
  EXPECT_LT(areaOf(mesh, onTop), 1.01 * areaOf(hull.mesh, onTop));
  for (const PinholeCamera& camera : cameras) {
    const auto before = rasterise(camera, hull.mesh.faces, hull.mesh.positions, 1),
               after = rasterise(camera, mesh.faces, mesh.positions, 1);
    size_t hit = 0, lost = 0;
    for (size_t i = 0; i < before.face.size(); ++i)
      if (before.face[i] != FaceBuffer::kNoFace) ++hit, lost += after.face[i] == FaceBuffer::kNoFace;
    ASSERT_GT(hit, 1000u);
    EXPECT_LT(double(lost), 0.005 * double(hit));
  }
}

// Each camera sees the performer in one colour and its neighbours' backdrops in the same one: points beside the
// performer have better photo-consistency than the performer.
TEST_F(StereoTest, BackdropDoesNotAttract) {
  const dvec3 colours[2] = {{160, 120, 80}, {60, 90, 140}};
  std::vector<Image> seen;
  for (size_t c = 0; c < cameras.size(); ++c)
    seen.push_back(traced(
        cameras[c], c, ball, [&](size_t camera, const dvec3&) { return colours[camera % 2]; }, colours[1 - c % 2]));
  const Hull hull = hullOf(seen);
  options.sweep.labels = kMaxLabels;
  options.smoothing.front_bias = 0, options.agreement_m = 1;  // no other term favours the hull
  const TriangleMesh mesh = refined(*refiner(), hull, seen);
  EXPECT_LT(meanError_m(mesh, ball, kEverywhere), meanError_m(hull.mesh, ball, kEverywhere) + 0.0005);
}

TEST_F(StereoTest, SameFramesGiveTheSameSurfaces) {
  std::vector<Image> first = pictures(bowlInBall, kTextured), second = first;
  addNoise(second, 1);
  const Hull hull = hullOf(first);
  const auto once = refiner();
  refined(*once, hull, first);
  const TriangleMesh a = refined(*once, hull, second);
  once->forget();
  const TriangleMesh alone = refined(*once, hull, second);
  once->forget();
  refined(*once, hull, first);
  const TriangleMesh b = refined(*once, hull, second);
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.faces, b.faces);
  EXPECT_NE(a.positions, alone.positions) << "the frame before must count";
}

TEST_F(StereoTest, StandsStillWithThePicturesAndDoesNotLag) {
  const std::vector<Image> clean = pictures(bowlInBall, kTextured);
  std::vector<Image> noisy[2] = {clean, clean};
  addNoise(noisy[0], 1), addNoise(noisy[1], 2);
  const Hull hull = hullOf(clean);
  const auto motion = [&](float kept) {
    options.kept = kept;
    const auto stereo = refiner();
    const TriangleMesh before = refined(*stereo, hull, noisy[0]);
    return meanMotion_m(cameras[0], before, refined(*stereo, hull, noisy[1]));
  };
  EXPECT_LT(motion(0.8f), 0.4 * motion(0));

  options.kept = 0.8f;
  const Shape moved = [](const dvec3& p) { return bowlInBall(p - dvec3(0.03, 0, 0)); };
  const std::vector<Image> later =
      pictures(moved, [](size_t, const dvec3& p) { return texture(p - dvec3(0.03, 0, 0)); });
  const Hull later_hull = hullOf(later);
  const auto stereo = refiner();
  refined(*stereo, hull, clean);
  const TriangleMesh followed = refined(*stereo, later_hull, later);
  EXPECT_LT(meanMotion_m(cameras[0], followed, refined(*refiner(), later_hull, later)), 0.0003);
}

TEST_F(StereoTest, BadSizesAreRefused) {
  std::vector<Image> seen = pictures(ball, kTextured);
  const Hull hull = hullOf(seen);
  const auto stereo = refiner();
  const auto refused = [&](const std::vector<Image>& pictures) {
    const auto mesh = stereo->refine(hull.distance, hull.mesh, pictures, hull.views);
    return !mesh.ok() && mesh.error().id == ErrorId::InvalidArgument;
  };
  std::vector<Image> fewer(seen.begin(), seen.end() - 1), smaller = seen, opaque = seen;
  smaller[3] = Image(kSide / 2, kSide, 4);
  opaque[3] = Image(kSide, kSide, 3);
  EXPECT_TRUE(refused(fewer));
  EXPECT_TRUE(refused(smaller));
  EXPECT_TRUE(refused(opaque));
  EXPECT_FALSE(refused(seen));

  const auto created = [&](const StereoOptions& o) { return StereoRefiner::create(*device, cameras, o); };
  for (const int labels : {0, 6, kMaxLabels + 4}) {
    StereoOptions wrong = options;
    wrong.sweep.labels = labels;
    EXPECT_FALSE(created(wrong)) << labels;
  }
  const auto one = StereoRefiner::create(*device, {cameras[0]}, options);
  ASSERT_FALSE(one);
  EXPECT_EQ(one.error().id, ErrorId::InvalidArgument);
}

TEST(SteadyDistance, CodecNoiseIsNoChange) {
  Image before(32, 32, 4, 100), now = before;
  for (size_t i = 0; i < now.pixels.size(); ++i) now.pixels[i] = uint8_t(now.pixels[i] + i * 7 % 5 - 2);
  for (int y = 0; y < 32; ++y)
    for (int x = 24; x < 32; ++x) now.at(x, y)[1] = 160;
  const std::vector<float> change = changeOf(before, now);
  EXPECT_EQ(change[16 * 32 + 8], 0);
  EXPECT_EQ(change[16 * 32 + 28], 1);
}

}  // namespace
}  // namespace fourdvt::testing
