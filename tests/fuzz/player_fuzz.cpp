// SPDX-License-Identifier: Apache-2.0
// Drives the player with a damaged or hostile folder and with calls in any order.
// Input:
//   number of edits; for each edit: file, offset (2 bytes), kind, value
//   flags: 1: update the files' hashes after the edits, 2: allow characters from cameras
//   events: kind, operand (1 byte each) until the end
// Checks for every input: shown frames can be drawn, memory is bounded, the device receives no invalid call. Without
// edits also: picture and geometry on screen are of one frame, except in a cross-fade.
#include <cstdlib>
#include <deque>

#include "../unit/player_fixture.h"
#include "../unit/simulated_worker.h"
#include "base/camera.h"
#include "player/player.h"

using namespace fourdvt;
using namespace fourdvt::testing;

namespace {

constexpr uint64_t kBudget_bytes = 64u << 10;
constexpr uint64_t kMaxHeld_bytes = 1u << 20;  // the budget, and the GOPs in use
constexpr int kMaxEvents = 2000;
constexpr size_t kMaxWaiting = 64;

void require(bool condition) {
  if (!condition) std::abort();
}

class Input {
 public:
  explicit Input(std::span<const uint8_t> bytes) : bytes_(bytes) {}
  bool ended() const { return at_ >= bytes_.size(); }
  uint8_t u8() { return ended() ? 0 : bytes_[at_++]; }
  uint32_t u16() { return uint32_t(u8()) | uint32_t(u8()) << 8; }

 private:
  std::span<const uint8_t> bytes_;
  size_t at_ = 0;
};

const FakeCharacter& honest() {
  static const FakeCharacter character = [] {
    FakeCharacter made = FakeBuilder().build({{"walk", 14, 5, 25, true, 192, 16, {}, 2},
                                              {"speed", 12, 6, 25, true, 192, 16, {{1, 1, {}}, {2, 0.5, {}}}},
                                              {"pickup", 9, 9, 30, false, 192, 16}});
    FakeBuilder::addGraph(
        made, [](uint32_t, uint32_t frame, uint32_t target) { return motion::Entry{.frame = (frame + target) % 9}; });
    return made;
  }();
  return character;
}

// Changes files or numbers of the manifest. Returns true if anything differs.
bool edit(FakeCharacter& character, Input& in) {
  static const char* const kNumbers[] = {"/sequences/0/frameCount",
                                         "/sequences/0/stream/byteLength",
                                         "/sequences/0/stream/headerLength",
                                         "/sequences/1/renditions/0/byteLength",
                                         "/sequences/1/renditions/0/width",
                                         "/sequences/2/fps",
                                         "/vertexCount",
                                         "/faceCount",
                                         "/mesh/byteOffset",
                                         "/graph/byteLength",
                                         "/layerCount",
                                         "/sequences/1/referenceCount"};
  const int edits = in.u8() % 8;
  for (int i = 0; i < edits; ++i) {
    auto file = character.files.begin();
    std::advance(file, in.u8() % character.files.size());
    const uint32_t offset = in.u16();
    const uint8_t kind = in.u8(), value = in.u8();
    std::vector<uint8_t>& bytes = file->second;
    const size_t at = bytes.empty() ? 0 : offset % bytes.size();
    if (kind % 4 == 0 && !bytes.empty()) bytes[at] = value;
    if (kind % 4 == 1) bytes.resize(at);
    if (kind % 4 == 2) bytes.insert(bytes.begin() + long(at), value);
    if (kind % 4 == 3)
      character.manifest.set(
          std::string("/extensions/") + package::kExtensionName + kNumbers[value % std::size(kNumbers)],
          kind & 4 ? double(offset) : double(offset) * 1e6);
  }
  return edits > 0;
}

// Device and programs, shared by kMaxInputs inputs.
struct Gpu {
  static constexpr int kMaxInputs = 256;
  TaggingDevice device;
  std::shared_ptr<render::Recipe> recipe = render::Recipe::create(device).take();
  int inputs = 0;

