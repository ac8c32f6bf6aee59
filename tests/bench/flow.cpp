// SPDX-License-Identifier: Apache-2.0
// bench_flow CHARACTER [REPEATS]: flow between two appearances on one mesh and view (the first two members of the first
// class, or the first two sequences on the first one's mesh) at four phases: end-point difference between the GPU's
// flow and OpenCV's, the residual of the second picture for each, inside the character; milliseconds of each, medians,
// with ratios to the GPU's Farneback.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "base/camera.h"
#include "edge/opencv_flow.h"
#include "or_stop.h"
#include "package/base_mesh.h"
#include "package/chunk_mesh.h"
#include "package/stream_file.h"
#include "platform/egl_context.h"
#include "platform/ffmpeg_video.h"
#include "platform/files.h"
#include "render/plain_figure.h"

namespace {

using namespace fourdvt;
using fourdvt::testing::orStop;

// Stream of a sequence, with one decoded picture at a time.
class Source {
 public:
  Source(gpu::Device& device, const std::filesystem::path& folder, const package::Sequence& sequence)
      : device_(device), rendition_(sequence.renditions.back()), video_((folder / rendition_.video_uri).string()) {
    stream_ = (folder / sequence.stream_uri).string();
    index_ =
        orStop(package::readStreamHeader(orStop(platform::readFileRange(stream_, 0, sequence.stream_header_bytes))));
    picture_ =
        orStop(render::createPicture(device, rendition_.width, rendition_.height, render::PictureTextures::Kind::I420));
  }

  uint32_t frameAt(double phase) const { return static_cast<uint32_t>(phase * index_.frame_count); }

  Positions positions(const package::ChunkMesh& mesh, uint32_t frame, uint32_t member) const {
    const uint32_t chunk = index_.chunkOfFrame(frame);
    const size_t first =
        ((frame - index_.chunks[chunk].first_frame) * index_.member_count + member) * index_.vertex_count;
    const package::ChunkFrames frames = decode(mesh, chunk);
    Positions out;
    for (size_t v = 0; v < index_.vertex_count; ++v)
      out.push_back(index_.position_origin + index_.position_step_m * glm::vec3(frames.positions[first + v]));
    return out;
  }

  // Shows labels, layout and picture of a member at a frame, for drawing on the figure's mesh.
  const render::PictureTextures& show(render::PlainFigure& figure, const package::ChunkMesh& mesh,
                                      const Positions& positions, uint32_t frame, uint32_t member) {
    const uint32_t chunk = index_.chunkOfFrame(frame);
    const size_t size = size_t(index_.layer_count) * index_.face_count;
    const package::ChunkFrames frames = decode(mesh, chunk);
    const size_t first = ((frame - index_.chunks[chunk].first_frame) * index_.member_count + member) * size;
    figure.setFrame(device_, positions, std::span<const uint8_t>(frames.labels).subspan(first, size));
    package::Rendition alone = rendition_;
    const auto layers = rendition_.layers.begin() + member * index_.layer_count;
    alone.layers.assign(layers, layers + index_.layer_count);
    figure.setLayout(alone);
    decodePicture(frame);
    return picture_;
  }

 private:
  package::ChunkFrames decode(const package::ChunkMesh& mesh, uint32_t chunk) const {
    const package::ChunkEntry& entry = index_.chunks[chunk];
    return orStop(
        package::decodeChunk(orStop(platform::readFileRange(stream_, entry.offset, entry.bytes)), index_, chunk, mesh));
  }
  void decodePicture(uint32_t frame) {
    const package::SampleTable& table = index_.renditions.back();
    auto decoder = orStop(platform::SampleDecoder::create(rendition_.codec, table.decoder_description,
                                                          [&](const I420View& picture, int64_t number) {
                                                            if (number == frame)
                                                              render::uploadPicture(device_, picture_, picture);
                                                          }));
    for (const package::VideoSample& sample : table.samples)
      orStop(decoder->decode(orStop(platform::readFileRange(video_, sample.offset, sample.bytes)), sample.frame,
                             sample.key));
    orStop(decoder->flush());
  }

