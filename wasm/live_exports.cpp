// SPDX-License-Identifier: Apache-2.0
// The C ABI's functions for live streams. exports.cpp says who owns what.
#include "instance.h"
#include "player/live_player.h"

using namespace fourdvt;

int32_t fdvt_live_load(Instance* h, abi::PictureKind kind, int32_t slots) {
  makeCurrent(h);
  PlayerOptions options;
  using render::PictureTextures;
  options.picture_kind = kind == abi::PictureKind::Rgba ? PictureTextures::Kind::Rgba : PictureTextures::Kind::I420;
  options.picture_slots = slots;
  options.cameras = &cameraParts();
  auto made = LivePlayer::create(*h->canvas->device, h->canvas->recipe, options);
  if (!made.ok()) return keep(h, made.error());
  h->live = made.value().get();
  h->player = made.take();
  int32_t ok = keep(h, h->player->loadManifest(h->manifest));
  h->manifest = {};
  if (ok && h->canvas->method.empty())
    ok = fdvt_set_method(h, "", 0, h->player->method().closest, abi::Visibility::Offset);
  return ok;
}

int32_t fdvt_live_frame(Instance* h, const uint8_t* message, uint32_t size) {
  makeCurrent(h);
  if (!h->live) return fail(h, ErrorId::InvalidArgument, "this character is not live");
  return keep(h, h->live->onLiveFrame({message, size}));
}
void fdvt_live_gap(Instance* h) {
  makeCurrent(h);
  if (h->live) h->live->onLiveGap();
}
double fdvt_live_captured_us(Instance* h) { return h->live ? static_cast<double>(h->live->capturedUs()) : 0; }