  static Gpu& take() {
    static std::unique_ptr<Gpu> gpu;
    if (!gpu || ++gpu->inputs > kMaxInputs) gpu = std::make_unique<Gpu>();
    return *gpu;
  }
};

// Simulates the page: answers the player's requests at events of the input, in the input's order.
class Page {
 public:
  Page(const FakeCharacter& character, bool is_honest) : character_(character), honest_(is_honest) {
    PlayerOptions options{.encoded_budget_bytes = kBudget_bytes, .preview_seeks = true};
    player_ = Player::create(device_, gpu_.recipe, options).take();
  }

  void run(Input& in) {
    if (!player_->loadManifest(character_.manifest).ok()) return;
    for (int i = 0; i < kMaxEvents && !in.ended(); ++i) {
      event(in.u8(), in.u8());
      collect();
      require(player_->stats().encoded_bytes_held <= kMaxHeld_bytes);
    }
    require(device_.takeErrors().empty());
  }

 private:
  void event(uint8_t what, uint8_t value) {
    static const char* const kNames[] = {"walk", "speed", "pickup", "nothing"};
    const std::string name = kNames[value % 4];
    switch (what % 20) {
      case 0:
      case 1:
        player_->tick(now_s_ += value / 500.0);
        break;
      case 2:
      case 3:
        answer(value);
        break;
      case 4:
      case 5:
        picture(value);
        break;
      case 6:
        player_->seekFrame(value);
        break;
      case 7:
        player_->seek((value - 20) / 30.0);
        break;
      case 8:
        (void)player_->selectSequence(name);
        break;
      case 9:
        (void)player_->goTo(name);
        break;
      case 10:
        value % 2 ? player_->play() : player_->pause();
        break;
      case 11:
        player_->setRate((1 + value) / 64.0);
        break;
      case 12:
        player_->setLoop(value % 3 - 1);
        break;
      case 13:
        (void)player_->setParameter(value % 8 ? "speed_mps" : "none", value / 100.0, value % 3 == 0);
        break;
      case 14:
        player_->onDecoderFailed(value % kDecoders, DecoderFault(value / 2 % 3), "fuzz");
        break;
      case 15:
        player_->setInSight(value % 2);
        break;
      case 16:
        player_->setQuality(value % 4 ? value % 4 - 1u : kHighestRendition, value % 5 ? 1u << 20 : value);
        break;
      case 17:
        if (value % 4 == 0) player_->sliceDecoding({.steps = 1u + value % 7});
        player_->lookAhead(value % 2), player_->judgeRendition(value % 5, value / 5 % 4, value % 2);
        break;
      case 18:
        player_->setTravel(value % 2), player_->steer(value / 40.0);
        if (value % 4 == 1) fromWorker(value / 4);
        break;
      default:
        draw();
    }
  }

  // Geometry from a worker: on, off, frames of a wrong size or of no job, or valid ones.
  void fromWorker(int value) {
    const std::optional<DecodeJob> job = player_->decodeJob(size_t(value % 3));
    const std::vector<uint8_t> bytes(static_cast<size_t>(value), 7);
    switch (value % 8) {
      case 0:
        player_->sliceDecoding({.steps = 1u + uint32_t(value) % 7});
        player_->decodeElsewhere(true);
        break;
      case 1:
        player_->decodeElsewhere(value > 32);
        break;
      case 2:
        player_->takeDecoded(job ? job->id : uint32_t(value), uint32_t(value) / 8 % 4, bytes, 0);
        break;
      default:
        if (!player_->chunkMesh()) break;
        worker_.answer(*player_, now_s_);
        worker_.work(*player_, *player_->chunkMesh(), now_s_);
    }
  }

