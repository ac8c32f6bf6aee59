// SPDX-License-Identifier: Apache-2.0
// The GLES device: formats round-trip, row order, strides, clears, depth, blending, resolve, messages.
#include "gl_fixture.h"

namespace fourdvt::gpu {
namespace {

constexpr std::string_view kVertex = R"(
out vec2 v_uv;
uniform float u_depth;
void main() {
  v_uv = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2);
  gl_Position = vec4(v_uv * 2.0 - 1.0, u_depth, 1.0);
})";
constexpr std::string_view kFill = R"(
in vec2 v_uv;
out vec4 o_color;
uniform vec4 u_color[2];
void main() { o_color = u_color[1]; })";

class GlesDevice : public testing::GlFixture {
 protected:
  Texture texture(PixelFormat format, int width, int height) {
    return makeTexture(*device, {.format = format, .width = width, .height = height, .label = "t"}).take();
  }
  // Uploads `bytes` and reads them back through a target: top row = GL's last row.
  template <class T>
  std::vector<T> roundTrip(PixelFormat format, int width, int height, const std::vector<T>& data, int stride = 0) {
    Texture t = texture(format, width, height);
    device->updateTexture(t.id(), {.width = width, .height = height}, data.data(), stride);
    Target target = makeTarget(*device, {.colors = {t.id()}, .label = "t"}).take();
    std::vector<T> out(static_cast<size_t>(width) * height * bytesPerPixel(format) / sizeof(T));
    EXPECT_TRUE(device->readPixels(target.id(), format, {.width = width, .height = height}, out.data()));
    return out;
  }
  void fill(TargetId target, glm::vec4 color, float depth, Draw state = {}) {
    const std::array<glm::vec4, 2> colors{glm::vec4(0), color};
    state.program = program_.id();
    state.uniforms = {uniform("u_depth", depth), uniform("u_color", std::span<const glm::vec4>(colors)),
                      uniform("u_not_there", depth)};
    state.vertex_count = 3;
    device->beginPass({.target = target, .label = "fill"});
    device->draw(state);
    device->endPass();
  }
  std::array<uint8_t, 4> pixel(TargetId target, int x, int y) {
    std::array<uint8_t, 4> rgba{};
    EXPECT_TRUE(device->readPixels(target, PixelFormat::RGBA8, {.x = x, .y = y, .width = 1, .height = 1}, rgba.data()));
    return rgba;
  }
  void SetUp() override {
    GlFixture::SetUp();
    auto made = makeProgram(*device, "fill", kVertex, kFill);
    ASSERT_TRUE(made) << made.error().message;
    program_ = made.take();
  }
  void TearDown() override {
    program_.reset();
    GlFixture::TearDown();
  }
  Program program_;
};

using Rgba = std::array<uint8_t, 4>;

TEST_F(GlesDevice, hasCaps) {
  EXPECT_GE(device->caps().max_texture_size, 2048);
  EXPECT_GE(device->caps().max_samples, 4);
  EXPECT_FALSE(device->caps().renderer.empty());
  printf("renderer: %s, float targets: %d\n", device->caps().renderer.c_str(), device->caps().float_targets);
}

TEST_F(GlesDevice, readsTheTopRowFirst) {
  const std::vector<uint8_t> rows = {1, 2, 3, 4, 5, 6};  // GL row 0 is 1,2,3
  EXPECT_EQ(roundTrip(PixelFormat::R8, 3, 2, rows), (std::vector<uint8_t>{4, 5, 6, 1, 2, 3}));
}

TEST_F(GlesDevice, uploadsRowsWithAStride) {
  const std::vector<uint8_t> padded = {1, 2, 3, 99, 99, 4, 5, 6, 99, 99};
  EXPECT_EQ(roundTrip(PixelFormat::R8, 3, 2, padded, 5), (std::vector<uint8_t>{4, 5, 6, 1, 2, 3}));
  const std::vector<uint8_t> odd = {1, 2, 3, 4, 99, 5, 6, 7, 8, 99};  // RG8, stride no multiple of a texel
  EXPECT_EQ(roundTrip(PixelFormat::RG8, 2, 2, odd, 5), (std::vector<uint8_t>{5, 6, 7, 8, 1, 2, 3, 4}));
}

