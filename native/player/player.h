// SPDX-License-Identifier: Apache-2.0
// Plays one character: decides what to fetch, what to decode, which frame to show, and composes what is drawn.
//
// Does: load, play, pause, seek, loop, rate, sequence choice; parameters of motion classes, transitions through the
// motion graph, root motion; pair decoded pictures with mesh chunks by timestamp and check the barcode; bound its
// memory by a window of GOPs. During a transition two sequences play, each with a decoder of its own
// (Request::decoder). Does NOT fetch, decode video, own a clock, touch the DOM or files: the edge (page or native tool)
// polls requests and feeds answers. Order of calls: create → loadManifest → { tick(now) → drain nextRequest/nextEvent →
// answers → draw } … Single-threaded. No call blocks.
//
// Words: a state is a node of the motion graph, that is a sequence or class as something to go to. A slot is a picture
// slot of a decoder. A look is one decoded picture on the figure's mesh; the figure is what a recipe draws.
//
// The player is made of parts (parts/), each with its own state and tests; player_impl.h brings them together.
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
  int picture_slots = 4;                      // decoded pictures kept on the GPU
  uint64_t encoded_budget_bytes = 16u << 20;  // fetched GOPs kept for loops
  render::PictureTextures::Kind picture_kind = render::PictureTextures::Kind::I420;
  // The decoders keep time themselves, at `pace`, and may leave pictures out or name a neighbour's timestamp (a <video>
  // element). With Kind::Rgba.
  bool paced = false;
  // With Kind::Rgba. False where the platform does not give back what its textures hold: a picture counts as that which
  // its timestamp names, without a check of its barcode.
  bool readable = true;
  double turn_rate_rad_s = 2.1;            // heading follows the wanted one at most this fast
  double parameter_rate = 1.5;             // a class's parameter crosses its whole range at most this often a second
  uint32_t rendition = kHighestRendition;  // that is played, as Ladder::setQuality takes it
  // A seek shows the key of the wanted frame's GOP until that frame is there, if the key is nearer to it than what is
  // shown.
  bool preview_seeks = false;
  // Without: motions are changed by cuts, until allowTransitions().
  bool transitions = true;
};

// Seconds in a sequence.
struct TimeRange {
  double start_s = 0, end_s = 0;
};

// World, metres; the normal is not of unit length, and points outwards.
struct SurfacePoint {
  glm::dvec3 position, normal;
};

struct PlayerStats {
  uint64_t frames_shown = 0;  // distinct presentations
  uint64_t frames_late = 0;   // presentations skipped because nothing was ready
  uint64_t barcode_checked = 0, barcode_mismatches = 0;
  uint64_t bytes_fetched = 0;
  uint64_t encoded_bytes_held = 0;
  uint32_t rendition = 0;  // of the picture shown, 0: the lowest
  DecodeStats decoded;
};

// A character of either kind, fetched or live. Methods that a live stream lacks do nothing by themselves.
class Player {
 public:
  static Result<std::unique_ptr<Player>> create(gpu::Device& device, const PlayerOptions& options);
  // Several characters on one device share programs and targets: they are drawn together by one recipe.
  static Result<std::unique_ptr<Player>> create(gpu::Device& device, std::shared_ptr<render::Recipe> recipe,
                                                const PlayerOptions& options);
  virtual ~Player() = default;

  // Starts loading; the first sequence (or `selectSequence` called before) is prepared at frame 0. start: the bytes of
  // the character's start file (package/start_file.h), if the edge has them: they show frame 0 before any fetch.
  virtual Status loadManifest(const FlatJson& gltf, std::span<const uint8_t> start = {}) = 0;
  // The base mesh is there, or none is needed: no fetch under way brings one in Draco's coding.
  virtual bool hasMesh() const { return true; }
  virtual void play() = 0;
  virtual void pause() = 0;
  virtual void seekFrame(uint32_t frame) = 0;  // of the current sequence, clamped; stays playing/paused
  virtual void seek(double time_s) = 0;
  virtual Status selectSequence(const std::string& name) = 0;  // keeps the old picture until the new one is ready
  virtual void setRate(double /*rate*/) {}                     // 0 <= rate <= 4; 0: plays, but the frame stays
  virtual void setLoop(int /*loop*/) {}                        // -1 as the sequence says, 0 never, 1 always

  // Parameters of classes, by name. The shown value glides to the wanted one (parameter_rate); a value outside its
  // range counts as the nearest. Kept for classes that are entered later. Errors: InvalidArgument: no class has it.
  virtual Status setParameter(const std::string& name, double value, bool at_once = false) = 0;
  virtual double parameter(const std::string& name) const = 0;  // as shown; NaN: no class has it
  // To another state by the best transition of the motion graph: waits for its exit frame, then cross-fades. Without a
  // graph, or while paused: as selectSequence. Asked again during a transition: taken up after it.
  virtual Status goTo(const std::string& state) = 0;
  virtual void allowTransitions() {}
  virtual bool inTransition() const { return false; }
  virtual std::string goal() const = 0;  // state asked for last
  // Root motion moves the placement while playing; off (default): the character stays where it is put.
  void setTravel(bool on) { root_motion_.setTravel(on); }
  void setPlacement(const motion::Placement& placement) { root_motion_.place(placement); }
  motion::Placement placement() const { return root_motion_.placement(); }
  void steer(double heading_rad) { root_motion_.steer(heading_rad); }  // reached at turn_rate_rad_s while playing
  virtual void setAlign(render::Align) {}  // default Baked; a stream without alignment is blended plainly
  void setMethod(const render::MethodOptions& options) { method_ = options; }  // of characters from cameras
  // Takes what Ladder::setQuality takes. The picture on screen comes anew in a rendition that was named.
  virtual void setQuality(uint32_t /*rendition*/, uint32_t /*most_texels*/) {}
  // Before loadManifest: bits per second at which the edge's own files came.
  virtual void expectThroughput(double /*bps*/) {}
  // Passes a judgement to Ladder::judge. Numbers out of range are ignored.
  virtual void judgeRendition(uint32_t /*sequence*/, uint32_t /*rendition*/, bool /*plays*/) {}
  // While nothing else is on its way, the beginnings of up to three other motions are fetched: at once, or after a goTo
  // or selectSequence, be it the next or one that has come since the first picture. Only with an automatic choice of
  // renditions.
  virtual void lookAhead(bool /*at_once*/) {}

