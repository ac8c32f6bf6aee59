// SPDX-License-Identifier: Apache-2.0
#include "live/server/recorder.h"

#include <atomic>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <mutex>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <thread>

#include "base/text.h"
#include "capture/pictures.h"
#include "capture/undistort.h"
#include "live/server/live_hull.h"
#include "platform/files.h"
#include "platform/video_writer.h"

namespace fourdvt::live {
namespace {

constexpr uint8_t kNoPlate = 128;
constexpr int kPictureCrf = 14;

// Cameras of the transmitted pictures: without distortion.
std::vector<capture::CaptureCamera> pinholes(const Rig& rig) {
  std::vector<capture::CaptureCamera> out;
  for (const RigCamera& camera : rig.cameras) out.push_back({camera.camera.pinhole, {}});
  return out;
}

Result<Image> decodedCrop(const CameraPicture& picture) {
  const cv::Mat encoded(1, int(picture.jpeg.size()), CV_8U, const_cast<uint8_t*>(picture.jpeg.data()));
  Image out(picture.crop.width, picture.crop.height, 3);
  try {
    const cv::Mat bgr = cv::imdecode(encoded, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
    if (bgr.cols != out.width || bgr.rows != out.height)
      return Error{ErrorId::FileUnreadable, "a camera's JPEG does not decode; use the same version on all sides"};
    cv::Mat rgb(out.height, out.width, CV_8UC3, out.pixels.data());
    cv::cvtColor(bgr, rgb, cv::COLOR_BGR2RGB);
  } catch (const cv::Exception&) {
    return Error{ErrorId::FileUnreadable, "a camera's JPEG does not decode; use the same version on all sides"};
  }
  return out;
}

// Videos of one take.
class Take {
 public:
  static Result<std::unique_ptr<Take>> open(const std::string& folder,
                                            const std::vector<capture::CaptureCamera>& cameras, double fps) {
    auto take = std::make_unique<Take>();
    FOURDVT_TRY(platform::makeFolder(folder));
    for (const capture::CaptureCamera& camera : cameras) {
      const PinholeCamera& p = camera.pinhole;
      platform::VideoFormat format{p.width, p.height, 3, fps, kPictureCrf, "ultrafast"};
      FOURDVT_ASSIGN(take->colours_.emplace_back(),
                     platform::VideoWriter::create(folder + "/" + p.name + ".mkv", format));
      format.channels = 1;
      FOURDVT_ASSIGN(take->mattes_.emplace_back(),
                     platform::VideoWriter::create(folder + "/" + capture::matteStem(p.name) + ".mkv", format));
    }
    return take;
  }

  Status write(const Instant& instant, const std::vector<Image>& plates) {
    for (size_t c = 0; c < plates.size(); ++c) {
      const CameraPicture& picture = instant.pictures[c]->picture;
      Image whole = plates[c];
      if (picture.crop.width > 0) {
        const auto crop = decodedCrop(picture);
        for (int y = 0; crop.ok() && y < crop.value().height; ++y)
          std::copy_n(crop.value().at(0, y), size_t(crop.value().width) * 3,
                      whole.at(picture.crop.x, picture.crop.y + y));
      }
      FOURDVT_TRY(colours_[c]->write(whole));
      Image matte(whole.width, whole.height, 1);
      if (!picture.rings.empty()) {
        const auto& background = coverage_.draw(picture.rings, {0, 0, matte.width, matte.height}, matte.width,
                                                matte.height, matte.width, matte.height);
        for (size_t i = 0; i < matte.pixels.size(); ++i) matte.pixels[i] = uint8_t(255 * (1 - background[i]) + 0.5f);
      }
      FOURDVT_TRY(mattes_[c]->write(matte));
    }
    ++frames_;
    return {};
  }

  Status finish() {
    for (auto* writers : {&colours_, &mattes_})
      for (auto& writer : *writers) FOURDVT_TRY(writer->finish());
    return {};
  }

  uint32_t frames() const { return frames_; }

 private:
  std::vector<std::unique_ptr<platform::VideoWriter>> colours_, mattes_;
  RingCoverage coverage_;
  uint32_t frames_ = 0;
};

class FolderRecorder final : public Recorder {
 public:
  FolderRecorder(const Rig& rig, const std::string& folder, std::function<void(const std::string&)> on_warning)
      : rig_(rig), folder_(folder), on_warning_(std::move(on_warning)), cameras_(pinholes(rig)) {}

  ~FolderRecorder() override {
    {
      const std::lock_guard lock(mutex_);
      waiting_.emplace_back(std::nullopt);
      stop_ = true;
    }
    wake_.notify_all();
    if (thread_.joinable()) thread_.join();
  }

  Status begin() {
    std::error_code ignored;
    if (std::filesystem::exists(folder_, ignored) && !std::filesystem::is_empty(folder_, ignored))
      return Error{ErrorId::WriteFailed, folder_ + ": holds something already; choose an empty folder to record into"};
    for (const capture::CaptureCamera& camera : cameras_)
      if (camera.pinhole.width % 2 || camera.pinhole.height % 2)
        return Error{ErrorId::InvalidArgument, "camera \"" + camera.pinhole.name +
                                                   "\" has pictures of an odd size, which cannot be recorded; record "
                                                   "without it, or crop its pictures and its calibration"};
    FOURDVT_TRY(platform::makeFolder(folder_ + "/cameras"));
    const capture::ColmapText text = capture::colmapText(cameras_, 1);
    FOURDVT_TRY(platform::writeFileAtomic(folder_ + "/cameras/cameras.txt", text.cameras));
    FOURDVT_TRY(platform::writeFileAtomic(folder_ + "/cameras/images.txt", text.images));
    for (const RigCamera& camera : rig_.cameras) FOURDVT_TRY(copyPlates(camera));
    thread_ = std::thread([this] { run(); });
    return {};
  }

  void add(const Instant& instant) override {
    const bool whole = instant.count() == cameras_.size();
    bool overflow = false;
    {
      const std::lock_guard lock(mutex_);
      const bool full = waiting_.size() >= kMaxWaiting;
      overflow = full && !overflowed_ && whole;
      overflowed_ = full || (overflowed_ && waiting_.size() > kMaxWaiting / 2);
      const bool ends = overflowed_ || !whole || instant.slot != last_slot_ + 1;
      if (ends && !ended_) waiting_.emplace_back(std::nullopt), ended_ = true;
      last_slot_ = instant.slot;
      if (whole && !overflowed_) waiting_.emplace_back(instant), ended_ = false;
    }
    wake_.notify_all();
    if (overflow) on_warning_("recording cannot keep up: the take ends, and another begins when it can");
  }

  uint64_t recorded() const override { return recorded_; }

 private:
  // Writes plates without distortion; the first one is the background onto which crops are pasted.
  Status copyPlates(const RigCamera& camera) {
    const PinholeCamera& p = camera.camera.pinhole;
    plates_.emplace_back(p.width, p.height, 3, kNoPlate);
    std::error_code ignored;
    const std::string base = rig_.background_folder + "/" + p.name;
    if (rig_.background_folder.empty() ||
        (!std::filesystem::exists(base + ".png", ignored) && !std::filesystem::exists(base, ignored)))
      return {};
    FOURDVT_ASSIGN(auto read, readRigPlates(rig_, camera, "; recording copies the plates"));
    const capture::Undistorter undistorter(camera.camera);
    const std::string folder = folder_ + "/background/" + p.name;
    FOURDVT_TRY(platform::makeFolder(folder));
    for (size_t i = 0; i < read.size(); ++i) {
      const Image plate = undistorter.apply(std::move(read[i]));
      const std::string name = printed("/%06zu.png", i);
      FOURDVT_TRY(platform::writeImage(folder + name, plate));
      if (i == 0) plates_.back() = plate;
    }
    return {};
  }

  void run() {
    for (;;) {
      std::optional<Instant> next;
      {
        std::unique_lock lock(mutex_);
        wake_.wait(lock, [&] { return stop_ || !waiting_.empty(); });
        if (waiting_.empty()) return;
        next = std::move(waiting_.front());
        waiting_.pop_front();
      }
      const Status done = failed_ ? Status() : next ? write(std::move(*next)) : endTake();
      if (done.ok()) continue;
      failed_ = true;
      take_.reset();
      on_warning_("recording ends: " + done.error().message);
    }
  }

  Status write(Instant instant) {
    if (!take_) {
      begun_.push_back(std::move(instant));
      if (begun_.size() < kMinFrames) return {};
      FOURDVT_ASSIGN(take_, Take::open(folder_ + "/" + nextName(), cameras_, rig_.fps));
      for (const Instant& early : begun_) FOURDVT_TRY(writeFrame(early));
      begun_.clear();
      return {};
    }
    return writeFrame(instant);
  }

  Status writeFrame(const Instant& instant) {
    FOURDVT_TRY(take_->write(instant, plates_));
    ++recorded_;
    return {};
  }

  std::string nextName() const { return "take" + std::to_string(sequences_.size() + 1); }

  Status endTake() {
    begun_.clear();
    if (!take_) return {};
    FOURDVT_TRY(take_->finish());
    sequences_.push_back({{"name", nextName()}, {"frames", take_->frames()}});
    take_.reset();
    const nlohmann::ordered_json capture = {{"name", rig_.name},
                                            {"fps", rig_.fps},
                                            {"units", "metre"},
                                            {"ground_y", rig_.ground_y_m},
                                            {"sequences", sequences_}};
    return platform::writeFileAtomic(
        folder_ + "/capture.json",
        capture.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
  }

  const Rig rig_;
  const std::string folder_;
  const std::function<void(const std::string&)> on_warning_;
  const std::vector<capture::CaptureCamera> cameras_;
  std::vector<Image> plates_;  // per camera, RGB

  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<std::optional<Instant>> waiting_;  // none: the take ends
  bool stop_ = false, ended_ = true, overflowed_ = false;
  int64_t last_slot_ = INT64_MIN;

  std::vector<Instant> begun_;  // frames of a take that is still too short
  std::unique_ptr<Take> take_;
  std::vector<nlohmann::ordered_json> sequences_;
  bool failed_ = false;
  std::atomic<uint64_t> recorded_{0};
  std::thread thread_;
};

}  // namespace

Result<std::unique_ptr<Recorder>> Recorder::start(const Rig& rig, const std::string& folder,
                                                  std::function<void(const std::string&)> on_warning) {
  auto recorder = std::make_unique<FolderRecorder>(rig, folder, std::move(on_warning));
  FOURDVT_TRY(recorder->begin());
  return std::unique_ptr<Recorder>(std::move(recorder));
}

}  // namespace fourdvt::live
