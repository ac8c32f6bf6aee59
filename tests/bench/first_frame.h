// SPDX-License-Identifier: Apache-2.0
// The first frame of a layered character, ready to be drawn.
#pragma once

#include <algorithm>
#include <filesystem>
#include <vector>

#include "or_stop.h"
#include "package/base_mesh.h"
#include "package/chunk_mesh.h"
#include "package/stream_file.h"
#include "platform/ffmpeg_video.h"
#include "platform/files.h"
#include "render/plain_figure.h"

namespace fourdvt::testing {

struct FirstFrame {
  package::Character character;
  package::BaseMesh mesh;
  package::ChunkFrames chunk;  // chunk that begins with the frame
  render::PlainFigure figure;
  render::PictureTextures picture;
  Positions positions;

  // Labels of the first member.
  std::span<const uint8_t> labels() const {
    return std::span<const uint8_t>(chunk.labels).first(size_t(character.layer_count) * character.face_count);
  }
};

// Frame 0 of the first sequence.
inline FirstFrame loadFirstFrame(gpu::Device& device, const std::filesystem::path& folder) {
  FirstFrame scene;
  scene.character = orStop(package::readManifest(orStop(platform::readJsonFlat((folder / "character.gltf").string()))));
  const package::Character& c = scene.character;
  const package::Sequence& sequence = c.sequences.at(0);
  const package::Rendition& rendition = sequence.renditions.back();
  scene.mesh = orStop(package::decodeBaseMesh(
      orStop(platform::readFileRange((folder / c.mesh_uri).string(), c.mesh_offset, c.mesh_bytes))));
  const std::string stream = (folder / sequence.stream_uri).string(), video = (folder / rendition.video_uri).string();
  const auto index =
      orStop(package::readStreamHeader(orStop(platform::readFileRange(stream, 0, sequence.stream_header_bytes))));
  scene.chunk = orStop(
      package::decodeChunk(orStop(platform::readFileRange(stream, index.chunks[0].offset, index.chunks[0].bytes)),
                           index, 0, package::makeChunkMesh(scene.mesh)));
  for (uint32_t v = 0; v < c.vertex_count; ++v)
    scene.positions.push_back(index.position_origin + index.position_step_m * glm::vec3(scene.chunk.positions[v]));
  scene.figure = orStop(render::PlainFigure::create(device, c, scene.mesh));
  scene.figure.setLayout(rendition);
  scene.figure.setFrame(device, scene.positions, scene.labels());
  scene.picture =
      orStop(render::createPicture(device, rendition.width, rendition.height, render::PictureTextures::Kind::I420));
  auto decoder = orStop(platform::SampleDecoder::create(rendition.codec, index.renditions.back().decoder_description,
                                                        [&](const I420View& frame, int64_t number) {
                                                          if (number == 0)
                                                            render::uploadPicture(device, scene.picture, frame);
                                                        }));
  for (const package::VideoSample& sample : index.renditions.back().samples)
    orStop(
        decoder->decode(orStop(platform::readFileRange(video, sample.offset, sample.bytes)), sample.frame, sample.key));
  orStop(decoder->flush());
  return scene;
}

inline double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

}  // namespace fourdvt::testing
