// SPDX-License-Identifier: Apache-2.0
// Simulated worker that decodes a player's geometry, like web/src/decode/geometry-worker.ts: jobs in order of rank,
// unwanted jobs are dropped, frames return after a latency.
#pragma once

#include <deque>
#include <map>
#include <random>

#include "package/chunk_decoder.h"
#include "player/player.h"

namespace fourdvt::testing {

class SimulatedWorker {
 public:
  double frame_s = 0.002, latency_s = 0.004;  // per frame: decoding time, and maximum latency of its return
  uint64_t damaged_every = 0;                 // every n-th frame lacks its last byte (0: never)
  bool silent = false;
  uint64_t frames = 0, refused = 0, begun = 0;

  explicit SimulatedWorker(uint32_t seed = 1) : random_(seed) {}

  // Before a tick: passes finished frames to the player. `Player` is a player or Loading.
  template <class Player>
  void answer(Player& player, double now_s) {
    while (!answers_.empty() && answers_.front().due_s <= now_s) {
      const Answer& a = answers_.front();
      refused += !player.takeDecoded(a.job, a.row, a.bytes, frame_s);
      answers_.pop_front();
    }
  }
  // After a tick: takes the player's jobs, and decodes until `now_s`.
  template <class Player>
  void work(Player& player, const package::ChunkMesh& mesh, double now_s) {
    std::map<uint32_t, Job> jobs;
    std::vector<uint32_t> order;
    for (size_t n = 0; const std::optional<DecodeJob> wanted = player.decodeJob(n); ++n) {
      order.push_back(wanted->id);
      const auto known = jobs_.find(wanted->id);
      Job& job = jobs[wanted->id];
      if (known != jobs_.end()) {
        job = std::move(known->second);
      } else {
        ++begun;
        job.bytes.assign(wanted->chunk.begin(), wanted->chunk.end());
        auto opened = package::ChunkDecoder::open(job.bytes, *wanted->index, wanted->gop, mesh);
        if (opened.ok()) job.decoder = opened.take();
      }
      job.wanted = wanted->frames;
    }
    jobs_ = std::move(jobs);
    for (free_s_ = std::max(free_s_, last_s_); !silent && free_s_ < now_s;)
      if (!decodeNext(order)) break;
    last_s_ = now_s;
  }

 private:
  struct Job {
    std::vector<uint8_t> bytes;
    std::unique_ptr<package::ChunkDecoder> decoder;  // null: the chunk is invalid
    uint32_t wanted = 0, next = 0;
  };
  struct Answer {
    uint32_t job, row;
    std::vector<uint8_t> bytes;
    double due_s;
  };
  bool decodeNext(const std::vector<uint32_t>& order) {
    for (const uint32_t id : order) {
      Job& job = jobs_[id];
      if (job.next >= job.wanted) continue;
      Answer answer{id, job.next, {}, 0};
      if (job.decoder && job.decoder->decodeTo(job.next).ok())
        package::writeDecodedFrame(job.decoder->take(), answer.bytes);
      if (answer.bytes.empty()) job.wanted = 0;
      ++job.next;
      if (damaged_every && ++frames % damaged_every == 0) answer.bytes.pop_back();
      free_s_ += frame_s;
      const double way_s = std::uniform_real_distribution<double>(0, latency_s)(random_);
      answer.due_s = std::max(answers_.empty() ? 0 : answers_.back().due_s, free_s_ + way_s);
      answers_.push_back(std::move(answer));
      return true;
    }
    return false;
  }

  std::mt19937 random_;
  std::map<uint32_t, Job> jobs_;
  std::deque<Answer> answers_;
  double free_s_ = 0, last_s_ = 0;
};

}  // namespace fourdvt::testing
