// SPDX-License-Identifier: Apache-2.0
// Simulated edge: seeded latencies, fetches that fail or arrive out of order, a decoder that reorders with a delay of
// two pictures and delivers some stale pictures after a reset, copies that take time.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <deque>
#include <optional>
#include <random>
#include <set>

#include "player/player.h"
#include "player_fixture.h"

namespace fourdvt::testing {

struct EdgeOptions {
  uint32_t seed = 1;
  double fetch_latency_s = 0.05, decode_latency_s = 0.004, copy_latency_s = 0.003;  // maxima, uniform from 0
  std::vector<double> decode_s;  // by rendition, per picture; replaces the latency
  double bits_per_s = 0;         // shared by all fetches, which are sent one by one; 0: no limit
  double fetch_failure = 0;      // probability
  double stale_delivery = 0.5;   // probability that a picture survives a reset
  int reorder_delay = 2;
  int wrong_picture_every = 0;  // every n-th picture shows a wrong frame (0: never)
  // Paced decoders: probabilities that a picture is labelled as a neighbour, and that it is missing.
  double misnamed = 0, left_out = 0;
  double early_seeks = 0;  // probability that a seek's picture is offered while the element still shows another
  bool interleaved_chroma = false;  // as in NV12
  uint32_t min_decoded = 1;         // minimum decoded pictures ahead for an element to advance
  PlayerOptions player;
};

class SimulatedEdge {
 public:
  SimulatedEdge(const FakeCharacter& character, const EdgeOptions& options)
      : options(options), character_(character), random_(options.seed) {
    auto made = Player::create(device, options.player);
    EXPECT_TRUE(made.ok());
    player = made.take();
  }

  EdgeOptions options;
  TaggingDevice device;
  std::unique_ptr<Player> player;
  std::map<EventKind, int> events;
  std::vector<Error> errors, warnings;
  std::vector<Event> progress;
  double now_s = 0;
  int max_slots_busy = 0, requests_after_error = 0, flushes = 0, stale_answers = 0, closes = 0;
  bool second_decoder_fails = false;
  bool wrong_sizes = false;  // of the pictures that the edge puts into textures
  bool offline = false;      // fetches wait until it is false
  uint64_t max_bytes_held = 0, bytes_asked = 0;
  std::multiset<std::string> uris;  // requested

