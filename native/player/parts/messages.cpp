// SPDX-License-Identifier: Apache-2.0
#include "player/parts/messages.h"

namespace fourdvt {

const char* eventName(EventKind kind) {
  switch (kind) {
    case EventKind::LoadedMetadata:
      return "loadedmetadata";
    case EventKind::CanPlay:
      return "canplay";
    case EventKind::Playing:
      return "playing";
    case EventKind::Paused:
      return "pause";
    case EventKind::Waiting:
      return "waiting";
    case EventKind::Seeked:
      return "seeked";
    case EventKind::Ended:
      return "ended";
    case EventKind::TimeUpdate:
      return "timeupdate";
    case EventKind::Progress:
      return "progress";
    case EventKind::SequenceChanged:
      return "sequencechange";
    case EventKind::Error:
      return "error";
    case EventKind::Warning:
      return "warning";
    case EventKind::TransitionStarted:
      return "transitionstart";
    case EventKind::TransitionEnded:
      return "transitionend";
    case EventKind::Sharper:
      return "sharper";
  }
  return "error";
}

}  // namespace fourdvt
