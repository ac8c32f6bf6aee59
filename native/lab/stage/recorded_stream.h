// SPDX-License-Identifier: Apache-2.0
// Reads a recording of a live stream whose cameras show a counted stage (stage.h): per frame, the number of each
// camera's picture. Works offline.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/mesh.h"
#include "base/result.h"

namespace fourdvt::stage {

struct RecordedFrame {
  uint32_t number = 0;  // from the message
  bool key = false;
  int64_t captured_us = 0;  // from the message
  size_t bytes = 0, surface_bytes = 0, picture_bytes = 0;
  size_t triangles = 0;
  std::optional<uint32_t> barcode;  // in the decoded picture: `number` modulo 4096
  struct Camera {
    bool shown = false;               // has a tile
    std::optional<uint32_t> counter;  // number of the camera's picture in its video; nullopt: unreadable
  };
  std::vector<Camera> cameras;  // order of RecordedStream
};

struct RecordedStream {
  std::vector<std::string> cameras;  // names as in the manifest
  std::vector<RecordedFrame> frames;
  // First surface per frame of the stage's sequence whose pictures are all of that frame; an empty mesh if there is
  // none.
  std::vector<TriangleMesh> surfaces;
};

// folder: manifest.json, the stream's first message, and frames.bin, its frames as received, each after its length in
// bytes (uint32, little-endian). stage_folder: written by writeStage with a counter. Errors: FileMissing,
// ManifestInvalid (a file, named), StreamInvalid (a frame that does not decode), VideoInvalid, DecoderUnsupported.
Result<RecordedStream> readRecordedStream(const std::string& folder, const std::string& stage_folder,
                                          const std::function<void(size_t frame)>& progress = {});
// JSON {"cameras": [name], "frames": [{…}]}; a frame has the members of RecordedFrame by their names, on a line of its
// own.
std::string recordedStreamJson(const RecordedStream& stream);

}  // namespace fourdvt::stage
