// SPDX-License-Identifier: Apache-2.0
// Plays a live stream of a performer from cameras: the edge passes the manifest and then every frame as it arrives.
// Shows the newest frame with both picture and surface, always of the same frame; older ones are skipped. Decoding
// starts at a key; after a gap, a lost decoder or too many queued frames the player waits for the next key. Holds at
// most a few frames.
// The edge handles connections, reconnects and the clock; there is no seeking. Order of calls as in player.h, with
// onLiveFrame in place of fetches.
// While paused, the player keeps the shown frame and goes on decoding, so that `play` shows the newest frame at once.
// Out of sight it keeps its decoder until the stream stops (onLiveGap).
#pragma once

#include <optional>
#include <vector>

#include "package/live_stream.h"
#include "player/parts/pictures.h"
#include "player/player.h"

namespace fourdvt {

class LivePlayer final : public Player {
 public:
  // Errors: InvalidArgument.
  static Result<std::unique_ptr<LivePlayer>> create(gpu::Device& device, std::shared_ptr<render::Recipe> recipe,
                                                    const PlayerOptions& options);

  // Processes one message of the stream, arbitrary bytes. Errors: as package::readLiveFrame; InvalidArgument: no
  // manifest yet. After an error the stream is unusable: reconnect. A surface that does not decode is an Error event.
  Status onLiveFrame(std::span<const uint8_t> bytes);
  // Connection lost or restarted: drops queued frames; the next frame must be a key.
  void onLiveGap();
  // Capture time of the shown frame, server clock, since 1970; 0: none shown.
  int64_t capturedUs() const { return hasFrame() ? shown_.captured_us : 0; }

  Status loadManifest(const FlatJson& manifest, std::span<const uint8_t> start) override;
  void play() override;
  void pause() override { playback_.pause(); }
  void seekFrame(uint32_t) override { seek(0); }
  void seek(double) override;  // no effect: live only
  Status selectSequence(const std::string& name) override;
  Status setParameter(const std::string& name, double, bool) override;
  double parameter(const std::string&) const override;
  Status goTo(const std::string& state) override { return selectSequence(state); }
  std::string goal() const override;
  void tick(double now_s) override;
  bool nextRequest(Request& out) override;
  int acquireSlot(int decoder, int64_t timestamp_us) override;
  void uploadI420(int slot, const I420View& picture, PictureBytes bytes) override;
  gpu::TextureId slotTexture(int slot) const override;
  void commitSlot(int slot, int width = 0, int height = 0) override;
  void onDecoderFailed(int decoder, DecoderFault fault, const std::string& reason) override;
  void setInSight(bool in_sight) override { in_sight_ = in_sight; }
  bool hasFrame() const override { return shown_.slot >= 0; }
  Result<render::Figure> figure() const override;
  const package::Character* character() const override { return live_ ? &live_->character : nullptr; }
  const package::Sequence* sequence() const override { return live_ ? &live_->character.sequences[0] : nullptr; }
  uint32_t frame() const override { return shown_.number; }
  double currentTime() const override;  // capture time since the first frame
  bool seeking() const override { return !hasFrame(); }
  bool failed() const override { return failed_; }
  PlayerStats stats() const override;

 private:
  // Received frame that is not shown yet; in order of arrival.
  struct Frame {
    int64_t serial = 0;  // picture's id for decoder and slots, unique
    uint32_t number = 0;
    bool key = false;
    int64_t captured_us = 0;
    std::vector<uint8_t> chunk, sample;
    bool fed = false;
    int slot = -1;     // slot of its picture; -1: none yet
    bool bad = false;  // picture must not be shown
  };
  struct Shown {
    int slot = -1;
    int64_t serial = -1;
    uint32_t number = 0;
    int64_t captured_us = 0;
  };

  LivePlayer(gpu::Device& device, std::shared_ptr<render::Recipe> recipe, const PlayerOptions& options);
  const package::Rendition& rendition() const { return sequence()->renditions[0]; }
  bool admit(bool key);
  void leaveOut(std::vector<Frame>::iterator first, std::vector<Frame>::iterator end);
  void forget();
  int freeSlotFor(int64_t serial);
  Frame* frameIn(int slot);
  bool checkSize(Frame& frame, int width, int height);
  bool checkNumber(Frame& frame, std::optional<uint32_t> seen);
  void finishSlot(int slot);
  void rejectPicture(Frame& frame, const char* reason);
  void lose(DecoderFault fault, const std::string& reason);
  void fail(Error error);
  bool showNewest();
  bool show(const Frame& frame);

  const bool on_gpu_;  // slot textures are filled by the edge
  const bool readable_;
  PictureSlots slots_;
  ShownFrame surface_;
  std::optional<package::LiveCharacter> live_;
  std::vector<Frame> frames_;
  std::vector<uint8_t> feeding_;  // sample last given to the edge
  std::optional<uint32_t> last_number_;
  int64_t next_serial_ = 0, fed_serial_ = -1, answered_serial_ = -1;
  bool needs_key_ = true, configured_ = false, in_sight_ = true, failed_ = false;
  int losses_ = 0, bad_pictures_ = 0;  // consecutive
  Shown shown_;
  int64_t first_captured_us_ = 0;
  double shown_at_s_ = 0;
};

}  // namespace fourdvt
