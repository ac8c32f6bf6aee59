// SPDX-License-Identifier: Apache-2.0
// The player as a page sees it: plain C functions on an opaque handle, results as plain structs in wasm memory.
//
// A returned block is owned by the handle and valid until the next fdvt_* call on it. Text is UTF-8, pointer + length.
// Several handles may share a canvas (fdvt_create_beside). Motion: motion_exports.cpp.
// Every function that may touch GL makes the handle's own context current first, so several handles may coexist.
#include <cstdlib>
#include <string>
#include <vector>

#include "instance.h"

using namespace fourdvt;

namespace {

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
    out.decoder = r.decoder;
    out.uri_or_codec = text(r.codec);
    out.data = bytes(r.description);
    out.width = r.width;
    out.height = r.height;
  }
  void operator()(const DecodeSample& r) const {
    out.kind = kDecode;
    out.decoder = r.decoder;
    out.data = bytes(r.bytes);
    out.timestamp_us = static_cast<double>(r.timestamp_us);
    out.key = r.key;
  }
  void operator()(const FlushDecoder& r) const { out.kind = kFlush, out.decoder = r.decoder; }
  void operator()(const ResetDecoder& r) const { out.kind = kReset, out.decoder = r.decoder; }
  void operator()(const CloseDecoder& r) const { out.kind = kClose, out.decoder = r.decoder; }
  static Text bytes(std::span<const uint8_t> s) {
    return {reinterpret_cast<const char*>(s.data()), static_cast<uint32_t>(s.size())};
  }
};

Status openStage(Stage& stage) {
  auto device = gpu::createGlesDevice();
  if (!device.ok()) return device.error();
  stage.device = device.take();
  auto recipe = render::Recipe::create(*stage.device);
  if (!recipe.ok()) return recipe.error();
  stage.recipe = recipe.take();
  return {};
}

void openPlayer(Instance* h, int32_t picture_kind, int32_t picture_slots) {
  PlayerOptions options;
  options.picture_kind = picture_kind ? render::PictureTextures::Kind::Rgba : render::PictureTextures::Kind::I420;
  options.picture_slots = picture_slots;
  auto player = Player::create(*h->stage->device, h->stage->recipe, options);
  if (player.ok()) h->player = player.take();
  if (!player.ok()) h->error = player.error();
}

Status drawTogether(Instance* const* handles, uint32_t count, const render::View& view) {
  std::vector<render::Figure> figures;
  for (uint32_t i = 0; i < count; ++i) {
    auto figure = handles[i]->player->figure();
    if (!figure.ok()) return figure.error();
    figures.push_back(figure.value());
  }
  Stage& stage = *handles[0]->stage;
  return stage.recipe->draw(figures, stage.scene.meshes.empty() ? nullptr : &stage.scene, view,
                            {handles[0]->recipe, handles[0]->player->align()}, gpu::kDefaultTarget);
}

int drawOrbit(Instance* const* handles, uint32_t count, const OrbitView& orbit, int32_t width, int32_t height) {
  Instance* h = handles[0];
  if (width < 1 || height < 1)
    return fail(h, ErrorId::InvalidArgument, "picture without pixels: give the canvas a size");
  makeCurrent(h);
  return keep(h, drawTogether(handles, count, render::viewFromCamera(cameraFromOrbit(orbit, width, height))));
}

}  // namespace

FDVT void* fdvt_alloc(uint32_t bytes) { return std::malloc(bytes); }
FDVT void fdvt_free(void* p) { std::free(p); }

// `context`: handle of emscripten's GL registry. picture_kind: 0 I420 planes, 1 RGBA textures that the page fills.
// Never null; 0 from fdvt_ready means that fdvt_error says why.
FDVT Instance* fdvt_create(int32_t context, int32_t picture_kind, int32_t picture_slots) {
  auto* h = new Instance;
  h->stage = std::make_shared<Stage>();
  h->stage->context = context;
  makeCurrent(h);
  if (keep(h, openStage(*h->stage))) openPlayer(h, picture_kind, picture_slots);
  return h;
}
// Another character on the first one's context, device and renderer.
FDVT Instance* fdvt_create_beside(Instance* first, int32_t picture_kind, int32_t picture_slots) {
  auto* h = new Instance;
  h->stage = first->stage;
  makeCurrent(h);
  openPlayer(h, picture_kind, picture_slots);
  return h;
}
FDVT int fdvt_ready(Instance* h) { return h->player != nullptr; }
FDVT void fdvt_destroy(Instance* h) {
  makeCurrent(h);
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
FDVT void fdvt_seek_frame(Instance* h, uint32_t frame) {
  makeCurrent(h);
  h->player->seekFrame(frame);
}
FDVT void fdvt_seek(Instance* h, double time_s) {
  makeCurrent(h);
  h->player->seek(time_s);
}
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
  makeCurrent(h);
  h->player->onRangeFailed(id, {reason, size});
}
FDVT void fdvt_decoder_failed(Instance* h, int32_t decoder, const char* reason, uint32_t size) {
  makeCurrent(h);
  h->player->onDecoderFailed(decoder, {reason, size});
}

FDVT int fdvt_acquire_slot(Instance* h, int32_t decoder, double timestamp_us) {
  makeCurrent(h);
  return h->player->acquireSlot(decoder, static_cast<int64_t>(timestamp_us));
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
  return h->stage->device->nativeTexture(h->player->slotTexture(slot));
}
FDVT void fdvt_commit_slot(Instance* h, int32_t slot) {
  makeCurrent(h);
  h->stage->device->invalidateState();
  h->player->commitSlot(slot);
}
// After page code used the context for itself.
FDVT void fdvt_invalidate_state(Instance* h) {
  makeCurrent(h);
  h->stage->device->invalidateState();
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
  return drawOrbit(&h, 1, {azimuth, elevation, distance, {target_x, target_y, target_z}, vertical_fov}, width, height);
}
// Handles of one canvas; options, scene and alignment are the first one's. All must have a frame.
FDVT int fdvt_draw_group(Instance* const* handles, uint32_t count, double azimuth, double elevation, double distance,
                         double target_x, double target_y, double target_z, double vertical_fov, int32_t width,
                         int32_t height) {
  return drawOrbit(handles, count, {azimuth, elevation, distance, {target_x, target_y, target_z}, vertical_fov}, width,
                   height);
}

FDVT const StateBlock* fdvt_state(Instance* h) {
  const Player& p = *h->player;
  const PlayerStats s = p.stats();
  const gpu::Counters& c = h->stage->device->counters();
  StateBlock& out = h->state = {};
  out.has_frame = p.hasFrame();
  out.paused = p.paused();
  out.seeking = p.seeking();
  out.in_transition = p.inTransition();
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
  const motion::Placement placement = p.placement();
  out.x_m = placement.ground_m.x;
  out.z_m = placement.ground_m.y;
  out.heading_rad = placement.heading_rad;
  h->goal = p.goal();
  out.goal = text(h->goal);
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
  h->sequence = {text(s.name),
                 static_cast<int32_t>(s.frame_count),
                 s.loop,
                 s.fps,
                 s.duration_s(),
                 static_cast<int32_t>(s.space.names.size()),
                 s.isClass() ? static_cast<int32_t>(s.members.size()) : 0};
  return &h->sequence;
}
