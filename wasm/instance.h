// SPDX-License-Identifier: Apache-2.0
// What the files of the C ABI share: the blocks that a page reads in wasm memory, and the handle behind it.
// The order of the fields is the ABI: web/src/wasm-player.ts reads them at fixed offsets (checked below).
#pragma once

#include <emscripten/html5.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "player/player.h"

#define FDVT extern "C" __attribute__((used, visibility("default")))

namespace fourdvt {

struct Text {
  const char* data = nullptr;
  uint32_t size = 0;
};
inline Text text(const std::string& s) { return {s.data(), static_cast<uint32_t>(s.size())}; }
inline Text text(const char* s) { return {s, static_cast<uint32_t>(std::char_traits<char>::length(s))}; }

struct ErrorBlock {
  int32_t id = 0;
  Text name, message;
};

enum RequestKind : int32_t { kFetch = 1, kCancel, kConfigure, kDecode, kFlush, kReset, kClose };
struct RequestBlock {
  int32_t kind = 0;
  uint32_t id = 0;
  Text uri_or_codec;
  Text data;  // decoder description or sample
  int32_t width = 0, height = 0;
  int32_t key = 0, decoder = 0;
  double offset = 0, bytes = 0;
  double timestamp_us = 0;
};

struct EventBlock {
  Text name;
  ErrorBlock error;
  int32_t pad = 0;
  double loaded_bytes = 0, total_bytes = 0;
};

struct StateBlock {
  int32_t has_frame = 0, paused = 1;
  int32_t frame = 0, sequence = -1;
  int32_t seeking = 0, in_transition = 0;
  double current_time_s = 0;
  double frames_shown = 0, frames_late = 0, barcode_checked = 0, barcode_mismatches = 0;
  double bytes_fetched = 0, encoded_bytes_held = 0;
  double draws = 0, live_textures = 0, live_texture_bytes = 0;
  double x_m = 0, z_m = 0, heading_rad = 0;
  Text goal;
};

struct CharacterBlock {
  double bounds_min[3] = {}, bounds_max[3] = {};
  double ground_y_m = 0;
  int32_t layers = 0, vertices = 0, faces = 0, sequences = 0;
  Text name, poster_uri;
};

struct SequenceBlock {
  Text name;
  int32_t frames = 0, loop = 0;
  double fps = 0, duration_s = 0;
  int32_t parameters = 0, members = 0;  // members: 0 for a plain sequence
};

struct ParameterBlock {
  Text name;
  double min = 0, max = 0;
};

static_assert(sizeof(ErrorBlock) == 20 && sizeof(RequestBlock) == 64 && offsetof(RequestBlock, offset) == 40);
static_assert(offsetof(EventBlock, loaded_bytes) == 32 && sizeof(StateBlock) == 136 &&
              offsetof(StateBlock, goal) == 128);
static_assert(sizeof(SequenceBlock) == 40 && offsetof(ParameterBlock, min) == 8);
static_assert(offsetof(CharacterBlock, layers) == 56 && offsetof(CharacterBlock, name) == 72);

// What characters in one canvas share.
struct Stage {
  EMSCRIPTEN_WEBGL_CONTEXT_HANDLE context = 0;
  std::unique_ptr<gpu::Device> device;
  std::shared_ptr<render::Recipe> recipe;
  render::Scene scene;
};

struct Instance {
  std::shared_ptr<Stage> stage;
  std::unique_ptr<Player> player;  // destroyed before the stage
  FlatJson manifest;
  render::RecipeOptions recipe;
  std::vector<uint8_t> chroma;  // de-interleaved NV12, u then v
  Request request;
  Event event;
  Error error;
  ErrorBlock error_block;
  RequestBlock request_block;
  EventBlock event_block;
  StateBlock state;
  CharacterBlock character;
  SequenceBlock sequence;
  ParameterBlock parameter;
  std::string goal;
  Text member;
};

inline ErrorBlock blockOf(const Error& error) {
  return {static_cast<int32_t>(error.id), text(errorName(error.id)), text(error.message)};
}

// 1, or 0 with the handle's error set.
inline int keep(Instance* h, const Status& status) {
  if (!status.ok()) h->error = status.error();
  return status.ok() ? 1 : 0;
}

inline int fail(Instance* h, ErrorId id, const char* message) {
  h->error = {id, message};
  return 0;
}

inline void makeCurrent(Instance* h) { emscripten_webgl_make_context_current(h->stage->context); }

}  // namespace fourdvt
