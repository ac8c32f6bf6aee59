// SPDX-License-Identifier: Apache-2.0
// Live player with the manifest of live_stream_fixture.h, fed with arbitrary messages (each after its length in 4
// bytes, little endian; length 0: an interruption) and pictures of arbitrary frames: it shows only matching pairs, and
// its memory is bounded.
#include <cstdlib>
#include <cstring>

#include "../unit/live_stream_fixture.h"
#include "package/barcode.h"
#include "player/live_player.h"

using namespace fourdvt;

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

// Decodes a sample as the number of its frame, or as an arbitrary one.
void decode(LivePlayer& player) {
  for (Request request; player.nextRequest(request);) {
    const auto* sample = std::get_if<DecodeSample>(&request);
    if (!sample) continue;
    const uint32_t number = sample->bytes.back() | (sample->bytes.size() > 1 ? sample->bytes.rbegin()[1] << 8 : 0);
    const int64_t timestamp_us = sample->timestamp_us;
    if (number % 16 == 15) {
      player.onDecoderFailed(0, static_cast<DecoderFault>(number / 16 % 3), "fuzz");
      continue;
    }
    const int slot = player.acquireSlot(0, timestamp_us);
    if (slot < 0) continue;
    const auto planes = std::make_shared<std::vector<uint8_t>>(192 * 64, uint8_t{128});
    uint8_t* luma = planes->data();
    package::drawBarcode({{0, 4, 128, 4}, 4}, number, luma, 192);
    player.uploadI420(slot, {192, 64, luma, luma, luma, 192, 96, 96}, planes);
    player.commitSlot(slot);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const std::unique_ptr<gpu::Device> device = gpu::createNullDevice();
  static const std::shared_ptr<render::Recipe> recipe = render::Recipe::create(*device).take();
  auto player = LivePlayer::create(*device, recipe, {}).take();
  require(player->loadManifest(testing::liveManifest(), {}).ok());
  player->play();
  double now_s = 0;
  for (size_t at = 0; at + 4 <= size;) {
    uint32_t length = 0;
    std::memcpy(&length, data + at, 4);
    at += 4;
    length = static_cast<uint32_t>(std::min<size_t>(length, size - at));
    if (length == 0)
      player->onLiveGap();
    else
      (void)player->onLiveFrame({data + at, length});
    at += length;
    if (length % 3 > 0) decode(*player);
    if (length % 5 > 0) player->tick(now_s += 0.016);
    for (Event event; player->nextEvent(event);) {
    }
    require(player->stats().encoded_bytes_held <= 8 * package::kMaxLiveFrameBytes);
    if (!player->hasFrame()) continue;
    const auto figure = player->figure();
    require(figure.ok() && figure.value().model->face_count > 0 && figure.value().model->face_count <= 400);
  }
  require(device->takeErrors().empty());
  return 0;
}
