// SPDX-License-Identifier: Apache-2.0
// Lengths of a bake: defaults for a person, in proportion for other surfaces, and explicit ones.
#include <gtest/gtest.h>

#include "bake/run/job.h"
#include "bake/stages/stages.h"

using namespace fourdvt;
using namespace fourdvt::bake;

namespace {

Job settled(double side_m, BakeOptions options = {}) {
  Job job;
  if (!options.appearance) options.appearance = package::AppearanceKind::Layers;
  job.options = options;
  job.bounds = {glm::vec3(0), glm::vec3(float(side_m))};
  EXPECT_TRUE(settleLengths(job, {side_m}).ok());
  return job;
}

TEST(Lengths, OfTheBakeAreThoseOfAPerson) {
  const Job layers = settled(1.8);
  EXPECT_EQ(layers.options.position_step_m, 0.0005);
  EXPECT_EQ(gridStep_m(layers.options), double(0.0005f / 16)) << "finer than residuals";
  EXPECT_EQ(layers.options.coarse_step_m, 0.0035);
  EXPECT_EQ(layers.options.classes.blend_error_m, 0.001);
  EXPECT_EQ(layers.options.classes.alignment_step_m, 0.0001);
  EXPECT_EQ(layers.options.resample.contour_step_m, 0.02f);
  BakeOptions cameras;
  cameras.appearance = package::AppearanceKind::Cameras;
  const Job from_cameras = settled(1.8, cameras);
  EXPECT_EQ(from_cameras.options.position_step_m, 0.001);
  EXPECT_EQ(gridStep_m(from_cameras.options), double(0.001f));
}

TEST(Lengths, OfTheBakeFollowTheSurface) {
  const Job figurine = settled(0.09), crane = settled(20);
  EXPECT_EQ(figurine.length_scale, 1 / 16.0);
  EXPECT_DOUBLE_EQ(*figurine.options.position_step_m, 0.0005 / 16);
  EXPECT_DOUBLE_EQ(*figurine.options.coarse_step_m, 0.0035 / 16);
  EXPECT_FLOAT_EQ(figurine.options.resample.contour_step_m, 0.02f / 16);
  EXPECT_DOUBLE_EQ(*crane.options.position_step_m, 0.004);
  EXPECT_DOUBLE_EQ(*crane.options.classes.blend_error_m, 0.008);
}

TEST(Lengths, ThatAreGivenStay) {
  BakeOptions given;
  given.position_step_m = 0.003;
  given.coarse_step_m = 0;
  const Job job = settled(20, given);
  EXPECT_EQ(job.options.position_step_m, 0.003);
  EXPECT_EQ(job.options.coarse_step_m, 0);
  EXPECT_DOUBLE_EQ(*job.options.classes.alignment_step_m, 0.0008) << "was not given";
}

TEST(Lengths, StayThoseOfTheFirstCall) {
  Job job = settled(0.09);
  ASSERT_TRUE(settleLengths(job, {1.8}).ok()) << "after the refinement, surfaces are measured again";
  EXPECT_EQ(job.length_scale, 1 / 16.0);
  EXPECT_FLOAT_EQ(job.options.resample.contour_step_m, 0.02f / 16);
}

TEST(Lengths, RefuseBoundsOfTooManySteps) {
  Job job;
  job.options.appearance = package::AppearanceKind::Layers;
  job.bounds = {glm::vec3(0), glm::vec3(5000)};
  EXPECT_EQ(settleLengths(job, {1.8}).error().id, ErrorId::InvalidArgument);
}

}  // namespace
