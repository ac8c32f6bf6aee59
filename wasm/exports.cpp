// SPDX-License-Identifier: Apache-2.0
// The player's C ABI: plain C functions on an opaque handle, results as plain records in wasm memory. abi.txt lists
// parameters and results; abi.h declares them. Motion: motion_exports.cpp; geometry in a worker: geometry_exports.cpp;
// methods, looks and scenes: appearance_exports.cpp; live streams: live_exports.cpp.
//
// A returned record is owned by the handle and valid until the next fdvt_* call on it. Several handles may share a
// canvas (fdvt_create_beside). Every function that may use GL first makes the handle's own context current, so that
// handles of several canvases may coexist.
#include <malloc.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "base/later.h"
#include "instance.h"

using namespace fourdvt;

namespace {

struct FillRequest {
  abi::Request& out;
  void operator()(const FetchRange& r) const {
    out.kind = abi::RequestKind::Fetch;
    out.id = r.id;
    out.uri = text(r.uri);
    out.offset = static_cast<double>(r.offset);
    out.size = static_cast<double>(r.bytes);
  }
  void operator()(const CancelFetch& r) const { out.kind = abi::RequestKind::Cancel, out.id = r.id; }
  void operator()(const ConfigureDecoder& r) const {
    out.kind = abi::RequestKind::Configure;
    out.decoder = r.decoder;
    out.codec = text(r.codec);
    out.data = bytes(r.description);
    out.width = r.width;
    out.height = r.height;
  }
  void operator()(const DecodeSample& r) const {
    out.kind = abi::RequestKind::Decode;
    out.decoder = r.decoder;
    out.data = bytes(r.bytes);
    out.timestamp_us = static_cast<double>(r.timestamp_us);
    out.key = r.key;
    out.wanted = r.wanted;
  }
  void operator()(const FlushDecoder& r) const { out.kind = abi::RequestKind::Flush, out.decoder = r.decoder; }
  void operator()(const ResetDecoder& r) const { out.kind = abi::RequestKind::Reset, out.decoder = r.decoder; }
  void operator()(const CloseDecoder& r) const { out.kind = abi::RequestKind::Close, out.decoder = r.decoder; }
  static abi::Bytes bytes(std::span<const uint8_t> s) { return {s.data(), static_cast<uint32_t>(s.size())}; }
};

// Returns the device of a context; all canvases of the context share it with its programs.
Result<std::shared_ptr<gpu::Device>> deviceOf(int32_t context) {
  static int32_t known = 0;
  static std::weak_ptr<gpu::Device> shared;
  std::shared_ptr<gpu::Device> device = shared.lock();
  if (device && known == context) return device;
  FOURDVT_ASSIGN(device, gpu::createGlesDevice());
  known = context;
  shared = device;
  return device;
}

Status openCanvas(Canvas& canvas) {
  FOURDVT_ASSIGN(canvas.device, deviceOf(canvas.context));
  auto recipe = render::Recipe::create(*canvas.device);
  if (!recipe.ok()) return recipe.error();
  canvas.recipe = recipe.take();
  return {};
}

void openPlayer(Instance* h, abi::PictureKind kind, int32_t readable, int32_t slots) {
  PlayerOptions options;
  using render::PictureTextures;
  options.picture_kind = kind == abi::PictureKind::I420 ? PictureTextures::Kind::I420 : PictureTextures::Kind::Rgba;
  options.paced = kind == abi::PictureKind::Video;
  options.readable = readable != 0;
  options.picture_slots = slots;
  options.rendition = kAutomaticRendition;
  options.preview_seeks = true;
  options.transitions = false;
  auto player = Player::create(*h->canvas->device, h->canvas->recipe, options);
  if (player.ok()) h->player = player.take();
  if (!player.ok()) h->error = player.error();
}

Status drawTogether(Instance* const* handles, uint32_t count, const PinholeCamera& camera) {
  std::vector<render::Figure> figures;
  for (uint32_t i = 0; i < count; ++i) {
    auto figure = handles[i]->player->figure();
    if (!figure.ok()) return figure.error();
    figures.push_back(figure.value());
  }
  Canvas& canvas = *handles[0]->canvas;
  const bool has_scene = canvas.scene.room.corners || !canvas.scene.meshes.empty();
  const render::View view = render::viewFromCamera(camera, render::lengthScalesOf(figures));
  return canvas.recipe->draw(figures, has_scene ? &canvas.scene : nullptr, view,
                             {handles[0]->options, handles[0]->player->align(), handles[0]->player->method()},
                             gpu::kDefaultTarget);
}

// Debug views have the renderer's numbers.
static_assert(static_cast<int>(abi::DebugView::Labels) == static_cast<int>(render::DebugView::Labels) &&
              static_cast<int>(abi::DebugView::Layer) == static_cast<int>(render::DebugView::Layer) &&
              static_cast<int>(abi::DebugView::Weights) == static_cast<int>(render::DebugView::Weights) &&
              static_cast<int>(abi::DebugView::Normals) == static_cast<int>(render::DebugView::Normals));

static_assert(static_cast<int>(abi::Visibility::Plain) == static_cast<int>(render::Visibility::Plain) &&
              static_cast<int>(abi::Visibility::Offset) == static_cast<int>(render::Visibility::Offset) &&
              static_cast<int>(abi::Visibility::Fattened) == static_cast<int>(render::Visibility::Fattened));

// Decoder faults have the player's numbers.
static_assert(static_cast<int>(abi::DecoderFault::Unsupported) == static_cast<int>(DecoderFault::Unsupported) &&
              static_cast<int>(abi::DecoderFault::TakenAway) == static_cast<int>(DecoderFault::TakenAway));

// Pool of freed blocks, at most as many as one decoder uses at a time.
class PlaneBlocks {
 public:
  void* take(uint32_t size) {
    size_t best = free_.size();
    for (size_t i = 0; i < free_.size(); ++i)
      if (sizeOf(free_[i]) >= size && (best == free_.size() || sizeOf(free_[i]) < sizeOf(free_[best]))) best = i;
    if (best < free_.size()) {
      void* found = free_[best];
      free_.erase(free_.begin() + static_cast<ptrdiff_t>(best));
      return found;
    }
    // Replaces a block that is too small.
    if (!free_.empty()) release(0);
    auto* block = static_cast<uint8_t*>(std::malloc(kHead + size));
    *reinterpret_cast<uint32_t*>(block) = size;
    return block + kHead;
  }
  void giveBack(void* planes) {
    if (!planes) return;
    free_.push_back(planes);
    if (free_.size() > kMaxFree) release(0);
  }

