// SPDX-License-Identifier: Apache-2.0
#include "lab/stage/recorded_stream.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <span>
#include <utility>

#include "lab/stage/counter.h"
#include "package/barcode.h"
#include "package/live_stream.h"
#include "package/surface_chunk.h"
#include "platform/ffmpeg_video.h"
#include "platform/files.h"

namespace fourdvt::stage {
namespace {

using Json = nlohmann::ordered_json;
using Corner = std::optional<glm::ivec2>;

constexpr size_t kLengthBytes = 4;

// Contents of counter.json.
struct Counters {
  int cell_px = 0;
  size_t frames = 0;                                   // sequence length
  std::map<std::string, std::vector<Corner>> corners;  // per camera and frame of the sequence
};

Result<Counters> readCounters(const std::string& path) {
  FOURDVT_ASSIGN(const auto bytes, platform::readFile(path));
  try {
    const Json json = Json::parse(bytes);
    Counters out;
    out.cell_px = json.at("cell_px").get<int>();
    out.frames = json.at("frames").get<size_t>();
    for (const auto& [name, places] : json.at("cameras").items())
      for (const Json& place : places)
        out.corners[name].push_back(
            place.is_null() ? Corner{} : Corner(glm::ivec2(place.at(0).get<int>(), place.at(1).get<int>())));
    if (out.frames < 1 || out.cell_px < 1)
      return Error{ErrorId::ManifestInvalid,
                   path + ": no frames or no cells; write it with `fourdvt-lab stage --counter`"};
    return out;
  } catch (const Json::exception& problem) {
    return Error{ErrorId::ManifestInvalid,
                 path + ": " + problem.what() + "; write it with `fourdvt-lab stage --counter`"};
  }
}

// Cuts a camera's tile out of the packed picture and resamples it to the camera's pixels. Luma only.
Image sourcePixels(const I420View& picture, const package::Rendition& rendition, const package::Sequence& sequence,
                   const package::CameraTile& tile) {
  const double scale_x = double(rendition.tiles.width) / sequence.layout_width;
  const double scale_y = double(rendition.tiles.height) / sequence.layout_height;
  const cv::Rect2d place(rendition.tiles.x + scale_x * tile.tile.x, rendition.tiles.y + scale_y * tile.tile.y,
                         scale_x * tile.tile.width, scale_y * tile.tile.height);
  Image out(tile.source.width, tile.source.height, 1);
  const cv::Mat luma(picture.height, picture.width, CV_8UC1, const_cast<uint8_t*>(picture.y), size_t(picture.stride_y));
  cv::Mat to(out.height, out.width, CV_8UC1, out.pixels.data());
  const double step_x = place.width / out.width, step_y = place.height / out.height;
  const cv::Matx23d from_out(step_x, 0, place.x + step_x / 2 - 0.5, 0, step_y, place.y + step_y / 2 - 0.5);
  cv::warpAffine(luma, to, from_out, to.size(), cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
  return out;
}

// Reads a number at each frame's corner; rejects numbers of other frames: picture i shows frame i modulo the number of
// corners.
std::optional<uint32_t> readAtAnyFrame(const Image& luma, const package::Rect& source,
                                       const std::vector<Corner>& corners, int cell_px) {
  std::optional<uint32_t> found;
  for (size_t frame = 0; frame < corners.size(); ++frame) {
    if (!corners[frame]) continue;
    const auto number = readCounter(luma, *corners[frame] - glm::ivec2(source.x, source.y), cell_px);
    if (!number || *number % corners.size() != frame || number == found) continue;
    if (found) return std::nullopt;
    found = number;
  }
  return found;
}

class Reader {
 public:
  Reader(package::LiveCharacter live, Counters counters, std::string path)
      : live_(std::move(live)), counters_(std::move(counters)), path_(std::move(path)) {
    for (const auto& camera : live_.character.cameras) out_.cameras.push_back(camera.name);
    out_.surfaces.resize(counters_.frames);
  }

  Result<RecordedStream> read(std::span<const uint8_t> messages, const std::function<void(size_t)>& progress) {
    FOURDVT_ASSIGN(decoder_,
                   platform::SampleDecoder::create(rendition().codec, {}, [this](const I420View& picture, int64_t i) {
                     readPicture(picture, size_t(i));
                   }));
    while (!messages.empty()) {
      if (progress) progress(out_.frames.size());
      uint32_t bytes = 0;
      for (size_t i = 0; i < kLengthBytes && i < messages.size(); ++i) bytes |= uint32_t(messages[i]) << (8 * i);
      if (messages.size() < kLengthBytes || bytes > messages.size() - kLengthBytes) return invalid("is cut off");
      FOURDVT_TRY(readMessage(messages.subspan(kLengthBytes, bytes)));
      messages = messages.subspan(kLengthBytes + bytes);
    }
    FOURDVT_TRY(decoder_->flush());
    return std::move(out_);
  }

 private:
  const package::Sequence& sequence() const { return live_.character.sequences[0]; }
  const package::Rendition& rendition() const { return sequence().renditions[0]; }
  Error invalid(const std::string& problem) const {
    return {ErrorId::StreamInvalid,
            path_ + ": frame " + std::to_string(out_.frames.size()) + " " + problem + "; record it again"};
  }

  Status readMessage(std::span<const uint8_t> message) {
    const auto read = package::readLiveFrame(message);
    if (!read) return invalid(read.error().message);
    const package::LiveFrame& frame = read.value();
    live_.index.chunks[0].bytes = uint32_t(frame.chunk.size());
    const auto chunk = package::SurfaceChunk::open(frame.chunk, live_.index, 0, live_.character, sequence());
    if (!chunk) return invalid(chunk.error().message);
    const Status decoded = chunk.value()->decodeTo(0);
    if (!decoded.ok()) return invalid(decoded.error().message);
    RecordedFrame& out = out_.frames.emplace_back();
    out.number = frame.number, out.key = frame.key, out.captured_us = frame.captured_us;
    out.bytes = message.size(), out.surface_bytes = frame.chunk.size(), out.picture_bytes = frame.sample.size();
    const package::Surface surface = chunk.value()->surface(0);
    out.triangles = surface.faces.size();
    meshes_.push_back(
        {{surface.positions.begin(), surface.positions.end()}, {surface.faces.begin(), surface.faces.end()}});
    tiles_.emplace_back(chunk.value()->tiles().begin(), chunk.value()->tiles().end());
    for (const auto& tile : tiles_.back()) out.cameras.push_back({!tile.empty(), {}});
    return decoder_->decode(frame.sample, int64_t(out_.frames.size() - 1), frame.key);
  }

  void readPicture(const I420View& picture, size_t frame) {
    if (frame >= out_.frames.size()) return;
    RecordedFrame& out = out_.frames[frame];
    out.barcode = package::readBarcode(rendition().barcode, picture);
    for (size_t c = 0; c < out.cameras.size(); ++c) {
      const auto corners = counters_.corners.find(out_.cameras[c]);
      if (!out.cameras[c].shown || corners == counters_.corners.end()) continue;
      const auto& tile = tiles_[frame][c];
      const Image luma = sourcePixels(picture, rendition(), sequence(), tile);
      out.cameras[c].counter = readAtAnyFrame(luma, tile.source, corners->second, counters_.cell_px);
    }
    keepSurface(out, std::exchange(meshes_[frame], {}));
  }

  void keepSurface(const RecordedFrame& frame, TriangleMesh mesh) {
    std::optional<uint32_t> number;
    for (const auto& camera : frame.cameras) {
      if (camera.counter && number && number != camera.counter) return;
      if (camera.counter) number = camera.counter;
    }
    if (!number) return;
    TriangleMesh& kept = out_.surfaces[*number % out_.surfaces.size()];
    if (kept.faces.empty()) kept = std::move(mesh);
  }

  package::LiveCharacter live_;
  const Counters counters_;
  const std::string path_;
  RecordedStream out_;
  std::vector<std::vector<package::CameraTile>> tiles_;  // per frame
  std::vector<TriangleMesh> meshes_;                     // per frame; moved out once its picture arrives
  std::unique_ptr<platform::SampleDecoder> decoder_;
};

Json orNull(const std::optional<uint32_t>& number) { return number ? Json(*number) : Json(); }

}  // namespace

Result<RecordedStream> readRecordedStream(const std::string& folder, const std::string& stage_folder,
                                          const std::function<void(size_t)>& progress) {
  FOURDVT_ASSIGN(auto counters, readCounters(stage_folder + "/counter.json"));
  FOURDVT_ASSIGN(const auto manifest, platform::readJsonFlat(folder + "/manifest.json"));
  auto live = package::readLiveManifest(manifest);
  if (!live) return Error{live.error().id, folder + "/manifest.json: " + live.error().message};
  const std::string path = folder + "/frames.bin";
  FOURDVT_ASSIGN(const auto messages, platform::readFile(path));
  return Reader(live.take(), std::move(counters), path).read(messages, progress);
}

std::string recordedStreamJson(const RecordedStream& stream) {
  std::string out = "{\"cameras\": " + Json(stream.cameras).dump() + ", \"frames\": [";
  for (const RecordedFrame& frame : stream.frames) {
    Json cameras = Json::array();
    for (const auto& camera : frame.cameras)
      cameras.push_back(Json{{"shown", camera.shown}, {"counter", orNull(camera.counter)}});
    const Json line{{"number", frame.number},
                    {"key", frame.key},
                    {"captured_us", frame.captured_us},
                    {"bytes", frame.bytes},
                    {"surface_bytes", frame.surface_bytes},
                    {"picture_bytes", frame.picture_bytes},
                    {"triangles", frame.triangles},
                    {"barcode", orNull(frame.barcode)},
                    {"cameras", cameras}};
    out += (&frame == stream.frames.data() ? "\n" : ",\n") + line.dump();
  }
  return out + "\n]}\n";
}

}  // namespace fourdvt::stage