  void collect() {
    for (Request request; player_->nextRequest(request);) {
      if (auto* fetch = std::get_if<FetchRange>(&request)) {
        require(!fetch->uri.empty() && fetch->bytes > 0 && fetch->offset + fetch->bytes > fetch->offset);
        fetches_.push_back(*fetch);
      }
      if (auto* cancel = std::get_if<CancelFetch>(&request))
        std::erase_if(fetches_, [&](const FetchRange& fetch) { return fetch.id == cancel->id; });
      if (auto* sample = std::get_if<DecodeSample>(&request)) {
        require(!sample->bytes.empty() && sample->decoder >= 0 && sample->decoder < kDecoders);
        uint32_t frame = 0;
        if (sample->bytes.size() >= 8) std::memcpy(&frame, sample->bytes.data() + 4, 4);
        samples_.push_back({sample->decoder, sample->timestamp_us, frame});
        if (samples_.size() > kMaxWaiting) samples_.pop_front();
      }
    }
    for (Event event; player_->nextEvent(event);)
      if (event.kind == EventKind::Error) require(!event.error.message.empty());
  }

  void answer(uint8_t value) {
    if (fetches_.empty()) return player_->onRangeFailed(value, "fuzz");  // not requested
    const size_t which = value % fetches_.size();
    const FetchRange fetch = fetches_[which];
    if (value != 255) fetches_.erase(fetches_.begin() + long(which));  // else it is answered again
    const auto file = character_.files.find(fetch.uri);
    if (file == character_.files.end() || fetch.offset + fetch.bytes > file->second.size() || value % 32 == 31)
      return player_->onRangeFailed(fetch.id, "fuzz");
    player_->onRangeReceived(fetch.id, std::span(file->second).subspan(size_t(fetch.offset), size_t(fetch.bytes)));
  }

  // Delivers the oldest or the newest requested picture; one of another size only with an edited folder.
  void picture(uint8_t value) {
    if (samples_.empty()) return;
    const Sample sample = value % 4 ? samples_.front() : samples_.back();
    const int slot = player_->acquireSlot(sample.decoder, sample.timestamp_us);
    if (slot == -1) return;
    value % 4 ? samples_.pop_front() : samples_.pop_back();
    if (slot < 0) return;
    const int width = value % 16 == 15 && !honest_ ? 64 : player_->sequence()->renditions.back().width, height = 16;
    const auto planes = std::make_shared<std::vector<uint8_t>>(size_t(width) * size_t(height), uint8_t{80});
    uint8_t* luma = planes->data();
    if (width >= 128) package::drawBarcode(fakeStrip(), sample.frame, luma, width);
    const uint8_t* v = value % 8 < 4 ? luma : nullptr;
    player_->uploadI420(slot, {width, height, luma, luma, v, width, v ? width / 2 : width, width / 2}, planes);
    player_->commitSlot(slot);
  }

  void draw() {
    if (!player_->hasFrame()) return;
    require(player_->figure().ok());
    device_.drawn = {};
    const render::View view = render::viewFromCamera(cameraFromOrbit({}, 16, 16));
    auto target = gpu::makeTarget(device_, {.width = 16, .height = 16, .own_depth = true});
    (void)player_->draw(view, {}, target.value().id());
    // A cross-fade draws two pictures on a mixture of their meshes.
    if (honest_ && !player_->inTransition() && device_.drawn.picture_frame >= 0)
      require(device_.drawn.picture_frame == device_.drawn.geometry_frame);
  }

  struct Sample {
    int decoder;
    int64_t timestamp_us;
    uint32_t frame;
  };
  const FakeCharacter& character_;
  const bool honest_;
  Gpu& gpu_ = Gpu::take();
  TaggingDevice& device_ = gpu_.device;
  std::unique_ptr<Player> player_;
  std::vector<FetchRange> fetches_;
  std::deque<Sample> samples_;
  SimulatedWorker worker_;
  double now_s_ = 0;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  Input in({data, size});
  FakeCharacter character = honest();
  const bool is_edited = edit(character, in);
  const uint8_t flags = in.u8();
  if (flags & 1) rehash(character);
  Page(character, !is_edited).run(in);
  return 0;
}
