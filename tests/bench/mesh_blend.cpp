// SPDX-License-Identifier: Apache-2.0
// Measurements of a capture's motion classes: time-warp, foot skate, the errors of linear and hybrid blends against the
// full non-linear one, and the cost of each. Usage: bench_mesh_blend CAPTURE_FOLDER [MEMBER MEMBER]
// MEMBER: two sequences, as a harder pair; frames are paired by their share of the whole.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "bake/motion/hybrid_blend.h"
#include "bake/motion/root_track.h"
#include "bench/blend_cost.h"
#include "capture/capture.h"
#include "mattes/frame_reader.h"
#include "or_stop.h"
#include "platform/ffmpeg_video.h"

using namespace fourdvt;
using fourdvt::testing::orStop;

namespace {

constexpr int kChecks = 24, kMaxSegments = 9;

using Phases = std::vector<std::vector<Positions>>;  // [phase][member]

void printErrors(const char* name, const bake::NonlinearBlend& blend, const Phases& phases, bake::HybridMix mix) {
  bake::HybridErrors errors({{0, 1, 1}}, mix, kChecks, kMaxSegments);
  for (const auto& members : phases) errors.add(blend, members);
  std::printf("%s, %zu phases x %d weights, mm: references max rms\n", name, phases.size(), kChecks - 1);
  for (int segments = 1; segments <= kMaxSegments; ++segments) {
    const auto& error = errors.of(segments);
    std::printf("  %d %8.3f %8.3f\n", segments - 1, 1e3 * error.max_m,
                1e3 * std::sqrt(error.sum_squares / double(error.count)));
  }
}

void printCost(const bake::NonlinearBlend& blend, const Phases& phases, const std::vector<float>& weights) {
  constexpr int kReferences = 8, kSolves = 10;
  package::StreamIndex index;
  index.position_step_m = 1e-4f;
  package::ChunkFrames frames;
  frames.frame_count = 1;
  frames.vertex_count = uint32_t(phases[0][0].size());
  frames.member_count = 2;
  frames.reference_count = kReferences;
  for (const Positions& member : phases[0])
    for (const glm::vec3& p : member) frames.positions.emplace_back(p / index.position_step_m);
  frames.offsets.assign(size_t(kReferences) * frames.vertex_count, glm::ivec3(3, -2, 1));
  Positions out;
  double start = bench::now_ms();
  for (int i = 0; i < kSolves; ++i) out = blend.blend(phases[0], weights);
  const double solve_ms = (bench::now_ms() - start) / kSolves;
  for (int used : {kReferences, 1}) {
    motion::BlendWeights hybrid{weights, std::vector<float>(kReferences, 0)};
    std::fill_n(hybrid.offsets.begin(), used, 0.1f);
    const double blend_ms = bench::blendCost_ms(frames, 0, index, hybrid);
    std::printf("blendFrame, 2 members, %d references used: %.4f ms; non-linear solve %.1f ms: %.0f times\n", used,
                blend_ms, solve_ms, solve_ms / blend_ms);
  }
}

void printSkate(const capture::Capture& capture, const capture::CaptureSequence& sequence,
                const bake::ReadPositions& read) {
  std::string note;
  auto track = orStop(bake::rootTrack(capture, sequence, read, &note));
  std::vector<glm::vec3> declared;
  for (uint32_t t = 0; t <= sequence.frame_count; ++t) {
    const glm::dvec3 moved = sequence.root_velocity_mps * (t / capture.fps);
    declared.emplace_back(moved.x, moved.z, 0);
  }
  const double duration_s = sequence.frame_count / capture.fps;
  std::printf("%s: feet travel at %.4f m/s, declared %.4f%s%s\n", sequence.name.c_str(),
              glm::length(glm::vec2(track.back())) / duration_s, glm::length(sequence.root_velocity_mps),
              note.empty() ? "" : "; ", note.c_str());
  for (const auto& [name, used] : {std::pair("declared", &declared), std::pair("feet", &track)}) {
    const bake::FootSkate skate = orStop(bake::footSkate(capture, sequence, *used, read));
    std::printf("  skate, %s: %d vertex contacts, mean %.1f mm, 95th percentile %.1f mm, max %.1f mm\n", name,
                skate.contacts, 1e3 * skate.mean_m, 1e3 * skate.tail_m, 1e3 * skate.max_m);
  }
}

void benchClass(const capture::Capture& capture, const capture::CaptureClass& source, const bake::ReadPositions& read) {
  const double start = bench::now_ms();
  const bake::ClassPlan plan = orStop(
      bake::planClass(capture, source, {capture.topology, read}, bake::ClassOptions{}, [](double) { return true; }));
  std::printf(
      "class %s: %u phases at %.3f fps, planned in %.1f s; linear %.3f mm, hybrid %.3f mm with %zu references\n",
      source.name.c_str(), plan.frame_count, plan.fps, 1e-3 * (bench::now_ms() - start), 1e3 * plan.linear_error_m,
      1e3 * plan.hybrid_error_m, plan.reference_weights.size());
  for (size_t m = 0; m < plan.members.size(); ++m) {
    std::printf("  %s: %s %.4f, %.2f s; frames", plan.manifest[m].name.c_str(), source.parameters[0].c_str(),
                plan.manifest[m].parameter[0], plan.manifest[m].duration_s);
    for (double frame : plan.members[m].source_frame) std::printf(" %.2f", frame);
    std::printf("\n");
  }
  Phases phases;
  for (uint32_t p = 0; p < plan.frame_count; ++p) {
    phases.emplace_back();
    for (size_t m = 0; m < 2; ++m) phases.back().push_back(orStop(bake::memberPositions(plan.members[m], p, read)));
  }
  const auto blend = orStop(bake::NonlinearBlend::create(capture.topology, phases[0][0]));
  printErrors("hybrid, straight pieces", blend, phases, bake::HybridMix::Straight);
  printErrors("hybrid, polynomial", blend, phases, bake::HybridMix::Polynomial);
  printCost(blend, phases, {0.4f, 0.6f});
}

void benchPair(const capture::Capture& capture, const std::string& a, const std::string& b,
               const bake::ReadPositions& read) {
  const capture::CaptureSequence* pair[2] = {capture.find(a), capture.find(b)};
  if (!pair[0] || !pair[1]) {
    std::fprintf(stderr, "bench_mesh_blend: no such sequences\n");
    std::exit(1);
  }
  constexpr uint32_t kPairs = 14;
  Phases phases;
  for (uint32_t p = 0; p < kPairs; ++p) {
    phases.emplace_back();
    for (const auto* sequence : pair)
      phases.back().push_back(orStop(read(*sequence, p * sequence->frame_count / kPairs)));
  }
  const auto blend = orStop(bake::NonlinearBlend::create(capture.topology, phases[0][0]));
  printErrors((a + " against " + b + ", straight pieces").c_str(), blend, phases, bake::HybridMix::Straight);
  printErrors((a + " against " + b + ", polynomial").c_str(), blend, phases, bake::HybridMix::Polynomial);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2 && argc != 4) {
    std::fprintf(stderr, "usage: bench_mesh_blend CAPTURE_FOLDER [MEMBER MEMBER]\n");
    return 2;
  }
  const capture::Capture capture = orStop(mattes::openCapture(argv[1], platform::openVideoFile));
  const bake::ReadPositions read = [&](const capture::CaptureSequence& sequence, uint32_t frame) {
    return capture::readMeshFrame(capture, sequence, frame);
  };
  if (argc == 4) {
    benchPair(capture, argv[2], argv[3], read);
    return 0;
  }
  for (const auto& sequence : capture.sequences) printSkate(capture, sequence, read);
  for (const auto& source : capture.classes) benchClass(capture, source, read);
}
