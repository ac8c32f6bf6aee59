// SPDX-License-Identifier: Apache-2.0
// The player as a page sees it: plain C functions on an opaque handle, results as plain structs in wasm memory.
//
// A returned block is owned by the handle and valid until the next fdvt_* call on it. Text is UTF-8, pointer + length.
// The order of the fields is the ABI: web/src/wasm-player.ts reads them at fixed offsets (checked below).
// Every function that may touch GL makes the handle's own context current first, so several handles may coexist.
#include <emscripten/html5.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "player/player.h"

#define FDVT extern "C" __attribute__((used, visibility("default")))

namespace {

using namespace fourdvt;

struct Text {
  const char* data = nullptr;
  uint32_t size = 0;
};
Text text(const std::string& s) { return {s.data(), static_cast<uint32_t>(s.size())}; }
Text text(const char* s) { return {s, static_cast<uint32_t>(std::char_traits<char>::length(s))}; }

struct ErrorBlock {
  int32_t id = 0;
  Text name, message;
};

enum RequestKind : int32_t { kFetch = 1, kCancel, kConfigure, kDecode, kFlush, kReset };
struct RequestBlock {
  int32_t kind = 0;
  uint32_t id = 0;
  Text uri_or_codec;
  Text data;  // decoder description or sample
  int32_t width = 0, height = 0;
  int32_t key = 0, pad = 0;
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
  int32_t seeking = 0, pad = 0;
  double current_time_s = 0;
  double frames_shown = 0, frames_late = 0, barcode_checked = 0, barcode_mismatches = 0;
  double bytes_fetched = 0, encoded_bytes_held = 0;
  double draws = 0, live_textures = 0, live_texture_bytes = 0;
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
};

static_assert(sizeof(ErrorBlock) == 20 && sizeof(RequestBlock) == 64 && offsetof(RequestBlock, offset) == 40);
static_assert(offsetof(EventBlock, loaded_bytes) == 32 && sizeof(StateBlock) == 104 && sizeof(SequenceBlock) == 32);
static_assert(offsetof(CharacterBlock, layers) == 56 && offsetof(CharacterBlock, name) == 72);

struct Instance {
  EMSCRIPTEN_WEBGL_CONTEXT_HANDLE context = 0;
  std::unique_ptr<gpu::Device> device;
  std::unique_ptr<Player> player;  // destroyed before the device
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
};

ErrorBlock blockOf(const Error& error) {
  return {static_cast<int32_t>(error.id), text(errorName(error.id)), text(error.message)};
}

// 1, or 0 with the handle's error set.
int keep(Instance* h, const Status& status) {
  if (!status.ok()) h->error = status.error();
  return status.ok() ? 1 : 0;
}

int fail(Instance* h, ErrorId id, const char* message) {
  h->error = {id, message};
  return 0;
}

void makeCurrent(Instance* h) { emscripten_webgl_make_context_current(h->context); }

struct FillRequest {
  RequestBlock& out;
  void operator()(const FetchRange& r) const {
    out.kind = kFetch;
    out.id = r.id;
    out.uri_or_codec = text(r.uri);
    out.offset = static_cast<double>(r.offset);
    out.bytes = static_cast<double>(r.bytes);
  }
  void operator()(const CancelFetch& r) const { out.kind = kCancel, out.id = r.id; }
  void operator()(const ConfigureDecoder& r) const {
    out.kind = kConfigure;
    out.uri_or_codec = text(r.codec);
    out.data = bytes(r.description);
    out.width = r.width;
    out.height = r.height;
  }
  void operator()(const DecodeSample& r) const {
    out.kind = kDecode;
    out.data = bytes(r.bytes);
    out.timestamp_us = static_cast<double>(r.timestamp_us);
    out.key = r.key;
  }
  void operator()(const FlushDecoder&) const { out.kind = kFlush; }
  void operator()(const ResetDecoder&) const { out.kind = kReset; }
  static Text bytes(std::span<const uint8_t> s) {
    return {reinterpret_cast<const char*>(s.data()), static_cast<uint32_t>(s.size())};
  }
};

}  // namespace

FDVT void* fdvt_alloc(uint32_t bytes) { return std::malloc(bytes); }
FDVT void fdvt_free(void* p) { std::free(p); }

