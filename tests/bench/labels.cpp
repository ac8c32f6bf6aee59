// SPDX-License-Identifier: Apache-2.0
// bench_labels CAPTURE SEQUENCE [--dump FILE] [--joint WEIGHTS]: every labelling on a captured sequence: seams, flips
// and penalties per layer, energy, milliseconds per frame with one and two jobs, and the energy of the windowed solve
// and of one solve of the whole sequence. --dump FILE: the joint labels as raw bytes [frame][layer][face], faces in the
// character's order.
// --joint: prints joint against spatial only, once per list of weights θ1,θ2,θ3,ω1,ω2,ω3,η,τ (lists separated by ':').
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "bake/labels/face_costs.h"
#include "bake/labels/labelling.h"
#include "bake/texels/frame_baker.h"
#include "bake/texels/gpu_capture.h"
#include "capture/capture.h"
#include "lab/labels/paper_labellings.h"
#include "mattes/frame_reader.h"
#include "or_stop.h"
#include "package/base_mesh.h"
#include "platform/egl_context.h"
#include "platform/ffmpeg_video.h"

namespace {

using namespace fourdvt;
using bake::Labelling;
using fourdvt::testing::orStop;

constexpr size_t kHysteresisFrames = 2;  // to each side, as in the bake's survey

struct Measured {
  bake::FaceGraph graph;
  std::vector<bake::FaceCosts> frames;
};

Positions inDecodedOrder(const package::EncodedBaseMesh& mesh, const Positions& source) {
  Positions out;
  for (uint32_t v : mesh.source_vertex) out.push_back(source[v]);
  return out;
}

std::vector<bake::FaceCosts> steadyCosts(const std::vector<PinholeCamera>& cameras, const MeshTopology& topology,
                                         const std::vector<Positions>& positions,
                                         const std::vector<std::vector<float>>& fractions) {
  const bake::FaceCostOptions options;
  std::vector<bake::FaceCosts> out;
  for (size_t f = 0; f < fractions.size(); ++f) {
    const size_t first = f - std::min(f, kHysteresisFrames),
                 end = std::min(f + kHysteresisFrames + 1, fractions.size());
    const auto steady = bake::steadyFractions(std::span(fractions).subspan(first, end - first), f - first, options);
    out.push_back(bake::measureFaceCosts(options, cameras, topology, positions[f], steady));
  }
  return out;
}

Measured measure(const std::string& folder, const std::string& sequence_name) {
  const OpenVideo open_video = [](const std::string& path, int channels) {
    return platform::openVideoFile(path, channels);
  };
  const auto context = orStop(platform::EglContext::create());
  const auto device = orStop(gpu::createGlesDevice());
  const capture::Capture capture = orStop(mattes::openCapture(folder, open_video));
  const capture::CaptureSequence* sequence = capture.find(sequence_name);
  if (!sequence) orStop(Result<int>(Error{ErrorId::InvalidArgument, folder + " has no sequence " + sequence_name}));
  const auto mesh = orStop(
      package::encodeBaseMesh(capture.topology, orStop(capture::readMeshFrame(capture, capture.sequences.at(0), 0))));
  const MeshTopology& topology = mesh.decoded.topology;
  std::vector<PinholeCamera> cameras;
  for (const capture::CaptureCamera& camera : capture.cameras) cameras.push_back(camera.pinhole);
  auto gpu_capture = orStop(bake::GpuCapture::create(*device, cameras, topology, false));
  auto visibility = orStop(bake::Visibility::create(*device, gpu_capture));
  const auto reader = orStop(mattes::FrameReader::open(capture, *sequence, open_video));
  std::vector<Positions> positions;
  std::vector<std::vector<float>> fractions;
  for (uint32_t f = 0; f < sequence->frame_count; ++f) {
    const mattes::CaptureFrame frame = orStop(reader->next());
    positions.push_back(inDecodedOrder(mesh, frame.positions));
    std::vector<bake::PictureCrop> crops;
    for (size_t c = 0; c < cameras.size(); ++c)
      crops.push_back(bake::cropPicture(cameras[c], positions.back(), frame.pictures[c]));
    gpu_capture.setFrame(*device, positions.back(), crops);
    fractions.push_back(orStop(visibility.measure(*device, gpu_capture)));
    std::fprintf(stderr, "\rvisibility %u/%u", f + 1, sequence->frame_count);
  }
  std::fprintf(stderr, "\n");
  return {bake::makeFaceGraph(topology), steadyCosts(cameras, topology, positions, fractions)};
}

struct Solved {
  bake::LabelStatistics statistics;
  std::vector<uint8_t> labels;  // [frame][layer][face]
};

Solved solve(const Measured& input, const bake::LabelOptions& options) {
  Solved out;
  const auto costs = [&](uint32_t f) -> Result<bake::FaceCosts> { return bake::FaceCosts(input.frames[f]); };
  const auto sink = [&](uint32_t, const std::vector<uint8_t>& labels) -> Status {
    out.labels.insert(out.labels.end(), labels.begin(), labels.end());
    return {};
  };
  out.statistics =
      orStop(bake::solveLabels(options, input.graph, static_cast<uint32_t>(input.frames.size()), {costs, sink}));
  return out;
}

std::string list(const std::vector<double>& values, const char* format) {
  std::string out;
  char text[32];
  for (double v : values) {
    std::snprintf(text, sizeof text, format, v);
    if (!out.empty()) out += '/';
    out += text;
  }
  return out;
}

double msPerFrame(const bake::LabelStatistics& s) { return 1000 * s.seconds / s.frames; }

// Prints layer 1 of joint against spatial. "all" includes borders of unseen regions, which no labelling can avoid.
void printComparison(const char* what, const std::vector<double>& flips, const std::vector<double>& spatial_flips,
                     const std::vector<double>& seams, const std::vector<double>& spatial_seams) {
  std::printf(
      "layer 1, %s: flips %.2f %% against %.2f %% (%.1f %% fewer), seams %.2f %% against %.2f %% (%.1f %% fewer)\n",
      what, flips[0], spatial_flips[0], 100 * (1 - flips[0] / spatial_flips[0]), seams[0], spatial_seams[0],
      100 * (1 - seams[0] / spatial_seams[0]));
}

void writeDump(const char* path, const std::vector<uint8_t>& bytes) {
  std::FILE* file = std::fopen(path, "wb");
  const bool written = file && std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
  if (!file || std::fclose(file) != 0 || !written)
    orStop(Result<int>(Error{ErrorId::WriteFailed, std::string(path) + ": cannot be written"}));
}

bake::LabelOptions jointOptions(const char* list) {
  bake::LabelOptions o;
  std::vector<float> w(8);
  if (std::sscanf(list, "%f,%f,%f,%f,%f,%f,%f,%f", &w[0], &w[1], &w[2], &w[3], &w[4], &w[5], &w[6], &w[7]) != 8)
    orStop(Result<int>(Error{ErrorId::InvalidArgument, "--joint takes eight numbers, not " + std::string(list)}));
  o.theta.assign(w.begin(), w.begin() + 3);
  o.omega.assign(w.begin() + 3, w.begin() + 6);
  o.eta = w[6];
  o.tau = w[7];
  return o;
}

void compareWeights(const Measured& input, const char* lists) {
  bake::LabelOptions options;
  options.rule = &lab::kNaive;
  const bake::LabelStatistics naive = solve(input, options).statistics;
  options.rule = &lab::kSpatial;
  const bake::LabelStatistics spatial = solve(input, options).statistics;
  for (const char* at = lists; at; at = std::strchr(at, ':')) {
    if (*at == ':') ++at;
    const bake::LabelStatistics s = solve(input, jointOptions(at)).statistics;
    std::printf(
        "%.*s\n  flips %s seams %s\n  flips %.2f %% (%.1f %% fewer) seams %.2f %% (%.1f %% fewer) penalty %+.1f %% "
        "%.1f ms\n",
        static_cast<int>(std::strcspn(at, ":")), at, list(s.flip_percent, "%.2f").c_str(),
        list(s.seam_percent, "%.2f").c_str(), s.flip_percent[0],
        100 * (1 - s.flip_percent[0] / spatial.flip_percent[0]), s.seam_percent[0],
        100 * (1 - s.seam_percent[0] / spatial.seam_percent[0]), 100 * (s.mean_penalty[0] / naive.mean_penalty[0] - 1),
        msPerFrame(s));
  }
}

}  // namespace

