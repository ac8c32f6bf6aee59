// SPDX-License-Identifier: Apache-2.0
// Runs tasks on other threads while the calling thread renders; results are returned in order of submission, so that
// sums over them do not depend on the number of threads.
#pragma once

#include <algorithm>
#include <future>
#include <utility>
#include <vector>

namespace fourdvt::bake {

template <class T>
class InOrder {
 public:
  // `at_once`: number of concurrent tasks; 1: each runs on the calling thread.
  explicit InOrder(int at_once) : at_once_(static_cast<size_t>(std::max(at_once, 1))) {}
  // Blocks while `at_once` tasks are running. Objects that the task refers to must outlive this one.
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
  std::vector<std::future<T>> tasks_;  // their destructors wait, on every return
};

}  // namespace fourdvt::bake