 private:
  static constexpr size_t kHead = 16, kMaxFree = 5;
  static uint8_t* blockOf(void* planes) { return static_cast<uint8_t*>(planes) - kHead; }
  static uint32_t sizeOf(void* planes) { return *reinterpret_cast<const uint32_t*>(blockOf(planes)); }
  void release(size_t i) {
    std::free(blockOf(free_[i]));
    free_.erase(free_.begin() + static_cast<ptrdiff_t>(i));
  }
  std::vector<void*> free_;
};

PlaneBlocks& planeBlocks() {
  static PlaneBlocks blocks;
  return blocks;
}

}  // namespace

void* fdvt_alloc_planes(uint32_t size) { return planeBlocks().take(size); }
void fdvt_free_planes(void* planes) { planeBlocks().giveBack(planes); }
void* fdvt_alloc(uint32_t size) { return std::malloc(size); }
void fdvt_free(void* memory) { std::free(memory); }

Instance* fdvt_create(int32_t context, abi::PictureKind kind, int32_t readable, int32_t slots) {
  auto* h = new Instance;
  h->canvas = std::make_shared<Canvas>();
  h->canvas->context = context;
  makeCurrent(h);
  if (keep(h, openCanvas(*h->canvas))) openPlayer(h, kind, readable, slots);
  return h;
}
Instance* fdvt_create_beside(Instance* first, abi::PictureKind kind, int32_t readable, int32_t slots) {
  auto* h = new Instance;
  h->canvas = first->canvas;
  makeCurrent(h);
  openPlayer(h, kind, readable, slots);
  return h;
}
int32_t fdvt_ready(Instance* h) { return h->player != nullptr; }
void fdvt_destroy(Instance* h) {
  makeCurrent(h);
  delete h;
}
const abi::Error* fdvt_error(Instance* h) {
  h->records.error = recordOf(h->error);
  return &h->records.error;
}

