// SPDX-License-Identifier: Apache-2.0
// Rendered views reveal neither chart seams nor the backdrop's green, between the cameras and at grazing angles, on an
// analytic cylinder and on the sample capture; deliberately broken bakes show both. Bounds lie near the values measured
// on the software rasteriser, given beside them.
#include <algorithm>

#include "bake/labels/face_costs.h"
#include "bake/texels/fill.h"
#include "bake/texels/frame_baker.h"
#include "bake/texels/resample.h"
#include "capture/capture.h"
#include "encode/tile.h"
#include "gl_fixture.h"
#include "lab/measure/seam_contrast.h"
#include "mattes/frame_reader.h"
#include "platform/ffmpeg_video.h"
#include "seam_scene.h"

namespace fourdvt::bake {
namespace {

struct Filmed {
  std::vector<PinholeCamera> cameras;
  MeshTopology topology;
  Positions positions;
  std::vector<Image> pictures;
};

struct BakeSettings {
  int texture = 256;
  float gutter_texels = 6;
  bool fill = true;
  bool use_matte = true;
};

struct Look {
  double seam = 0, control = 0;  // levels, see SeamContrast
  size_t samples = 0;
  double fringe = 0;
  double visible() const { return samples ? (seam - control) / double(samples) : 1e9; }
};

std::vector<uint8_t> labelsByPenalty(const Filmed& filmed, const std::vector<float>& fractions, int layers) {
  const FaceCosts costs = measureFaceCosts({}, filmed.cameras, filmed.topology, filmed.positions, fractions);
  const size_t faces = filmed.topology.faceCount();
  std::vector<uint8_t> labels(layers * faces, package::kNoCamera);
  for (size_t f = 0; f < faces; ++f) {
    std::vector<std::pair<float, uint8_t>> order;
    for (int c = 0; c < costs.camera_count; ++c)
      if (costs.feasible[f] >> c & 1) order.emplace_back(costs.penalty[f * costs.camera_count + c], uint8_t(c));
    std::sort(order.begin(), order.end());
    for (size_t l = 0; l < std::min<size_t>(layers, order.size()); ++l) labels[l * faces + f] = order[l].second;
  }
  return labels;
}

struct Seams : testing::GlFixture {
  struct Baked {
    std::vector<uint8_t> labels;
    std::vector<Image> layers;
  };

  Baked bakeFrame(const Filmed& filmed, const encode::TileLayout& layout, const BakeSettings& settings) {
    auto made = GpuCapture::create(*device, filmed.cameras, filmed.topology, false);
    EXPECT_TRUE(made) << (made ? "" : made.error().message);
    GpuCapture capture = made.take();
    std::vector<PictureCrop> crops;
    for (size_t c = 0; c < filmed.cameras.size(); ++c) {
      Image picture = filmed.pictures[c];
      for (size_t i = 3; !settings.use_matte && i < picture.pixels.size(); i += 4) picture.pixels[i] = 255;
      crops.push_back(cropPicture(filmed.cameras[c], filmed.positions, picture));
    }
    capture.setFrame(*device, filmed.positions, crops);
    Visibility visibility = Visibility::create(*device, capture).take();
    std::vector<int> sizes;
    for (const package::Rect& rect : layout.layers) sizes.push_back(rect.width);
    Baked out;
    out.labels = labelsByPenalty(filmed, visibility.measure(*device, capture).take(), int(sizes.size()));
    Resampler resampler = Resampler::create(*device, capture, sizes, {}, {}).take();
    out.layers = resampler.resample(*device, capture, out.labels).take();
    if (!settings.fill) return out;
    std::vector<GutterMap> maps;
    std::vector<const GutterMap*> pointers;
    for (int size : sizes)
      maps.push_back(makeGutterMap(filmed.topology, size, settings.gutter_texels * size / sizes[0]));
    for (const GutterMap& map : maps) pointers.push_back(&map);
    fillLayers(pointers, out.layers);
    return out;
  }

