// SPDX-License-Identifier: Apache-2.0
#include "bake/motion/class_plan.h"

#include <gtest/gtest.h>

#include "bake/motion/hybrid_blend.h"
#include "bake/motion/time_warp.h"
#include "motion/blend.h"
#include "motion_shapes.h"

namespace fourdvt::bake {
namespace {

bool keepOn(double) { return true; }

// Points on ellipses with a phase each: no two poses are alike.
Positions ring(double u) {
  Positions out;
  for (int i = 0; i < 20; ++i) {
    const double a = kTau * u + 0.4 * i, b = 2 * kTau * u + 0.9 * i;
    out.emplace_back(0.1 * i + 0.3 * std::cos(a), 0.2 * std::sin(b), 0.4 * std::sin(a));
  }
  return out;
}

PoseFeatures ringFeatures(size_t frames, bool loop, const std::function<double(double)>& pass_of) {
  std::vector<Positions> poses;
  const double whole = loop ? double(frames) : double(frames - 1);
  for (size_t t = 0; t < frames; ++t) poses.push_back(ring((loop ? 1 : 0.8) * pass_of(double(t) / whole)));
  return poseFeatures(poses, loop);
}

double same(double u) { return u; }
double bowed(double u) { return u + 0.08 * std::sin(kTau * u); }

TEST(TimeWarp, RecoversAKnownWarpAndItsCyclicOffset) {
  for (double offset : {0.0, 0.3, 0.85}) {
    const PoseFeatures reference = ringFeatures(28, true, same);
    const PoseFeatures member = ringFeatures(19, true, [=](double u) { return bowed(u) + offset; });
    const std::vector<double> time = warpTime(reference, member, true);
    ASSERT_EQ(time.size(), 28u);
    for (size_t p = 0; p < 28; ++p) {
      EXPECT_GE(time[p], 0);
      if (p > 0) {
        EXPECT_GT(time[p], time[p - 1]);
      }
      const double shown = bowed(time[p] / 19) + offset - double(p) / 28;
      EXPECT_NEAR(shown - std::round(shown), 0, 0.012) << "phase " << p << " offset " << offset;
    }
    EXPECT_LT(time[27] - time[0], 19);
    EXPECT_GT(19 - (time[27] - time[0]), 0.2);  // the step that closes the loop is like the others
  }
}

TEST(TimeWarp, JoinsTheEndsOfWhatDoesNotLoop) {
  const PoseFeatures reference = ringFeatures(30, false, same);
  const std::vector<double> time = warpTime(reference, ringFeatures(24, false, bowed), false);
  EXPECT_NEAR(time.front(), 0, 1e-9);
  EXPECT_NEAR(time.back(), 23, 1e-9);
  for (size_t p = 0; p < 30; ++p) EXPECT_NEAR(bowed(time[p] / 23), double(p) / 29, 0.015) << p;
}

TEST(TimeWarp, PaceKeepsItsBounds) {
  // Unrelated motions: the path still may not jump.
  const PoseFeatures reference = ringFeatures(28, true, [](double u) { return 3 * u; });
  const std::vector<double> time = warpTime(reference, ringFeatures(14, true, same), true);
  for (size_t p = 1; p < 28; ++p) {
    EXPECT_GT(time[p] - time[p - 1], 0.3 * 14 / 28);
    EXPECT_LT(time[p] - time[p - 1], 3.2 * 14 / 28);
  }
}

double maxApart(const std::vector<double>& a, const std::vector<double>& b, double pass) {
  double most = 0;
  for (size_t p = 0; p < a.size(); ++p) most = std::max(most, std::abs(std::remainder(a[p] - b[p], pass)));
  return most;
}

TEST(TimeWarp, ABandRoundTheThinnedWarpFindsThePathOfTheWholeSearch) {
  for (const bool loop : {false, true}) {
    const double offset = loop ? 0.7 : 0;
    const PoseFeatures reference = ringFeatures(200, loop, same);
    const PoseFeatures member = ringFeatures(
        155, loop, [=](double u) { return u + 0.05 * std::sin(kTau * u) + 0.004 * std::sin(9 * kTau * u) + offset; });
    const std::vector<double> whole = warpTime(reference, member, loop);
    WarpSearch few;
    few.max_cells = 200 * 155 * 11 / 10;  // a tenth of the full search's cells
    const std::vector<double> band = warpTime(reference, member, loop, few);
    ASSERT_EQ(band.size(), 200u);
    EXPECT_LT(maxApart(band, whole, 155), 0.25) << "frames, a few steps; loop " << loop;
    std::vector<double> even;
    for (size_t p = 0; p < 200; ++p) even.push_back(whole[0] + double(p) * (loop ? 155 / 200. : 154 / 199.));
    EXPECT_GT(maxApart(whole, even, 155), 3) << "the member's time is not its mean pace";
    // A band that is too narrow is widened until the path stays off its edges.
    few.band_frames = 0.05;
    EXPECT_LT(maxApart(warpTime(reference, member, loop, few), whole, 155), 0.25)
        << "frames, a few steps; loop " << loop;
  }
}

TEST(TimeWarp, SpreadVerticesAreDistinctAndFar) {
  const Positions tube = Tube::bent(0);
  const auto chosen = spreadVertices(tube, 5);
  ASSERT_EQ(chosen.size(), 5u);
  for (size_t a = 0; a < 5; ++a)
    for (size_t b = 0; b < a; ++b) EXPECT_GT(glm::distance(tube[chosen[a]], tube[chosen[b]]), 0.2f);
  EXPECT_EQ(spreadVertices(tube, 9999).size(), tube.size());
}

// A capture of walkers, with one class of them.
struct Walkers {
  std::vector<Walker> walkers;
  capture::Capture capture;
  capture::CaptureClass locomotion;