void fdvt_manifest_number(Instance* h, const char* pointer, uint32_t size, double value) {
  h->manifest.set({pointer, size}, value);
}
void fdvt_manifest_string(Instance* h, const char* pointer, uint32_t size, const char* value, uint32_t value_size) {
  h->manifest.set({pointer, size}, std::string(value, value_size));
}
void fdvt_manifest_bool(Instance* h, const char* pointer, uint32_t size, int32_t value) {
  h->manifest.set({pointer, size}, value != 0);
}
int32_t fdvt_load(Instance* h, const uint8_t* start, uint32_t size) {
  makeCurrent(h);
  int ok = keep(h, h->player->loadManifest(h->manifest, {start, size}));
  if (ok && h->player->character()->appearance == package::AppearanceKind::Cameras)
    ok = later<&useMethodOfCharacter>(h);
  h->manifest = {};
  return ok;
}

void fdvt_play(Instance* h) { h->player->play(); }
void fdvt_pause(Instance* h) { h->player->pause(); }
void fdvt_seek_frame(Instance* h, uint32_t frame) {
  makeCurrent(h);
  h->player->seekFrame(frame);
}
void fdvt_seek(Instance* h, double time_s) {
  makeCurrent(h);
  h->player->seek(time_s);
}
void fdvt_set_rate(Instance* h, double rate) { h->player->setRate(rate); }
void fdvt_set_loop(Instance* h, int32_t loop) { h->player->setLoop(loop); }
int32_t fdvt_select(Instance* h, const char* name, uint32_t size) {
  makeCurrent(h);
  return keep(h, h->player->selectSequence({name, size}));
}

void fdvt_expect_throughput(Instance* h, double bits_per_second) { h->player->expectThroughput(bits_per_second); }
void fdvt_set_quality(Instance* h, int32_t rendition, uint32_t max_texels) {
  static_assert(kHighestRendition == uint32_t(-1) && kAutomaticRendition == uint32_t(-2));
  makeCurrent(h);
  h->player->setQuality(static_cast<uint32_t>(rendition), max_texels);
}
void fdvt_judge_rendition(Instance* h, uint32_t sequence, uint32_t rendition, int32_t plays) {
  h->player->judgeRendition(sequence, rendition, plays != 0);
}
void fdvt_look_ahead(Instance* h, int32_t at_once) { h->player->lookAhead(at_once != 0); }

void fdvt_tick(Instance* h, double now_s) {
  makeCurrent(h);
  h->player->tick(now_s);
}
const abi::Request* fdvt_next_request(Instance* h) {
  makeCurrent(h);
  if (!h->player->nextRequest(h->request)) return nullptr;
  h->records.request = {};
  std::visit(FillRequest{h->records.request}, h->request);
  return &h->records.request;
}
const abi::Event* fdvt_next_event(Instance* h) {
  abi::Event& out = h->records.event;
  if (h->fallback.is_new) {
    h->fallback.is_new = false;
    out = {
        text("methodfallback"), {text(h->fallback.wanted), text(h->fallback.message)}, text(h->fallback.drawn), 0, 0};
  } else {
    if (!h->player->nextEvent(h->event)) return nullptr;
    out = {text(eventName(h->event.kind)),
           recordOf(h->event.error),
           {},
           static_cast<double>(h->event.loaded_bytes),
           static_cast<double>(h->event.total_bytes)};
  }
  return &out;
}

