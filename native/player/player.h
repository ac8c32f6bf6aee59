// SPDX-License-Identifier: Apache-2.0
// Player of one character: selects data to fetch, samples to decode and the frame to show, and composes the figure to
// draw.
//
// Functions: load, play, pause, seek, loop, rate, sequence choice; parameters of motion classes, transitions through
// the motion graph, root motion; pairing of decoded pictures with mesh chunks by timestamp, checked by the barcode; a
// window of GOPs that bounds memory. During a transition two sequences play, each with its own decoder
// (Request::decoder).
// The edge (page or native tool) has the clock, files, network and video decoders: it polls requests and returns
// answers. Order of calls: create → loadManifest → { tick(now) → drain nextRequest/nextEvent → answers → draw } …
// Single-threaded. No call blocks.
//
// Terms: a state is a node of the motion graph, i.e. a sequence or class as a transition target. A slot is a picture
// slot of a decoder. A look is one decoded picture on the figure's mesh; a recipe draws the figure.
//
// Parts with their own state and tests: parts/; player_impl.h combines them.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "base/camera.h"
#include "base/flat_json.h"
#include "player/parts/figure.h"
#include "player/parts/loading.h"
#include "player/parts/motion.h"
#include "player/parts/playback.h"
#include "render/barcodes/picture_checks.h"

namespace fourdvt {

struct PlayerOptions {
  int picture_slots = 4;                      // decoded pictures on the GPU
  uint64_t encoded_budget_bytes = 16u << 20;  // fetched GOPs kept for loops
  render::PictureTextures::Kind picture_kind = render::PictureTextures::Kind::I420;
  // Decoders run in real time, at `pace`, and may skip pictures or report a neighbour's timestamp (a <video> element).
  // Requires Kind::Rgba.
  bool paced = false;
  // Kind::Rgba: textures can be read back. False: timestamps identify the pictures, without a barcode check.
  bool readable = true;
  double turn_rate_rad_s = 2.1;            // maximum turn rate towards the requested heading
  double parameter_rate = 1.5;             // maximum change of a class's parameter per second, in units of its range
  uint32_t rendition = kHighestRendition;  // rendition to play, as Ladder::setQuality
  // While seeking, shows the key of the target frame's GOP if the key is nearer to it than the shown frame.
  bool preview_seeks = false;
  // false: cuts between motions until allowTransitions().
  bool transitions = true;
};

// Interval of a sequence, seconds.
struct TimeRange {
  double start_s = 0, end_s = 0;
};

// Metres, world; the normal points outwards and is not normalised.
struct SurfacePoint {
  glm::dvec3 position, normal;
};

struct PlayerStats {
  uint64_t frames_shown = 0;  // distinct presentations
  uint64_t frames_late = 0;   // presentations skipped for lack of a ready picture
  uint64_t barcode_checked = 0, barcode_mismatches = 0;
  uint64_t bytes_fetched = 0;
  uint64_t encoded_bytes_held = 0;
  uint32_t rendition = 0;  // rendition of the shown picture, 0: lowest
  DecodeStats decoded;
};

// Character of either kind, fetched or live. Default implementations of methods without a live equivalent have no
// effect.
class Player {
 public:
  static Result<std::unique_ptr<Player>> create(gpu::Device& device, const PlayerOptions& options);
  // Characters on one device share programs and targets: one recipe draws them together.
  static Result<std::unique_ptr<Player>> create(gpu::Device& device, std::shared_ptr<render::Recipe> recipe,
                                                const PlayerOptions& options);
  virtual ~Player() = default;

