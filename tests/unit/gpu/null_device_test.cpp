// SPDX-License-Identifier: Apache-2.0
// Validation and counting, shared by the null device and GLES.
#include <gtest/gtest.h>

#include <array>

#include "../live_objects.h"
#include "gpu/device.h"

namespace fourdvt::gpu {
namespace {

class NullDeviceTest : public ::testing::Test {
 protected:
  Texture texture(PixelFormat format, int width, int height) {
    auto made = makeTexture(*device, {.format = format, .width = width, .height = height, .label = "t"});
    EXPECT_TRUE(made) << made.error().message;
    return made.take();
  }
  Program program() { return makeProgram(*device, "p", "void main(){}", "void main(){}").take(); }
  void expectMisuse(const char* part) {
    const std::string errors = device->takeErrors();
    EXPECT_NE(errors.find(part), std::string::npos) << "errors: " << errors;
  }
  std::unique_ptr<Device> device = createNullDevice();
  std::array<uint8_t, 4096> bytes{};
};

TEST_F(NullDeviceTest, countsLiveObjectsDownToZero) {
  {
    Texture color = texture(PixelFormat::RGBA8, 16, 8);
    Texture moved = std::move(color);
    EXPECT_FALSE(color);
    Target target = makeTarget(*device, {.colors = {moved.id()}, .own_depth = true}).take();
    Program p = program();
    EXPECT_EQ(device->counters().live_textures, 1u);
    EXPECT_EQ(device->counters().live_texture_bytes, 16u * 8 * 4);
    EXPECT_EQ(device->counters().live_targets, 1u);
    EXPECT_EQ(device->counters().live_programs, 1u);
  }
  fourdvt::testing::expectNothingLives(*device);
}

TEST_F(NullDeviceTest, compilesProgramsOfTheSameTextsOnce) {
  const auto make = [&](const char* label, const char* fragment, const char* defines) {
    return makeProgram(*device, label, "void main() {}", fragment, defines).take();
  };
  Program first = make("first", "a", "N 1\n"), other = make("other", "a", "N 2\n");
  {
    Program again = make("again", "a", "N 1\n");
    EXPECT_EQ(again.id(), first.id());
    EXPECT_NE(other.id(), first.id());
    EXPECT_EQ(device->counters().live_programs, 2u);
  }
  EXPECT_EQ(device->counters().live_programs, 2u) << "one owner is left";
  first.reset();
  EXPECT_EQ(device->counters().live_programs, 1u);
  EXPECT_NE(make("anew", "a", "N 1\n").id(), 0u);
}

TEST_F(NullDeviceTest, countsMipmapAndArrayBytes) {
  auto mipmapped =
      makeTexture(*device, {.format = PixelFormat::R8, .width = 8, .height = 4, .filter = Filter::LinearMipmap}).take();
  EXPECT_EQ(device->counters().live_texture_bytes, 32u + 8 + 2 + 1);
  auto array = makeTexture(*device, {.format = PixelFormat::RG8, .width = 8, .height = 4, .layers = 3}).take();
  EXPECT_EQ(device->counters().live_texture_bytes, 43u + 3 * 64);
}

TEST_F(NullDeviceTest, filtersHalfFloatsAndRefusesFloatTargetsItHasNot) {
  EXPECT_TRUE(makeTexture(*device, {.format = PixelFormat::RG16F, .filter = Filter::Linear}));
  EXPECT_FALSE(makeTexture(*device, {.format = PixelFormat::RG32F, .filter = Filter::Linear}));
  EXPECT_EQ(bytesPerPixel(PixelFormat::RGBA16F), 8);
  EXPECT_EQ(readBytesPerPixel(PixelFormat::RGBA16F), 16);
  EXPECT_EQ(readBytesPerPixel(PixelFormat::RGBA8), 4);
  const auto plain = createNullDevice(false);
  for (PixelFormat format : {PixelFormat::RG16F, PixelFormat::RGBA16F, PixelFormat::RGBA32F}) {
    Texture color = makeTexture(*plain, {.format = format}).take();
    EXPECT_FALSE(makeTarget(*plain, {.colors = {color.id()}}));
  }
}

TEST_F(NullDeviceTest, countsDrawsAndUploads) {
  Texture color = texture(PixelFormat::RGBA8, 16, 8);
  Target target = makeTarget(*device, {.colors = {color.id()}}).take();
  Program p = program();
  device->updateTexture(color.id(), {.x = 4, .y = 2, .width = 8, .height = 4}, bytes.data());
  device->beginPass({.target = target.id()});
  device->draw({.program = p.id(), .vertex_count = 9});
  device->endPass();
  EXPECT_EQ(device->counters().passes, 1u);
  EXPECT_EQ(device->counters().draws, 1u);
  EXPECT_EQ(device->counters().vertices, 9u);
  EXPECT_EQ(device->counters().texture_updates, 1u);
  EXPECT_EQ(device->counters().uploaded_bytes, 8u * 4 * 4);
  device->resetCounters();
  EXPECT_EQ(device->counters().draws, 0u);
  EXPECT_EQ(device->counters().live_textures, 1u);
  EXPECT_EQ(device->takeErrors(), "");
}

TEST_F(NullDeviceTest, refusesBadTextures) {
  const TextureDesc bad[] = {{.width = 0},
                             {.width = 1 << 20},
                             {.height = -1},
                             {.format = PixelFormat::RGBA32F, .filter = Filter::Linear},
                             {.format = PixelFormat::R32UI, .filter = Filter::LinearMipmap}};
  for (const TextureDesc& desc : bad) {
    auto made = device->createTexture(desc);
    ASSERT_FALSE(made);
    EXPECT_EQ(made.error().id, ErrorId::GpuFailure);
  }
  EXPECT_EQ(device->counters().live_textures, 0u);
}

TEST_F(NullDeviceTest, refusesBadUpdates) {
  Texture color = texture(PixelFormat::RGBA8, 16, 8);
  device->updateTexture(color.id(), {.x = 9, .width = 8, .height = 8}, bytes.data());
  expectMisuse("outside");
  device->updateTexture(color.id(), {.width = 16, .height = 8}, nullptr);
  expectMisuse("no pixels");
  device->updateTexture(color.id(), {.width = 16, .height = 8}, bytes.data(), 63);
  expectMisuse("stride");
  device->updateTexture(color.id() + 7, {.width = 1, .height = 1}, bytes.data());
  expectMisuse("no such texture");
  device->generateMipmaps(color.id());
  expectMisuse("LinearMipmap");
  EXPECT_EQ(device->counters().texture_updates, 0u);
}

TEST_F(NullDeviceTest, refusesBadTargets) {
  Texture a = texture(PixelFormat::RGBA8, 16, 8), b = texture(PixelFormat::RGBA8, 8, 8);
  Texture depth = texture(PixelFormat::Depth24, 16, 8);
  EXPECT_TRUE(makeTarget(*device, {.colors = {a.id()}, .depth = depth.id()}));
  EXPECT_FALSE(makeTarget(*device, {.colors = {a.id(), b.id()}}));
  EXPECT_FALSE(makeTarget(*device, {.colors = {depth.id()}}));
  EXPECT_FALSE(makeTarget(*device, {.colors = {a.id()}, .depth = b.id()}));
  EXPECT_FALSE(makeTarget(*device, {.colors = {a.id()}, .samples = 4}));
  EXPECT_FALSE(makeTarget(*device, {.colors = {999}}));
  EXPECT_FALSE(makeTarget(*device, {}));
}

TEST_F(NullDeviceTest, refusesWrongPassOrder) {
  Texture color = texture(PixelFormat::RGBA8, 16, 8);
  Target target = makeTarget(*device, {.colors = {color.id()}}).take();
  Program p = program();
  device->draw({.program = p.id(), .vertex_count = 3});
  expectMisuse("outside a pass");
  device->endPass();
  expectMisuse("without beginPass");
  device->beginPass({.target = target.id()});
  device->beginPass({.target = target.id()});
  expectMisuse("inside a pass");
  device->updateTexture(color.id(), {.width = 1, .height = 1}, bytes.data());
  expectMisuse("inside a pass");
  device->draw({.program = p.id(), .textures = {{"s", color.id()}}, .vertex_count = 3});
  expectMisuse("draws into");
  device->draw({.program = p.id(), .vertex_count = 4});
  expectMisuse("multiple of 3");
  device->draw({.program = p.id(), .vertex_count = 3, .depth_write = true});
  expectMisuse("depth_test");
  device->draw({.program = 12345, .vertex_count = 3});
  expectMisuse("no such program");
  EXPECT_FALSE(device->readPixels(target.id(), PixelFormat::RGBA8, {.width = 1, .height = 1}, bytes.data()));
  device->endPass();
  EXPECT_EQ(device->counters().draws, 0u);
}

TEST_F(NullDeviceTest, refusesBadBlitsAndReads) {
  Texture color = texture(PixelFormat::RGBA8, 16, 8), other = texture(PixelFormat::R8, 16, 8);
  Target plain = makeTarget(*device, {.colors = {color.id()}}).take();
  Target grey = makeTarget(*device, {.colors = {other.id()}}).take();
  Target many = makeTarget(*device, {.width = 16, .height = 8, .samples = 4}).take();
  device->blit(many.id(), plain.id(), {.width = 16, .height = 8});
  EXPECT_EQ(device->takeErrors(), "");
  device->blit(many.id(), plain.id(), {.x = 4, .width = 8, .height = 8});
  expectMisuse("cannot be moved");
  device->blit(plain.id(), many.id(), {.width = 8, .height = 8});
  expectMisuse("multisampled");
  device->blit(plain.id(), grey.id(), {.width = 8, .height = 8});
  expectMisuse("formats");
  device->blit(plain.id(), kDefaultTarget, {.width = 17, .height = 8});
  expectMisuse("larger");
  EXPECT_FALSE(device->readPixels(many.id(), PixelFormat::RGBA8, {.width = 1, .height = 1}, bytes.data()));
  EXPECT_FALSE(device->readPixels(plain.id(), PixelFormat::R8, {.width = 1, .height = 1}, bytes.data()));
  EXPECT_FALSE(device->readPixels(plain.id(), PixelFormat::RGBA8, {.width = 17, .height = 1}, bytes.data()));
  EXPECT_TRUE(device->readPixels(plain.id(), PixelFormat::RGBA8, {.width = 16, .height = 8}, bytes.data()));
}

TEST_F(NullDeviceTest, refusesBadIndices) {
  Texture color = texture(PixelFormat::RGBA8, 16, 8);
  const Target target = makeTarget(*device, {.colors = {color.id()}}).take();
  const Program p = program();
  IndexBuffer indices = makeIndexBuffer(*device);
  const std::vector<uint32_t> six(6, 0);
  device->updateIndices(12345, six);
  expectMisuse("no such index buffer");
  device->updateIndices(indices.id(), six);
  EXPECT_EQ(device->counters().uploaded_bytes, 24u);
  device->beginPass({.target = target.id()});
  device->draw({.program = p.id(), .vertex_count = 6, .indices = indices.id()});
  EXPECT_EQ(device->takeErrors(), "");
  device->draw({.program = p.id(), .vertex_count = 9, .indices = indices.id()});
  expectMisuse("fewer than vertex_count");
  device->draw({.program = p.id(), .vertex_count = 3, .indices = 12345});
  expectMisuse("no such indices");
  device->updateIndices(indices.id(), six);
  expectMisuse("inside a pass");
  device->endPass();
  indices.reset();
  EXPECT_EQ(device->counters().live_index_buffers, 0u);
}

TEST_F(NullDeviceTest, countsTheBytesOfRenderbuffers) {
  Texture color = texture(PixelFormat::RGBA8, 16, 8);
  const Target plain = makeTarget(*device, {.colors = {color.id()}}).take();
  EXPECT_EQ(device->counters().live_target_bytes, 0u);  // the texture's are counted as such
  const Target with_depth = makeTarget(*device, {.colors = {color.id()}, .own_depth = true}).take();
  EXPECT_EQ(device->counters().live_target_bytes, 16u * 8 * 4);
  {
    const Target many = makeTarget(*device, {.width = 10, .height = 4, .samples = 4}).take();
    EXPECT_EQ(device->counters().live_target_bytes, 16u * 8 * 4 + 10 * 4 * 4 * 8);
  }
  EXPECT_EQ(device->counters().live_target_bytes, 16u * 8 * 4);
}

TEST_F(NullDeviceTest, noticesADestroyedAttachment) {
  Texture color = texture(PixelFormat::RGBA8, 16, 8);
  Target target = makeTarget(*device, {.colors = {color.id()}}).take();
  color.reset();
  device->beginPass({.target = target.id()});
  expectMisuse("destroyed");
}

TEST(ShaderText, isEmbeddedWithIncludesExpanded) {
  EXPECT_TRUE(shaderText("no_such.frag").empty());
  const std::string_view layered = shaderText("layered.vert");
  EXPECT_NE(layered.find("texelFetch"), std::string_view::npos);
  EXPECT_EQ(layered.find("#include"), std::string_view::npos);
  const size_t table = layered.find("ivec2 tableTexel");  // nested include, once
  ASSERT_NE(table, std::string_view::npos);
  EXPECT_EQ(layered.find("ivec2 tableTexel", table + 1), std::string_view::npos);
}

TEST(NullDevice, refusesAnEmptyShader) {
  auto device = createNullDevice();
  auto made = device->createProgram("nothing", shaderText("no_such.vert"), "x");
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().id, ErrorId::GpuFailure);
}

}  // namespace
}  // namespace fourdvt::gpu