TEST_F(GlesDevice, keepsEveryFormatExactly) {
  const std::vector<uint32_t> ids = {0, 0xffffffffu, 7, 0x80000001u};
  EXPECT_EQ(roundTrip(PixelFormat::R32UI, 4, 1, ids), ids);
  EXPECT_EQ(roundTrip(PixelFormat::RGBA8, 1, 1, std::vector<uint8_t>{9, 200, 31, 4}),
            (std::vector<uint8_t>{9, 200, 31, 4}));
  if (device->caps().half_float_targets) {  // uploaded as halves, read as floats: 1, -2, 0.5, 65504
    Texture half = texture(PixelFormat::RGBA16F, 1, 1);
    const std::array<uint16_t, 4> halves = {0x3c00, 0xc000, 0x3800, 0x7bff};
    device->updateTexture(half.id(), {.width = 1, .height = 1}, halves.data());
    Target target = makeTarget(*device, {.colors = {half.id()}, .label = "half"}).take();
    std::array<float, 4> out{};
    ASSERT_TRUE(device->readPixels(target.id(), PixelFormat::RGBA16F, {.width = 1, .height = 1}, out.data()));
    EXPECT_EQ(out, (std::array<float, 4>{1, -2, 0.5f, 65504}));
  }
  if (!device->caps().float_targets) GTEST_SKIP() << "no EXT_color_buffer_float";
  const std::vector<float> values = {1e-7f, -3.25f, 16777215.0f, 0.1f};
  EXPECT_EQ(roundTrip(PixelFormat::RGBA32F, 1, 1, values), values);
  EXPECT_EQ(roundTrip(PixelFormat::RG32F, 2, 1, values), values);
  EXPECT_EQ(roundTrip(PixelFormat::R32F, 4, 1, values), values);
}

TEST_F(GlesDevice, clearsOnlyTheViewportAndIntegersExactly) {
  Texture color = texture(PixelFormat::RGBA8, 4, 4), ids = texture(PixelFormat::R32UI, 4, 4);
  Target target = makeTarget(*device, {.colors = {ids.id(), color.id()}}).take();
  device->beginPass({.target = target.id(), .clear_color = true, .color = glm::vec4(0)});
  device->endPass();
  device->beginPass({.target = target.id(),
                     .x = 1,
                     .y = 0,
                     .width = 2,
                     .height = 1,
                     .clear_color = true,
                     .color = glm::vec4(4294967295.0f)});
  device->endPass();
  std::array<uint32_t, 16> out{};
  ASSERT_TRUE(device->readPixels(target.id(), PixelFormat::R32UI, {.width = 4, .height = 4}, out.data()));
  for (int i = 0; i < 16; ++i) EXPECT_EQ(out[i], i == 13 || i == 14 ? 0xffffffffu : 0u) << i;
}

TEST_F(GlesDevice, testsDepthAndBlendsPremultiplied) {
  Target target = makeTarget(*device, {.width = 4, .height = 4, .own_depth = true}).take();
  device->beginPass({.target = target.id(), .clear_color = true, .clear_depth = true});
  device->endPass();
  const Draw solid{.depth_test = true, .depth_write = true};
  fill(target.id(), {1, 0, 0, 1}, 0.0f, solid);
  fill(target.id(), {0, 1, 0, 1}, 0.5f, solid);  // behind
  EXPECT_EQ(pixel(target.id(), 1, 1), (Rgba{255, 0, 0, 255}));
  fill(target.id(), {0, 0, 0.2f, 0.4f}, 0.9f, {.blend = Blend::PremultipliedOver});
  EXPECT_EQ(pixel(target.id(), 2, 2), (Rgba{153, 0, 51, 255}));
}

