// SPDX-License-Identifier: Apache-2.0
// Prints the contents of a character folder and decodes all of it: base mesh, chunks, video samples, barcodes.
#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "base/bytes.h"
#include "base/hash.h"
#include "edge/scene_file.h"
#include "motion/blend.h"
#include "motion/motion_graph.h"
#include "package/barcode.h"
#include "package/base_mesh.h"
#include "package/character.h"
#include "package/chunk_mesh.h"
#include "package/sound.h"
#include "package/stream_file.h"
#include "package/surface_chunk.h"
#include "platform/ffmpeg_video.h"
#include "platform/files.h"
#include "tools/args.h"
#include "tools/commands.h"
#include "tools/session.h"

namespace fourdvt::tools {
namespace {

namespace fs = std::filesystem;

Error inFile(const std::string& path, const Error& error) {
  if (error.message.find(path) != std::string::npos) return error;
  return {error.id, path + ": " + error.message};
}

struct SequenceSizes {
  uint64_t video = 0;             // highest rendition
  uint64_t lower_renditions = 0;  // all other renditions
  uint64_t positions = 0, labels = 0, offsets = 0, alignment = 0;
  uint64_t index = 0;  // header, tables of lengths, root motion
  size_t chunks = 0;
  bool aligned = false;
  // Camera-based characters: surfaces count as positions.
  uint32_t runs = 0, max_vertices = 0, max_faces = 0;
  std::vector<double> kept_pixels;  // [camera], mean over the GOPs
  uint64_t withoutVideo() const { return positions + labels + offsets + alignment + index; }
};

// Adds a chunk's sizes. Layout: lengths of its parts first (positions and labels of all members, corrections,
// alignment).
void addChunk(std::span<const uint8_t> bytes, const package::StreamIndex& index, SequenceSizes& sizes) {
  ByteReader lengths(bytes);
  uint64_t parts = 0;
  const auto add = [&](uint64_t& kind) {
    const uint32_t length = lengths.u32();
    kind += length;
    parts += length;
  };
  for (uint32_t m = 0; m < index.member_count; ++m) add(sizes.positions), add(sizes.labels);
  for (uint32_t r = 0; r < index.reference_count; ++r) add(sizes.offsets);
  for (uint32_t a = 0; a < index.alignment_count; ++a) add(sizes.alignment);
  sizes.index += bytes.size() - parts;
}

// Adds a surface chunk's sizes. Layout: tiles and runs first; each run has the lengths of its mesh and its motion.
void addSurfaceChunk(std::span<const uint8_t> bytes, const package::SurfaceChunk& chunk, double share,
                     SequenceSizes& sizes) {
  ByteReader in(bytes);
  in.bytes(size_t(16) * in.u32());
  const uint32_t runs = in.u32();
  uint64_t surfaces = 0;
  for (uint32_t r = 0; r < runs; ++r) {
    in.u32();
    surfaces += in.u32();
    surfaces += in.u32();
  }
  sizes.runs += runs;
  sizes.positions += surfaces;
  sizes.index += bytes.size() - surfaces;
  sizes.kept_pixels.resize(chunk.tiles().size());
  for (size_t c = 0; c < chunk.tiles().size(); ++c)
    sizes.kept_pixels[c] += share * chunk.tiles()[c].source.width * chunk.tiles()[c].source.height;
  for (uint32_t f = 0; f < chunk.decodedCount(); ++f) {
    const package::Surface surface = chunk.surface(f);
    sizes.max_vertices = std::max(sizes.max_vertices, static_cast<uint32_t>(surface.positions.size()));
    sizes.max_faces = std::max(sizes.max_faces, static_cast<uint32_t>(surface.faces.size()));
  }
}

class Inspection {
 public:
  explicit Inspection(const std::string& manifest) : manifest_(manifest), folder_(fs::path(manifest).parent_path()) {}

  Status run() {
    FOURDVT_ASSIGN(auto json, platform::readJsonFlat(manifest_));
    auto character = package::readManifest(json);
    if (!character.ok()) return inFile(manifest_, character.error());
    character_ = character.take();
    FOURDVT_TRY(baseMesh());
    for (const package::Sequence& sequence : character_.sequences) FOURDVT_TRY(inspectSequence(sequence));
    for (size_t s = 0; s < character_.sequences.size(); ++s) FOURDVT_TRY(inspectSound(json, s));
    if (!character_.graph_uri.empty()) FOURDVT_TRY(readGraph());
    if (!character_.poster_uri.empty()) {
      auto poster = platform::readImage(path(character_.poster_uri));
      if (!poster.ok()) return inFile(path(character_.poster_uri), poster.error());
      poster_bytes_ = fs::file_size(path(character_.poster_uri));
    }
    if (!character_.room.picture_uri.empty()) FOURDVT_TRY(edge::readRoomPicture(folder_.string(), character_.room));
    return {};
  }