  Look look(const Filmed& filmed, const std::vector<PinholeCamera>& views, const BakeSettings& settings,
            double min_angle_deg) {
    constexpr int kLayers = 3;
    const encode::TileLayout layout = encode::makeTileLayout(kLayers, settings.texture);
    const Baked baked = bakeFrame(filmed, layout, settings);
    testing::Scene scene;
    scene.mesh.topology = filmed.topology;
    scene.mesh.positions = filmed.positions;
    scene.character.cameras = filmed.cameras;
    scene.character.layer_count = kLayers;
    scene.rendition.width = layout.width;
    scene.rendition.height = layout.height;
    scene.rendition.layers = layout.layers;
    scene.labels = baked.labels;
    scene.finish();
    testing::Still still(*device, scene, render::PictureTextures::Kind::Rgba);
    for (int l = 0; l < kLayers; ++l) {
      const package::Rect& at = layout.layers[l];
      device->updateTexture(still.picture.rgba.id(), {.x = at.x, .y = at.y, .width = at.width, .height = at.height},
                            baked.layers[l].pixels.data());
    }
    Look sum;
    render::RecipeOptions options;
    options.ground_shadow = false;
    for (const PinholeCamera& view : views) {
      Image picture = still.draw(render::viewFromCamera(view), options);
      straighten(picture);
      remember(picture);
      add(measure::seamContrast(picture, view, filmed.topology, filmed.positions, {min_angle_deg}), sum);
      sum.fringe += measure::fringeShare(picture, testing::kBackdrop) / double(views.size());
    }
    report(sum);
    return sum;
  }

  static void add(const measure::SeamContrast& contrast, Look& sum) {
    sum.seam += contrast.seam * double(contrast.samples);
    sum.control += contrast.control * double(contrast.samples);
    sum.samples += contrast.samples;
  }
  static void report(const Look& l) {
    const double n = double(std::max<size_t>(l.samples, 1));
    printf("seams %.2f, surroundings %.2f, visible %.2f levels over %zu samples; fringe %.4f\n", l.seam / n,
           l.control / n, l.visible(), l.samples, l.fringe);
  }

  static void straighten(Image& premultiplied) {
    for (size_t i = 0; i < premultiplied.pixels.size(); i += 4)
      if (const int a = premultiplied.pixels[i + 3])
        for (int c = 0; c < 3; ++c)
          premultiplied.pixels[i + c] =
              static_cast<uint8_t>(std::min(255, (premultiplied.pixels[i + c] * 255 + a / 2) / a));
  }

  static std::vector<PinholeCamera> viewsBetween(int count, double first_deg, double distance_m, int width,
                                                 int height) {
    std::vector<PinholeCamera> views;
    for (double elevation : {-40.0, 0.0, 40.0})
      for (int k = 0; k < count; ++k) {
        OrbitView orbit;
        orbit.azimuth_deg = first_deg + 360.0 * k / count;
        orbit.elevation_deg = elevation;
        orbit.distance_m = distance_m;
        orbit.target_in_world = {0, 0.85, 0};
        views.push_back(cameraFromOrbit(orbit, width, height));
      }
    return views;
  }
};

struct CylinderSeams : Seams {
  static Filmed film() {
    const testing::Cylinder cylinder;
    Filmed filmed{{}, cylinder.topology, cylinder.positions, {}};
    for (int k = 0; k < 6; ++k) {
      const double turn = k * M_PI / 3;
      filmed.cameras.push_back(
          testing::lookAt({2.5 * std::sin(turn), 0.8, 2.5 * std::cos(turn)}, {0, 0.8, 0}, 160, 240, 300));
      filmed.pictures.push_back(testing::filmCylinder(filmed.cameras.back()));
    }
    return filmed;
  }
  const Filmed filmed = film();
  const std::vector<PinholeCamera> views = viewsBetween(12, 15, 2.6, 240, 320);
};

TEST_F(CylinderSeams, NeitherSeamsNorBackdropShow) {
  const Look all = look(filmed, views, {}, 0), grazing = look(filmed, views, {}, 60);
  EXPECT_GT(all.samples, 3000u);
  EXPECT_GT(grazing.samples, 200u);
  EXPECT_LT(all.visible(), 0);        // -0.18
  EXPECT_LT(grazing.visible(), 0.7);  // 0.50
  EXPECT_LT(all.fringe, 0.0125);      // 0.0108
}

TEST_F(CylinderSeams, WithoutGuttersSeamsShow) {
  BakeSettings broken;
  broken.gutter_texels = 0;
  EXPECT_GT(look(filmed, views, broken, 0).visible(), 0.3);  // 0.47
}

TEST_F(CylinderSeams, WithoutFillingSeamsShow) {
  BakeSettings broken;
  broken.fill = false;
  EXPECT_GT(look(filmed, views, broken, 0).visible(), 22);  // 27.4
}

TEST_F(CylinderSeams, WithoutMatteTheBackdropShows) {
  BakeSettings broken;
  broken.use_matte = false;
  EXPECT_GT(look(filmed, views, broken, 0).fringe, 0.07);  // 0.084
}

struct SampleSeams : Seams {
  Filmed filmed;
  std::string folder = std::string(FOURDVT_SOURCE_DIR) + "/site/sample/actor_a";
  static constexpr BakeSettings kSettings{1024, 10};

