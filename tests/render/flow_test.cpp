// SPDX-License-Identifier: Apache-2.0
// Optical flow by fragment passes: known motions of a synthetic texture, and OpenCV on the same pairs.
#include <cmath>
#include <functional>

#include "edge/opencv_flow.h"
#include "gl_fixture.h"
#include "render/flow/gpu_flow.h"

namespace fourdvt::render {
namespace {

using Motion = std::function<glm::dvec2(glm::dvec2)>;  // position in b of a point of a
struct Pair {
  Image a, b;
  std::vector<bool> inside;  // of the character, away from its outline
};

// Waves with periods of 9 to 120 pixels in many directions, 0..1.
double texture(glm::dvec2 p) {
  constexpr int kWaves = 14;
  double sum = 0;
  for (int i = 0; i < kWaves; ++i) {
    const double wavelength = 9 * std::pow(120.0 / 9, i / (kWaves - 1.0)), angle = 2.4 * i;
    sum += std::sin(2 * M_PI / wavelength * (p.x * std::cos(angle) + p.y * std::sin(angle)) + i * i);
  }
  return glm::clamp(0.5 + 0.09 * sum, 0.0, 1.0);
}

glm::dvec2 centre(const Image& image) { return {image.width / 2.0, image.height / 2.0}; }
double radius(const Image& image) { return 0.4 * std::min(image.width, image.height); }

// Textured disc that stands still while its texture moves, like one mesh under two appearances. Rows in GL order. The
// texture of b at p is that of a at from_b(p).
Pair disc(int width, int height, const Motion& from_b, double contrast = 1) {
  Pair pair{Image(width, height, 4), Image(width, height, 4), {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const glm::dvec2 p(x + 0.5, y + 0.5);
      const double edge = radius(pair.a) - glm::length(p - centre(pair.a));
      const double alpha = glm::clamp(edge + 0.5, 0.0, 1.0);
      const auto paint = [&](uint8_t* pixel, glm::dvec2 at) {
        for (int c = 0; c < 3; ++c)
          pixel[c] = static_cast<uint8_t>(std::lrint(255 * alpha * (0.5 + contrast * (texture(at) - 0.5))));
        pixel[3] = static_cast<uint8_t>(std::lrint(255 * alpha));
      };
      paint(pair.a.at(x, y), p);
      paint(pair.b.at(x, y), from_b(p));
      pair.inside.push_back(edge > 20);
    }
  return pair;
}

class Flow : public testing::GlFixture {
 protected:
  gpu::Texture upload(const Image& image) {
    auto texture = gpu::makeTexture(*device, {.width = image.width, .height = image.height, .label = "picture"}).take();
    device->updateTexture(texture.id(), {.width = image.width, .height = image.height}, image.pixels.data());
    return texture;
  }
  std::unique_ptr<FlowSource> gpuFlow(FlowMethod method, FlowOptions options = {}) {
    options.method = method;
    auto made = createGpuFlow(*device, options);
    EXPECT_TRUE(made) << (made ? "" : made.error().message);
    return made ? made.take() : nullptr;
  }
  // Flow with rows in GL order; `format`: of the source's texture.
  std::vector<glm::vec2> flow(FlowSource& source, const Pair& pair, gpu::PixelFormat format = gpu::PixelFormat::RG16F) {
    const int width = pair.a.width, height = pair.a.height;
    const gpu::Texture a = upload(pair.a), b = upload(pair.b);
    const Status computed = source.compute(a.id(), b.id(), width, height);
    EXPECT_TRUE(computed) << computed.error().message;
    std::vector<glm::vec2> top_first(pair.inside.size()), out(pair.inside.size());
    auto target = gpu::makeTarget(*device, {.colors = {source.flow()}, .label = "flow"}).take();
    EXPECT_TRUE(device->readPixels(target.id(), format, {.width = width, .height = height}, top_first.data()));
    for (int y = 0; y < height; ++y)
      std::copy_n(top_first.begin() + (height - 1 - y) * width, width, out.begin() + y * width);
    return out;
  }
  // Mean end-point error inside against the motion a → b.
  double error(const std::vector<glm::vec2>& flow, const Pair& pair, const Motion& to_b) {
    double sum = 0, count = 0;
    for (size_t i = 0; i < flow.size(); ++i) {
      if (!pair.inside[i]) continue;
      const glm::dvec2 p(i % pair.a.width + 0.5, i / pair.a.width + 0.5);
      sum += glm::length(p + glm::dvec2(flow[i]) - to_b(p));
      count += 1;
    }
    return sum / count;
  }
};

TEST_F(Flow, findsAShiftAtSubPixels) {
  const glm::dvec2 shift(3.3, -2.6);
  const Pair pair = disc(256, 256, [&](glm::dvec2 p) { return p - shift; });
  const Motion moved = [&](glm::dvec2 p) { return p + shift; };
  EXPECT_LT(error(flow(*gpuFlow(FlowMethod::Farneback), pair), pair, moved), 0.05);
  EXPECT_LT(error(flow(*gpuFlow(FlowMethod::Dis), pair), pair, moved), 0.2);
}

TEST_F(Flow, findsARotationWithScaleInAnUnevenSize) {
  const glm::dvec2 middle(333 / 2.0, 251 / 2.0);
  const auto turned = [&](double angle, double scale) {
    return [=](glm::dvec2 p) {
      const glm::dvec2 r = p - middle;
      return middle + scale * glm::dvec2(std::cos(angle) * r.x - std::sin(angle) * r.y,
                                         std::sin(angle) * r.x + std::cos(angle) * r.y);
    };
  };
  const Pair pair = disc(333, 251, turned(-0.04, 1 / 1.03));
  EXPECT_LT(error(flow(*gpuFlow(FlowMethod::Farneback), pair), pair, turned(0.04, 1.03)), 0.15);
  EXPECT_LT(error(flow(*gpuFlow(FlowMethod::Dis), pair), pair, turned(0.04, 1.03)), 0.4);
}

TEST_F(Flow, agreesWithOpencvFarneback) {
  const auto source = gpuFlow(FlowMethod::Farneback), reference = edge::createOpencvFlow(*device);
  for (const glm::ivec2 size : {glm::ivec2(256, 256), glm::ivec2(333, 251), glm::ivec2(70, 190)}) {
    const Pair pair = disc(size.x, size.y, [&](glm::dvec2 p) {
      return p - glm::dvec2(4 * std::sin(p.y / 40) + 1, 3 * std::cos(p.x / 50));
    });
    const auto ours = flow(*source, pair), theirs = flow(*reference, pair, gpu::PixelFormat::RG32F);
    double sum = 0, size_of_flow = 0, count = 0;
    for (size_t i = 0; i < ours.size(); ++i) {
      if (!pair.inside[i]) continue;
      sum += glm::length(ours[i] - theirs[i]);
      size_of_flow += glm::length(theirs[i]);
      count += 1;
    }
    EXPECT_GT(size_of_flow / count, 1.5);
    EXPECT_LT(sum / count, 0.05) << size.x << " x " << size.y;
  }
}

// Half the size and one level fewer: the same patches, hence nearly the same flow, in pixels twice as large.
TEST_F(Flow, ofHalfTheSizeIsHalfAsLong) {
  const glm::dvec2 shift(5.3, -3.6);
  const Pair pair = disc(256, 320, [&](glm::dvec2 p) { return p - shift; });
  const auto small = gpuFlow(FlowMethod::Dis, {.finest = 1});
  const gpu::Texture a = upload(pair.a), b = upload(pair.b);
  ASSERT_TRUE(small->compute(a.id(), b.id(), 128, 160));
  std::vector<glm::vec2> found(128 * 160);
  auto target = gpu::makeTarget(*device, {.colors = {small->flow()}, .label = "flow"}).take();
  ASSERT_TRUE(device->readPixels(target.id(), gpu::PixelFormat::RG16F, {.width = 128, .height = 160}, found.data()));
  const auto full = flow(*gpuFlow(FlowMethod::Dis), pair);
  double error = 0, difference = 0, count = 0;
  for (int y = 0; y < 160; ++y)
    for (int x = 0; x < 128; ++x) {
      if (glm::length(glm::dvec2(2 * x + 1, 2 * y + 1) - centre(pair.a)) > radius(pair.a) - 30) continue;
      const glm::dvec2 f = 2.0 * glm::dvec2(found[(159 - y) * 128 + x]);
      error += glm::length(f - shift);
      difference += glm::length(f - glm::dvec2(full[2 * y * 256 + 2 * x]));
      count += 1;
    }
  EXPECT_GT(count, 1000);
  EXPECT_LT(error / count, 0.2);
  EXPECT_LT(difference / count, 0.2);
}

// No displacement aligns pictures of different content; a true one is taken in full.
TEST_F(Flow, takesADisplacementAsFarAsItExplains) {
  const auto size = [](const std::vector<glm::vec2>& flow, const Pair& pair) {
    double sum = 0, count = 0;
    for (size_t i = 0; i < flow.size(); ++i)
      if (pair.inside[i]) sum += glm::length(flow[i]), count += 1;
    return sum / count;
  };
  const Pair moved = disc(256, 256, [](glm::dvec2 p) { return p - glm::dvec2(3, -2); });
  const Motion motion = [](glm::dvec2 p) { return p + glm::dvec2(3, -2); };
  const Pair strange = disc(256, 256, [](glm::dvec2 p) { return glm::dvec2(700 + p.y, 300 - p.x); });
  for (const FlowMethod method : {FlowMethod::Farneback, FlowMethod::Dis}) {
    double before = size(flow(*gpuFlow(method), strange), strange);
    for (const double must_explain : {0.04, 0.25}) {
      FlowOptions options;
      options.must_explain = must_explain;
      EXPECT_LT(error(flow(*gpuFlow(method, options), moved), moved, motion), 0.2) << must_explain;
      const double now = size(flow(*gpuFlow(method, options), strange), strange);
      EXPECT_LT(now, 0.95 * before) << must_explain;
      before = now;
    }
    // Displacements above `sure_px` are taken untested; those below half of it are tested.
    const double unasked = size(flow(*gpuFlow(method), strange), strange),
                 all_sure = size(flow(*gpuFlow(method, {.must_explain = 0.25, .sure_px = 0.1}), strange), strange),
                 long_sure = size(flow(*gpuFlow(method, {.must_explain = 0.25, .sure_px = 20}), strange), strange);
    EXPECT_NEAR(all_sure, unasked, 0.01 * unasked);
    EXPECT_GT(long_sure, 1.02 * before);
    EXPECT_LT(long_sure, 0.98 * unasked);
  }
}

// Filling starts where a coarse level is no longer empty and ends where no hole is left: a smooth extension of both.
TEST_F(Flow, fillsOutsideSmoothlyWithTheSameLuma) {
  constexpr int kSide = 320;
  const Pair pair = disc(kSide, kSide, [](glm::dvec2 p) { return p - glm::dvec2(4, 0); });
  const gpu::Texture a = upload(pair.a), b = upload(pair.b);
  FlowPictures pictures;
  ASSERT_TRUE(pictures.prepare(*device, a.id(), b.id(), kSide, kSide));
  std::vector<glm::u8vec4> filled(kSide * kSide);
  ASSERT_TRUE(
      device->readPixels(pictures.target(), gpu::PixelFormat::RGBA8, {.width = kSide, .height = kSide}, filled.data()));
  double confident = 0, inside = 0, near = 0, confident_near = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const size_t i = (kSide - 1 - y) * kSide + x, here = y * kSide + x;
      const double outside = glm::length(glm::dvec2(x + 0.5, y + 0.5) - centre(pair.a)) - radius(pair.a);
      if (pair.inside[here]) {
        EXPECT_NEAR(filled[i][0], pair.a.at(x, y)[0], 1);
        EXPECT_NEAR(filled[i][1], pair.b.at(x, y)[0], 1);
        inside += 1, confident += filled[i].a > 128;
      }
      if (outside > 0 && outside < 3) near += 1, confident_near += filled[i].a > 64;
      if (outside < 2) continue;
      ASSERT_EQ(filled[i][0], filled[i][1]);
      ASSERT_GT(filled[i][0], 40) << x << ", " << y << ": the character's mean is about 128";
      if (outside > 14) {
        ASSERT_EQ(filled[i].a, 0);
        if (x > 0) ASSERT_LE(std::abs(filled[i][0] - filled[i - 1][0]), 12) << x << ", " << y;
      }
    }
  EXPECT_GT(confident, 0.9 * inside);
  EXPECT_GT(confident_near, 0.9 * near) << "confidence reaches beyond the outline";
}

// Mipmaps of such sizes skip columns; content in these must not count as empty.
TEST_F(Flow, seesANarrowBarWhereverItStands) {
  constexpr int kWidth = 180, kHeight = 240, kBar = 8;
  FlowPictures pictures;
  std::vector<glm::u8vec4> filled(kWidth * kHeight);
  for (int start = 2; start + kBar + 2 < kWidth; start += 3) {
    Image picture(kWidth, kHeight, 4);
    for (int y = 0; y < kHeight; ++y)
      for (int x = start; x < start + kBar; ++x) {
        const auto luma = static_cast<uint8_t>(40 + 53 * ((x / 2 + y / 2) % 4));
        for (int c = 0; c < 3; ++c) picture.at(x, y)[c] = luma;
        picture.at(x, y)[3] = 255;
      }
    const gpu::Texture texture = upload(picture);
    ASSERT_TRUE(pictures.prepare(*device, texture.id(), texture.id(), kWidth, kHeight));
    ASSERT_TRUE(device->readPixels(pictures.target(), gpu::PixelFormat::RGBA8, {.width = kWidth, .height = kHeight},
                                   filled.data()));
    for (int y = 20; y < kHeight - 20; ++y)
      for (int x = start - 2; x < start + kBar + 2; ++x) {
        const glm::u8vec4& here = filled[(kHeight - 1 - y) * kWidth + x];
        ASSERT_GT(here.a, 60) << "bar at " << start << ", column " << x << ", row " << y;
        if (x >= start && x < start + kBar)
          ASSERT_NEAR(here[0], picture.at(x, y)[0], 1) << start;
        else
          ASSERT_GT(here[0], 30) << "bar at " << start << ", column " << x << ", row " << y;
      }
  }
}

TEST_F(Flow, isZeroForEqualPictures) {
  const Pair pair = disc(200, 120, [](glm::dvec2 p) { return p; });
  for (FlowMethod method : {FlowMethod::Farneback, FlowMethod::Dis})
    for (const glm::vec2& f : flow(*gpuFlow(method), pair)) ASSERT_LT(glm::length(f), 1e-3f);
}

TEST_F(Flow, goesSmoothlyToZeroOutsideTheCharacter) {
  const Pair pair = disc(256, 256, [](glm::dvec2 p) { return p - glm::dvec2(4, 0); });
  for (FlowMethod method : {FlowMethod::Farneback, FlowMethod::Dis}) {
    const auto found = flow(*gpuFlow(method), pair);
    float steepest = 0;
    for (int y = 0; y < 256; ++y)
      for (int x = 0; x < 256; ++x) {
        const glm::dvec2 p(x + 0.5, y + 0.5);
        const double outside = glm::length(p - centre(pair.a)) - radius(pair.a);
        const glm::vec2 f = found[y * 256 + x];
        if (outside > 24) {
          ASSERT_LT(glm::length(f), 0.02f) << x << ", " << y;
        }
        if (x > 0 && outside > 0) steepest = std::max(steepest, glm::length(f - found[y * 256 + x - 1]));
      }
    EXPECT_LT(steepest, 2.0f);
  }
}

TEST_F(Flow, isSmallWhereThereIsNoTexture) {
  const Pair pair = disc(
      256, 256, [](glm::dvec2 p) { return p - glm::dvec2(4, 0); }, 0.004);  // one grey level
  for (FlowMethod method : {FlowMethod::Farneback, FlowMethod::Dis}) {
    const auto found = flow(*gpuFlow(method), pair);
    for (size_t i = 0; i < found.size(); ++i) ASSERT_LT(pair.inside[i] ? glm::length(found[i]) : 0, 0.5f);
  }
}

TEST_F(Flow, keepsNoMemoryAndTakesEverySize) {
  const auto before = device->counters().live_texture_bytes;
  {
    const auto source = gpuFlow(FlowMethod::Farneback), other = gpuFlow(FlowMethod::Dis);
    for (const glm::ivec2 size : {glm::ivec2(64, 64), glm::ivec2(9, 31), glm::ivec2(130, 65)}) {
      const Pair pair = disc(size.x, size.y, [](glm::dvec2 p) { return p; });
      for (FlowSource* s : {source.get(), other.get()})
        for (const glm::vec2& f : flow(*s, pair)) ASSERT_LT(glm::length(f), 0.1f);
    }
  }
  EXPECT_EQ(device->counters().live_texture_bytes, before);
}

TEST(FlowWithoutFloatTargets, isUnsupportedAndOpencvStillWorks) {
  const auto device = gpu::createNullDevice(false);
  const auto made = createGpuFlow(*device);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().id, ErrorId::Unsupported);
  const auto picture = gpu::makeTexture(*device, {.width = 40, .height = 36, .label = "picture"}).take();
  const auto opencv = edge::createOpencvFlow(*device);
  EXPECT_TRUE(opencv->compute(picture.id(), picture.id(), 40, 36));
  EXPECT_EQ(device->takeErrors(), "");
}

TEST(FlowOptions, areChecked) {
  const auto device = gpu::createNullDevice();
  for (const auto& [window, poly_n] : {std::pair(12, 5), std::pair(13, 6), std::pair(1, 5)}) {
    const auto made = createGpuFlow(*device, {.window = window, .poly_n = poly_n});
    ASSERT_FALSE(made);
    EXPECT_EQ(made.error().id, ErrorId::InvalidArgument);
  }
  EXPECT_FALSE(createGpuFlow(*device, {.finest = -1}));
  for (const double value : {-0.1, std::nan("")}) {
    EXPECT_FALSE(createGpuFlow(*device, {.must_explain = value}));
    EXPECT_FALSE(createGpuFlow(*device, {.sure_px = value}));
  }
}

}  // namespace
}  // namespace fourdvt::render