  void print() const {
    const package::Character& c = character_;
    std::printf("%s: %s, format %d\n", manifest_.c_str(), c.name.c_str(), c.version);
    if (fromCameras()) {
      std::printf("surfaces   up to %u vertices, %u faces\ntextured   from the pictures of %zu cameras\n",
                  c.vertex_count, c.face_count, c.cameras.size());
    } else {
      std::printf("mesh       %u vertices, %u faces\nlayers     %d from %zu cameras\n", c.vertex_count, c.face_count,
                  c.layer_count, c.cameras.size());
    }
    std::printf("bounds     x %.2f to %.2f, y %.2f to %.2f, z %.2f to %.2f m, ground at %.2f m\n", c.bounds.min.x,
                c.bounds.max.x, c.bounds.min.y, c.bounds.max.y, c.bounds.min.z, c.bounds.max.z, c.ground_y_m);
    printRoom();
    std::printf("%-12s %6s %6s %8s %5s %5s\n", "sequence", "frames", "fps", "seconds", "loop", "GOPs");
    for (size_t i = 0; i < sizes_.size(); ++i) {
      const package::Sequence& s = c.sequences[i];
      std::printf("%-12s %6u %6.2f %8.2f %5s %5zu\n", s.name.c_str(), s.frame_count, s.fps, s.duration_s(),
                  s.loop ? "yes" : "no", sizes_[i].chunks);
    }
    printRenditions();
    if (fromCameras()) printTiles();
    printClasses();
    printGraph();
    printSounds();
    printSizes();
  }

 private:
  bool fromCameras() const { return character_.appearance == package::AppearanceKind::Cameras; }
  std::string path(const std::string& uri) const { return (folder_ / uri).string(); }

  Status baseMesh() {
    const std::string file = path(character_.mesh_uri);
    FOURDVT_ASSIGN(auto bytes, platform::readFileRange(file, character_.mesh_offset, character_.mesh_bytes));
    FOURDVT_TRY(checkHash(file, bytes, character_.mesh_hash));
    if (fromCameras()) return {};  // surfaces come from the streams
    auto mesh = package::decodeBaseMesh(bytes);
    if (!mesh.ok()) return inFile(file, mesh.error());
    const MeshTopology& t = mesh.value().topology;
    chunk_mesh_ = package::makeChunkMesh(mesh.value());
    if (t.vertex_count == character_.vertex_count && t.faceCount() == character_.face_count) return {};
    return Error{ErrorId::MeshDataInvalid,
                 file + ": its numbers of vertices and faces are not those of the manifest; bake the character again"};
  }

  Status checkSize(const std::string& file, uint64_t expected, ErrorId id) const {
    std::error_code failed;
    const uint64_t actual = fs::file_size(file, failed);
    if (failed) return Error{ErrorId::FileMissing, file + ": missing; copy the whole character folder"};
    if (actual == expected) return {};
    return Error{id, file + ": " + std::to_string(actual) + " bytes, the manifest says " + std::to_string(expected) +
                         "; the file is truncated or not this character's, copy or bake it again"};
  }

  static Status checkHash(const std::string& file, std::span<const uint8_t> bytes, uint64_t expected) {
    if (fnv1a(bytes) == expected) return {};
    return Error{ErrorId::FilesDiffer,
                 file + ": its bytes are not those that were baked with character.gltf; copy or bake it again"};
  }

  Status inspectSequence(const package::Sequence& sequence) {
    const std::string file = path(sequence.stream_uri);
    FOURDVT_TRY(checkSize(file, sequence.stream_bytes, ErrorId::StreamInvalid));
    FOURDVT_ASSIGN(auto header, platform::readFileRange(file, 0, sequence.stream_header_bytes));
    FOURDVT_TRY(checkHash(file, header, sequence.stream_header_hash));
    auto index = package::readStreamHeader(header);
    if (!index.ok()) return inFile(file, index.error());
    SequenceSizes sizes;
    sizes.index = sequence.stream_header_bytes;
    sizes.chunks = index.value().chunks.size();
    sizes.aligned = index.value().alignment_count > 0;
    FOURDVT_TRY(matchesManifest(sequence, index.value(), file));
    if (fromCameras()) {
      FOURDVT_TRY(surfaceChunks(sequence, index.value(), file, sizes));
    } else {
      FOURDVT_TRY(chunks(index.value(), file, &sizes));
      FOURDVT_TRY(chunks(index.value().coarse(), file, nullptr));
    }
    for (size_t r = 0; r < sequence.renditions.size(); ++r) {
      FOURDVT_TRY(video(sequence, sequence.renditions[r], index.value().renditions[r]));
      sizes.lower_renditions += sizes.video;
      sizes.video = sequence.renditions[r].video_bytes;
    }
    sizes_.push_back(sizes);
    return {};
  }