// The shader's vertex ID is the index: 0, 1, 2 cover everything, others nothing.
TEST_F(GlesDevice, drawsWithIndices) {
  Texture color = texture(PixelFormat::RGBA8, 4, 4);
  Target target = makeTarget(*device, {.colors = {color.id()}}).take();
  const IndexBuffer whole = makeIndexBuffer(*device), nothing = makeIndexBuffer(*device);
  device->updateIndices(whole.id(), std::vector<uint32_t>{2, 0, 1, 7});
  device->updateIndices(nothing.id(), std::vector<uint32_t>{0, 4, 0});
  fill(target.id(), {0, 1, 0, 1}, 0);
  fill(target.id(), {1, 0, 0, 1}, 0, {.indices = nothing.id()});
  EXPECT_EQ(pixel(target.id(), 1, 1), (Rgba{0, 255, 0, 255}));
  fill(target.id(), {0, 0, 1, 1}, 0, {.indices = whole.id()});
  EXPECT_EQ(pixel(target.id(), 1, 1), (Rgba{0, 0, 255, 255}));
  fill(target.id(), {1, 1, 0, 1}, 0);  // not indexed, after an indexed draw
  EXPECT_EQ(pixel(target.id(), 1, 1), (Rgba{255, 255, 0, 255}));
  device->updateIndices(whole.id(), std::vector<uint32_t>{0, 0, 0});
  fill(target.id(), {0, 0, 1, 1}, 0, {.indices = whole.id()});
  EXPECT_EQ(pixel(target.id(), 1, 1), (Rgba{255, 255, 0, 255}));
}

TEST_F(GlesDevice, resolvesMultisampledTargets) {
  Texture color = texture(PixelFormat::RGBA8, 4, 4);
  Target plain = makeTarget(*device, {.colors = {color.id()}}).take();
  Target many = makeTarget(*device, {.width = 4, .height = 4, .samples = 4, .own_depth = true}).take();
  fill(many.id(), {0.2f, 0.4f, 0.6f, 1}, 0, {});
  device->blit(many.id(), plain.id(), {.width = 4, .height = 4});
  EXPECT_EQ(pixel(plain.id(), 3, 0), (Rgba{51, 102, 153, 255}));
}

TEST_F(GlesDevice, drawsIntoOneLayerOfAnArray) {
  auto array = makeTexture(*device, {.width = 2, .height = 2, .layers = 2}).take();
  Target first = makeTarget(*device, {.colors = {array.id()}, .color_layer = 0}).take();
  Target second = makeTarget(*device, {.colors = {array.id()}, .color_layer = 1}).take();
  fill(first.id(), {1, 0, 0, 1}, 0);
  fill(second.id(), {0, 0, 1, 1}, 0);
  EXPECT_EQ(pixel(first.id(), 0, 0), (Rgba{255, 0, 0, 255}));
  EXPECT_EQ(pixel(second.id(), 1, 1), (Rgba{0, 0, 255, 255}));
}

TEST_F(GlesDevice, namesTheProgramAndTheLineThatDoesNotCompile) {
  auto broken = device->createProgram("broken one", kVertex, "out vec4 o;\nvoid main() { o = nonsense; }");
  ASSERT_FALSE(broken);
  EXPECT_EQ(broken.error().id, ErrorId::GpuFailure);
  EXPECT_NE(broken.error().message.find("broken one"), std::string::npos);
  EXPECT_NE(broken.error().message.find("nonsense"), std::string::npos) << broken.error().message;
  EXPECT_NE(broken.error().message.find(":2("), std::string::npos) << broken.error().message;
  auto unlinked =
      device->createProgram("unlinked", kVertex, "in vec3 v_no; out vec4 o; void main() { o = v_no.xyzz; }");
  EXPECT_FALSE(unlinked);
}

TEST_F(GlesDevice, recoversItsStateAfterForeignCalls) {
  Target target = makeTarget(*device, {.width = 2, .height = 2}).take();
  fill(target.id(), {1, 0, 0, 1}, 0);
  device->invalidateState();
  fill(target.id(), {0, 1, 0, 1}, 0);
  EXPECT_EQ(pixel(target.id(), 0, 0), (Rgba{0, 255, 0, 255}));
}

TEST_F(GlesDevice, countsLiveObjectsDownToZero) {
  {
    Texture t = texture(PixelFormat::RGBA8, 2, 2);
    Target target = makeTarget(*device, {.colors = {t.id()}}).take();
    EXPECT_NE(device->nativeTexture(t.id()), 0u);
  }
  program_.reset();
  EXPECT_EQ(device->counters().live_textures, 0u);
  EXPECT_EQ(device->counters().live_targets, 0u);
  EXPECT_EQ(device->counters().live_programs, 0u);
}

}  // namespace
}  // namespace fourdvt::gpu
