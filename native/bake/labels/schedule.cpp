// SPDX-License-Identifier: Apache-2.0
#include "bake/labels/schedule.h"

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace fourdvt::bake {
namespace {

enum class State { Waiting, Running, Done };

// State of the windows of one run: those that may start next, and the frames that are final.
class Board {
 public:
  explicit Board(const std::vector<LabelWindow>& windows)
      : windows_(windows), states_(windows.size(), State::Waiting) {}

  // The earliest window that may start, so that few frames are in memory at a time; -1: none.
  int next() const {
    for (size_t i = 0; i < windows_.size(); ++i)
      if (states_[i] == State::Waiting && ready(i)) return static_cast<int>(i);
    return -1;
  }
  void set(size_t window, State state) { states_[window] = state; }
  bool allDone() const {
    return std::all_of(states_.begin(), states_.end(), [](State s) { return s == State::Done; });
  }
  // Frames before this are final.
  uint32_t finalEnd(uint32_t frame_count) const {
    uint32_t end = frame_count;
    for (size_t i = 0; i < windows_.size(); ++i)
      if (states_[i] != State::Done) end = std::min(end, windows_[i].frozen_first);
    return end;
  }

 private:
  bool ready(size_t i) const {
    if (!windows_[i].odd) return true;
    return states_[i - 1] == State::Done && states_[i + 1] == State::Done;
  }
  const std::vector<LabelWindow>& windows_;
  std::vector<State> states_;
};

std::vector<LabelWindow> framesAlone(uint32_t frame_count) {
  std::vector<LabelWindow> out;
  for (uint32_t t = 0; t < frame_count; ++t) out.push_back({t, t + 1, t, t + 1, t, t + 1, false});
  return out;
}

}  // namespace

std::vector<LabelWindow> planWindows(const LabelOptions& options, uint32_t frame_count) {
  if (!options.rule->windowed) return framesAlone(frame_count);
  const uint32_t window = static_cast<uint32_t>(options.window_frames), hop = static_cast<uint32_t>(options.hop_frames);
  const uint32_t gap = 2 * hop > window ? 2 * hop - window : 1;
  const uint32_t evens = frame_count <= window ? 1 : (frame_count + gap + window + gap - 1) / (window + gap);
  const uint32_t even_frames = frame_count - (evens - 1) * gap;
  std::vector<LabelWindow> out;
  uint32_t first = 0;
  for (uint32_t k = 0; k < evens; ++k) {
    const uint32_t length = (k + 1) * even_frames / evens - k * even_frames / evens, end = first + length;
    out.push_back({first, end, first, end, first, end, false});
    if (k + 1 < evens) {
      const uint32_t next_length = (k + 2) * even_frames / evens - (k + 1) * even_frames / evens;
      // Neighbouring odd windows must leave a frozen frame of the even one between them.
      const uint32_t overlap = window - hop, left = std::min(overlap, (length - 1) / 2),
                     right = std::min(overlap, (next_length - 1) / 2);
      const uint32_t last = end + gap + right;
      out.push_back({end - left, last, end, end + gap, end - left - 1, std::min(last + 1, frame_count), true});
    }
    first = end + gap;
  }
  return out;
}

Status runWindows(const std::vector<LabelWindow>& windows, uint32_t frame_count, int jobs, const LabelSteps& steps,
                  const std::atomic<bool>* stop) {
  Board board(windows);
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<size_t> solved;
  std::vector<std::thread> threads(windows.size());
  struct Joiner {
    std::vector<std::thread>& threads;
    ~Joiner() {
      for (std::thread& t : threads)
        if (t.joinable()) t.join();
    }
  } joiner{threads};
  int running = 0;
  uint32_t finished = 0;
  while (!board.allDone()) {
    if (stop && *stop) return Error{ErrorId::Interrupted, "stopped while labelling"};
    const int next = running < jobs ? board.next() : -1;
    if (next >= 0) {
      FOURDVT_TRY(steps.load(windows[next]));
      board.set(next, State::Running);
      ++running;
      const auto solve = [&, next] {
        steps.solve(windows[next]);
        std::lock_guard lock(mutex);
        solved.push_back(next);
        changed.notify_one();
      };
      if (jobs > 1) {
        threads[next] = std::thread(solve);
        continue;
      }
      solve();
    }
    std::unique_lock lock(mutex);
    changed.wait(lock, [&] { return !solved.empty(); });
    std::vector<size_t> batch;
    batch.swap(solved);
    lock.unlock();
    for (size_t window : batch) {
      if (threads[window].joinable()) threads[window].join();
      board.set(window, State::Done);
      --running;
    }
    for (const uint32_t end = board.finalEnd(frame_count); finished < end; ++finished)
      FOURDVT_TRY(steps.finish(finished));
  }
  return {};
}

}  // namespace fourdvt::bake