  // Checks sizes only: segments are decoded by players, and their bytes are those of the bake.
  Status inspectSound(const FlatJson& json, size_t sequence) {
    auto sound = package::readSound(json, sequence);
    if (!sound.ok()) return inFile(manifest_, sound.error());
    for (const package::SoundEncoding& encoding : sound.value().encodings) {
      const std::string file = path(encoding.uri);
      FOURDVT_TRY(checkSize(file, encoding.bytes, ErrorId::FilesDiffer));
      FOURDVT_ASSIGN(const auto bytes, platform::readFile(file));
      FOURDVT_TRY(checkHash(file, bytes, encoding.hash));
    }
    if (!sound.value().encodings.empty()) sounds_[character_.sequences[sequence].name] = sound.take();
    return {};
  }

  Status matchesManifest(const package::Sequence& sequence, const package::StreamIndex& index,
                         const std::string& file) const {
    const bool counts =
        fromCameras() ? index.vertex_count <= character_.vertex_count && index.face_count <= character_.face_count
                      : index.vertex_count == character_.vertex_count && index.face_count == character_.face_count;
    const bool same = index.frame_count == sequence.frame_count && counts &&
                      static_cast<int>(index.layer_count) == character_.layer_count &&
                      index.member_count == sequence.members.size() &&
                      index.reference_count == sequence.reference_count &&
                      index.renditions.size() == sequence.renditions.size() &&
                      index.coarse_chunks.empty() == (sequence.coarse_renditions == 0);
    if (same) return {};
    return Error{ErrorId::StreamInvalid, file + ": counts differ from the manifest's; bake the character again"};
  }

  Status chunks(const package::StreamIndex& index, const std::string& file, SequenceSizes* sizes) const {
    for (uint32_t c = 0; c < index.chunks.size(); ++c) {
      FOURDVT_ASSIGN(auto bytes, platform::readFileRange(file, index.chunks[c].offset, index.chunks[c].bytes));
      FOURDVT_TRY(checkHash(file, bytes, index.chunks[c].hash));
      auto frames = package::decodeChunk(bytes, index, c, chunk_mesh_);
      if (!frames.ok()) return inFile(file, frames.error());
      if (sizes) addChunk(bytes, index, *sizes);
    }
    return {};
  }

  Status surfaceChunks(const package::Sequence& sequence, const package::StreamIndex& index, const std::string& file,
                       SequenceSizes& sizes) const {
    for (uint32_t c = 0; c < index.chunks.size(); ++c) {
      FOURDVT_ASSIGN(auto bytes, platform::readFileRange(file, index.chunks[c].offset, index.chunks[c].bytes));
      FOURDVT_TRY(checkHash(file, bytes, index.chunks[c].hash));
      auto chunk = package::SurfaceChunk::open(bytes, index, c, character_, sequence);
      if (!chunk.ok()) return inFile(file, chunk.error());
      const Status decoded = chunk.value()->decodeTo(index.chunks[c].frame_count);
      if (!decoded.ok()) return inFile(file, decoded.error());
      addSurfaceChunk(bytes, *chunk.value(), 1.0 / double(index.chunks.size()), sizes);
    }
    return {};
  }

