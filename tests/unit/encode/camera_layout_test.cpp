// SPDX-License-Identifier: Apache-2.0
// Characters from cameras: regions, packing, the tiled picture's layout, and the filling of tiles.
#include "encode/camera_layout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "encode/surfaces.h"

namespace fourdvt::encode {
namespace {

using package::CameraTile, package::Rect;

bool overlap(const Rect& a, const Rect& b) {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

std::vector<PinholeCamera> ring(int count, int width = 720, int height = 960) {
  std::vector<PinholeCamera> out;
  for (int k = 0; k < count; ++k) {
    OrbitView view;
    view.azimuth_deg = 360.0 * k / count;
    out.push_back(cameraFromOrbit(view, width, height));
  }
  return out;
}

std::vector<std::vector<Rect>> randomRegions(uint32_t seed, size_t gops, size_t cameras, int width, int height) {
  std::mt19937 random(seed);
  const auto below = [&](int n) { return static_cast<int>(random() % uint32_t(n)); };
  std::vector<std::vector<Rect>> out(gops);
  for (auto& gop : out) {
    for (size_t c = 0; c < cameras; ++c) {
      const int w = 1 + below(width), h = 1 + below(height);
      gop.push_back(below(8) == 0 ? Rect{} : Rect{below(width - w + 1), below(height - h + 1), w, h});
    }
  }
  return out;
}

void expectSound(const CameraLayout& layout, const std::vector<PinholeCamera>& cameras,
                 const std::vector<std::vector<Rect>>& regions) {
  EXPECT_EQ(layout.picture_width % 2, 0);
  EXPECT_EQ(layout.picture_height % 2, 0);
  EXPECT_GE(layout.picture_width, layout.width);
  ASSERT_EQ(layout.gops.size(), regions.size());
  for (size_t g = 0; g < regions.size(); ++g) {
    std::vector<Rect> taken{layout.barcode.rect};
    for (size_t c = 0; c < cameras.size(); ++c) {
      const CameraTile& t = layout.gops[g][c];
      const Rect& region = regions[g][c];
      ASSERT_EQ(t.empty(), region.width == 0);
      if (t.empty()) continue;
      EXPECT_TRUE(t.source.x >= 0 && t.source.y >= 0 && t.source.x + t.source.width <= cameras[c].width &&
                  t.source.y + t.source.height <= cameras[c].height);
      EXPECT_TRUE(t.source.x <= region.x && t.source.y <= region.y &&
                  t.source.x + t.source.width >= region.x + region.width &&
                  t.source.y + t.source.height >= region.y + region.height);
      const Rect cells = cellsOf(t.tile);
      EXPECT_EQ(cells.x % kCellTexels + cells.y % kCellTexels, 0);
      EXPECT_LE(cells.x + cells.width, layout.width);
      EXPECT_LE(cells.y + cells.height, layout.height);
      for (const Rect& other : taken) EXPECT_FALSE(overlap(cells, other)) << "GOP " << g << ", camera " << c;
      taken.push_back(cells);
    }
  }
}

// Cells scale to whole texels at every eighth, so that no texel of a smaller picture covers two cells.
TEST(CameraLayout, ASmallerPictureKeepsTilesApart) {
  const auto cameras = ring(5, 200, 160);
  const CameraLayout layout = planCameraLayout(cameras, randomRegions(3, 2, 5, 200, 160), 1);
  for (int eighths = 1; eighths <= 8; ++eighths) {
    const CameraPicture picture = scaledPicture(layout, eighths);
    EXPECT_EQ(picture.width % 16, 0);
    EXPECT_EQ(picture.height % 16, 0);
    EXPECT_EQ(picture.tiles.width * 8, layout.width * eighths);
    EXPECT_EQ(picture.tiles.height * 8, layout.height * eighths);
    EXPECT_FALSE(overlap(picture.tiles, picture.barcode.rect));
    EXPECT_LE(picture.barcode.rect.y + picture.barcode.rect.height, picture.height);
    EXPECT_LE(picture.barcode.rect.width, picture.width);
    for (const CameraTile& tile : layout.gops[0]) {
      const Rect cells = cellsOf(tile.tile), small = scaledCells(cells, eighths);
      const int pairs[4][2] = {
          {small.x, cells.x}, {small.y, cells.y}, {small.width, cells.width}, {small.height, cells.height}};
      for (const auto& [side, whole] : pairs) {
        EXPECT_EQ(side * 8, whole * eighths);
        EXPECT_EQ(side % 2, 0) << "chroma";
      }
    }
  }
  EXPECT_EQ(scaledPicture(layout, 8).width, layout.picture_width);
  EXPECT_EQ(scaledPicture(layout, 8).height, layout.picture_height);
}

TEST(Packing, PutsRectanglesApartAndFillsAGrid) {
  std::mt19937 random(1);
  for (int round = 0; round < 200; ++round) {
    std::vector<glm::ivec2> sizes;
    for (uint32_t i = 0; i < 1 + random() % 31; ++i) sizes.emplace_back(1 + random() % 60, 1 + random() % 60);
    const int width = 60 + int(random() % 100);
    const Packing packing = packInto(sizes, width);
    for (size_t i = 0; i < sizes.size(); ++i) {
      const Rect a{packing.places[i].x, packing.places[i].y, sizes[i].x, sizes[i].y};
      EXPECT_TRUE(a.x >= 0 && a.y >= 0 && a.x + a.width <= width && a.y + a.height <= packing.height);
      for (size_t j = 0; j < i; ++j)
        EXPECT_FALSE(overlap(a, {packing.places[j].x, packing.places[j].y, sizes[j].x, sizes[j].y}));
    }
    EXPECT_EQ(packInto(sizes, width).places, packing.places);
  }
  const std::vector<glm::ivec2> grid(12, glm::ivec2(10, 7));
  EXPECT_EQ(packInto(grid, 40).height, 21);
  EXPECT_EQ(packInto(std::vector<glm::ivec2>{{0, 5}, {3, 0}}, 10).height, 0);
}

TEST(CameraLayout, KeepsEveryRegionInOneLayout) {
  const auto cameras = ring(8);
  for (uint32_t seed = 0; seed < 6; ++seed) {
    const auto regions = randomRegions(seed, 5, cameras.size(), 720, 960);
    for (double scale : {1.0, 0.37}) expectSound(planCameraLayout(cameras, regions, scale), cameras, regions);
  }
}

TEST(CameraLayout, ScaleOneShowsPixelsAsTheyAre) {
  const auto cameras = ring(3, 101, 75);  // picture sizes that are no multiples of a cell
  const auto regions = randomRegions(3, 2, cameras.size(), 101, 75);
  const CameraLayout layout = planCameraLayout(cameras, regions, 1);
  expectSound(layout, cameras, regions);
  for (const auto& gop : layout.gops) {
    for (const CameraTile& t : gop) {
      EXPECT_EQ(t.tile.width, t.source.width);
      EXPECT_EQ(t.tile.height, t.source.height);
    }
  }
}

TEST(CameraLayout, WastesLittle) {
  const auto cameras = ring(8);
  const std::vector<std::vector<Rect>> regions(3, std::vector<Rect>(8, Rect{200, 100, 256, 768}));
  const CameraLayout layout = planCameraLayout(cameras, regions, 1);
  EXPECT_LT(layout.pictureTexels(), 1.05 * 8 * 256 * 768);
  EXPECT_EQ(checkCameraLayout(layout, 1, 9.4e6), "");
}

TEST(CameraLayout, SaysWhichScaleWouldFit) {
  const auto cameras = ring(31, 1920, 1080);
  const std::vector<std::vector<Rect>> regions(1, std::vector<Rect>(31, Rect{400, 0, 600, 1080}));
  const CameraLayout large = planCameraLayout(cameras, regions, 1);
  const std::string wrong = checkCameraLayout(large, 1, 9.4e6);
  const size_t at = wrong.find("--tile-scale ");
  ASSERT_NE(at, std::string::npos) << wrong;
  const double scale = std::stod(wrong.substr(at + 13));
  EXPECT_GT(scale, 0.5);
  EXPECT_EQ(checkCameraLayout(planCameraLayout(cameras, regions, scale), scale, 9.4e6), "") << wrong;
}

TEST(CameraLayout, RegionsHoldTheProjectedSurface) {
  const auto camera = ring(1)[0];
  const Rect region = regionOfInterest(camera, {{-0.2f, 0.5f, 0}, {0.3f, 1.2f, 0.1f}});
  for (const glm::dvec3& p : {glm::dvec3(-0.2, 0.5, 0), glm::dvec3(0.3, 1.2, 0.1)}) {
    const glm::dvec3 pixel = camera.project(p);
    EXPECT_TRUE(pixel.x > region.x && pixel.x < region.x + region.width && pixel.y > region.y &&
                pixel.y < region.y + region.height);
  }
  EXPECT_EQ(regionOfInterest(camera, {{0, 0.9f, 10}}).width, 0) << "behind the camera";
  const Rect both = united({10, 20, 5, 5}, {2, 22, 4, 9});
  EXPECT_EQ(both.x, 2);
  EXPECT_EQ(both.width, 13);
  EXPECT_EQ(both.height, 11);
  EXPECT_EQ(united({}, {2, 3, 4, 5}).x, 2);
}

// Disc of two colours in the middle.
Image disc(int size) {
  Image out(size, size, 4);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const int dx = 2 * x + 1 - size, dy = 2 * y + 1 - size;
      if (dx * dx + dy * dy > size * size / 4) continue;
      uint8_t* p = out.at(x, y);
      p[0] = x < size / 2 ? 200 : 40, p[1] = 90, p[2] = 30, p[3] = 255;
    }
  }
  return out;
}

TEST(DrawTile, KeepsThePerformerAndFillsTheRestSmoothly) {
  const Image source = disc(60);
  const Image tile = drawTile(source, {60, 60}, {64, 64});
  int steepest = 0;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const uint8_t* p = tile.at(x, y);
      const bool inside = x < 60 && y < 60 && source.at(x, y)[3];
      if (inside) {
        EXPECT_EQ(p[0], source.at(x, y)[0]);
      }
      EXPECT_TRUE(p[0] >= 40 && p[0] <= 200);
      EXPECT_EQ(p[1], 90) << "what is of one colour goes on in it";
      const bool far = std::hypot(x - 29.5, y - 29.5) > 20;  // the disc's radius is 15
      if (far && x > 0) steepest = std::max(steepest, std::abs(p[0] - tile.at(x - 1, y)[0]));
    }
  }
  EXPECT_LT(steepest, 16) << "the disc has a step of 160";
  const Image wide = drawTile(source, {60, 60}, {256, 256});
  EXPECT_NEAR(wide.at(48, 30)[1], 90, 8) << "near the performer";
  EXPECT_EQ(wide.at(200, 200)[0], 128) << "far from him nothing changes";
  const Image empty = drawTile(Image(20, 10, 4), {20, 10}, {32, 16});
  EXPECT_TRUE(std::all_of(empty.pixels.begin(), empty.pixels.end(), [](uint8_t v) { return v == 128; }));
}