  explicit Walkers(std::vector<Walker> of) : walkers(std::move(of)) {
    capture = walkers[0].capture;
    locomotion.name = "locomotion";
    locomotion.parameters = {"speed_mps"};
    for (const Walker& walker : walkers) {
      capture.sequences.push_back(walker.sequence);
      locomotion.members.push_back({walker.sequence.name, {}});
    }
  }
  ReadPositions read() const {
    return [this](const capture::CaptureSequence& sequence, uint32_t t) -> Result<Positions> {
      for (const Walker& walker : walkers)
        if (walker.sequence.name == sequence.name) return walker.frame(t);
      return Error{ErrorId::Internal, "no such walker"};
    };
  }
  Result<ClassPlan> plan(const ClassOptions& options = {}) const {
    return planClass(capture, locomotion, {capture.topology, read()}, options, keepOn);
  }
};

Walkers walkAndRun() {
  Walker walk("walk", 1.2, 28), run("run", 2.7, 19);
  run.first_share = 0.25;
  return Walkers({walk, run});
}

package::Sequence manifestOf(const ClassPlan& plan) {
  package::Sequence sequence;
  sequence.members = plan.manifest;
  sequence.space = plan.space;
  sequence.reference_count = uint32_t(plan.reference_weights.size());
  return sequence;
}

double speedAt(const package::Sequence& sequence, const std::vector<float>& weights) {
  glm::dvec3 travel(0);
  for (size_t m = 0; m < weights.size(); ++m) travel += double(weights[m]) * sequence.members[m].travel;
  return glm::length(glm::dvec2(travel)) / motion::durationAt(sequence, weights);
}

TEST(ClassPlan, WalkAndRunBecomeOneMotionBySpeed) {
  const Walkers walkers = walkAndRun();
  auto planned = walkers.plan();
  ASSERT_TRUE(planned.ok()) << planned.error().message;
  const ClassPlan& plan = planned.value();
  EXPECT_EQ(plan.frame_count, 28u);
  EXPECT_TRUE(plan.loop);
  EXPECT_NEAR(plan.fps, 28 / ((1.12 + 0.76) / 2), 1e-9);
  EXPECT_NEAR(plan.manifest[0].parameter[0], 1.2, 1e-3);
  EXPECT_NEAR(plan.manifest[1].parameter[0], 2.7, 2e-2);
  EXPECT_TRUE(plan.notes.empty());
  for (uint32_t p = 0; p < 28; ++p) EXPECT_EQ(plan.members[0].source_frame[p], p);
  EXPECT_NEAR(plan.members[1].source_frame[0], 0.75 * 19, 0.7);  // where the walker's left foot touches down
  for (const ClassMember& member : plan.members) EXPECT_EQ(member.root[0], glm::vec3(0));
  const float whole = float(2.7 * 19 / 25);  // also across the loop's seam
  EXPECT_NEAR(plan.members[1].root[27].y,
              whole * (plan.members[1].source_frame[27] - plan.members[1].source_frame[0]) / 19, 0.03);
}

TEST(ClassPlan, ASpeedAskedForIsTheSpeedTravelled) {
  const Walkers walkers = walkAndRun();
  const package::Sequence sequence = manifestOf(walkers.plan().value());
  EXPECT_GE(sequence.space.samples.size(), 17u);
  for (double speed : {1.25, 1.7, 2.1, 2.6}) {
    const auto weights = motion::weightsAt(sequence, std::vector<double>{speed});
    EXPECT_NEAR(speedAt(sequence, weights.members), speed, 2e-3);
  }
}

TEST(ClassPlan, MembersAreOrderedByTheirParameter) {
  Walkers walkers = walkAndRun();
  std::swap(walkers.locomotion.members[0], walkers.locomotion.members[1]);
  const auto plan = walkers.plan().take();
  EXPECT_EQ(plan.manifest[0].name, "walk");
  ASSERT_EQ(plan.notes.size(), 1u);
  EXPECT_NE(plan.notes[0].find("order"), std::string::npos);
}

TEST(ClassPlan, DeclaredParametersMixLinearly) {
  Walkers walkers = walkAndRun();
  walkers.locomotion.parameters = {"height_m"};
  walkers.locomotion.members[0].parameter = {0.5};
  walkers.locomotion.members[1].parameter = {1.5};
  const package::Sequence sequence = manifestOf(walkers.plan().value());
  EXPECT_NEAR(motion::weightsAt(sequence, std::vector<double>{0.75}).members[1], 0.25, 1e-5);
}

TEST(ClassPlan, ImpossibleClassesAreRefused) {
  const auto refused = [](const std::function<void(Walkers&)>& change) {
    Walkers walkers = walkAndRun();
    change(walkers);
    const auto plan = walkers.plan();
    ASSERT_FALSE(plan.ok());
    EXPECT_EQ(plan.error().id, ErrorId::CaptureJson);
  };
  refused([](Walkers& w) { w.capture.sequences[1].loop = false; });
  refused([](Walkers& w) { w.locomotion.parameters = {"height_m"}; });
  refused([](Walkers& w) { w.locomotion.members[1].sequence = "fly"; });
  refused([](Walkers& w) { w.locomotion.members.pop_back(); });
  refused([](Walkers& w) { w.locomotion.members[1] = w.locomotion.members[0]; });
  refused([](Walkers& w) { w.locomotion.members[1].parameter = {1, 2}; });
  refused([](Walkers& w) {
    w.locomotion.parameters = {"a", "b"};
    for (auto& member : w.locomotion.members) member.parameter = {1, 2};
  });
}

// A bake rejects these before it reads a picture.
TEST(ClassPlan, WhatShowsWithoutMeshesIsCheckedWithoutThem) {
  const auto problem = [](const std::vector<std::string>& parameters, const std::vector<std::vector<double>>& values) {
    Walkers walkers = walkAndRun();
    walkers.capture.folder = "studio";
    walkers.locomotion.parameters = parameters;
    for (size_t m = 0; m < values.size(); ++m) walkers.locomotion.members[m].parameter = values[m];
    const Status status = checkClass(walkers.capture, walkers.locomotion);
    return status.ok() ? std::string() : status.error().message;
  };
  EXPECT_EQ(problem({"speed_mps"}, {}), "");
  EXPECT_EQ(problem({"speed_mps"}, {{1}}), "") << "the other one is measured";
  EXPECT_EQ(problem({"height_m"}, {{1}, {2}}), "");
  EXPECT_EQ(problem({"height_m"}, {{2}, {2}}),
            "studio/capture.json: class 'locomotion': 'walk' and 'run' have the same parameter; leave one out");
  EXPECT_NE(problem({"height_m"}, {{2}}).find("studio/capture.json: class 'locomotion': only speed_mps is measured"),
            std::string::npos);
  EXPECT_NE(problem({"a", "b"}, {{1, 2}, {2, 1}}).find("two parameters need three or four members"), std::string::npos);
}

TEST(ClassPlan, StopsWhenAsked) {
  const Walkers walkers = walkAndRun();
  const auto plan = planClass(walkers.capture, walkers.locomotion, {walkers.capture.topology, walkers.read()}, {},
                              [](double) { return false; });
  ASSERT_FALSE(plan.ok());
  EXPECT_EQ(plan.error().id, ErrorId::Interrupted);
}

// Tubes that sway, each member by another angle.
struct Tubes {
  Tube tube;
  capture::Capture capture;
  capture::CaptureClass bending;
  std::vector<double> angles;