void fdvt_range_received(Instance* h, uint32_t id, const uint8_t* data, uint32_t size) {
  makeCurrent(h);
  h->player->onRangeReceived(id, {data, size});
}
void fdvt_range_failed(Instance* h, uint32_t id, const char* reason, uint32_t size) {
  makeCurrent(h);
  h->player->onRangeFailed(id, {reason, size});
}
void fdvt_decoder_failed(Instance* h, int32_t decoder, abi::DecoderFault fault, const char* reason, uint32_t size) {
  makeCurrent(h);
  h->player->onDecoderFailed(decoder, static_cast<DecoderFault>(fault), {reason, size});
}
void fdvt_set_in_sight(Instance* h, int32_t in_sight) {
  makeCurrent(h);
  h->player->setInSight(in_sight != 0);
}

double fdvt_pace(Instance* h, int32_t decoder) { return h->player->pace(decoder); }
int32_t fdvt_acquire_slot(Instance* h, int32_t decoder, double timestamp_us) {
  makeCurrent(h);
  return h->player->acquireSlot(decoder, static_cast<int64_t>(timestamp_us));
}
void fdvt_upload(Instance* h, int32_t slot, void* block, const abi::Planes* layout) {
  makeCurrent(h);
  const abi::Planes& p = *layout;
  const auto* data = static_cast<const uint8_t*>(block);
  const I420View view{
      p.width,    p.height,   data + p.offset_y, data + p.offset_u, p.stride_v ? data + p.offset_v : nullptr,
      p.stride_y, p.stride_u, p.stride_v};
  h->player->uploadI420(
      slot, view, PictureBytes(block, [](const void* planes) { planeBlocks().giveBack(const_cast<void*>(planes)); }));
  h->player->commitSlot(slot);
}
uint32_t fdvt_slot_texture(Instance* h, int32_t slot) {
  return h->canvas->device->nativeTexture(h->player->slotTexture(slot));
}
void fdvt_commit_slot(Instance* h, int32_t slot, int32_t width, int32_t height) {
  makeCurrent(h);
  h->canvas->device->invalidateState();
  h->player->commitSlot(slot, width, height);
}
void fdvt_invalidate_state(Instance* h) {
  makeCurrent(h);
  h->canvas->device->invalidateState();
}

void fdvt_set_options(Instance* h, const abi::Options* options) {
  const double* b = options->background;
  h->options.background = glm::dvec4(b[0], b[1], b[2], b[3]);
  h->options.ground_shadow = options->ground_shadow != 0;
  h->options.shadow_strength = static_cast<float>(options->shadow_strength);
  h->options.samples = options->samples;
  h->options.debug = static_cast<render::DebugView>(options->debug);
  h->options.debug_layer = options->debug_layer;
}
int32_t fdvt_make_next_program(Instance* h) {
  makeCurrent(h);
  return h->player->makeNextProgram(h->options) ? 1 : 0;
}
int32_t fdvt_draw(Instance* const* characters, uint32_t count, const abi::View* view) {
  Instance* h = characters[0];
  if (view->width < 1 || view->height < 1)
    return fail(h, ErrorId::InvalidArgument, "picture without pixels: give the canvas a size");
  makeCurrent(h);
  return keep(h, drawTogether(characters, count, cameraOf(*view)));
}

