// SPDX-License-Identifier: Apache-2.0
#include "lab/measure/character_frame.h"

#include <cstring>

#include "platform/files.h"

namespace fourdvt::measure {
namespace {

Error noFrame(const std::string& folder, const std::string& sequence, uint32_t frame) {
  return {ErrorId::InvalidArgument,
          folder + ": has no frame " + std::to_string(frame) + " of \"" + sequence + "\"; bake it again"};
}

std::vector<std::vector<uint8_t>> labelsOf(const package::ChunkFrames& chunk, uint32_t frame_in_chunk) {
  std::vector<std::vector<uint8_t>> out;
  for (uint32_t l = 0; l < chunk.layer_count; ++l) {
    const auto start = chunk.labels.begin() +
                       static_cast<std::ptrdiff_t>((size_t(frame_in_chunk) * chunk.layer_count + l) * chunk.face_count);
    out.emplace_back(start, start + chunk.face_count);
  }
  return out;
}

Image part(const Image& picture, const package::Rect& rect) {
  Image out(rect.width, rect.height, 3);
  for (int y = 0; y < rect.height; ++y)
    std::memcpy(out.at(0, y), picture.at(rect.x, rect.y + y), size_t(3) * static_cast<size_t>(rect.width));
  return out;
}

}  // namespace

Result<package::Character> readCharacter(const std::string& folder) {
  FOURDVT_ASSIGN(auto json, platform::readJsonFlat(folder + "/character.gltf"));
  return package::readManifest(json);
}

Status openCharacterStream(const std::string& folder, const std::string& name, CharacterStream& out) {
  FOURDVT_ASSIGN(auto character, readCharacter(folder));
  out.character = std::move(character);
  out.sequence = out.character.find(name);
  if (!out.sequence) return noFrame(folder, name, 0);
  out.path = folder + "/" + out.sequence->stream_uri;
  FOURDVT_ASSIGN(auto header, platform::readFileRange(out.path, 0, out.sequence->stream_header_bytes));
  auto index = package::readStreamHeader(header);
  if (!index.ok()) return Error{index.error().id, out.path + ": " + index.error().message};
  out.index = index.take();
  const package::Character& c = out.character;
  FOURDVT_ASSIGN(auto bytes, platform::readFileRange(folder + "/" + c.mesh_uri, c.mesh_offset, c.mesh_bytes));
  FOURDVT_ASSIGN(auto mesh, package::decodeBaseMesh(bytes));
  out.mesh = std::move(mesh);
  out.chunk_mesh = package::makeChunkMesh(out.mesh);
  return {};
}

Result<package::ChunkFrames> readCharacterChunk(const CharacterStream& stream, uint32_t chunk) {
  const package::ChunkEntry& entry = stream.index.chunks[chunk];
  FOURDVT_ASSIGN(auto bytes, platform::readFileRange(stream.path, entry.offset, entry.bytes));
  return package::decodeChunk(bytes, stream.index, chunk, stream.chunk_mesh);
}

Result<CharacterFrame> readCharacterFrame(const std::string& folder, const std::string& name, uint32_t frame,
                                          const OpenVideo& open_video) {
  CharacterStream stream;
  FOURDVT_TRY(openCharacterStream(folder, name, stream));
  if (frame >= stream.index.frame_count) return noFrame(folder, name, frame);
  CharacterFrame out;
  out.topology = std::move(stream.mesh.topology);

  const uint32_t chunk_index = stream.index.chunkOfFrame(frame);
  FOURDVT_ASSIGN(auto chunk, readCharacterChunk(stream, chunk_index));
  const uint32_t inside = frame - stream.index.chunks[chunk_index].first_frame;
  out.labels = labelsOf(chunk, inside);
  const size_t vertices = chunk.vertex_count;
  for (size_t v = 0; v < vertices; ++v)
    out.positions.push_back(stream.index.position_origin +
                            stream.index.position_step_m * glm::vec3(chunk.positions[inside * vertices + v]));

  const package::Rendition& rendition = stream.sequence->renditions.back();
  const std::string video_path = folder + "/" + rendition.video_uri;
  FOURDVT_ASSIGN(auto video, open_video(video_path, 3));
  for (uint32_t f = 0; f <= frame; ++f) {
    FOURDVT_ASSIGN(auto picture, video->next());
    if (!picture) return Error{ErrorId::VideoTooShort, video_path + ": ends early; bake it again"};
    if (f != frame) continue;
    for (const package::Rect& rect : rendition.layers) out.layers.push_back(part(*picture, rect));
  }
  return out;
}

Result<std::vector<std::vector<std::vector<uint8_t>>>> readCharacterLabels(const std::string& folder,
                                                                           const std::string& name, uint32_t first,
                                                                           uint32_t count) {
  CharacterStream stream;
  FOURDVT_TRY(openCharacterStream(folder, name, stream));
  if (first + count > stream.index.frame_count) return noFrame(folder, name, first + count - 1);
  std::vector<std::vector<std::vector<uint8_t>>> out;
  for (uint32_t c = 0; c < stream.index.chunks.size(); ++c) {
    const package::ChunkEntry& entry = stream.index.chunks[c];
    if (entry.first_frame + entry.frame_count <= first || entry.first_frame >= first + count) continue;
    FOURDVT_ASSIGN(auto chunk, readCharacterChunk(stream, c));
    for (uint32_t f = 0; f < entry.frame_count; ++f)
      if (entry.first_frame + f >= first && entry.first_frame + f < first + count) out.push_back(labelsOf(chunk, f));
  }
  return out;
}

}  // namespace fourdvt::measure
