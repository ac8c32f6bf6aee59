// SPDX-License-Identifier: Apache-2.0
// What passes between a player and its edge (the page, or a native tool): requests that the edge carries out, events
// that it passes on. Types only: does NOT queue them (outbox.h) and does NOT carry anything out.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <variant>

#include "base/result.h"

namespace fourdvt {

// Keeps the planes of a decoded picture in memory until it is let go.
using PictureBytes = std::shared_ptr<const void>;

// What the edge must do. Spans stay valid until the next call of any non-const method of the player.
struct FetchRange {  // answer: onRangeReceived / onRangeFailed
  uint32_t id = 0;
  std::string uri;  // relative to the manifest
  uint64_t offset = 0, bytes = 0;
};
struct CancelFetch {
  uint32_t id = 0;
};
// Decoder requests name one of kDecoders; the second is used only around transitions.
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
  int64_t timestamp_us = 0;  // names the presentation that the picture is for; never repeats; goes back in the answer
  bool key = false;
  bool wanted = true;  // a presentation waits for its picture, not only the pictures that refer to it
};
struct FlushDecoder {
  int decoder = 0;
};  // the end of a sequence that does not loop: output every picture of the samples so far
struct ResetDecoder {
  int decoder = 0;
};  // forget queued samples and pictures (seek, other sequence); answers still in flight are dropped
struct CloseDecoder {
  int decoder = 0;
};  // not needed any more: free it
// Why a decoder gives no pictures any more.
enum class DecoderFault {
  Samples,      // it did not like what it was fed
  Unsupported,  // there is none for this codec
  TakenAway     // the browser or the system wanted it back
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
  Sharper  // the picture that stands comes again in a higher rendition
};
const char* eventName(EventKind kind);  // "loadedmetadata", "canplay", … as the media element names them
struct Event {
  EventKind kind;
  Error error;                                 // Error, and Warning: playing goes on without what it names
  uint64_t loaded_bytes = 0, total_bytes = 0;  // Progress only: towards the first picture
};

}  // namespace fourdvt
