// SPDX-License-Identifier: Apache-2.0
// Messages between a player and its edge (the page, or a native tool): requests that the edge carries out, events
// that it passes on, the queue of both, and the byte ranges that are on their way. Does NOT carry anything out.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "base/result.h"

namespace fourdvt {

// Keeps the planes of a decoded picture in memory until it is let go.
using PictureBytes = std::shared_ptr<const void>;

// Work for the edge. Spans stay valid until the next call of any non-const method of the player.
struct FetchRange {  // answer: onRangeReceived / onRangeFailed
  uint32_t id = 0;
  std::string uri;  // relative to the manifest
  uint64_t offset = 0, bytes = 0;
};
struct CancelFetch {
  uint32_t id = 0;
};
// Decoder requests name one of kDecoders; the second is used only around transitions.
constexpr int kDecoders = 2;
struct ConfigureDecoder {  // drop everything queued, then configure
  int decoder = 0;
  std::string codec;
  std::span<const uint8_t> description;  // avcC or empty
  int width = 0, height = 0;
};
struct DecodeSample {
  int decoder = 0;
  std::span<const uint8_t> bytes;
  int64_t timestamp_us = 0;  // names the presentation that the picture is for; never repeats; goes back in the answer
  bool key = false;
  bool wanted = true;  // a presentation waits for its picture, not only the pictures that refer to it
};
struct FlushDecoder {
  int decoder = 0;
};  // the end of a sequence that does not loop: output every picture of the samples so far
struct ResetDecoder {
  int decoder = 0;
};  // forget queued samples and pictures (seek, other sequence); answers still in flight are dropped
struct CloseDecoder {
  int decoder = 0;
};  // not needed any more: free it
// Why a decoder gives no pictures any more.
enum class DecoderFault {
  Samples,      // it did not like what it was fed
  Unsupported,  // there is none for this codec
  TakenAway     // the browser or the system wanted it back
};
using Request =
    std::variant<FetchRange, CancelFetch, ConfigureDecoder, DecodeSample, FlushDecoder, ResetDecoder, CloseDecoder>;

enum class EventKind {
  LoadedMetadata,
  CanPlay,
  Playing,
  Paused,
  Waiting,
  Seeked,
  Ended,
  TimeUpdate,
  Progress,
  SequenceChanged,
  Error,
  Warning,
  TransitionStarted,
  TransitionEnded,
  Sharper  // the picture that stands comes again in a higher rendition
};
const char* eventName(EventKind kind);  // "loadedmetadata", "canplay", … as the media element names them
struct Event {
  EventKind kind;
  Error error;                                 // Error, and Warning: playing goes on without what it names
  uint64_t loaded_bytes = 0, total_bytes = 0;  // Progress only: towards the first picture
};

// Queue of requests and events, each kept in the order in which they arose until the edge
// polls. Samples for decoders are not among them: Feeding makes those when the edge polls, so that they are never
// stale.
class Outbox {
 public:
  template <class T>  // an alternative of Request
  void request(T request) {
    requests_.items.emplace_back() = std::move(request);
  }
  void emit(Event event) { events_.items.push_back(std::move(event)); }
  void emit(EventKind kind) { emit({kind, {}, 0, 0}); }
  bool nextRequest(Request& out) { return requests_.take(out); }
  bool nextEvent(Event& out) { return events_.take(out); }

 private:
  template <class T>
  struct Queue {
    std::vector<T> items;
    size_t next = 0;
    bool take(T& out) {
      if (items.empty()) return false;
      out = std::move(items[next++]);
      if (next == items.size()) {
        items.clear();
        next = 0;
      }
      return true;
    }
  };

  Queue<Request> requests_;
  Queue<Event> events_;
};

// Use of a byte range.
struct FetchPurpose {
  enum class Kind { Mesh, Graph, Header, Video, Better, Chunk, Fine } kind = Kind::Mesh;  // as of Gop
  int sequence = -1;                                                                      // -1: of the whole character
  uint32_t gop = 0;                                                                       // from Video on
  bool ahead = false;                                                                     // nobody needs it yet
  bool ofGop() const { return kind >= Kind::Video; }
  bool ofVideo() const { return kind == Kind::Video || kind == Kind::Better; }
  // Playing goes on without it.
  bool optional() const { return kind == Kind::Graph || kind == Kind::Better || kind == Kind::Fine; }
};

struct Fetch {
  FetchPurpose purpose;
  FetchRange range;
};

// Byte ranges on their way, and how far loading towards the first picture has come. Each range is asked for once: the
// edge waits out faults that pass (web/src/net/transport.ts), so that a refusal is final. Does NOT look into the bytes and
// does NOT decide what to fetch (loading.h).
class Fetches {
 public:
  explicit Fetches(Outbox& outbox) : outbox_(outbox) {}

  void request(const FetchPurpose& purpose, const std::string& uri, uint64_t offset, uint64_t bytes);
  // Null: nobody asked for it, or it is settled. Valid until the next call.
  const Fetch* find(uint32_t id) const;
  // All bytes of a fetch that `find` knows are there: settles it and reports progress.
  FetchPurpose finish(uint32_t id);
  // A fetch that `find` knows has failed: settles it.
  Fetch drop(uint32_t id);
  bool empty() const { return fetches_.empty(); }  // nothing is on its way
  // Calls off what nobody needs any more: `unneeded` settles each purpose that it returns true for.
  template <class Unneeded>
  void cancel(const Unneeded& unneeded) {
    std::erase_if(fetches_, [&](const Fetch& fetch) {
      if (!unneeded(fetch.purpose)) return false;
      outbox_.request(CancelFetch{fetch.range.id});
      return true;
    });
  }
  template <class Action>
  void forEach(const Action& action) {
    for (Fetch& fetch : fetches_) action(fetch);
  }
  uint64_t bytesFetched() const { return bytes_fetched_; }

  // Progress counts a sequence's bytes from the moment they are asked for; `bytes` more are expected from the start.
  void startProgress(uint64_t bytes) { progress_total_ = bytes; }
  void endProgress() { progress_ended_ = true; }  // the first picture is on screen
  bool progressEnded() const { return progress_ended_; }

 private:
  std::vector<Fetch>::iterator locate(uint32_t id);

  Outbox& outbox_;
  std::vector<Fetch> fetches_;
  uint32_t next_id_ = 1;
  uint64_t progress_loaded_ = 0, progress_total_ = 0, bytes_fetched_ = 0;
  bool progress_ended_ = false;
};

}  // namespace fourdvt