// `context`: handle of emscripten's GL registry. picture_kind: 0 I420 planes, 1 RGBA textures that the page fills.
// Never null; 0 from fdvt_ready means that fdvt_error says why.
FDVT Instance* fdvt_create(int32_t context, int32_t picture_kind, int32_t picture_slots) {
  auto* h = new Instance;
  h->context = context;
  makeCurrent(h);
  auto device = gpu::createGlesDevice();
  if (!device.ok()) {
    h->error = device.error();
    return h;
  }
  h->device = device.take();
  PlayerOptions options;
  options.picture_kind = picture_kind ? render::PictureTextures::Kind::Rgba : render::PictureTextures::Kind::I420;
  options.picture_slots = picture_slots;
  auto player = Player::create(*h->device, options);
  if (player.ok()) h->player = player.take();
  if (!player.ok()) h->error = player.error();
  return h;
}
FDVT int fdvt_ready(Instance* h) { return h->player != nullptr; }
FDVT void fdvt_destroy(Instance* h) {
  makeCurrent(h);
  h->player.reset();
  h->device.reset();
  delete h;
}
FDVT const ErrorBlock* fdvt_error(Instance* h) {
  h->error_block = blockOf(h->error);
  return &h->error_block;
}

// The manifest as base/flat_json.h describes it, then fdvt_load.
FDVT void fdvt_manifest_number(Instance* h, const char* pointer, uint32_t size, double value) {
  h->manifest.set({pointer, size}, value);
}
FDVT void fdvt_manifest_string(Instance* h, const char* pointer, uint32_t size, const char* value,
                               uint32_t value_size) {
  h->manifest.set({pointer, size}, std::string(value, value_size));
}
FDVT void fdvt_manifest_bool(Instance* h, const char* pointer, uint32_t size, int32_t value) {
  h->manifest.set({pointer, size}, value != 0);
}
FDVT int fdvt_load(Instance* h) {
  makeCurrent(h);
  const int ok = keep(h, h->player->loadManifest(h->manifest));
  h->manifest = {};
  return ok;
}

FDVT void fdvt_play(Instance* h) { h->player->play(); }
FDVT void fdvt_pause(Instance* h) { h->player->pause(); }
FDVT void fdvt_seek_frame(Instance* h, uint32_t frame) { h->player->seekFrame(frame); }
FDVT void fdvt_seek(Instance* h, double time_s) { h->player->seek(time_s); }
FDVT void fdvt_set_rate(Instance* h, double rate) { h->player->setRate(rate); }
FDVT void fdvt_set_loop(Instance* h, int32_t loop) { h->player->setLoop(loop); }
FDVT int fdvt_select(Instance* h, const char* name, uint32_t size) {
  makeCurrent(h);
  return keep(h, h->player->selectSequence({name, size}));
}

FDVT void fdvt_tick(Instance* h, double now_s) {
  makeCurrent(h);
  h->player->tick(now_s);
}
FDVT const RequestBlock* fdvt_next_request(Instance* h) {
  makeCurrent(h);
  if (!h->player->nextRequest(h->request)) return nullptr;
  h->request_block = {};
  std::visit(FillRequest{h->request_block}, h->request);
  return &h->request_block;
}
FDVT const EventBlock* fdvt_next_event(Instance* h) {
  if (!h->player->nextEvent(h->event)) return nullptr;
  h->event_block = {};
  h->event_block.name = text(eventName(h->event.kind));
  h->event_block.error = blockOf(h->event.error);
  h->event_block.loaded_bytes = static_cast<double>(h->event.loaded_bytes);
  h->event_block.total_bytes = static_cast<double>(h->event.total_bytes);
  return &h->event_block;
}

FDVT void fdvt_range_received(Instance* h, uint32_t id, const uint8_t* bytes, uint32_t size) {
  makeCurrent(h);
  h->player->onRangeReceived(id, {bytes, size});
}
FDVT void fdvt_range_failed(Instance* h, uint32_t id, const char* reason, uint32_t size) {
  h->player->onRangeFailed(id, {reason, size});
}
FDVT void fdvt_decoder_failed(Instance* h, const char* reason, uint32_t size) {
  h->player->onDecoderFailed({reason, size});
}