TEST(DrawTile, ShrinksByTheMeanOfWhatIsOpaque) {
  Image source(6, 4, 4);
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 6; ++x) {
      uint8_t* p = source.at(x, y);
      p[0] = static_cast<uint8_t>(10 * x), p[1] = 255, p[3] = x < 4 ? 255 : 0;
    }
  }
  const Image half = drawTile(source, {3, 2}, {16, 16});
  EXPECT_EQ(half.at(0, 0)[0], 5);
  EXPECT_EQ(half.at(1, 1)[0], 25);
  EXPECT_EQ(half.at(2, 0)[1], 255) << "from the opaque ones beside it";
  const Image two_thirds = drawTile(source, {4, 4}, {16, 16});
  EXPECT_NEAR(two_thirds.at(0, 0)[0], 10.0 / 3, 0.6);
}

TEST(QuantisedSurface, RoundsAndWeldsWhatLiesAtOnePlace) {
  const PositionGrid grid{{1, 2, 3}, 0.5};
  const Positions positions{{1, 2, 3}, {2, 2.2f, 3}, {1, 2, 4}, {1, 2, 3}, {2.01f, 2.2f, 3}};
  const std::vector<glm::uvec3> faces{{0, 1, 2}, {3, 2, 4}};
  const auto apart = quantisedSurface(grid, positions, faces, false);
  EXPECT_EQ(apart.faces, faces);
  EXPECT_EQ(apart.positions[1], glm::ivec3(2, 0, 0));
  EXPECT_EQ(apart.positions[2], glm::ivec3(0, 0, 2));
  const auto welded = quantisedSurface(grid, positions, faces, true);
  EXPECT_EQ(welded.faces[1], glm::uvec3(0, 2, 4)) << "places that only round to one stay two vertices";
  EXPECT_EQ(welded.positions, apart.positions);
}

