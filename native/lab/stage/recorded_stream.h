// SPDX-License-Identifier: Apache-2.0
// Reads a recording of a live stream whose cameras show a counted stage (stage.h): per frame, the number of each
// camera's picture. Does NOT connect to a server.
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
  uint32_t number = 0;  // the message's
  bool key = false;
  int64_t captured_us = 0;  // the message's
  size_t bytes = 0, surface_bytes = 0, picture_bytes = 0;
  size_t triangles = 0;
  std::optional<uint32_t> barcode;  // in the decoded picture: `number` modulo 4096
  struct Camera {
    bool shown = false;               // has a tile
    std::optional<uint32_t> counter;  // number of the camera's picture in its video; none where it does not read
  };
  std::vector<Camera> cameras;  // as in RecordedStream
};

struct RecordedStream {
  std::vector<std::string> cameras;  // as the manifest names them
  std::vector<RecordedFrame> frames;
  // By frame of the sequence that the stage shows: the first surface whose pictures are all of that frame. Empty meshes
  // where none came.
  std::vector<TriangleMesh> surfaces;
};

// folder: manifest.json, the stream's first message, and frames.bin, its frames as they came, each after its length in
// bytes (uint32, little-endian). stage_folder: of writeStage, with a counter. Errors: FileMissing, ManifestInvalid (a
// file, named), StreamInvalid (a frame that does not decode), VideoInvalid, DecoderUnsupported.
Result<RecordedStream> readRecordedStream(const std::string& folder, const std::string& stage_folder,
                                          const std::function<void(size_t frame)>& progress = {});
// JSON {"cameras": [name], "frames": [{…}]}; a frame has the members of RecordedFrame by their names, and a line of its
// own.
std::string recordedStreamJson(const RecordedStream& stream);

}  // namespace fourdvt::stage
