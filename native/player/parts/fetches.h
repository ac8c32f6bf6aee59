// SPDX-License-Identifier: Apache-2.0
// Byte ranges on their way: what each one is for, and how far loading towards the first picture has come. Each range is
// asked for once: the edge waits out faults that pass (web/src/transport.ts), so that a refusal is final. Does NOT look
// into the bytes and does NOT decide what to fetch (loading.h).
#pragma once

#include <vector>

#include "player/parts/outbox.h"

namespace fourdvt {

// What a byte range is for.
struct FetchPurpose {
  enum class Kind { Mesh, Graph, Header, Video, Better, Chunk, Fine } kind = Kind::Mesh;  // as of stream::Gop
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
