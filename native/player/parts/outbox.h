// SPDX-License-Identifier: Apache-2.0
// What the player has to tell its edge: requests and events, each kept in the order in which they arose until the edge
// polls. Does NOT hold samples for decoders: Feeding makes those when the edge polls, so that they are never stale.
#pragma once

#include <deque>
#include <utility>

#include "player/parts/messages.h"

namespace fourdvt {

class Outbox {
 public:
  void request(Request request) { requests_.push_back(std::move(request)); }
  void emit(Event event) { events_.push_back(std::move(event)); }
  void emit(EventKind kind) { emit({kind, {}, 0, 0}); }
  bool nextRequest(Request& out) { return take(requests_, out); }
  bool nextEvent(Event& out) { return take(events_, out); }

 private:
  template <class T>
  static bool take(std::deque<T>& queue, T& out) {
    if (queue.empty()) return false;
    out = std::move(queue.front());
    queue.pop_front();
    return true;
  }

  std::deque<Request> requests_;
  std::deque<Event> events_;
};

}  // namespace fourdvt
