// SPDX-License-Identifier: Apache-2.0
// Work on other threads while the calling thread draws; its results come back in the order in which it was given, so
// that sums over them do not depend on the number of threads.
#pragma once

#include <algorithm>
#include <future>
#include <utility>
#include <vector>

namespace fourdvt::bake {

template <class T>
class InOrder {
 public:
  // `at_once`: tasks at work at a time; 1: each runs on the calling thread.
  explicit InOrder(int at_once) : at_once_(static_cast<size_t>(std::max(at_once, 1))) {}
  // Waits while `at_once` tasks are at work. What the task refers to must outlive this object.
  template <class Task>
  void add(Task task) {
    if (tasks_.size() >= at_once_) tasks_[tasks_.size() - at_once_].wait();
    tasks_.push_back(std::async(at_once_ > 1 ? std::launch::async : std::launch::deferred, std::move(task)));
  }
  std::vector<T> take() {
    std::vector<T> results;
    for (std::future<T>& task : tasks_) results.push_back(task.get());
    tasks_.clear();
    return results;
  }

 private:
  const size_t at_once_;
  std::vector<std::future<T>> tasks_;  // futures join on every way out
};

}  // namespace fourdvt::bake