FDVT int fdvt_acquire_slot(Instance* h, double timestamp_us) {
  makeCurrent(h);
  return h->player->acquireSlot(static_cast<int64_t>(timestamp_us));
}
// Planes lie at byte offsets of `pixels`; an NV12 picture has its interleaved plane at offset_u and stride_v == 0.
FDVT void fdvt_upload(Instance* h, int32_t slot, const uint8_t* pixels, int32_t width, int32_t height,
                      uint32_t offset_y, int32_t stride_y, uint32_t offset_u, int32_t stride_u, uint32_t offset_v,
                      int32_t stride_v) {
  makeCurrent(h);
  I420View view{width, height, pixels + offset_y, pixels + offset_u, pixels + offset_v, stride_y, stride_u, stride_v};
  if (stride_v == 0) {
    const size_t w = width / 2, rows = height / 2, plane = w * rows;
    h->chroma.resize(2 * plane);
    for (size_t row = 0; row < rows; ++row) {
      const uint8_t* from = pixels + offset_u + row * stride_u;
      uint8_t* to = h->chroma.data() + row * w;
      for (size_t x = 0; x < w; ++x) to[x] = from[2 * x], to[plane + x] = from[2 * x + 1];
    }
    view.u = h->chroma.data();
    view.v = view.u + plane;
    view.stride_u = view.stride_v = static_cast<int>(w);
  }
  h->player->uploadI420(slot, view);
  h->player->commitSlot(slot);
}
// RGBA kind: the page fills this texture (a GL name of the context), then commits.
FDVT uint32_t fdvt_slot_texture(Instance* h, int32_t slot) {
  return h->device->nativeTexture(h->player->slotTexture(slot));
}
FDVT void fdvt_commit_slot(Instance* h, int32_t slot) {
  makeCurrent(h);
  h->device->invalidateState();
  h->player->commitSlot(slot);
}
// After page code used the context for itself.
FDVT void fdvt_invalidate_state(Instance* h) {
  makeCurrent(h);
  h->device->invalidateState();
}

// background: premultiplied sRGB-encoded; debug: render::DebugView.
FDVT void fdvt_set_options(Instance* h, float r, float g, float b, float a, int32_t ground_shadow, float strength,
                           int32_t samples, int32_t debug, int32_t debug_layer) {
  h->recipe.background = {r, g, b, a};
  h->recipe.ground_shadow = ground_shadow != 0;
  h->recipe.shadow_strength = strength;
  h->recipe.samples = samples;
  h->recipe.debug = static_cast<render::DebugView>(debug);
  h->recipe.debug_layer = debug_layer;
}
// Degrees, metres, pixels of the canvas.
FDVT int fdvt_draw(Instance* h, double azimuth, double elevation, double distance, double target_x, double target_y,
                   double target_z, double vertical_fov, int32_t width, int32_t height) {
  if (width < 1 || height < 1)
    return fail(h, ErrorId::InvalidArgument, "picture without pixels: give the canvas a size");
  makeCurrent(h);
  const OrbitView orbit{azimuth, elevation, distance, {target_x, target_y, target_z}, vertical_fov};
  const render::View view = render::viewFromCamera(cameraFromOrbit(orbit, width, height));
  return keep(h, h->player->draw(view, h->recipe, gpu::kDefaultTarget));
}

FDVT const StateBlock* fdvt_state(Instance* h) {
  const Player& p = *h->player;
  const PlayerStats s = p.stats();
  const gpu::Counters& c = h->device->counters();
  StateBlock& out = h->state = {};
  out.has_frame = p.hasFrame();
  out.paused = p.paused();
  out.seeking = p.seeking();
  out.frame = static_cast<int32_t>(p.frame());
  if (p.character() && p.sequence())
    out.sequence = static_cast<int32_t>(p.sequence() - p.character()->sequences.data());
  out.current_time_s = p.currentTime();
  out.frames_shown = static_cast<double>(s.frames_shown);
  out.frames_late = static_cast<double>(s.frames_late);
  out.barcode_checked = static_cast<double>(s.barcode_checked);
  out.barcode_mismatches = static_cast<double>(s.barcode_mismatches);
  out.bytes_fetched = static_cast<double>(s.bytes_fetched);
  out.encoded_bytes_held = static_cast<double>(s.encoded_bytes_held);
  out.draws = static_cast<double>(c.draws);
  out.live_textures = static_cast<double>(c.live_textures);
  out.live_texture_bytes = static_cast<double>(c.live_texture_bytes);
  return &out;
}
// Null before the manifest is read.
FDVT const CharacterBlock* fdvt_character(Instance* h) {
  const package::Character* c = h->player->character();
  if (!c) return nullptr;
  CharacterBlock& out = h->character = {};
  for (int i = 0; i < 3; ++i) out.bounds_min[i] = c->bounds.min[i], out.bounds_max[i] = c->bounds.max[i];
  out.ground_y_m = c->ground_y_m;
  out.layers = c->layer_count;
  out.vertices = static_cast<int32_t>(c->vertex_count);
  out.faces = static_cast<int32_t>(c->face_count);
  out.sequences = static_cast<int32_t>(c->sequences.size());
  out.name = text(c->name);
  out.poster_uri = text(c->poster_uri);
  return &out;
}
FDVT const SequenceBlock* fdvt_sequence(Instance* h, uint32_t index) {
  const package::Character* c = h->player->character();
  if (!c || index >= c->sequences.size()) return nullptr;
  const package::Sequence& s = c->sequences[index];
  h->sequence = {text(s.name), static_cast<int32_t>(s.frame_count), s.loop, s.fps, s.duration_s()};
  return &h->sequence;
}