  gpu::Device& device_;
  const package::Rendition rendition_;
  const std::string video_;
  std::string stream_;
  package::StreamIndex index_;
  render::PictureTextures picture_;
};

struct Picture {
  Picture(gpu::Device& device, int width, int height) {
    texture = orStop(gpu::makeTexture(device, {.width = width, .height = height, .label = "picture"}));
    target = orStop(gpu::makeTarget(device, {.colors = {texture.id()}, .label = "picture"}));
  }
  gpu::Texture texture;
  gpu::Target target;
};

// Draws the two appearances of the character at a phase, a and b.
void drawPair(gpu::Device& device, const package::Character& character, const package::BaseMesh& base,
              std::vector<Source>& sources, double phase, const render::View& view, Picture* pair) {
  const package::ChunkMesh mesh = package::makeChunkMesh(base);
  const Positions positions = sources[0].positions(mesh, sources[0].frameAt(phase), 0);
  render::PlainFigure figure = orStop(render::PlainFigure::create(device, character, base));
  const auto recipe = orStop(render::Recipe::create(device));
  for (int i = 0; i < 2; ++i) {
    Source& source = sources.size() > 1 ? sources[i] : sources[0];
    const auto& picture =
        source.show(figure, mesh, positions, source.frameAt(phase), sources.size() > 1 ? 0 : static_cast<uint32_t>(i));
    orStop(figure.draw(*recipe, picture, view, {.ground_shadow = false}, pair[i].target.id()));
  }
}

struct Method {
  const char* name;
  std::unique_ptr<render::FlowSource> source;
  gpu::PixelFormat format;
  std::vector<double> times_ms;
  std::vector<glm::vec2> flow;
  std::vector<double> residuals;
};

void compute(gpu::Device& device, Method& method, const Picture* pair, int width, int height) {
  const auto start = std::chrono::steady_clock::now();
  orStop(method.source->compute(pair[0].texture.id(), pair[1].texture.id(), width, height));
  method.flow.resize(size_t(width) * height);
  const auto target = orStop(gpu::makeTarget(device, {.colors = {method.source->flow()}, .label = "flow"}));
  uint8_t waits_for_all[16];
  orStop(device.readPixels(target.id(), method.format, {.width = 1, .height = 1}, waits_for_all));
  method.times_ms.push_back(
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
  orStop(device.readPixels(target.id(), method.format, {.width = width, .height = height}, method.flow.data()));
}

double percentile(std::vector<double> values, double share) {
  const auto at = values.begin() + static_cast<ptrdiff_t>(share * (values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (double value : values) sum += value;
  return sum / values.size();
}

// Appends, over the pixels inside: differences between two methods, and the length of the second one's flow.
void compare(const Method& ours, const Method& theirs, const std::vector<uint8_t>& rgba,
             std::vector<double>& difference, std::vector<double>& length) {
  for (size_t i = 0; i < ours.flow.size(); ++i) {
    if (rgba[4 * i + 3] < 250) continue;
    difference.push_back(glm::length(ours.flow[i] - theirs.flow[i]));
    length.push_back(glm::length(theirs.flow[i]));
  }
}

// Mean difference, grey levels, between a's luma and b's at the flow's end, inside. All pictures top row first.
double residual(const std::vector<uint8_t>* rgba, const std::vector<glm::vec2>& flow, int width, int height) {
  const auto luma = [&](int x, int y) {
    const uint8_t* p = &rgba[1][4 * (size_t(glm::clamp(y, 0, height - 1)) * width + glm::clamp(x, 0, width - 1))];
    return 0.299 * p[0] + 0.587 * p[1] + 0.114 * p[2];
  };
  double sum = 0, count = 0;
  for (int i = 0; i < width * height; ++i) {
    const uint8_t* a = &rgba[0][4 * size_t(i)];
    if (a[3] < 250) continue;
    const double x = i % width + flow[i].x, y = i / width - flow[i].y;
    const int x0 = int(std::floor(x)), y0 = int(std::floor(y));
    const double b = glm::mix(glm::mix(luma(x0, y0), luma(x0 + 1, y0), x - x0),
                              glm::mix(luma(x0, y0 + 1), luma(x0 + 1, y0 + 1), x - x0), y - y0);
    sum += std::abs(0.299 * a[0] + 0.587 * a[1] + 0.114 * a[2] - b);
    count += 1;
  }
  return sum / count;
}

void measure(gpu::Device& device, const package::Character& character, const package::BaseMesh& base,
             std::vector<Source>& sources, int width, int height, int repeats) {
  using render::FlowMethod;
  render::FlowOptions dis;
  dis.method = FlowMethod::Dis;
  Method methods[] = {{"farneback gpu", orStop(render::createGpuFlow(device)), gpu::PixelFormat::RG16F, {}, {}, {}},
                      {"farneback opencv", edge::createOpencvFlow(device), gpu::PixelFormat::RG32F, {}, {}, {}},
                      {"dis gpu", orStop(render::createGpuFlow(device, dis)), gpu::PixelFormat::RG16F, {}, {}, {}},
                      {"dis opencv", edge::createOpencvFlow(device, dis), gpu::PixelFormat::RG32F, {}, {}, {}}};
  const render::View view =
      render::viewFromCamera(cameraFromOrbit(defaultOrbit(character.bounds, double(width) / height), width, height));
  Picture pair[] = {Picture(device, width, height), Picture(device, width, height)};
  std::vector<double> difference[2], length[2];
  std::vector<uint8_t> rgba[2];
  std::vector<double> still;
  for (double phase : {0.0, 0.25, 0.5, 0.75}) {
    drawPair(device, character, base, sources, phase, view, pair);
    for (int i = 0; i < 2; ++i) {
      rgba[i].resize(4 * size_t(width) * height);
      orStop(device.readPixels(pair[i].target.id(), gpu::PixelFormat::RGBA8, {.width = width, .height = height},
                               rgba[i].data()));
    }
    for (int i = 0; i < repeats; ++i)
      for (Method& method : methods) compute(device, method, pair, width, height);
    for (int i = 0; i < 2; ++i) compare(methods[2 * i], methods[2 * i + 1], rgba[0], difference[i], length[i]);
    for (Method& method : methods) method.residuals.push_back(residual(rgba, method.flow, width, height));
    still.push_back(residual(rgba, std::vector<glm::vec2>(methods[0].flow.size()), width, height));
  }
  std::printf("%s, %d x %d, four phases, %d repeats\n", device.caps().renderer.c_str(), width, height, repeats);
  for (int i = 0; i < 2; ++i)
    std::printf("%s from OpenCV's: mean %.4f px, 95%% %.4f px; OpenCV's flow: mean %.2f px\n", methods[2 * i].name,
                mean(difference[i]), percentile(difference[i], 0.95), mean(length[i]));
  const double unit = percentile(methods[0].times_ms, 0.5);
  for (const Method& method : methods)
    std::printf("%-16s %8.1f ms, ratio %.2f; luma off by %.2f of 255, without flow %.2f\n", method.name,
                percentile(method.times_ms, 0.5), percentile(method.times_ms, 0.5) / unit, mean(method.residuals),
                mean(still));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return std::fprintf(stderr, "usage: bench_flow CHARACTER [REPEATS]\n"), 2;
  const std::filesystem::path folder = argv[1];
  const int repeats = argc > 2 ? std::max(1, std::atoi(argv[2])) : 5;
  const auto context = orStop(platform::EglContext::create());
  const auto device = orStop(gpu::createGlesDevice());
  const package::Character character =
      orStop(package::readManifest(orStop(platform::readJsonFlat((folder / "character.gltf").string()))));
  const auto base = orStop(package::decodeBaseMesh(orStop(
      platform::readFileRange((folder / character.mesh_uri).string(), character.mesh_offset, character.mesh_bytes))));
  const auto& sequences = character.sequences;
  const auto blended = std::find_if(sequences.begin(), sequences.end(), [](const auto& s) { return s.isClass(); });
  std::vector<Source> sources;
  if (blended != sequences.end())
    sources.emplace_back(*device, folder, *blended);
  else
    for (size_t i = 0; i < std::min<size_t>(2, sequences.size()); ++i)
      sources.emplace_back(*device, folder, sequences[i]);
  if (blended == sequences.end() && sources.size() < 2)
    return std::fprintf(stderr, "bench_flow: the character has one motion; name one with a class or two sequences\n"),
           1;
  for (const glm::ivec2 size : {glm::ivec2(512, 512), glm::ivec2(720, 960)})
    measure(*device, character, base, sources, size.x, size.y, repeats);
  return 0;
}