  // Starts loading; prepares frame 0 of the first sequence (or of an earlier `selectSequence`). start: bytes of the
  // character's start file (package/start_file.h), if available: shows frame 0 before any fetch.
  virtual Status loadManifest(const FlatJson& gltf, std::span<const uint8_t> start = {}) = 0;
  // True if the base mesh is loaded or not needed: no pending fetch is Draco-coded.
  virtual bool hasMesh() const { return true; }
  virtual void play() = 0;
  virtual void pause() = 0;
  virtual void seekFrame(uint32_t frame) = 0;  // current sequence, clamped; play state unchanged
  virtual void seek(double time_s) = 0;
  virtual Status selectSequence(const std::string& name) = 0;  // keeps the old picture until the new one is ready
  virtual void setRate(double /*rate*/) {}                     // 0 <= rate <= 4; 0: playing, frame frozen
  virtual void setLoop(int /*loop*/) {}                        // -1: as the sequence, 0: never, 1: always

  // Parameters of classes by name. The shown value glides to the requested one (parameter_rate), which is clamped to
  // its range. Kept for classes entered later. Errors: InvalidArgument: no class has it.
  virtual Status setParameter(const std::string& name, double value, bool at_once = false) = 0;
  virtual double parameter(const std::string& name) const = 0;  // shown value; NaN: no class has the parameter
  // Requests the best transition of the motion graph to another state: waits for the exit frame, then cross-fades.
  // Without a graph, or while paused: as selectSequence. During a transition: deferred until its end.
  virtual Status goTo(const std::string& state) = 0;
  virtual void allowTransitions() {}
  virtual bool inTransition() const { return false; }
  virtual std::string goal() const = 0;  // last requested state
  // Root motion moves the placement during playback; off (default): placement fixed.
  void setTravel(bool on) { root_motion_.setTravel(on); }
  void setPlacement(const motion::Placement& placement) { root_motion_.place(placement); }
  motion::Placement placement() const { return root_motion_.placement(); }
  void steer(double heading_rad) { root_motion_.steer(heading_rad); }  // reached at turn_rate_rad_s during playback
  virtual void setAlign(render::Align) {}  // default Baked; linear blend for a stream without alignment
  void setMethod(const render::MethodOptions& options) { method_ = options; }  // characters from cameras
  // Parameters as Ladder::setQuality. An explicit rendition replaces the picture on screen.
  virtual void setQuality(uint32_t /*rendition*/, uint32_t /*max_texels*/) {}
  // Measured throughput of the edge's own files, bits per second; call before loadManifest.
  virtual void expectThroughput(double /*bps*/) {}
  // Forwards to Ladder::judge. Numbers out of range are ignored.
  virtual void judgeRendition(uint32_t /*sequence*/, uint32_t /*rendition*/, bool /*plays*/) {}
  // Enables prefetching the beginnings of up to three other motions while the network is idle: at once, or once goTo or
  // selectSequence is called; a call since the first picture counts, too. Requires the automatic choice of renditions.
  virtual void lookAhead(bool /*at_once*/) {}

  // Limits geometry decoding per tick to the slice, ahead of time and nearest first, plus one row per due decoder: rows
  // of a GOP are decoded in order, so a frame may be some ticks late. Until the first call all rows up to a frame's are
  // decoded when it is due.
  virtual void sliceDecoding(const DecodeSlice&) {}
  // Geometry of layered characters decoded by the edge, in a worker; see Loading. Each tick updates the jobs.
  virtual void decodeElsewhere(bool) {}
  virtual std::optional<DecodeJob> decodeJob(size_t) { return {}; }
  virtual bool takeDecoded(uint32_t, uint32_t, std::span<const uint8_t>, double) { return false; }
  // Mesh for decoding jobs; null: no jobs.
  virtual const package::BaseMesh* mesh() const { return nullptr; }
  virtual const package::ChunkMesh* chunkMesh() const { return nullptr; }

  // Advances the clock to the edge's monotonic time and selects the frame to show.
  virtual void tick(double now_s) = 0;
  virtual bool nextRequest(Request& out) = 0;
  bool nextEvent(Event& out) { return outbox_.nextEvent(out); }