  void step(double dt_s) {
    now_s += dt_s;
    answerFetches();
    finishCopies();
    offerPictures();
    player->tick(now_s);
    for (Request request; player->nextRequest(request);) take(request);
    for (Event event; player->nextEvent(event);) note(event);
    max_bytes_held = std::max(max_bytes_held, player->stats().encoded_bytes_held);
  }
  // Runs until the condition holds; false after `limit_s`.
  template <class Condition>
  bool runUntil(Condition condition, double limit_s = 20) {
    for (const double end_s = now_s + limit_s; now_s < end_s;) {
      step(0.008);
      if (condition()) return true;
    }
    return condition();
  }
  bool runUntilShown() {
    return runUntil([&] { return player->hasFrame() && !player->seeking(); });
  }
  // Loads the manifest and runs until the first picture is shown.
  bool load(std::span<const uint8_t> start = {}) {
    return player->loadManifest(character_.manifest, start).ok() && runUntilShown();
  }
  // Frames that the shown picture and geometry are tagged with, by one draw.
  TaggingDevice::Drawn draw() {
    device.drawn = {};
    render::View view = render::viewFromCamera(cameraFromOrbit({}, 32, 32));
    auto target = gpu::makeTarget(device, {.width = 32, .height = 32, .own_depth = true});
    EXPECT_TRUE(player->draw(view, {}, target.value().id()).ok());
    EXPECT_EQ(device.takeErrors(), "");
    return device.drawn;
  }
  void expectPaired() {
    const TaggingDevice::Drawn drawn = draw();
    EXPECT_EQ(drawn.picture_frame, drawn.geometry_frame);
    EXPECT_EQ(drawn.picture_frame, int(player->frame()));
    const FakeSequence& sequence = character_.sequences[size_t(std::max(0, drawn.geometry_sequence))];
    EXPECT_EQ(drawn.picture_width, sequence.widthOf(options.player.rendition));
    if (!player->seeking()) {
      EXPECT_EQ(sequence.name, player->sequence()->name);
    }
  }
  // Plays a sequence of `frames` frames `loops` times: expects every frame, in order, with matching picture and
  // geometry.
  void expectEveryFrame(uint32_t frames, uint32_t loops) {
    uint32_t last = player->frame(), advances = 0;
    while (advances < frames * loops && now_s < 60) {
      step(0.005);
      if (player->frame() == last) continue;
      EXPECT_EQ(player->frame(), (last + 1) % frames);
      last = player->frame();
      ++advances;
      expectPaired();
    }
    EXPECT_EQ(advances, frames * loops);
  }
  // Seeks every frame of every sequence: expects exactly that frame, with matching picture and geometry. No count of
  // frames may be a multiple of 11.
  void expectExactSeeks() {
    for (const FakeSequence& sequence : character_.sequences) {
      ASSERT_TRUE(player->selectSequence(sequence.name).ok());
      for (uint32_t i = 0; i < sequence.frames; ++i) {
        const uint32_t frame = i * 11 % sequence.frames;
        player->seekFrame(frame);
        ASSERT_TRUE(runUntilShown()) << sequence.name << " " << frame;
        ASSERT_EQ(player->frame(), frame);
        expectPaired();
      }
    }
  }
  // Closes a decoder as a browser does; its pictures are lost.
  void loseDecoder(int number, DecoderFault fault) {
    reset(decoders_[size_t(number)]);
    decoders_[size_t(number)].open = false;
    player->onDecoderFailed(number, fault, "simulated");
  }
  void replaceFile(const std::string& uri, std::vector<uint8_t> bytes) { character_.files[uri] = std::move(bytes); }
  bool isOpen(int number) const { return decoders_[size_t(number)].open; }
  int openDecoders() const {
    return int(std::count_if(decoders_.begin(), decoders_.end(), [](const Decoder& d) { return d.open; }));
  }
  double uniform(double high) { return std::uniform_real_distribution<double>(0, high)(random_); }
  uint32_t below(uint32_t n) { return random_() % n; }
  // Randomly seeks, or sets rate, motion or speed_mps; mostly just plays. Needs the motions `walk` and `go`.
  void command() {
    switch (below(80)) {
      case 0:
        player->seekFrame(below(40));
        break;
      case 1:
        player->setRate(0.25 + uniform(3.7));
        break;
      case 2:
        ASSERT_TRUE(player->goTo(below(2) ? "walk" : "go").ok());
        break;
      case 3:
        EXPECT_TRUE(player->setParameter("speed_mps", 1 + uniform(1), false).ok());
        break;
      default:
        if (player->paused()) player->play();
    }
  }
  std::vector<FetchRange> pendingFetches() const {
    std::vector<FetchRange> out;
    for (const PendingFetch& fetch : fetches_) out.push_back(fetch.range);
    return out;
  }

 private:
  double network_free_s_ = 0;
  struct PendingFetch {
    FetchRange range;
    double due_s, end_s, transfer_s;  // time of the answer, and of its last byte; transfer time of its bytes
  };
  struct Decoded {
    int64_t timestamp_us;
    uint32_t sequence, rendition, frame;
    double due_s;
    bool wanted;
  };
  struct Decoder {
    bool open = false, needs_key = true;
    uint32_t sequence = 99, rendition = 99;
    std::map<int64_t, std::pair<uint32_t, uint32_t>> reorder;
    std::deque<Decoded> decoded;
    size_t stale_from = 0;
    // Paced: it shows its front picture, which has not been offered yet; frames it should have advanced since.
    bool stands = false, fresh = false, flushed = false;
    double ahead = 0, stood_s = 0, moved_s = 0, offered_s = 0;
    std::set<int64_t> unwanted;
  };
  struct Copy {
    int slot;
    Decoded picture;
    double due_s;
  };