// Closed unit sphere of `bands` by 2 `bands` quads.
TriangleMesh ball(uint32_t bands) {
  TriangleMesh out;
  const uint32_t around = 2 * bands;
  const auto add = [&](double polar, double azimuth) {
    out.positions.emplace_back(std::sin(polar) * std::cos(azimuth), std::cos(polar),
                               std::sin(polar) * std::sin(azimuth));
  };
  const double pi = std::acos(-1.0);
  add(0, 0);
  for (uint32_t j = 1; j < bands; ++j)
    for (uint32_t i = 0; i < around; ++i) add(pi * j / bands, 2 * pi * i / around);
  add(pi, 0);
  const uint32_t last = static_cast<uint32_t>(out.positions.size()) - 1;
  const auto at = [&](uint32_t j, uint32_t i) { return 1 + (j - 1) * around + i % around; };
  for (uint32_t i = 0; i < around; ++i) {
    out.faces.emplace_back(0, at(1, i + 1), at(1, i));
    for (uint32_t j = 1; j + 1 < bands; ++j) {
      out.faces.emplace_back(at(j, i), at(j, i + 1), at(j + 1, i));
      out.faces.emplace_back(at(j + 1, i), at(j, i + 1), at(j + 1, i + 1));
    }
    out.faces.emplace_back(last, at(bands - 1, i), at(bands - 1, i + 1));
  }
  return out;
}

