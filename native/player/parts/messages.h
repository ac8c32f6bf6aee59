// SPDX-License-Identifier: Apache-2.0
// Messages between a player and its edge (the page, or a native tool): requests for the edge to execute, events for it
// to forward, the queue of both, and the byte ranges in flight.
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

// Owner of a decoded picture's planes in memory.
using PictureBytes = std::shared_ptr<const void>;

// Requests to the edge. Spans stay valid until the next call of any non-const method of the player.
struct FetchRange {  // answer: onRangeReceived / onRangeFailed
  uint32_t id = 0;
  std::string uri;  // relative to the manifest
  uint64_t offset = 0, bytes = 0;
};
struct CancelFetch {
  uint32_t id = 0;
};
// Decoder number of a request, below kDecoders; the second is used only around transitions.
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
  int64_t timestamp_us = 0;  // unique id of the presentation; returned with the picture
  bool key = false;
  bool wanted = true;  // a presentation waits for this picture; false: reference only
};
struct FlushDecoder {
  int decoder = 0;
};  // end of a sequence that does not loop: output all pending pictures
struct ResetDecoder {
  int decoder = 0;
};  // drop queued samples and pictures (seek, other sequence); later answers to them are ignored
struct CloseDecoder {
  int decoder = 0;
};  // free the unused decoder
// Cause of a decoder failure.
enum class DecoderFault {
  Samples,      // rejected the samples
  Unsupported,  // codec unavailable
  TakenAway     // reclaimed by browser or system
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
  Sharper  // a higher rendition replaces the standing picture
};
const char* eventName(EventKind kind);  // media element names: "loadedmetadata", "canplay", …
struct Event {
  EventKind kind;
  Error error;                                 // Error, and Warning: playback continues without the named part
  uint64_t loaded_bytes = 0, total_bytes = 0;  // Progress only: up to the first picture
};

// Queue of requests and events, each in order of occurrence until the edge polls. Decoder samples are made by Feeding
// at the poll, so that they are never stale.
class Outbox {
 public:
  template <class T>  // alternative of Request
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
  enum class Kind {
    Mesh,
    Graph,
    Header,
    Video,
    Better,
    Chunk,
    Fine
  } kind = Kind::Mesh;  // parts of a Gop from Video on
  int sequence = -1;    // -1: whole character
  uint32_t gop = 0;     // Video and later kinds
  bool ahead = false;   // prefetch without a present need
  bool ofGop() const { return kind >= Kind::Video; }
  bool ofVideo() const { return kind == Kind::Video || kind == Kind::Better; }
  // True for parts that playback can do without.
  bool optional() const { return kind == Kind::Graph || kind == Kind::Better || kind == Kind::Fine; }
};

struct Fetch {
  FetchPurpose purpose;
  FetchRange range;
};

// Byte ranges in flight, and progress towards the first picture. Each range is requested once: the edge retries
// transient network errors (web/src/net/transport.ts), so that a failure is final. loading.h selects the ranges and
// checks the bytes.
class Fetches {
 public:
  explicit Fetches(Outbox& outbox) : outbox_(outbox) {}

  void request(const FetchPurpose& purpose, const std::string& uri, uint64_t offset, uint64_t bytes);
  // Null: unknown or settled id. Valid until the next call.
  const Fetch* find(uint32_t id) const;
  // Settles a complete fetch known to `find`, and reports progress.
  FetchPurpose finish(uint32_t id);
  // Settles a failed fetch known to `find`.
  Fetch drop(uint32_t id);
  bool empty() const { return fetches_.empty(); }  // nothing in flight
  // Cancels the fetches for which `unneeded(purpose)` returns true; `unneeded` also settles them.
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

  // Starts progress with `bytes` expected; a sequence's bytes are added on request.
  void startProgress(uint64_t bytes) { progress_total_ = bytes; }
  void endProgress() { progress_ended_ = true; }  // first picture on screen
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
