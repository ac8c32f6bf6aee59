// SPDX-License-Identifier: Apache-2.0
// Byte ranges on their way: what each one is for, how often it was tried, and how far loading towards the first picture
// has come. Asks for each range up to three times. Does NOT look into the bytes and does NOT decide what to fetch
// (loading.h).
#pragma once

#include <map>
#include <optional>

#include "player/parts/outbox.h"

namespace fourdvt {

struct Fetch {
  enum class Kind { Mesh, Graph, Header, Video, Chunk } kind = Kind::Mesh;
  int sequence = -1;  // -1: it is of the whole character
  uint32_t gop = 0;   // Video and Chunk only
  FetchRange range;   // its id is given by Fetches
  int tries = 1;
};

class Fetches {
 public:
  explicit Fetches(Outbox& outbox) : outbox_(outbox) {}

  void request(Fetch fetch);
  // Null: nobody asked for it, or it is settled.
  const Fetch* find(uint32_t id) const;
  // All of its bytes are there: reports progress. The id must be one that `find` knows.
  Fetch finish(uint32_t id);
  // The fetch that is given up; null: nobody asked for it, or it is asked for again.
  std::optional<Fetch> fail(uint32_t id);
  bool empty() const { return fetches_.empty(); }
  uint64_t bytesFetched() const { return bytes_fetched_; }

  // Progress counts a sequence's bytes from the moment they are asked for; `bytes` more are expected from the start.
  void startProgress(uint64_t bytes) { progress_total_ = bytes; }
  void endProgress() { progress_ended_ = true; }  // the first picture is on screen
  bool progressEnded() const { return progress_ended_; }

 private:
  Outbox& outbox_;
  std::map<uint32_t, Fetch> fetches_;  // by id
  uint32_t next_id_ = 1;
  uint64_t progress_loaded_ = 0, progress_total_ = 0, bytes_fetched_ = 0;
  bool progress_ended_ = false;
};

}  // namespace fourdvt