int main(int argc, char** argv) {
  const char *dump = nullptr, *weights = nullptr;
  bool usage = argc < 3 || argc % 2 == 0;
  for (int i = 3; !usage && i < argc; i += 2) {
    if (!std::strcmp(argv[i], "--dump"))
      dump = argv[i + 1];
    else if (!std::strcmp(argv[i], "--joint"))
      weights = argv[i + 1];
    else
      usage = true;
  }
  if (usage) return std::fprintf(stderr, "usage: bench_labels CAPTURE SEQUENCE [--dump FILE] [--joint WEIGHTS]\n"), 2;
  const Measured input = measure(argv[1], argv[2]);
  if (weights) return compareWeights(input, weights), 0;
  std::printf("%s: %zu frames, %u faces, %zu edges\n", argv[2], input.frames.size(), input.graph.face_count,
              input.graph.edges.size());
  std::printf("%-16s %-18s %-18s %-18s %10s %8s %8s\n", "labels", "seam %", "flip %", "penalty", "energy", "ms j1",
              "ms j2");
  bake::LabelStatistics naive, spatial, joint;
  for (const Labelling* rule : {&lab::kNaive, &lab::kSpatial, &lab::kTemporalPaper, &bake::kJoint}) {
    bake::LabelOptions options;
    options.rule = rule;
    const Solved one = solve(input, options);
    options.jobs = 2;
    const Solved two = solve(input, options);
    const bake::LabelStatistics& s = one.statistics;
    std::printf("%-16s %-18s %-18s %-18s %10.0f %8.1f %8.1f%s\n", rule->name, list(s.seam_percent, "%.2f").c_str(),
                list(s.flip_percent, "%.2f").c_str(), list(s.mean_penalty, "%.3f").c_str(), s.energy, msPerFrame(s),
                msPerFrame(two.statistics), one.labels == two.labels ? "" : "  LABELS DEPEND ON THE JOB COUNT");
    if (rule == &lab::kNaive) naive = s;
    if (rule == &lab::kSpatial) spatial = s;
    if (rule == &bake::kJoint) joint = s;
    if (rule == &bake::kJoint && dump) writeDump(dump, one.labels);
  }
  printComparison("all", joint.flip_percent, spatial.flip_percent, joint.seam_percent, spatial.seam_percent);
  printComparison("between cameras", joint.camera_flip_percent, spatial.camera_flip_percent, joint.camera_seam_percent,
                  spatial.camera_seam_percent);
  std::printf("layer-1 penalty %+.1f %% of naive's; empty ranks %.2f %%, naive %.2f %%\n",
              100 * (joint.mean_penalty[0] / naive.mean_penalty[0] - 1), joint.empty_percent, naive.empty_percent);
  bake::LabelOptions whole;
  whole.window_frames = whole.hop_frames = static_cast<int>(input.frames.size());
  whole.sweeps = 20;
  const bake::LabelStatistics global = solve(input, whole).statistics;
  std::printf("windowed / whole energy: %.5f (whole: %.0f, %.1f ms a frame)\n", joint.energy / global.energy,
              global.energy, msPerFrame(global));
  return 0;
}
