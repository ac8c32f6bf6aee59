// SPDX-License-Identifier: Apache-2.0
// Labels on graphs with known answers: the box between two cameras, chains with brute force over all labellings, and
// random sheets for invariants.
#include "bake/labels/labelling.h"

#include <gtest/gtest.h>

#include <bit>
#include <map>
#include <mutex>
#include <random>

#include "bake/labels/expansion.h"
#include "bake/labels/schedule.h"
#include "lab/labels/paper_labellings.h"
#include "label_fixture.h"

namespace fourdvt::bake {
namespace {

using lab::kNaive, lab::kPerTexel, lab::kSpatial, lab::kTemporalPaper;

using Labels = std::vector<std::vector<uint8_t>>;  // [frame][layer * faces + face]

struct Problem {
  FaceGraph graph;
  std::vector<FaceCosts> frames;
};

FaceGraph graphOf(uint32_t faces, std::vector<std::pair<uint32_t, uint32_t>> edges) {
  FaceGraph graph{faces, std::move(edges), std::vector<uint8_t>(faces, 0)};
  for (auto [f, g] : graph.edges) ++graph.neighbour_count[f], ++graph.neighbour_count[g];
  return graph;
}

FaceGraph chainOf(uint32_t faces) {
  std::vector<std::pair<uint32_t, uint32_t>> edges;
  for (uint32_t f = 0; f + 1 < faces; ++f) edges.push_back({f, f + 1});
  return graphOf(faces, std::move(edges));
}

FaceGraph sheetOf(uint32_t columns, uint32_t rows) {
  std::vector<std::pair<uint32_t, uint32_t>> edges;
  for (uint32_t f = 0; f < columns * rows; ++f) {
    if ((f + 1) % columns) edges.push_back({f, f + 1});
    if (f + columns < columns * rows) edges.push_back({f, f + columns});
  }
  return graphOf(columns * rows, std::move(edges));
}

// Random penalties and feasible cameras; about one face in ten has no camera, a fifth of the others are partial.
FaceCosts randomCosts(std::mt19937& random, uint32_t faces, int cameras) {
  FaceCosts out{cameras, std::vector<uint32_t>(faces), std::vector<uint32_t>(faces), {}};
  for (uint32_t f = 0; f < faces; ++f) {
    if (random() % 10 == 0) continue;
    out.feasible[f] = random() % (1u << cameras);
    if (out.feasible[f]) out.partial[f] = random() % (1u << cameras) & random() & ~out.feasible[f];
  }
  for (size_t i = 0; i < size_t(faces) * cameras; ++i) out.penalty.push_back((random() % 1000) / 1000.0f);
  return out;
}

Problem randomProblem(uint32_t seed, FaceGraph graph, uint32_t frames, int cameras) {
  std::mt19937 random(seed);
  Problem out{std::move(graph), {}};
  for (uint32_t t = 0; t < frames; ++t) out.frames.push_back(randomCosts(random, out.graph.face_count, cameras));
  return out;
}

struct Solution {
  LabelStatistics statistics;
  Labels labels;
};

Solution solve(const Problem& problem, const LabelOptions& options, const LabelKeeper* keeper = nullptr) {
  Solution out;
  auto statistics = solveLabels(options, problem.graph, static_cast<uint32_t>(problem.frames.size()),
                                {[&](uint32_t t) -> Result<FaceCosts> { return FaceCosts(problem.frames[t]); },
                                 [&](uint32_t t, const std::vector<uint8_t>& labels) -> Status {
                                   EXPECT_EQ(t, out.labels.size());  // ascending
                                   out.labels.push_back(labels);
                                   return {};
                                 },
                                 {},
                                 nullptr,
                                 keeper});
  EXPECT_TRUE(statistics.ok());
  if (statistics.ok()) out.statistics = statistics.take();
  EXPECT_EQ(out.labels.size(), problem.frames.size());
  return out;
}

LabelOptions withRule(const Labelling& rule, int layers = 3) {
  LabelOptions options;
  options.rule = &rule;
  options.layers = layers;
  return options;
}

double energyOf(const Problem& problem, const LabelOptions& options, const Labels& labels) {
  LabelMeter meter(options, problem.graph);
  for (size_t t = 0; t < labels.size(); ++t) meter.add(problem.frames[t], labels[t]);
  return meter.statistics().energy;
}

uint32_t usable(const FaceCosts& costs, size_t face) { return costs.feasible[face] | costs.partial[face]; }

// Minimum energy over all labellings with one layer.
double bruteForce(const Problem& problem, const LabelOptions& options) {
  const size_t faces = problem.graph.face_count, nodes = faces * problem.frames.size();
  Labels labels(problem.frames.size(), std::vector<uint8_t>(faces));
  double best = 1e300;
  const std::function<void(size_t)> choose = [&](size_t node) {
    if (node == nodes) return void(best = std::min(best, energyOf(problem, options, labels)));
    uint8_t& label = labels[node / faces][node % faces];
    const uint32_t cameras = usable(problem.frames[node / faces], node % faces);
    if (!cameras) label = package::kNoCamera, choose(node + 1);
    for (uint8_t c = 0; c < 8; ++c)
      if (cameras >> c & 1) label = c, choose(node + 1);
  };
  choose(0);
  return best;
}

TEST(Labellings, NamesRoundTrip) {
  EXPECT_EQ(lab::allLabellings().size(), 5u);
  for (const Labelling* rule : lab::allLabellings()) EXPECT_EQ(lab::findLabelling(rule->name), rule);
  EXPECT_EQ(lab::findLabelling("best"), nullptr);
}

TEST(FaceGraphOfAMesh, HasEverySharedEdgeOnce) {
  MeshTopology topology;
  topology.vertex_count = 5;
  topology.face_vertices = {{0, 1, 2}, {2, 1, 3}, {2, 3, 4}};
  const FaceGraph graph = makeFaceGraph(topology);
  EXPECT_EQ(graph.edges, (std::vector<std::pair<uint32_t, uint32_t>>{{0, 1}, {1, 2}}));
  EXPECT_EQ(graph.neighbour_count, (std::vector<uint8_t>{1, 2, 1}));
}

struct BoxLabels : testing::Test {
  Box box = makeBox();
  std::vector<float> fractions = std::vector<float>(2 * 12, 1.0f);
  std::vector<uint8_t> labels(const Labelling& rule) {
    const std::vector<PinholeCamera> cameras = boxCameras();
    Problem problem{makeFaceGraph(box.topology),
                    {measureFaceCosts({}, cameras, box.topology, box.positions, fractions)}};
    return solve(problem, withRule(rule, 2)).labels[0];
  }
};

TEST_F(BoxLabels, NaiveOrdersCamerasByPenalty) {
  for (const Labelling* rule : {&kNaive, &kPerTexel}) {
    const auto l = labels(*rule);
    for (int f : {8, 9}) {  // +z: 0° to camera 0, 30° to camera 1
      EXPECT_EQ(l[f], 0);
      EXPECT_EQ(l[12 + f], 1);
    }
    for (int f : {0, 1}) {  // +x: seen by camera 1 only
      EXPECT_EQ(l[f], 1);
      EXPECT_EQ(l[12 + f], package::kNoCamera);
    }
    for (int f : {10, 11}) EXPECT_EQ(l[f], package::kNoCamera);
  }
}

TEST_F(BoxLabels, HiddenCamerasAreReplaced) {
  fractions[8] = 0.5f;  // camera 0, face 8
  EXPECT_EQ(labels(kNaive)[8], 1);
  EXPECT_EQ(labels(kNaive)[12 + 8], package::kNoCamera);
  fractions[8] = 0;
  EXPECT_EQ(labels(kJoint)[8], 1);
  EXPECT_EQ(labels(kJoint)[12 + 8], package::kNoCamera);
}

// The two triangles of the front face share the diagonal: 1/1 + 1/1 = 2 for a seam, against 0.25 of penalty.
TEST_F(BoxLabels, SpatialAvoidsASeamThatCostsMoreThanThePenalty) {
  fractions[8] = 0;  // face 8 must take camera 1; face 9 is cheaper with camera 0
  EXPECT_EQ(labels(kNaive)[9], 0);
  EXPECT_EQ(labels(kSpatial)[9], 1);
  EXPECT_EQ(labels(kSpatial)[12 + 9], 0);  // the next layer, without the first one's camera
}

struct AllLabellings : testing::TestWithParam<const Labelling*> {};
INSTANTIATE_TEST_SUITE_P(Labels, AllLabellings, testing::ValuesIn(lab::allLabellings()));

TEST_P(AllLabellings, TuplesHoldDistinctFeasibleCameras) {
  const Problem problem = randomProblem(1, sheetOf(9, 7), 19, 5);
  const Solution solution = solve(problem, withRule(*GetParam()));
  const size_t faces = problem.graph.face_count;
  for (size_t t = 0; t < problem.frames.size(); ++t) {
    for (size_t f = 0; f < faces; ++f) {
      uint32_t seen = 0;
      const uint32_t allowed = GetParam() == &kJoint ? usable(problem.frames[t], f) : problem.frames[t].feasible[f];
      for (int l = 0; l < 3; ++l) {
        const uint8_t camera = solution.labels[t][l * faces + f];
        if (camera == package::kNoCamera) continue;
        ASSERT_LT(camera, 5);
        EXPECT_TRUE(allowed >> camera & 1);
        EXPECT_FALSE(seen >> camera & 1);
        seen |= 1u << camera;
      }
      EXPECT_EQ(allowed == 0, solution.labels[t][f] == package::kNoCamera);
    }
  }
}

TEST_P(AllLabellings, LabelsDoNotDependOnTheJobCount) {
  const Problem problem = randomProblem(2, sheetOf(8, 8), 45, 5);
  LabelOptions options = withRule(*GetParam());
  const Labels one = solve(problem, options).labels;
  for (int jobs : {2, 5}) {
    options.jobs = jobs;
    EXPECT_EQ(solve(problem, options).labels, one) << jobs;
  }
}

// With two labels one expansion is the whole problem: one sweep finds the optimum.
TEST(Expansion, IsExactForTwoCameras) {
  for (uint32_t seed = 0; seed < 40; ++seed) {
    Problem problem = randomProblem(seed, chainOf(5), 2, 2);
    for (FaceCosts& frame : problem.frames)
      for (uint32_t& mask : frame.feasible) mask = 3;
    const LabelOptions options = withRule(kJoint, 1);
    EXPECT_NEAR(solve(problem, options).statistics.energy, bruteForce(problem, options), 1e-3) << seed;
  }
}

TEST(Expansion, IsWithinFivePercentForFourCameras) {
  for (uint32_t seed = 0; seed < 25; ++seed) {
    const Problem problem = randomProblem(seed, chainOf(7), 1, 4);
    const LabelOptions options = withRule(kJoint, 1);
    const double best = bruteForce(problem, options);
    const double found = solve(problem, options).statistics.energy;
    EXPECT_GE(found, best - 1e-3) << seed;
    EXPECT_LE(found, 1.05 * best) << seed;
  }
}

// Uses its own block, to check the energy after every move.
TEST(Expansion, MovesNeverRaiseTheEnergy) {
  const Problem problem = randomProblem(3, sheetOf(12, 10), 6, 6);
  LabelOptions options;
  const FaceLinks links = makeFaceLinks(problem.graph);
  std::vector<std::vector<LabelTuple>> labels(problem.frames.size());
  std::vector<BlockFrame> frames;
  for (size_t t = 0; t < problem.frames.size(); ++t) {
    for (uint32_t f = 0; f < problem.graph.face_count; ++f)
      labels[t].push_back(cheapestCameras(problem.frames[t], f, problem.frames[t].feasible[f], options.layers));
    frames.push_back({&problem.frames[t], &problem.frames[t].feasible, &labels[t]});
  }
  const LabelWeights weights = LabelWeights::joint(options, links);
  ExpansionBlock block(weights, links, frames);
  int64_t energy = block.energy();
  const int64_t start = energy;
  int falls = 0;
  for (int sweep = 0; sweep < 3; ++sweep) {
    for (int rank = 0; rank < options.layers; ++rank) {
      for (uint8_t c : {0, 1, 2, 3, 4, 5, 255}) {
        const bool changed = block.expand(rank, c);
        const int64_t now = block.energy();
        ASSERT_EQ(changed, now < energy) << "rank " << rank << " camera " << int(c);
        falls += changed;
        energy = now;
      }
    }
  }
  EXPECT_GT(falls, 10);
  EXPECT_LT(energy, start * 9 / 10);
  // The integer energy equals the statistics' energy.
  block.solve(1);
  Labels planar;
  for (const auto& frame : labels) {
    planar.emplace_back(options.layers * frame.size());
    for (size_t i = 0; i < planar.back().size(); ++i)
      planar.back()[i] = frame[i % frame.size()].ranks[i / frame.size()];
  }
  EXPECT_NEAR(block.energy() / weights.units / energyOf(problem, options, planar), 1, 2e-3);
}

TEST(Flow, FindsTheMinimumOfRandomGraphs) {
  std::mt19937 random(7);
  LabelFlow flow;
  for (int round = 0; round < 3000; ++round) {
    const int n = 2 + static_cast<int>(random() % 9);
    struct Pair {
      int i, j, c_ij, c_ji;
    };
    std::vector<int> unary;
    std::vector<Pair> pairs;
    flow.reset(n);
    for (int i = 0; i < n; ++i) {
      unary.push_back(static_cast<int>(random() % 11) - 5);
      flow.addUnary(i, unary.back());
    }
    for (unsigned k = random() % (3 * n); k > 0; --k) {
      const int i = static_cast<int>(random() % n), j = static_cast<int>(random() % n);
      if (i == j) continue;
      pairs.push_back({i, j, static_cast<int>(random() % 5), static_cast<int>(random() % 5)});
      flow.addPair(i, j, pairs.back().c_ij, pairs.back().c_ji);
    }
    const auto cost = [&](unsigned ones) {
      int sum = 0;
      for (int i = 0; i < n; ++i) sum += ones >> i & 1 ? unary[i] : 0;
      for (const Pair& p : pairs) {
        if (!(ones >> p.i & 1) && (ones >> p.j & 1)) sum += p.c_ij;
        if ((ones >> p.i & 1) && !(ones >> p.j & 1)) sum += p.c_ji;
      }
      return sum;
    };
    unsigned best = 0, found = 0;
    for (unsigned s = 1; s < 1u << n; ++s)
      if (cost(s) < cost(best) || (cost(s) == cost(best) && std::popcount(s) < std::popcount(best))) best = s;
    flow.solve();
    for (int i = 0; i < n; ++i) found |= unsigned(flow.one(i)) << i;
    ASSERT_EQ(cost(found), cost(best)) << "round " << round;
    ASSERT_EQ(found, best) << "round " << round;  // the minimum with the fewest ones
  }
}

TEST(Joint, LossOfFeasibilityForcesAChangeAndOnlyThat) {
  Problem problem{chainOf(6), {}};
  FaceCosts costs{2, std::vector<uint32_t>(6, 3), {}, {}};
  for (int f = 0; f < 6; ++f) costs.penalty.insert(costs.penalty.end(), {0.2f, 0.3f});
  for (int t = 0; t < 20; ++t) problem.frames.push_back(costs);
  for (int t = 10; t < 20; ++t)
    for (uint32_t& mask : problem.frames[t].feasible) mask = 2;  // camera 0 becomes infeasible
  const Labels labels = solve(problem, withRule(kJoint, 1)).labels;
  for (int t = 0; t < 20; ++t)
    for (int f = 0; f < 6; ++f) EXPECT_EQ(labels[t][f], t < 10 ? 0 : 1) << t;
}

// In one frame the other camera is slightly better, which does not justify two flips of every face.
TEST(Joint, IgnoresAShortAdvantageThatSpatialFollows) {
  Problem problem{chainOf(6), {}};
  for (int t = 0; t < 9; ++t) {
    FaceCosts costs{2, std::vector<uint32_t>(6, 3), {}, {}};
    for (int f = 0; f < 6; ++f) costs.penalty.insert(costs.penalty.end(), {0.2f, t == 4 ? 0.15f : 0.3f});
    problem.frames.push_back(costs);
  }
  EXPECT_EQ(solve(problem, withRule(kJoint, 1)).statistics.flip_percent[0], 0);
  EXPECT_NEAR(solve(problem, withRule(kSpatial, 1)).statistics.flip_percent[0], 25, 1e-9);  // 2 of 8 steps
}

// Faces seen, unseen, seen: the label continues across the middle, whose penalty is not counted.
TEST(Joint, LabelGoesOnAcrossAFaceThatNoCameraSees) {
  Problem problem{chainOf(3), {}};
  for (int t = 0; t < 2; ++t)
    problem.frames.push_back({2, {0b10, 0, 0b10}, {0, 0, 0}, {0, 1, 0}, {1, 0.25f, 1, 1, 1, 0.25f}});
  const Solution joint = solve(problem, withRule(kJoint, 1));
  EXPECT_EQ(joint.labels[0], (std::vector<uint8_t>{1, 1, 1}));
  EXPECT_EQ(joint.statistics.seam_percent[0], 0);
  EXPECT_NEAR(joint.statistics.mean_penalty[0], 0.25, 1e-6);
  const Solution spatial = solve(problem, withRule(kSpatial, 1));
  EXPECT_EQ(spatial.labels[0], (std::vector<uint8_t>{1, package::kNoCamera, 1}));
}

// Options that the study switches off to measure the effect of each.
TEST(Joint, WithoutItsLibertiesItTakesFullyVisibleCamerasOnly) {
  // Seen, unseen, seen by camera 1; camera 0 sees face 2 in part and is cheaper in total, with its neighbours.
  Problem problem{chainOf(4), {}};
  problem.frames.push_back(
      {2, {0b01, 0, 0b10, 0b01}, {0, 0, 0b01, 0}, {0, 1, 0, 0}, {0.2f, 1, 1.9f, 1.9f, 0.25f, 0.2f, 0.2f, 1}});
  LabelOptions options = withRule(kJoint, 1);
  EXPECT_EQ(solve(problem, options).labels[0], (std::vector<uint8_t>{0, 0, 0, 0}));
  options.use_partial = false;
  EXPECT_EQ(solve(problem, options).labels[0][2], 1);
  EXPECT_NE(solve(problem, options).labels[0][1], package::kNoCamera);
  options.label_unseen = false;
  EXPECT_EQ(solve(problem, options).labels[0], (std::vector<uint8_t>{0, package::kNoCamera, 1, 0}));
  options.use_partial = true;
  EXPECT_EQ(solve(problem, options).labels[0], (std::vector<uint8_t>{0, package::kNoCamera, 0, 0}));
}

// 4DVT Eq. 5 as printed: the weight of a flip is 1 / |M|, which holds on a mesh of two faces and vanishes on a hundred.
TEST(TemporalPaper, FlipsCostLessTheMoreFacesTheMeshHas) {
  const auto flips = [](const Labelling& rule, uint32_t faces) {
    Problem problem{chainOf(faces), {}};
    for (int t = 0; t < 9; ++t) {
      FaceCosts costs{2, std::vector<uint32_t>(faces, 3), {}, {}};
      for (uint32_t f = 0; f < faces; ++f) costs.penalty.insert(costs.penalty.end(), {0.2f, t == 4 ? 0.15f : 0.3f});
      problem.frames.push_back(costs);
    }
    return solve(problem, withRule(rule, 1)).statistics.flip_percent[0];
  };
  EXPECT_EQ(flips(kTemporalPaper, 2), 0);
  EXPECT_NEAR(flips(kTemporalPaper, 100), 25, 1e-9);
  for (uint32_t faces : {2, 100}) {
    EXPECT_NEAR(flips(kNaive, faces), 25, 1e-9);
    EXPECT_NEAR(flips(kSpatial, faces), 25, 1e-9);
    EXPECT_EQ(flips(kJoint, faces), 0);
  }
}

// Compares the rules' statistics on one random problem.
TEST(Labellings, StandInTheOrderOfWhatTheyAskFor) {
  const Problem problem = randomProblem(11, sheetOf(12, 10), 24, 5);
  const auto of = [&](const Labelling& rule) { return solve(problem, withRule(rule)).statistics; };
  const LabelStatistics naive = of(kNaive), spatial = of(kSpatial), temporal = of(kTemporalPaper), joint = of(kJoint);
  EXPECT_LT(naive.mean_penalty[0], spatial.mean_penalty[0]);
  EXPECT_LT(spatial.seam_percent[0], 0.9 * naive.seam_percent[0]);
  EXPECT_LE(temporal.flip_percent[0], spatial.flip_percent[0]);
  EXPECT_LT(joint.flip_percent[0], 0.8 * temporal.flip_percent[0]);
  EXPECT_LT(joint.energy, temporal.energy);
  EXPECT_EQ(solve(problem, withRule(kPerTexel)).labels, solve(problem, withRule(kNaive)).labels);
}

TEST(Joint, WindowThatCoversEverythingIsTheGlobalSolve) {
  const Problem problem = randomProblem(5, sheetOf(10, 8), 12, 5);
  LabelOptions options = withRule(kJoint);
  const Solution windowed = solve(problem, options);
  options.window_frames = options.hop_frames = 40;
  EXPECT_EQ(solve(problem, options).labels, windowed.labels);
}

TEST(Joint, WindowsAreCloseToTheGlobalSolve) {
  const Problem problem = randomProblem(6, sheetOf(10, 8), 50, 5);
  LabelOptions options = withRule(kJoint);
  const double windowed = solve(problem, options).statistics.energy;
  options.window_frames = options.hop_frames = 50;
  EXPECT_NEAR(windowed / solve(problem, options).statistics.energy, 1, 0.01);
}

TEST(Windows, CoverEveryFrameOnceAndKeepOddOnesApart) {
  for (uint32_t frames : {1u, 12u, 13u, 19u, 28u, 40u, 300u}) {
    const auto windows = planWindows(withRule(kJoint), frames);
    uint32_t next = 0;
    for (size_t i = 0; i < windows.size(); ++i) {
      const LabelWindow& w = windows[i];
      EXPECT_EQ(w.fresh_first, next);
      EXPECT_LT(w.fresh_first, w.fresh_end);
      EXPECT_LE(w.end - w.first, 12u);
      EXPECT_EQ(w.odd, i % 2 == 1);
      EXPECT_LE(w.frozen_end, frames);
      if (i >= 2 && w.odd) {
        EXPECT_GE(w.frozen_first, windows[i - 2].end);  // reads no frame that its neighbour writes
        EXPECT_GE(w.first, windows[i - 2].frozen_end);
      }
      next = w.fresh_end;
    }
    EXPECT_EQ(next, frames);
  }
}

TEST(Statistics, CountSeamsAndFlips) {
  LabelOptions options = withRule(kNaive, 1);
  const FaceGraph graph = chainOf(4);
  LabelMeter meter(options, graph);
  const FaceCosts costs{2, std::vector<uint32_t>(4, 3), {}, {}, {0.1f, 0.2f, 0.1f, 0.2f, 0.1f, 0.2f, 0.1f, 0.2f}};
  meter.add(costs, {0, 0, 1, package::kNoCamera});
  meter.add(costs, {0, 1, 1, 0});
  const LabelStatistics s = meter.statistics();
  EXPECT_NEAR(s.seam_percent[0], 100 * 4.0 / 6, 1e-9);
  EXPECT_NEAR(s.camera_seam_percent[0], 100 * 3.0 / 6, 1e-9);
  EXPECT_NEAR(s.flip_percent[0], 100 * 2.0 / 4, 1e-9);
  EXPECT_NEAR(s.camera_flip_percent[0], 100 * 1.0 / 4, 1e-9);
  EXPECT_NEAR(s.mean_penalty[0], (0.1 * 4 + 0.2 * 3) / 7, 1e-6);
  EXPECT_NEAR(s.empty_percent, 100 / 8.0, 1e-9);
}

// Face 3 is unseen in the first frame, face 2 in the second.
TEST(Statistics, CountOnFacesThatACameraSees) {
  const FaceGraph graph = chainOf(4);
  LabelMeter meter(withRule(kNaive, 1), graph);
  FaceCosts costs{2, std::vector<uint32_t>(4, 3), {}, {0, 0, 0, 1}, std::vector<float>(8, 0.5f)};
  meter.add(costs, {0, 0, 1, 0});  // seams 1|2 and 2|3, the second beside an unseen face
  costs.unseen = {0, 0, 1, 0};
  meter.add(costs, {1, 1, 0, 0});  // seam 1|2 beside an unseen face; flips 0, 1, and 2, seen in one frame only
  const LabelStatistics s = meter.statistics();
  EXPECT_NEAR(s.seam_percent[0], 100 * 3.0 / 6, 1e-9);
  EXPECT_NEAR(s.seen_seam_percent[0], 100 * 1.0 / 3, 1e-9);  // edges 0-1, 1-2; 0-1
  EXPECT_NEAR(s.flip_percent[0], 100 * 3.0 / 4, 1e-9);
  EXPECT_NEAR(s.seen_flip_percent[0], 100 * 2.0 / 2, 1e-9);  // faces 0 and 1
}

// Keeps windows of labels in memory.
struct Shelf {
  std::map<std::pair<uint32_t, uint32_t>, std::vector<uint8_t>> windows;
  std::mutex mutex;
  Status answer;
  LabelKeeper keeper() {
    return {[this](uint32_t first, uint32_t end) {
              std::lock_guard lock(mutex);
              const auto found = windows.find({first, end});
              return found == windows.end() ? std::vector<uint8_t>() : found->second;
            },
            [this](uint32_t first, uint32_t end, const std::vector<uint8_t>& bytes) -> Status {
              std::lock_guard lock(mutex);
              windows[{first, end}] = bytes;
              return answer;
            }};
  }
};

TEST(SolveLabels, GoesOnWithTheWindowsThatWereKept) {
  const Problem problem = randomProblem(11, sheetOf(5, 4), 40, 4);
  LabelOptions options;
  options.window_frames = 8;
  options.hop_frames = 6;
  options.jobs = 2;
  const Solution expected = solve(problem, options);
  Shelf shelf;
  const LabelKeeper keeper = shelf.keeper();
  EXPECT_EQ(solve(problem, options, &keeper).labels, expected.labels);
  const auto windows = planWindows(options, 40);
  ASSERT_EQ(shelf.windows.size(), windows.size());
  const auto all = shelf.windows;

  // Does not solve again, although other costs would give other labels.
  Problem other = problem;
  for (FaceCosts& costs : other.frames)
    for (float& penalty : costs.penalty) penalty = 1 - penalty;
  EXPECT_NE(solve(other, options).labels, expected.labels);
  EXPECT_EQ(solve(other, options, &keeper).labels, expected.labels);

  // Solves missing windows, after an interruption or with a truncated file.
  for (const bool odd : {false, true}) {
    shelf.windows = all;
    for (const LabelWindow& window : windows)
      if (window.odd == odd) shelf.windows.erase({window.first, window.end});
    shelf.windows.begin()->second.pop_back();
    EXPECT_EQ(solve(problem, options, &keeper).labels, expected.labels);
    EXPECT_EQ(shelf.windows, all);
  }

  // Solves windows one by one, in any order.
  shelf.windows.clear();
  const LabelSink ignore = [](uint32_t, const std::vector<uint8_t>&) -> Status { return {}; };
  const FaceCostSource costs = [&](uint32_t t) -> Result<FaceCosts> { return FaceCosts(problem.frames[t]); };
  for (size_t w = windows.size(); w-- > 0;)
    ASSERT_TRUE(solveLabelWindows(options, problem.graph, 40, {w}, {costs, ignore, {}, nullptr, &keeper}).ok());
  EXPECT_EQ(shelf.windows, all);

  shelf.windows.clear();
  shelf.answer = Error{ErrorId::WriteFailed, "x"};
  EXPECT_EQ(solveLabelWindows(options, problem.graph, 40, {1}, {costs, ignore, {}, nullptr, &keeper}).error().id,
            ErrorId::WriteFailed);
  EXPECT_EQ(solveLabels(options, problem.graph, 40, {costs, ignore, {}, nullptr, &keeper}).error().id,
            ErrorId::WriteFailed);
}

TEST(SolveLabels, PassesErrorsOnAndStops) {
  const Problem problem = randomProblem(8, chainOf(4), 3, 2);
  const FaceCostSource good = [&](uint32_t t) -> Result<FaceCosts> { return FaceCosts(problem.frames[t]); };
  const FaceCostSource bad = [](uint32_t) -> Result<FaceCosts> { return Error{ErrorId::FileUnreadable, "x"}; };
  const LabelSink ignore = [](uint32_t, const std::vector<uint8_t>&) -> Status { return {}; };
  const LabelSink full = [](uint32_t, const std::vector<uint8_t>&) -> Status {
    return Error{ErrorId::WriteFailed, "x"};
  };
  LabelOptions options;
  options.jobs = 2;
  EXPECT_EQ(solveLabels(options, problem.graph, 3, {bad, ignore}).error().id, ErrorId::FileUnreadable);
  EXPECT_EQ(solveLabels(options, problem.graph, 3, {good, full}).error().id, ErrorId::WriteFailed);
  std::atomic<bool> stop = true;
  EXPECT_EQ(solveLabels(options, problem.graph, 3, {good, ignore, {}, &stop}).error().id, ErrorId::Interrupted);
  options.tau = -1;
  EXPECT_EQ(solveLabels(options, problem.graph, 3, {good, ignore}).error().id, ErrorId::InvalidArgument);
}

}  // namespace
}  // namespace fourdvt::bake
