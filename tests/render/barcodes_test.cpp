// SPDX-License-Identifier: Apache-2.0
// Frame numbers read back from pictures on the GPU: equal to the CPU's for any strip, in order, without blocking.
#include <random>

#include "gl_fixture.h"
#include "render/barcodes/picture_checks.h"

namespace fourdvt::render {
namespace {

class Barcodes : public testing::GlFixture {
 protected:
  struct Seen {
    int slot;
    std::optional<uint32_t> frame;
  };
  gpu::Texture picture(int width, int height) {
    return gpu::makeTexture(*device, {.width = width,
                                      .height = height,
                                      .filter = gpu::Filter::Linear,
                                      .respecifiable = true,
                                      .label = "picture"})
        .take();
  }
  // Uploads a grey picture with the barcode, and noise like a codec's, as RGBA.
  void upload(const gpu::Texture& texture, int width, int height, const package::BarcodeStrip& strip, uint32_t frame) {
    std::vector<uint8_t> luma(static_cast<size_t>(width) * height, 120);
    package::drawBarcode(strip, frame, luma.data(), width);
    std::vector<uint8_t> rgba(4 * luma.size());
    for (size_t i = 0; i < luma.size(); ++i) {
      const int level = (luma[i] - 16) * 255 / 219 + static_cast<int>(random_() % 81) - 40;
      for (int c = 0; c < 3; ++c) rgba[4 * i + c] = static_cast<uint8_t>(std::clamp(level, 0, 255));
      rgba[4 * i + 3] = 255;
    }
    device->updateTexture(texture.id(), {.width = width, .height = height}, rgba.data());
  }
  std::vector<Seen> settleAll(PictureChecks& checks, size_t count) {
    std::vector<Seen> seen;
    for (int poll = 0; poll < 100000 && seen.size() < count; ++poll)
      checks.settle([&](int slot, std::optional<uint32_t> frame) { seen.push_back({slot, frame}); });
    return seen;
  }
  std::mt19937 random_{5};
};

TEST_F(Barcodes, AreReadInOrderFromStripsOfAllSizes) {
  PictureChecks checks(*device);
  for (const int cell : {2, 3, 4, 8, 13}) {
    const int width = 32 * cell + 10, height = 64;
    const package::BarcodeStrip strip{{6, 20, 32 * cell, std::max(4, cell)}, cell};
    std::vector<uint32_t> frames;
    std::vector<gpu::Texture> pictures;
    for (int i = 0; i < 40; ++i) {
      frames.push_back(random_() % 4096);
      pictures.push_back(picture(width, height));
      upload(pictures.back(), width, height, strip, frames.back());
      ASSERT_TRUE(checks.begin(i, pictures.back().id(), strip));
    }
    const std::vector<Seen> seen = settleAll(checks, frames.size());
    ASSERT_EQ(seen.size(), frames.size());
    for (int i = 0; i < 40; ++i) {
      EXPECT_EQ(seen[i].slot, i);
      EXPECT_EQ(seen[i].frame, frames[i]) << "cells of " << cell;
    }
  }
}

TEST_F(Barcodes, NothingIsReadWhereThereIsNone) {
  PictureChecks checks(*device);
  const package::BarcodeStrip strip{{0, 0, 128, 8}, 4};
  const gpu::Texture texture = picture(128, 16);
  int unread = 0;
  for (int i = 0; i < 32; ++i) {
    std::vector<uint8_t> noise(4 * 128 * 16);
    for (size_t x = 0; x < 128; ++x) {
      const uint8_t level = (random_() >> 3) % 2 && x % 4 == 0 ? 255 : x % 4 ? noise[4 * (x - 1)] : 0;
      for (size_t y = 0; y < 16; ++y) std::fill_n(&noise[4 * (y * 128 + x)], 4, level);
    }
    device->updateTexture(texture.id(), {.width = 128, .height = 16}, noise.data());
    ASSERT_TRUE(checks.begin(0, texture.id(), strip));
    const std::vector<Seen> seen = settleAll(checks, 1);
    ASSERT_EQ(seen.size(), 1u);
    unread += !seen[0].frame;
  }
  EXPECT_GT(unread, 20) << "random cells fit their check bits by chance only, 2 in 16";
}

TEST_F(Barcodes, ReadsThatNobodyTakesAreForgotten) {
  const package::BarcodeStrip strip{{0, 0, 128, 8}, 4};
  const gpu::Texture texture = picture(128, 16);
  {
    PictureChecks checks(*device);
    for (int i = 0; i < 8; ++i) ASSERT_TRUE(checks.begin(i, texture.id(), strip));
  }
  EXPECT_EQ(device->takeErrors(), "");
}

TEST_F(Barcodes, ReadsOfNothingAreRefused) {
  EXPECT_EQ(device->beginRead(77, {.width = 1, .height = 1}), 0u);
  EXPECT_FALSE(device->endRead(77, nullptr));
  EXPECT_NE(device->takeErrors(), "");
}

}  // namespace
}  // namespace fourdvt::render
