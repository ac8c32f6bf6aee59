// SPDX-License-Identifier: Apache-2.0
// C ABI, live streams. Ownership of records: exports.cpp.
#include "instance.h"
#include "player/live_player.h"

using namespace fourdvt;

int32_t fdvt_live_load(Instance* h, abi::PictureKind kind, int32_t readable, int32_t slots) {
  makeCurrent(h);
  PlayerOptions options;
  using render::PictureTextures;
  options.picture_kind = kind == abi::PictureKind::I420 ? PictureTextures::Kind::I420 : PictureTextures::Kind::Rgba;
  options.readable = readable != 0;
  options.picture_slots = slots;
  auto made = LivePlayer::create(*h->canvas->device, h->canvas->recipe, options);
  if (!made.ok()) return keep(h, made.error());
  h->live = made.value().get();
  h->player = made.take();
  const int32_t ok = keep(h, h->player->loadManifest(h->manifest));
  h->manifest = {};
  return ok && useMethodOfCharacter(h);
}

int32_t fdvt_live_frame(Instance* h, const uint8_t* message, uint32_t size) {
  makeCurrent(h);
  if (!h->live) return fail(h, ErrorId::InvalidArgument, "this character is not live");
  if (size > 0) return keep(h, h->live->onLiveFrame({message, size}));
  h->live->onLiveGap();
  return 1;
}
double fdvt_live_captured_us(Instance* h) { return h->live ? static_cast<double>(h->live->capturedUs()) : 0; }