const abi::State* fdvt_state(Instance* h) {
  const Player& p = *h->player;
  const PlayerStats s = p.stats();
  const gpu::Counters& c = h->canvas->device->counters();
  abi::State& out = h->records.state = {};
  out.has_frame = p.hasFrame();
  out.paused = p.paused();
  out.seeking = p.seeking();
  out.failed = p.failed();
  out.in_transition = p.inTransition();
  out.frame = static_cast<int32_t>(p.frame());
  out.sequence =
      p.character() && p.sequence() ? static_cast<int32_t>(p.sequence() - p.character()->sequences.data()) : -1;
  out.current_time_s = p.currentTime();
  out.frames_shown = static_cast<double>(s.frames_shown);
  out.frames_late = static_cast<double>(s.frames_late);
  out.barcode_checked = static_cast<double>(s.barcode_checked);
  out.barcode_mismatches = static_cast<double>(s.barcode_mismatches);
  out.bytes_fetched = static_cast<double>(s.bytes_fetched);
  out.encoded_bytes_held = static_cast<double>(s.encoded_bytes_held);
  out.live_texture_bytes = static_cast<double>(c.live_texture_bytes);
  out.live_target_bytes = static_cast<double>(c.live_target_bytes);
  out.rendition = s.rendition;
  out.decode_ms = 1e3 * s.decoded.rowSeconds();
  out.longest_decode_ms = 1e3 * s.decoded.longest_tick_s;
  out.worker_frames = static_cast<double>(s.decoded.elsewhere);
  const motion::Placement placement = p.placement();
  out.x_m = placement.ground_m.x;
  out.z_m = placement.ground_m.y;
  out.heading_rad = placement.heading_rad;
  h->goal = p.goal();
  out.goal = text(h->goal);
  return &out;
}
const abi::Character* fdvt_character(Instance* h) {
  const package::Character* c = h->player->character();
  if (!c) return nullptr;
  abi::Character& out = h->records.character = {};
  for (int i = 0; i < 3; ++i) out.bounds_min[i] = c->bounds.min[i], out.bounds_max[i] = c->bounds.max[i];
  out.ground_y_m = c->ground_y_m;
  out.sequences = static_cast<int32_t>(c->sequences.size());
  out.from_cameras = c->appearance == package::AppearanceKind::Cameras;
  if (out.from_cameras) out.method = text(h->canvas->method);
  out.has_mesh = h->player->hasMesh();
  out.name = text(c->name);
  out.poster_uri = text(c->poster_uri);
  out.room_uri = text(c->room.picture_uri);
  out.room_bytes = static_cast<double>(c->room.picture_bytes);
  return &out;
}
const abi::Sequence* fdvt_sequence(Instance* h, uint32_t index) {
  const package::Character* c = h->player->character();
  if (!c || index >= c->sequences.size()) return nullptr;
  const package::Sequence& s = c->sequences[index];
  h->records.sequence = {text(s.name),
                         static_cast<int32_t>(s.frame_count),
                         s.loop,
                         s.fps,
                         s.duration_s(),
                         static_cast<int32_t>(s.space.names.size()),
                         s.isClass() ? static_cast<int32_t>(s.members.size()) : 0};
  return &h->records.sequence;
}

const abi::TimeRange* fdvt_buffered(Instance* h, uint32_t number) {
  const std::optional<TimeRange> range = h->player->buffered(number);
  if (!range) return nullptr;
  h->records.range = {range->start_s, range->end_s};
  return &h->records.range;
}
double fdvt_clock_time(Instance* h) { return h->player->clockTime(); }
const abi::SurfacePoint* fdvt_surface_point(Instance* h, uint32_t vertex, const abi::View* view) {
  const std::optional<SurfacePoint> point = h->player->surfacePoint(vertex);
  if (!point) return nullptr;
  const PinholeCamera camera = cameraOf(*view);
  const glm::dvec3 pixel = camera.project(point->position);
  if (pixel.z <= 0) return nullptr;
  const bool facing = glm::dot(point->normal, camera.centreInWorld() - point->position) > 0;
  h->records.point = {pixel.x, pixel.y, facing};
  return &h->records.point;
}
int32_t fdvt_vertex_at(Instance* h, const abi::View* view, double x_px, double y_px) {
  const std::optional<uint32_t> vertex = h->player->vertexAt(cameraOf(*view), x_px, y_px);
  return vertex ? static_cast<int32_t>(*vertex) : -1;
}
double fdvt_heap_bytes(Instance*) { return static_cast<double>(static_cast<uint32_t>(mallinfo().uordblks)); }