  virtual void onRangeReceived(uint32_t /*id*/, std::span<const uint8_t> /*bytes*/) {}
  virtual void onRangeFailed(uint32_t /*id*/, const std::string& /*reason*/) {}
  // Slot for a decoded picture; -1: none is free (keep the picture, retry after the next tick); -2: timestamp not
  // awaited (drop it). Slots are numbered over both decoders.
  virtual int acquireSlot(int decoder, int64_t timestamp_us) = 0;
  // Checks size and barcode. bytes: owner of the view's memory; kept until its upload is complete.
  virtual void uploadI420(int slot, const I420View& picture, PictureBytes bytes) = 0;
  virtual gpu::TextureId slotTexture(int slot) const = 0;  // Rgba kind: filled by the edge
  // Marks the slot as filled. Kind Rgba: takes the picture's size, and shows the picture once the frame number in its
  // pixels (package/barcode.h) has been read back from the GPU; other kinds ignore the size.
  virtual void commitSlot(int slot, int width = 0, int height = 0) = 0;
  // Pictures per second that a paced decoder should deliver; 0: only the picture of the last seek.
  virtual double pace(int /*decoder*/) const { return 0; }
  // Reports a decoder without further output. It is reconfigured at the GOP's key sample, a few times in a row.
  virtual void onDecoderFailed(int decoder, DecoderFault fault, const std::string& reason) = 0;
  // False: frees decoders and stops decoding; true: resumes from the shown frame.
  virtual void setInSight(bool in_sight) = 0;

  // True once tick has shown a complete frame (picture + geometry).
  virtual bool hasFrame() const = 0;
  // Figure for a recipe, to draw with others; valid until the next tick. Errors: InvalidArgument: no frame yet.
  virtual Result<render::Figure> figure() const = 0;
  render::Align align() const { return align_; }
  const render::MethodOptions& method() const { return method_; }
  // Makes one program that this character's motions will require; returns false if none is missing. Call when idle.
  virtual bool makeNextProgram(const render::RecipeOptions&) { return false; }
  // Draws this character alone.
  Status draw(const render::View& view, const render::RecipeOptions& options, gpu::TargetId target);

  virtual const package::Character* character() const = 0;  // null before the manifest is read
  virtual const package::Sequence* sequence() const = 0;
  virtual uint32_t frame() const = 0;      // shown frame index
  virtual double currentTime() const = 0;  // seconds in the sequence; its duration at the end
  // Clock position in the sequence, seconds, for synchronising sound; currentTime is the shown frame's. 0: none.
  virtual double clockTime() const { return 0; }
  // Ranges of the current sequence playable without a fetch, in order; nullopt after the last.
  virtual std::optional<TimeRange> buffered(size_t) const { return {}; }
  // Vertex of the base mesh in its shown position. Nullopt: no such vertex, no frame yet, or a character from cameras,
  // whose meshes change.
  virtual std::optional<SurfacePoint> surfacePoint(uint32_t) const { return {}; }
  // Nearest vertex to this pixel, of the face visible there; nullopt where there is no face.
  virtual std::optional<uint32_t> vertexAt(const PinholeCamera&, double, double) const { return {}; }
  bool paused() const { return !playback_.playing(); }
  virtual bool seeking() const = 0;  // requested sequence and frame not on screen yet
  virtual bool failed() const = 0;   // requested sequence unplayable, after an Error event
  virtual PlayerStats stats() const = 0;

 protected:
  Player(gpu::Device& device, const PlayerOptions& options, std::shared_ptr<render::Recipe> recipe, render::Align align)
      : device_(device),
        recipe_(std::move(recipe)),
        playback_(outbox_),
        checks_(device),
        root_motion_(options.turn_rate_rad_s),
        align_(align) {}

  gpu::Device& device_;
  std::shared_ptr<render::Recipe> recipe_;
  Outbox outbox_;
  Playback playback_;
  render::PictureChecks checks_;
  RootMotion root_motion_;
  FigureComposer composer_;
  render::Align align_;
  render::MethodOptions method_;
  PlayerStats stats_;  // counters kept by the player itself
};

}  // namespace fourdvt