  // From now on a tick decodes no more geometry than the slice allows, ahead of time and nearest first, and one row for
  // each decoder that is due: rows of a GOP are decoded in order, so a frame may have to wait for some ticks. Before,
  // and on edges that never call it, all rows as far as a frame's are decoded when it is due.
  virtual void sliceDecoding(const DecodeSlice&) {}
  // Geometry of layered characters that the edge decodes beside the player, in a worker; see Loading. After each tick
  // the jobs are those that are wanted then.
  virtual void decodeElsewhere(bool) {}
  virtual std::optional<DecodeJob> decodeJob(size_t) { return {}; }
  virtual bool takeDecoded(uint32_t, uint32_t, std::span<const uint8_t>, double) { return false; }
  // Meshes that jobs are decoded with; null: there will be no jobs.
  virtual const package::BaseMesh* mesh() const { return nullptr; }
  virtual const package::ChunkMesh* chunkMesh() const { return nullptr; }

  // Advances the clock to the edge's monotonic time and chooses the frame to show.
  virtual void tick(double now_s) = 0;
  virtual bool nextRequest(Request& out) = 0;
  bool nextEvent(Event& out) { return outbox_.nextEvent(out); }

  virtual void onRangeReceived(uint32_t /*id*/, std::span<const uint8_t> /*bytes*/) {}
  virtual void onRangeFailed(uint32_t /*id*/, const std::string& /*reason*/) {}
  // A decoded picture wants a slot: -1 if none is free now (hold the picture and ask again after the next tick), -2 if
  // nobody waits for that timestamp any more (drop it).
  // Slots are numbered over both decoders.
  virtual int acquireSlot(int decoder, int64_t timestamp_us) = 0;
  // Also checks size and barcode. bytes: what the view is into; kept until no more of it is to be uploaded.
  virtual void uploadI420(int slot, const I420View& picture, PictureBytes bytes) = 0;
  virtual gpu::TextureId slotTexture(int slot) const = 0;  // Rgba kind: the edge fills it itself
  // The slot is filled; Rgba kind: with a picture of this size, whose barcode is read from the GPU before it counts.
  virtual void commitSlot(int slot, int width = 0, int height = 0) = 0;
  // Paced decoders: pictures a second that this one should give now; 0: none but one that is sought.
  virtual double pace(int /*decoder*/) const { return 0; }
  // The decoder gives nothing any more. It is configured anew at the GOP's key sample, a few times in a row.
  virtual void onDecoderFailed(int decoder, DecoderFault fault, const std::string& reason) = 0;
  // Out of sight no decoder is held and nothing is decoded; back in sight playing goes on from the shown frame.
  virtual void setInSight(bool in_sight) = 0;

  // True once a complete frame (picture + geometry) has been shown by tick.
  virtual bool hasFrame() const = 0;
  // Figure for a recipe, to draw it with others; valid until the next tick. Errors: InvalidArgument: no frame yet.
  virtual Result<render::Figure> figure() const = 0;
  render::Align align() const { return align_; }
  const render::MethodOptions& method() const { return method_; }
  // Makes one of the programs that this character's motions will need, before one of them does; false: none is missing.
  // For moments when nothing else is to be done.
  virtual bool makeNextProgram(const render::RecipeOptions&) { return false; }
  // This character alone.
  Status draw(const render::View& view, const render::RecipeOptions& options, gpu::TargetId target);

  virtual const package::Character* character() const = 0;  // null before the manifest is read
  virtual const package::Sequence* sequence() const = 0;
  virtual uint32_t frame() const = 0;      // shown frame index
  virtual double currentTime() const = 0;  // seconds in the sequence; at the end its duration
  // Seconds in the sequence as its clock runs: what sound keeps to. currentTime is that of the frame shown. 0: none.
  virtual double clockTime() const { return 0; }
  // The ranges of the current sequence that can be played without a fetch, in their order; none after the last.
  virtual std::optional<TimeRange> buffered(size_t) const { return {}; }
  // A vertex of the base mesh as it is shown. None: there is no such vertex, no frame yet, or the character is from
  // cameras, whose meshes change.
  virtual std::optional<SurfacePoint> surfacePoint(uint32_t) const { return {}; }
  // The vertex nearest to this pixel, of the face that is seen there; none where no face is.
  virtual std::optional<uint32_t> vertexAt(const PinholeCamera&, double, double) const { return {}; }
  bool paused() const { return !playback_.playing(); }
  virtual bool seeking() const = 0;  // the wanted sequence and frame are not on screen yet
  virtual bool failed() const = 0;   // the wanted sequence cannot be played; an Error event has said why
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
  PlayerStats stats_;  // without what is counted elsewhere
};

}  // namespace fourdvt