TEST(SimplifiedSurface, KeepsItsShapeAndStaysClosed) {
  const TriangleMesh fine = ball(50);
  const TriangleMesh coarse = simplified(fine, 1000);
  EXPECT_LE(coarse.faces.size(), 1000u);
  EXPECT_GE(coarse.faces.size(), 900u);
  std::map<std::pair<uint32_t, uint32_t>, int> edges;
  double volume = 0;
  for (const glm::uvec3& f : coarse.faces) {
    for (int k = 0; k < 3; ++k) {
      ++edges[{f[k], f[(k + 1) % 3]}];
      --edges[{f[(k + 1) % 3], f[k]}];
    }
    const glm::dvec3 a(coarse.positions[f.x]), b(coarse.positions[f.y]), c(coarse.positions[f.z]);
    volume += glm::dot(a, glm::cross(b, c)) / 6;
    EXPECT_GT(glm::length((a + b + c) / 3.0), 0.97) << "the middle of a face";
  }
  for (const auto& [edge, count] : edges) EXPECT_EQ(count, 0) << "an edge without its other side";
  EXPECT_NEAR(std::abs(volume), 4.0 / 3 * std::acos(-1.0), 0.08);
}

TEST(SimplifiedSurface, LeavesASmallOneAloneAndWeldsALargeOne) {
  const TriangleMesh fine = ball(10);
  EXPECT_EQ(simplified(fine, 10000).faces, fine.faces);
  EXPECT_EQ(simplified(fine, 0).faces, fine.faces);
  TriangleMesh loose;  // every face has corners of its own
  for (const glm::uvec3& f : fine.faces) {
    const uint32_t first = static_cast<uint32_t>(loose.positions.size());
    for (int k = 0; k < 3; ++k) loose.positions.push_back(fine.positions[f[k]]);
    loose.faces.emplace_back(first, first + 1, first + 2);
  }
  const size_t faces = simplified(loose, 100).faces.size();
  EXPECT_LE(faces, 100u) << "faces that hang together can be simplified";
  EXPECT_GE(faces, 60u);
}

}  // namespace
}  // namespace fourdvt::encode