  void take(const Request& request) {
    if (!errors.empty()) ++requests_after_error;
    if (auto* fetch = std::get_if<FetchRange>(&request)) {
      const double transfer_s = options.bits_per_s > 0 ? 8 * double(fetch->bytes) / options.bits_per_s : 0;
      network_free_s_ = std::max(network_free_s_, now_s) + transfer_s;
      fetches_.push_back({*fetch, network_free_s_ + uniform(options.fetch_latency_s), network_free_s_, transfer_s});
      bytes_asked += fetch->bytes;
      uris.insert(fetch->uri);
    } else if (auto* cancel = std::get_if<CancelFetch>(&request)) {
      cancelFetch(cancel->id);
    } else if (auto* configure = std::get_if<ConfigureDecoder>(&request)) {
      Decoder& decoder = decoders_[size_t(configure->decoder)];
      reset(decoder);
      EXPECT_EQ(configure->description.size(), 2u);
      decoder.rendition = configure->description[0];
      decoder.sequence = configure->description[1];
      if (second_decoder_fails && openDecoders() == 1 && !decoder.open) {
        player->onDecoderFailed(configure->decoder, DecoderFault::Unsupported, "only one decoder");
        return;
      }
      decoder.open = true;
    } else if (auto* sample = std::get_if<DecodeSample>(&request)) {
      decode(decoders_[size_t(sample->decoder)], *sample);
    } else if (auto* flush = std::get_if<FlushDecoder>(&request)) {
      ++flushes;
      Decoder& decoder = decoders_[size_t(flush->decoder)];
      while (!decoder.reorder.empty()) output(decoder);
      decoder.needs_key = decoder.flushed = true;
    } else if (auto* forget = std::get_if<ResetDecoder>(&request)) {
      EXPECT_TRUE(decoders_[size_t(forget->decoder)].open);
      reset(decoders_[size_t(forget->decoder)]);
    } else if (auto* close = std::get_if<CloseDecoder>(&request)) {
      ++closes;
      reset(decoders_[size_t(close->decoder)]);
      decoders_[size_t(close->decoder)].open = false;
    }
  }
  // Frees the network time of a cancelled fetch that has not been sent yet.
  void cancelFetch(uint32_t id) {
    const auto at =
        std::find_if(fetches_.begin(), fetches_.end(), [&](const PendingFetch& f) { return f.range.id == id; });
    if (at == fetches_.end()) return;
    const double end_s = at->end_s, freed_s = std::clamp(end_s - now_s, 0.0, at->transfer_s);
    fetches_.erase(at);
    network_free_s_ -= freed_s;
    for (PendingFetch& f : fetches_)
      if (f.end_s > end_s) f.end_s -= freed_s, f.due_s -= freed_s;
  }
  void reset(Decoder& decoder) {
    decoder.reorder.clear();
    if (options.player.paced) decoder.decoded.clear();
    decoder.stands = decoder.fresh = decoder.flushed = false;
    std::erase_if(decoder.decoded, [&](const Decoded& d) { return !d.wanted || uniform(1) > options.stale_delivery; });
    for (Decoded& stale : decoder.decoded) stale.due_s = now_s;  // they were under way; nothing waits behind them
    decoder.stale_from = decoder.decoded.size();
    decoder.needs_key = true;
  }
  void decode(Decoder& decoder, const DecodeSample& sample) {
    uint32_t sequence = 0, frame = 0;
    ASSERT_GE(sample.bytes.size(), 9u);
    std::memcpy(&sequence, sample.bytes.data(), 4);
    std::memcpy(&frame, sample.bytes.data() + 4, 4);
    if (!decoder.open) return;  // failed: pictures in flight are lost
    EXPECT_EQ(sequence, decoder.sequence);
    EXPECT_EQ(sample.bytes[8] == 1, sample.key);
    EXPECT_EQ(sample.bytes[9], decoder.rendition);
    if (decoder.needs_key) {
      EXPECT_TRUE(sample.key) << "decoding must start at a key";
    }
    decoder.needs_key = decoder.flushed = false;
    if (!sample.wanted) decoder.unwanted.insert(sample.timestamp_us);
    EXPECT_FALSE(decoder.reorder.count(sample.timestamp_us));
    decoder.reorder[sample.timestamp_us] = {sequence, frame};
    if (int(decoder.reorder.size()) > options.reorder_delay) output(decoder);
  }
  void output(Decoder& decoder) {
    const auto first = decoder.reorder.begin();
    auto [sequence, frame] = first->second;
    if (options.wrong_picture_every && ++pictures_ % options.wrong_picture_every == 0) frame ^= 1;
    const double after_s = decoder.decoded.empty() ? now_s : decoder.decoded.back().due_s;
    decoder.decoded.push_back(
        {first->first, sequence, decoder.rendition, frame,
         std::max(now_s, after_s) +
             (options.decode_s.empty() ? uniform(options.decode_latency_s) : options.decode_s[decoder.rendition]),
         decoder.unwanted.erase(first->first) == 0});
    decoder.reorder.erase(first);
  }
  void answerFetches() {
    std::shuffle(fetches_.begin(), fetches_.end(), random_);
    for (size_t i = 0; i < fetches_.size();) {
      if (fetches_[i].due_s > now_s) {
        ++i;
        continue;
      }
      if (offline || uniform(1) < options.fetch_failure) {  // temporary: the edge retries
        fetches_[i++].due_s = now_s + 0.2;
        continue;
      }
      const FetchRange range = fetches_[i].range;
      fetches_.erase(fetches_.begin() + long(i));
      const auto file = character_.files.find(range.uri);
      const bool there = file != character_.files.end() && range.offset + range.bytes <= file->second.size();
      if (!there) {
        player->onRangeFailed(range.id, "simulated");
      } else {
        player->onRangeReceived(range.id, std::span(file->second).subspan(range.offset, range.bytes));
      }
    }
  }
  void offerPictures() {
    for (int d = 0; d < kDecoders; ++d) {
      if (options.player.paced)
        runElement(d, decoders_[size_t(d)]);
      else
        offerPictures(d, decoders_[size_t(d)]);
    }
  }
  // A <video> element: after a seek it shows the first wanted picture, then runs at the player's pace. It stops at a
  // picture for which no slot is free.
  void runElement(int number, Decoder& decoder) {
    auto& waiting = decoder.decoded;
    while (!waiting.empty() && !waiting.front().wanted) waiting.pop_front();
    if (!decoder.stands && !waiting.empty() && (decoder.flushed || waiting.size() >= options.min_decoded)) {
      decoder.stands = decoder.fresh = true;
      decoder.stood_s = now_s;
      decoder.ahead = 0;
    }
    if (!decoder.stands) return;
    if (!decoder.fresh) {
      decoder.ahead += player->pace(number) * (now_s - decoder.moved_s);
      for (; decoder.ahead >= 1 && waiting.size() > 1; decoder.ahead -= 1) {
        waiting.pop_front();
        decoder.fresh = true;
      }
      decoder.ahead = std::min(decoder.ahead, 1.0);
      if (decoder.fresh && waiting.size() > 1 && uniform(1) < options.left_out) waiting.pop_front();
    }
    decoder.moved_s = now_s;
    if (!decoder.fresh && player->pace(number) <= 0 && now_s > decoder.offered_s + 0.08) decoder.fresh = true;
    if (!decoder.fresh) return;
    Decoded picture = waiting.front();
    // After a seek the first picture is the requested one.
    const bool misnamed = decoder.moved_s > decoder.stood_s && uniform(1) < options.misnamed;
    const int64_t off = misnamed ? (below(2) ? 40000 : -40000) : 0;
    const int slot = player->acquireSlot(number, picture.timestamp_us + off);
    if (slot == -1) return;
    decoder.fresh = false;
    decoder.offered_s = now_s;
    if (player->seeking() && uniform(1) < options.early_seeks) picture.frame ^= 1;
    if (slot >= 0) copies_.push_back({slot, picture, now_s});
  }
  void offerPictures(int number, Decoder& decoder) {
    while (!decoder.decoded.empty() && decoder.decoded.front().due_s <= now_s) {
      const Decoded picture = decoder.decoded.front();
      if (!picture.wanted) {
        decoder.decoded.pop_front();
        decoder.stale_from -= decoder.stale_from > 0;
        continue;
      }
      const int slot = player->acquireSlot(number, picture.timestamp_us);
      if (slot == -1) return;
      const bool stale = decoder.stale_from > 0;
      if (stale) --decoder.stale_from, ++stale_answers;
      decoder.decoded.pop_front();
      if (slot < 0) continue;
      EXPECT_FALSE(stale) << "a picture from before a reset got a slot";
      for (const Copy& copy : copies_) EXPECT_NE(copy.slot, slot) << "a slot was given twice";
      copies_.push_back({slot, picture, now_s + uniform(options.copy_latency_s)});
      max_slots_busy = std::max(max_slots_busy, int(copies_.size()));
    }
  }
  void finishCopies() {
    while (!copies_.empty() && copies_.front().due_s <= now_s) {
      const Copy copy = copies_.front();
      copies_.pop_front();
      const FakeSequence& sequence = character_.sequences[copy.picture.sequence];
      const int w = sequence.widthOf(copy.picture.rendition), h = sequence.height;
      if (options.player.picture_kind == render::PictureTextures::Kind::Rgba) {
        device.fill(player->slotTexture(copy.slot), int(copy.picture.frame));
        player->commitSlot(copy.slot, wrong_sizes ? w / 2 : w, h);
        continue;
      }
      const auto planes = std::make_shared<std::vector<uint8_t>>(size_t(w) * h, 80);
      const uint8_t* y = planes->data();
      package::drawBarcode(fakeStrip(), copy.picture.frame, planes->data(), w);
      const I420View view{
          w, h, y, y, options.interleaved_chroma ? nullptr : y, w, options.interleaved_chroma ? w : w / 2, w / 2};
      player->uploadI420(copy.slot, view, planes);
      player->commitSlot(copy.slot);
    }
  }
  void note(const Event& event) {
    ++events[event.kind];
    if (event.kind == EventKind::Error) errors.push_back(event.error);
    if (event.kind == EventKind::Warning) warnings.push_back(event.error);
    if (event.kind == EventKind::Progress) progress.push_back(event);
  }

  FakeCharacter character_;
  std::mt19937 random_;
  std::vector<PendingFetch> fetches_;
  std::array<Decoder, kDecoders> decoders_;
  std::deque<Copy> copies_;
  int pictures_ = 0;
};

}  // namespace fourdvt::testing