  void SetUp() override {
    Seams::SetUp();
    auto capture = mattes::openCapture(folder, platform::openVideoFile, {"run"});
    ASSERT_TRUE(capture) << capture.error().message;
    auto reader = mattes::FrameReader::open(capture.value(), capture.value().sequences[0], platform::openVideoFile);
    ASSERT_TRUE(reader) << reader.error().message;
    auto frame = reader.value()->next();
    ASSERT_TRUE(frame) << frame.error().message;
    filmed = {{}, capture.value().topology, frame.value().positions, std::move(frame.value().pictures)};
    for (const auto& camera : capture.value().cameras) filmed.cameras.push_back(camera.pinhole);
  }
};

// The sample's charts end where cloth and skin meet, so that its seams have contrast of their own: contrast up to that
// of the truth pictures is no artefact.
TEST_F(SampleSeams, NoMoreThanTheTruthShows) {
  Look truth;
  std::vector<PinholeCamera> views;
  for (const auto& camera : capture::readColmapCameras(folder + "/cameras_test").take()) {
    views.push_back(camera.pinhole);
    Image picture = platform::readImage(folder + "/run/" + camera.pinhole.name + "/0000.png").take();
    truth.fringe += measure::fringeShare(picture, testing::kBackdrop) / 3;
    for (size_t i = 0; i < picture.pixels.size(); ++i)
      picture.pixels[i] = static_cast<uint8_t>(picture.pixels[i] * picture.pixels[i / 4 * 4 + 3] / 255);
    add(measure::seamContrast(picture, camera.pinhole, filmed.topology, filmed.positions), truth);
  }
  report(truth);
  const Look ours = look(filmed, views, kSettings, 0);
  EXPECT_GT(ours.samples, 1000u);
  // Contrast at the seams over that of their surroundings: 1.41, the truth's 1.22; its surroundings have more contrast.
  EXPECT_LT(ours.seam / ours.control, 1.18 * truth.seam / truth.control);
  EXPECT_LT(ours.seam, 0.95 * double(ours.samples) / double(truth.samples) * truth.seam);  // 26.5 and 29.4 levels
  EXPECT_LT(ours.fringe, truth.fringe + 0.0045);                                           // 0.0018 + 0.0033
}

TEST_F(SampleSeams, GrazingViewsBetweenTheCameras) {
  const std::vector<PinholeCamera> views = viewsBetween(4, 22.5, 3.2, 540, 720);
  const Look grazing = look(filmed, views, kSettings, 60);
  EXPECT_GT(grazing.samples, 500u);
  EXPECT_LT(grazing.visible(), 6.4);  // 5.75
  EXPECT_LT(grazing.fringe, 0.006);   // 0.0048
  EXPECT_GT(look(filmed, views, {1024, 10, false, true}, 60).visible(), 17) << "not filled: seams must show";
  EXPECT_GT(look(filmed, views, {1024, 10, true, false}, 60).fringe, 0.026) << "matte ignored: green must show";
}

}  // namespace
}  // namespace fourdvt::bake
