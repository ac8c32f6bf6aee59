// SPDX-License-Identifier: Apache-2.0
// Baked alignment end to end: two members whose textures are displaced by a known field.
#include "alignment_rig.h"
#include "gl_fixture.h"

namespace fourdvt::testing {
namespace {

using BakeAlignment = GlFixture;

// Smaller than a real character, to keep the test short.
AlignmentSceneOptions smallScene(double drift_m) {
  AlignmentSceneOptions options;
  options.drift_m = drift_m;
  options.rings = 30;
  options.segments = 40;
  options.layer_size = 512;
  return options;
}

bake::AlignmentOptions fewViews() {
  bake::AlignmentOptions options;
  options.views = 8;
  options.picture_height = 512;
  return options;
}

// Aligns from few views. On an error the test fails and the result is empty.
bake::AlignedFrame aligned(AlignmentRig& rig) {
  auto found = rig.align(fewViews());
  if (found) return found.take();
  ADD_FAILURE() << found.error().message;
  return {};
}

TEST_F(BakeAlignment, FindsTheDriftAndSharpensTheMiddle) {
  const AlignmentSceneOptions options = smallScene(0.012);
  AlignmentRig rig(*device, options), truth(*device, smallScene(0));
  const bake::AlignedFrame found = aligned(rig);
  ASSERT_FALSE(HasFailure());
  EXPECT_LT(alignmentError_m(rig.scene, found.displacement_m), 0.05 * options.drift_m);
  const float half[] = {0.5f, 0.5f};
  SquaredError none, baked;
  for (int view = 0; view < kHeldOutViews; ++view) {
    const PinholeCamera camera = rig.heldOutView(view);
    const Image wanted = truth.draw(camera, half, render::Align::None);
    rig.setAlignment({});
    none.add(wanted, rig.draw(camera, half, render::Align::None));
    rig.setAlignment(found.displacement_m);
    baked.add(wanted, rig.draw(camera, half, render::Align::Baked));
  }
  printf("PSNR at w = 1/2: none %.2f dB, baked %.2f dB\n", none.psnr_db(), baked.psnr_db());
  EXPECT_GT(baked.psnr_db(), none.psnr_db() + 10);
}

TEST_F(BakeAlignment, EqualMembersStay) {
  AlignmentRig rig(*device, smallScene(0));
  const bake::AlignedFrame found = aligned(rig);
  ASSERT_FALSE(HasFailure());
  for (const glm::vec2& d : found.displacement_m) ASSERT_LT(glm::length(d), 1e-5);
  EXPECT_GT(found.detail_correlation, 0.999f);
}

TEST_F(BakeAlignment, DifferingShadingIsNotMotion) {
  AlignmentSceneOptions options = smallScene(0.006);
  options.wrinkles = 0.15;
  AlignmentRig rig(*device, options);
  const bake::AlignedFrame found = aligned(rig);
  ASSERT_FALSE(HasFailure());
  EXPECT_LT(alignmentError_m(rig.scene, found.displacement_m), 0.12 * options.drift_m);
}

TEST_F(BakeAlignment, PlainPlacesTakeASmoothFieldAndLittleConfidence) {
  AlignmentSceneOptions options = smallScene(0.008);
  options.plain_from = 0.45;
  options.plain_to = 0.55;
  AlignmentRig rig(*device, options);
  const bake::AlignedFrame found = aligned(rig);
  ASSERT_FALSE(HasFailure());
  const auto truth = rig.scene.truth();
  float plain = 0, textured = 0;
  int plain_count = 0, textured_count = 0;
  for (uint32_t v = 0; v < truth.size(); ++v) {
    const double share = rig.scene.heightShare(v);
    if (share > 0.48 && share < 0.52) {
      EXPECT_LT(glm::distance(found.displacement_m[v], truth[v]), 0.5 * options.drift_m) << v;
      plain += found.confidence[v];
      ++plain_count;
    } else if (share > 0.25 && share < 0.4) {
      textured += found.confidence[v];
      ++textured_count;
    }
  }
  ASSERT_GT(plain_count, 0);
  EXPECT_LT(plain / float(plain_count), 0.2f);
  EXPECT_GT(textured / float(textured_count), 0.7f);
}

TEST_F(BakeAlignment, ThreeMembersEachFindTheirOwnWay) {
  AlignmentSceneOptions options = smallScene(0.012);
  options.members = 3;
  AlignmentRig rig(*device, options);
  const std::vector<glm::vec2> found = aligned(rig).displacement_m;
  ASSERT_FALSE(HasFailure());
  const size_t vertices = rig.scene.mesh.topology.vertex_count;
  ASSERT_EQ(found.size(), 2 * vertices);
  EXPECT_LT(alignmentError_m(rig.scene, std::span(found).subspan(vertices)), 0.05 * options.drift_m);
  std::vector<glm::vec2> doubled(found.begin(), found.begin() + ptrdiff_t(vertices));
  for (glm::vec2& d : doubled) d *= 2;  // member 1's displacement is half as long
  EXPECT_LT(alignmentError_m(rig.scene, doubled), 0.08 * options.drift_m);
}

TEST_F(BakeAlignment, RefusesWhatCannotBeAligned) {
  AlignmentRig rig(*device, smallScene(0));
  const auto refused = [&](bake::AlignmentOptions options) {
    auto made = rig.align(options);
    return !made && made.error().id == ErrorId::InvalidArgument;
  };
  bake::AlignmentOptions options;
  options.views = 0;
  EXPECT_TRUE(refused(options));
  options = {};
  options.picture_height = 3;
  EXPECT_TRUE(refused(options));
  options = {};
  options.smoothness = std::nan("");
  EXPECT_TRUE(refused(options));
}

}  // namespace
}  // namespace fourdvt::testing