  // Decodes all samples from their table entries, as the player does, and compares barcodes with frame numbers.
  Status video(const package::Sequence& sequence, const package::Rendition& rendition,
               const package::SampleTable& table) const {
    const std::string file = path(rendition.video_uri);
    FOURDVT_TRY(checkSize(file, rendition.video_bytes, ErrorId::VideoInvalid));
    uint32_t shown = 0;
    std::string wrong;
    auto decoder = platform::SampleDecoder::create(
        rendition.codec, table.decoder_description, [&](const I420View& picture, int64_t frame) {
          ++shown;
          if (picture.width != rendition.width || picture.height != rendition.height)
            wrong = "has another picture size than the manifest says";
          else if (package::readBarcode(rendition.barcode, picture) !=
                   std::optional<uint32_t>(static_cast<uint32_t>(frame) % 4096))
            wrong = "barcode of frame " + std::to_string(frame) + " does not say so";
        });
    if (!decoder.ok()) return inFile(file, decoder.error());
    for (uint32_t c = 0; c < table.chunk_hash.size(); ++c) {
      const package::ByteSpan span = table.videoOf(c);
      FOURDVT_ASSIGN(auto bytes, platform::readFileRange(file, span.offset, span.bytes));
      FOURDVT_TRY(checkHash(file, bytes, table.chunk_hash[c]));
      for (uint32_t s = table.chunk_first_sample[c]; s < table.chunk_first_sample[c + 1]; ++s) {
        const package::VideoSample& sample = table.samples[s];
        const auto part = std::span(bytes).subspan(sample.offset - span.offset, sample.bytes);
        Status decoded = decoder.value()->decode(part, sample.frame, sample.key);
        if (!decoded.ok()) return inFile(file, decoded.error());
      }
    }
    Status flushed = decoder.value()->flush();
    if (!flushed.ok()) return inFile(file, flushed.error());
    if (wrong.empty() && shown != sequence.frame_count)
      wrong = std::to_string(shown) + " of " + std::to_string(sequence.frame_count) + " frames decode";
    if (wrong.empty()) return {};
    return Error{ErrorId::VideoInvalid, file + ": " + wrong + "; copy or bake it again"};
  }

  Status readGraph() {
    const std::string file = path(character_.graph_uri);
    FOURDVT_TRY(checkSize(file, character_.graph_bytes, ErrorId::StreamInvalid));
    FOURDVT_ASSIGN(auto bytes, platform::readFileRange(file, 0, character_.graph_bytes));
    FOURDVT_TRY(checkHash(file, bytes, character_.graph_hash));
    auto graph = motion::MotionGraph::read(bytes, character_);
    if (!graph.ok()) return inFile(file, graph.error());
    graph_ = graph.take();
    return {};
  }

  void printRenditions() const {
    std::printf("\n%-12s %9s %7s %10s  %-14s %10s %7s\n", "video", "rendition", "texels", "picture", "codec", "bytes",
                "Mbit/s");
    for (const package::Sequence& s : character_.sequences)
      for (size_t r = 0; r < s.renditions.size(); ++r) {
        const package::Rendition& rendition = s.renditions[r];
        const std::string size = std::to_string(rendition.width) + "x" + std::to_string(rendition.height);
        const std::string texels = fromCameras() ? "-" : std::to_string(rendition.layers[0].width);
        std::printf("%-12s %9zu %7s %10s  %-14s %10lu %7.2f\n", s.name.c_str(), r, texels.c_str(), size.c_str(),
                    rendition.codec.c_str(), rendition.video_bytes, rendition.video_bytes * 8e-6 / s.duration_s());
      }
  }

  void printTiles() const {
    for (size_t i = 0; i < sizes_.size(); ++i) {
      const package::Sequence& s = character_.sequences[i];
      std::printf("\n%s: layout %d x %d; %u frames in %u runs of one topology, up to %u vertices, %u faces\n",
                  s.name.c_str(), s.layout_width, s.layout_height, s.frame_count, sizes_[i].runs,
                  sizes_[i].max_vertices, sizes_[i].max_faces);
      for (size_t c = 0; c < character_.cameras.size(); ++c) {
        const PinholeCamera& camera = character_.cameras[c];
        std::printf("  %-10s %4.1f %% of its picture\n", camera.name.c_str(),
                    100 * sizes_[i].kept_pixels[c] / (double(camera.width) * camera.height));
      }
    }
  }

  void printRoom() const {
    const package::Room& r = character_.room;
    if (!r.picture_uri.empty()) {
      std::printf("room       x %.2f to %.2f, y %.2f to %.2f, z %.2f to %.2f m, %s of %dx%d\n", r.box.min.x,
                  r.box.max.x, r.box.min.y, r.box.max.y, r.box.min.z, r.box.max.z, r.picture_uri.c_str(), r.width,
                  r.height);
    }
    std::printf("\n");
  }

  void printSounds() const {
    for (const auto& [name, sound] : sounds_) {
      std::printf("\nsound of %s: %s", name.c_str(), sound.channels == 2 ? "stereo" : "mono");
      if (sound.steps.empty())
        std::printf(", %zu segments of %.2f s", sound.encodings[0].segments.size(), sound.segment_s);
      else
        std::printf(", one step of %.2f s, %zu times a pass", sound.segment_s, sound.steps.size());
      for (const package::SoundEncoding& encoding : sound.encodings)
        std::printf(", %s of %lu bytes", encoding.uri.c_str(), encoding.bytes);
    }
    if (!sounds_.empty()) std::printf("\n");
  }