  explicit Tubes(const std::vector<double>& of, size_t parameters = 1) : angles(of) {
    capture.fps = 25;
    capture.topology = tube.topology;
    bending.name = "bending";
    bending.parameters = {"angle", "other"};
    bending.parameters.resize(parameters);
    for (size_t m = 0; m < angles.size(); ++m) {
      capture::CaptureSequence sequence;
      sequence.name = std::string(1, char('a' + m));
      sequence.frame_count = 4;
      capture.sequences.push_back(sequence);
      bending.members.push_back({sequence.name, {angles[m]}});
    }
  }
  ReadPositions read() const {
    return [this](const capture::CaptureSequence& sequence, uint32_t t) -> Result<Positions> {
      return Tube::bent(angles[size_t(sequence.name[0] - 'a')] * t / 3.0);
    };
  }
  ClassPlan plan(const ClassOptions& options) const {
    auto planned = planClass(capture, bending, {capture.topology, read()}, options, keepOn);
    EXPECT_TRUE(planned.ok()) << planned.error().message;
    return planned.take();
  }
};

// Largest error of the meshes that the player shows, over phases and over values between the checked ones.
double shownError(const Tubes& tubes, const ClassPlan& plan, const std::vector<std::vector<double>>& values) {
  const package::Sequence sequence = manifestOf(plan);
  const auto blend = NonlinearBlend::create(tubes.tube.topology, Tube::bent(0)).take();
  double most = 0;
  for (uint32_t phase = 0; phase < plan.frame_count; ++phase) {
    std::vector<Positions> members;
    for (const ClassMember& member : plan.members)
      members.push_back(memberPositions(member, phase, tubes.read()).take());
    const auto offsets = referenceOffsets(blend, plan, members);
    for (const auto& value : values) {
      const motion::BlendWeights weights = motion::weightsAt(sequence, value);
      Positions shown = linearBlend(members, weights.members);
      for (size_t r = 0; r < offsets.size(); ++r)
        for (size_t v = 0; v < shown.size(); ++v) shown[v] += weights.offsets[r] * offsets[r][v];
      most = std::max(most, largestDistance(shown, blend.blend(members, weights.members)));
    }
  }
  return most;
}

TEST(ClassPlan, ReferencesKeepTheBlendsBound) {
  const Tubes tubes({0.1, 2.2});
  const ClassPlan plan = tubes.plan({});
  EXPECT_GT(plan.linear_error_m, 0.05);
  EXPECT_LT(plan.hybrid_error_m, ClassOptions().blend_error_m);
  EXPECT_GE(plan.reference_weights.size(), 1u);
  EXPECT_LE(plan.reference_weights.size(), 4u);
  EXPECT_LT(shownError(tubes, plan, {{0.33}, {0.777}, {1.2}, {1.61}, {2.02}}), 1.2 * ClassOptions().blend_error_m);
  ClassOptions few;
  few.max_references = 1;
  few.blend_error_m = 1e-6;
  const ClassPlan rough = tubes.plan(few);
  EXPECT_EQ(rough.reference_weights.size(), 1u);
  EXPECT_GT(rough.hybrid_error_m, few.blend_error_m);
  EXPECT_LT(rough.hybrid_error_m, rough.linear_error_m);
  few.blend_error_m = 1;
  EXPECT_TRUE(tubes.plan(few).reference_weights.empty());
}

TEST(ClassPlan, ThreeMembersFollowOneAnother) {
  const Tubes tubes({0.1, 2.2, 1.0});
  const ClassPlan plan = tubes.plan({});
  EXPECT_EQ(plan.manifest[1].name, "c");
  EXPECT_LT(plan.hybrid_error_m, ClassOptions().blend_error_m);
  const auto weights = motion::weightsAt(manifestOf(plan), std::vector<double>{1.6});
  EXPECT_NEAR(weights.members[0], 0, 1e-6);
  EXPECT_NEAR(weights.members[1], 0.5, 1e-5);
  EXPECT_LT(shownError(tubes, plan, {{0.4}, {0.9}, {1.3}, {1.9}}), 1.2 * ClassOptions().blend_error_m);
}

TEST(ClassPlan, TwoParametersMakeTriangles) {
  Tubes tubes({0, 1.2, 0.6, 1.8}, 2);
  const double other[4] = {0, 0, 10, 10};
  for (size_t m = 0; m < 4; ++m) tubes.bending.members[m].parameter.push_back(other[m]);
  ClassOptions options;
  options.blend_error_m = 0.01;
  options.max_references = 12;
  const ClassPlan plan = tubes.plan(options);
  EXPECT_LT(plan.hybrid_error_m, 0.01);
  EXPECT_LE(plan.reference_weights.size(), 12u);
  const auto weights = motion::weightsAt(manifestOf(plan), std::vector<double>{0.9, 5});
  double angle = 0, value = 0;
  for (size_t m = 0; m < 4; ++m) {
    angle += weights.members[m] * plan.manifest[m].parameter[0];
    value += weights.members[m] * plan.manifest[m].parameter[1];
  }
  EXPECT_NEAR(angle, 0.9, 1e-5);
  EXPECT_NEAR(value, 5, 1e-4);
  EXPECT_LT(shownError(tubes, plan, {{0.5, 2}, {0.9, 5}, {1.2, 7}}), 0.012);
}

TEST(ClassSimplices, QuadsAreCutAlongTheShorterDiagonalAndInnerPointsJoinAll) {
  const auto members = [](std::vector<std::array<double, 2>> at) {
    std::vector<package::Member> out(at.size());
    for (size_t i = 0; i < at.size(); ++i) out[i].parameter = {at[i][0], at[i][1]};
    return out;
  };
  const auto quad = classSimplices(members({{0, 0}, {3, 2}, {1, 2}, {2, 0}}), "x").take();
  ASSERT_EQ(quad.size(), 2u);
  for (const BlendSimplex& s : quad) {  // from 2 to 3, not from 0 to 1
    EXPECT_TRUE(std::count(s.members.begin(), s.members.end(), 2) == 1);
    EXPECT_TRUE(std::count(s.members.begin(), s.members.end(), 3) == 1);
  }
  const auto fan = classSimplices(members({{0, 0}, {4, 0}, {1, 1}, {0, 4}}), "x").take();
  ASSERT_EQ(fan.size(), 3u);
  for (const BlendSimplex& s : fan) EXPECT_EQ(std::count(s.members.begin(), s.members.end(), 2), 1);
  EXPECT_FALSE(classSimplices(members({{0, 0}, {1, 1}, {2, 2}}), "x").ok());
}

TEST(MemberPositions, FourPointsFollowAParabola) {
  capture::CaptureSequence sequence;
  sequence.frame_count = 8;
  const ReadPositions read = [](const capture::CaptureSequence&, uint32_t t) -> Result<Positions> {
    return Positions{{float(t * t), float(t), 1}};
  };
  const ClassMember member{&sequence, {0, 2.5, 3.25, 6, 7}, {}};
  const auto at = [&](uint32_t phase) { return memberPositions(member, phase, read).value()[0]; };
  EXPECT_LT(glm::distance(at(1), {6.25f, 2.5f, 1}), 1e-5);
  EXPECT_LT(glm::distance(at(2), {3.25f * 3.25f, 3.25f, 1}), 1e-5);
  EXPECT_EQ(at(3), glm::vec3(36, 6, 1));
  EXPECT_EQ(at(4), glm::vec3(49, 7, 1));
}

TEST(MemberPositions, LoopsGoOnAtTheirStart) {
  const Walker walker("walk", 1.2, 28);
  const ReadPositions read = [&](const capture::CaptureSequence&, uint32_t t) -> Result<Positions> {
    EXPECT_LT(t, 28u);
    return walker.frame(t);
  };
  const ClassMember member{&walker.sequence, {27.5, 28.5, 30}, {}};
  EXPECT_LT(largestDistance(memberPositions(member, 0, read).value(), walker.pose(27.5 / 28)), 0.01);
  EXPECT_LT(largestDistance(memberPositions(member, 1, read).value(), walker.pose(0.5 / 28)), 0.01);
  EXPECT_LT(largestDistance(memberPositions(member, 2, read).value(), walker.frame(2)), 1e-6);
}

}  // namespace
}  // namespace fourdvt::bake
