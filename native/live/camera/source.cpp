// SPDX-License-Identifier: Apache-2.0
#include "live/camera/source.h"

#include <chrono>
#include <cmath>
#include <thread>

#include "capture/pictures.h"
#include "platform/video_input.h"

namespace fourdvt::live {
namespace {

constexpr int64_t kLongestSleep_us = 20000;  // bounds the delay of a stop

class InputSource final : public Source {
 public:
  InputSource(const Rig& rig, const RigCamera& camera, const std::atomic<bool>& stop)
      : camera_(camera.camera),
        filmed_(camera.filmed),
        reduce_(rig.reduce),
        url_(camera.source->url),
        fps_(rig.fps),
        stop_(stop) {}

  Status open(const SourcePlace& place) {
    FOURDVT_ASSIGN(input_, platform::VideoInput::open({place.url, place.format, place.options}, &stop_));
    FOURDVT_TRY(input_->isFile() ? input_->decode(0) : input_->decodeNext());
    Image first;
    FOURDVT_TRY(input_->convert(first));
    return capture::checkSize(first, filmed_, url_);
  }

  Result<bool> next(SourcePicture& out) override { return input_->isFile() ? nextOfFile(out) : nextOfDevice(out); }

 private:
  Result<bool> nextOfFile(SourcePicture& out) {
    slot_ = std::max(slot_ + 1, slotAt(systemNow_us(), fps_));
    FOURDVT_TRY(input_->decode(uint32_t(slot_ % input_->pictures())));
    FOURDVT_TRY(take(out));
    out.captured_us = slotBegin_us(slot_, fps_);
    return waitUntil(out.captured_us);
  }

  Result<bool> nextOfDevice(SourcePicture& out) {
    const Status decoded = input_->decodeNext();
    if (stop_) return false;
    if (!decoded.ok()) return decoded.error();
    const int64_t stamp_us = input_->wallClock_us();
    out.captured_us = stamp_us ? stamp_us : systemNow_us();
    FOURDVT_TRY(take(out));
    return true;
  }

  Status take(SourcePicture& out) {
    FOURDVT_TRY(input_->convert(out.rgb, reduce_));
    return capture::checkSize(out.rgb, camera_, url_);
  }

  bool waitUntil(int64_t due_us) const {
    for (int64_t now_us; !stop_ && (now_us = systemNow_us()) < due_us;)
      std::this_thread::sleep_for(std::chrono::microseconds(std::min(due_us - now_us, kLongestSleep_us)));
    return !stop_;
  }

  const capture::CaptureCamera camera_, filmed_;
  const int reduce_;
  const std::string url_;
  const double fps_;
  const std::atomic<bool>& stop_;
  std::unique_ptr<platform::VideoInput> input_;
  int64_t slot_ = 0;
};

}  // namespace

int64_t systemNow_us() {
  using namespace std::chrono;
  return duration_cast<microseconds>(system_clock::now().time_since_epoch()).count();
}

int64_t slotBegin_us(int64_t slot, double fps) { return static_cast<int64_t>(std::llround(double(slot) * 1e6 / fps)); }

int64_t slotAt(int64_t now_us, double fps) {
  auto slot = static_cast<int64_t>(std::floor(double(now_us) * fps / 1e6));
  while (slotBegin_us(slot + 1, fps) <= now_us) ++slot;  // corrects the product's rounding
  while (slotBegin_us(slot, fps) > now_us) --slot;
  return slot;
}

Result<std::unique_ptr<Source>> Source::open(const Rig& rig, const RigCamera& camera, const std::atomic<bool>& stop) {
  if (!camera.source)
    return Error{ErrorId::InvalidArgument, rig.path + ": camera \"" + camera.camera.pinhole.name +
                                               "\" has no source; give it one in \"sources\""};
  auto source = std::make_unique<InputSource>(rig, camera, stop);
  FOURDVT_TRY(source->open(*camera.source));
  return std::unique_ptr<Source>(std::move(source));
}

}  // namespace fourdvt::live