  void printClasses() const {
    for (size_t i = 0; i < sizes_.size(); ++i) {
      const package::Sequence& s = character_.sequences[i];
      if (!s.isClass()) continue;
      std::printf("\nclass %s: ", s.name.c_str());
      for (size_t p = 0; p < s.space.names.size(); ++p) {
        const motion::Range range = motion::parameterRange(s, p);
        std::printf("%s %.2f to %.2f, ", s.space.names[p].c_str(), range.min, range.max);
      }
      std::printf(
          "%u corrections a frame, %s\n", s.reference_count,
          sizes_[i].aligned ? (std::to_string(sizes_[i].alignment) + " bytes of alignment").c_str() : "not aligned");
      for (const package::Member& m : s.members) {
        std::printf("  %-10s at", m.name.c_str());
        for (double value : m.parameter) std::printf(" %.2f", value);
        std::printf(": %.2f s, travels x %.2f, z %.2f m, turns %.1f degrees\n", m.duration_s, m.travel.x, m.travel.y,
                    glm::degrees(m.travel.z));
      }
    }
  }

  void printGraph() const {
    const int states = static_cast<int>(graph_.states().size());
    int pairs = 0;
    for (int from = 0; from < states; ++from)
      for (int to = 0; to < states; ++to) pairs += graph_.entry(from, 0, 0, to) != nullptr;
    if (states > 0) {
      std::printf("\nmotion graph: %d of %d transitions between %d states, %lu bytes\n", pairs, states * (states - 1),
                  states, character_.graph_bytes);
    }
  }

  void printSizes() const {
    std::printf("\n%-12s %9s %9s %9s %9s %9s %9s %10s  %s\n", "bytes", "video",
                fromCameras() ? "surfaces" : "positions", "labels", "offsets", "alignment", "index", "total",
                "Mbit/s (video + rest), MB a minute");
    uint64_t all = character_.mesh_bytes + poster_bytes_ + character_.graph_bytes + character_.room.picture_bytes +
                   fs::file_size(manifest_);
    for (size_t i = 0; i < sizes_.size(); ++i) {
      const SequenceSizes& s = sizes_[i];
      const uint64_t rest = s.withoutVideo();
      const double rate = 8e-6 / character_.sequences[i].duration_s();
      std::printf("%-12s %9lu %9lu %9lu %9lu %9lu %9lu %10lu  %.2f (%.2f + %.2f), %.0f\n",
                  character_.sequences[i].name.c_str(), s.video, s.positions, s.labels, s.offsets, s.alignment, s.index,
                  s.video + rest, (s.video + rest) * rate, s.video * rate, rest * rate,
                  (s.video + rest) * rate * 60 / 8);
      all += s.video + s.lower_renditions + rest;
    }
    std::printf("\nmesh %lu, poster %lu, manifest %lu; all that a player may load: %lu bytes (%.2f MB)\n",
                character_.mesh_bytes, poster_bytes_, uint64_t(fs::file_size(manifest_)), all, all / 1e6);
  }

  std::string manifest_;
  fs::path folder_;
  package::Character character_;
  package::ChunkMesh chunk_mesh_;
  std::vector<SequenceSizes> sizes_;
  package::Sounds sounds_;
  motion::MotionGraph graph_;  // no states if the character has none
  uint64_t poster_bytes_ = 0;
};

}  // namespace

Result<int> inspectCommand(int argc, char** argv) {
  std::string path;
  const Args args({"inspect CHARACTER|CAPTURE",
                   "Of a capture folder: lists per camera the pictures, the marks that their files have (turned, "
                   "interlaced, HDR, colour profiles), what reading makes of them, and where mattes come from; exits "
                   "with 1 if a view cannot be used. Of a character: lists sequences, motion classes, renditions (the "
                   "lowest first) and sizes of a character folder (or of its character.gltf). Checks content hashes "
                   "and decodes every chunk, every video frame, the motion graph and the room. Exits with 1 if "
                   "anything is damaged.",
                   {&path},
                   {}},
                  argc, argv);
  if (const auto code = args.helpOrProblem()) return *code;
  if (isCaptureFolder(path)) return inspectCapture(path);
  if (std::error_code ignored; fs::is_directory(path, ignored) && !fs::exists(manifestPath(path), ignored))
    return Error{
        ErrorId::FileMissing,
        path + ": neither a capture (capture.json) nor a character (character.gltf); name the folder that has one"};
  Inspection inspection(manifestPath(path));
  FOURDVT_TRY(inspection.run());
  inspection.print();
  std::printf("everything decodes\n");
  return kOk;
}

}  // namespace fourdvt::tools
