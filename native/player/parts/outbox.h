// SPDX-License-Identifier: Apache-2.0
// What the player has to tell its edge: requests and events, each kept in the order in which they arose until the edge
// polls. Does NOT hold samples for decoders: Feeding makes those when the edge polls, so that they are never stale.
#pragma once

#include <utility>
#include <vector>

#include "player/parts/messages.h"

namespace fourdvt {

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

}  // namespace fourdvt
