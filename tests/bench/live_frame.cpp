// SPDX-License-Identifier: Apache-2.0
// Cost of a frame of a live stream, step by step, on one core: six cameras of the sample, reduced to 320 x 240 and to
// 640 x 480 texels, at several tolerances of the outlines. Goal: the sum is below a frame's time at 25 and 12 frames a
// second. Then runs the pipeline itself at that rate, with a second thread that makes the cameras' outlines.
//   build/release/tests/bench/bench_live_frame site/sample/actor_a
#include <algorithm>
#include <cstdio>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <thread>

#include "bench/blend_cost.h"
#include "capture/capture.h"
#include "encode/surfaces.h"
#include "live/server/live_encoder.h"
#include "live/server/live_hull.h"
#include "live/server/pipeline.h"
#include "live/server/tile_painter.h"
#include "mattes/frame_reader.h"
#include "or_stop.h"
#include "platform/ffmpeg_video.h"

using namespace fourdvt;
using namespace fourdvt::live;
using fourdvt::testing::orStop;

namespace {

constexpr uint32_t kFrames = 24;
const BoundingBox kBounds{glm::vec3(-1.2f, -0.05f, -1.2f), glm::vec3(1.2f, 2.1f, 1.2f)};

struct Seen {  // a camera's picture of one frame
  Image coverage;
  std::vector<uint8_t> jpeg;
  std::vector<Ring16> rings;
  package::Rect crop;
};

struct Setup {
  std::vector<PinholeCamera> cameras;
  std::vector<std::vector<Seen>> frames;  // [frame][camera]
};

// Camera whose landscape picture has the whole portrait picture in its middle, as if it stood on a tripod.
PinholeCamera boxedCamera(PinholeCamera camera, int width, int height) {
  const double scale = double(height) / camera.height;
  camera.fx *= scale, camera.fy *= scale, camera.cx *= scale, camera.cy *= scale;
  camera.cx += (width - camera.width * scale) / 2;
  camera.width = width, camera.height = height;
  return camera;
}

Seen seen(const Image& rgba, int width, int height) {
  const cv::Mat whole(rgba.height, rgba.width, CV_8UC4, const_cast<uint8_t*>(rgba.pixels.data()));
  const int inner = int(double(rgba.width) * height / rgba.height) & ~1;
  cv::Mat small, channels[4], bgr(height, width, CV_8UC3, cv::Scalar(110, 120, 130));
  cv::resize(whole, small, {inner, height}, 0, 0, cv::INTER_AREA);
  cv::Mat colour;
  cv::cvtColor(small, colour, cv::COLOR_RGBA2BGR);
  cv::split(small, channels);
  const cv::Rect place((width - inner) / 2, 0, inner, height);
  colour.copyTo(bgr(place));
  Seen out;
  out.coverage = Image(width, height, 1);
  cv::Mat coverage(height, width, CV_8U, out.coverage.pixels.data());
  channels[3].copyTo(coverage(place));
  cv::Mat performer = coverage > 127;
  const cv::Rect box = cv::boundingRect(performer);
  out.crop = padded({box.x, box.y, box.width, box.height}, 0.25, 16, {0, 0, width, height});
  cv::imencode(".jpg", bgr(cv::Rect(out.crop.x, out.crop.y, out.crop.width, out.crop.height)), out.jpeg,
               {cv::IMWRITE_JPEG_QUALITY, 85});
  return out;
}

Setup setUp(const std::string& folder, int width, int height) {
  const auto capture =
      orStop(mattes::openCapture(folder, platform::openVideoFile, {"walk"}, capture::MeshNeed::Nothing));
  Setup out;
  for (size_t c = 0; c < 6; ++c) out.cameras.push_back(boxedCamera(capture.cameras[c].pinhole, width, height));
  auto reader = orStop(mattes::FrameReader::open(capture, capture.sequences[0], platform::openVideoFile));
  for (uint32_t f = 0; f < kFrames; ++f) {
    const auto frame = orStop(reader->next());
    out.frames.emplace_back();
    for (size_t c = 0; c < 6; ++c) out.frames.back().push_back(seen(frame.pictures[c], width, height));
  }
  return out;
}

std::vector<Ring16> ringsOf(const Image& coverage, double tolerance_px) {
  std::vector<Ring16> out;
  for (const auto& ring : silhouette::outlineOf(coverage, {tolerance_px}).rings) {
    out.emplace_back();
    for (const glm::dvec2& p : ring)
      out.back().push_back({uint16_t(std::lround(p.x * 16)), uint16_t(std::lround(p.y * 16))});
  }
  return out;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

struct Costs {
  std::map<std::string, std::vector<double>> ms;
  std::vector<double> triangles, chunk_bytes, sample_bytes;
  template <class Work>
  auto time(const char* name, const Work& work) {
    const double start_ms = bench::now_ms();
    auto out = work();
    ms[name].push_back(bench::now_ms() - start_ms);
    return out;
  }
  double of(const char* name) { return median(ms[name]); }
};

void run(Setup& setup, double tolerance_px, const char* preset, bool header) {
  const PackedSize size = orStop(packedSize(setup.cameras, 0.5));
  auto encoder = orStop(LiveEncoder::create({size.width, size.height, 25, 23, preset}));
  const auto maker = orStop(HullMaker::create(setup.cameras, {kBounds}));
  auto decoder = orStop(JpegDecoder::create());
  TilePainter painter(size);
  LiveTiles tiles(setup.cameras, size);
  Costs costs;
  int keys = 0, failed = 0, planned = 0;
  for (uint32_t f = 0; f < kFrames; ++f) {
    auto& frame = setup.frames[f];
    std::vector<const std::vector<Ring16>*> rings;
    std::vector<package::Rect> crops, boxes;
    costs.time("outlines", [&] {
      for (Seen& seen : frame) seen.rings = ringsOf(seen.coverage, tolerance_px);
      return 0;
    });
    for (const Seen& seen : frame) rings.push_back(&seen.rings), crops.push_back(seen.crop);
    auto hull = costs.time("hull", [&] { return maker.make(rings); });
    if (!hull.ok() || hull.value().mesh.faces.empty()) {
      ++failed;
      continue;
    }
    const TriangleMesh& mesh = hull.value().mesh;
    costs.triangles.push_back(double(mesh.faces.size()));
    for (const auto& camera : setup.cameras) boxes.push_back(projectedBox(camera, mesh.positions));
    const bool leaves = tiles.wantsLayout(boxes, crops), key = planned % 12 == 0 || leaves;
    ++planned;
    if (key) tiles.plan(boxes, crops), painter.clear(), ++keys;
    const auto chunk = costs.time("chunk", [&] {
      const std::vector<package::QuantisedSurface> surface{
          encode::quantisedSurface({glm::dvec3(kBounds.min), 0.001}, mesh.positions, mesh.faces, true)};
      return orStop(package::encodeSurfaceChunk(tiles.tiles(), surface));
    });
    costs.chunk_bytes.push_back(double(chunk.bytes.size()));
    costs.ms["jpeg"].push_back(0);
    costs.ms["draw"].push_back(0);
    for (size_t c = 0; c < 6; ++c) {
      const double start_ms = bench::now_ms();
      const auto planes = orStop(decoder->decode(frame[c].jpeg, crops[c].width, crops[c].height));
      const double decoded_ms = bench::now_ms();
      painter.draw(tiles.tiles()[c], planes, crops[c], frame[c].rings);
      costs.ms["jpeg"].back() += decoded_ms - start_ms;
      costs.ms["draw"].back() += bench::now_ms() - decoded_ms;
    }
    painter.drawBarcode(f);
    if (getenv("FOURDVT_BENCH_PICTURE") && f == 12) {
      cv::Mat i420(size.height * 3 / 2, size.width, CV_8U), bgr;
      const I420View v = painter.view();
      std::copy_n(v.y, size.width * size.height, i420.data);
      std::copy_n(v.u, size.width * size.height / 4, i420.data + size.width * size.height);
      std::copy_n(v.v, size.width * size.height / 4, i420.data + size.width * size.height * 5 / 4);
      cv::cvtColor(i420, bgr, cv::COLOR_YUV2BGR_I420);
      cv::imwrite(getenv("FOURDVT_BENCH_PICTURE"), bgr);
    }
    const auto sample = costs.time("encode", [&] { return orStop(encoder->encode(painter.view(), key)); });
    costs.sample_bytes.push_back(double(sample.sample.size()));
  }
  if (header)
    std::printf(
        "%d x %d, packed %d x %d, tiles at %.2f\n tolerance preset     triangles outlines  hull chunk  jpeg  "
        "draw encode   sum ms  chunk B  sample B  keys failed\n",
        setup.cameras[0].width, setup.cameras[0].height, size.width, size.height, tiles.scale());
  if (costs.triangles.empty()) return;
  double sum = 0, bytes = 0;
  for (const char* step : {"hull", "chunk", "jpeg", "draw", "encode"}) sum += costs.of(step);
  for (const double b : costs.sample_bytes) bytes += b / double(costs.sample_bytes.size());
  std::printf("%6.1f px  %-10s %9.0f %8.2f %5.2f %5.2f %5.2f %5.2f %6.2f %8.2f %8.0f %9.0f %5d %6d\n", tolerance_px,
              preset, median(costs.triangles), costs.of("outlines"), costs.of("hull"), costs.of("chunk"),
              costs.of("jpeg"), costs.of("draw"), costs.of("encode"), sum, median(costs.chunk_bytes), bytes, keys,
              failed);
}

void runLive(const Setup& setup, double fps, double seconds) {
  using std::chrono::system_clock, std::chrono::microseconds;
  const auto now_us = [] {
    return std::chrono::duration_cast<microseconds>(system_clock::now().time_since_epoch()).count();
  };
  Rig rig;
  rig.name = "bench", rig.fps = fps, rig.bounds = kBounds;
  for (size_t c = 0; c < setup.cameras.size(); ++c) {
    RigCamera& camera = rig.cameras.emplace_back();
    camera.camera.pinhole = setup.cameras[c];
    camera.camera.pinhole.name = "cam0" + std::to_string(c);
    camera.filmed = camera.camera;
  }
  const auto pipeline = orStop(Pipeline::start(rig, {}, {}));
  for (size_t c = 0; c < 6; ++c) pipeline->setConnected(c, true), pipeline->onClock(c, {now_us(), now_us()}, now_us());
  int64_t time_us = now_us();
  for (int f = 0; f < int(seconds * fps); ++f) {
    time_us += std::llround(1e6 / fps);
    std::this_thread::sleep_until(system_clock::time_point(microseconds(time_us)));
    for (size_t c = 0; c < 6; ++c) {
      const Seen& seen = setup.frames[size_t(f) % kFrames][c];
      CameraPicture picture{uint32_t(f), time_us,  0, ringsOf(seen.coverage, pipeline->settings(c).tolerance_px),
                            seen.crop,   seen.jpeg};
      pipeline->onPicture(c, std::move(picture), seen.jpeg.size() + 1000, now_us());
    }
  }
  const PipelineStatus s = pipeline->status();
  std::printf(
      " live at %.0f/s: %.0f frames/s, %.0f triangles at %.2f px; hull %.1f ms, picture %.1f ms, encode %.1f ms, "
      "latency %.1f ms; %.0f + %.0f kB/s; %llu skipped, %llu incomplete, %llu failed\n",
      fps, s.frames_per_s, s.triangles, s.tolerance_px, s.hull_ms, s.picture_ms, s.encode_ms, s.latency_ms,
      s.surface_bytes_per_s / 1e3, s.picture_bytes_per_s / 1e3, (unsigned long long)s.skipped,
      (unsigned long long)s.incomplete, (unsigned long long)s.failed);
}

}  // namespace

int main(int count, char** arguments) {
  cv::setNumThreads(1);
  const std::string folder = count > 1 ? arguments[1] : "site/sample/actor_a";
  for (const glm::ivec2 size : {glm::ivec2(320, 240), glm::ivec2(640, 480)}) {
    Setup setup = setUp(folder, size.x, size.y);
    bool header = true;
    for (const double tolerance_px : {0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 16.0}) {
      run(setup, tolerance_px, "superfast", header);
      header = false;
    }
    for (const char* preset : {"ultrafast", "veryfast"}) run(setup, 2, preset, false);
    runLive(setup, size.x == 320 ? 25 : 12, 10);
    runLive(setup, 25, 10);
  }
}
