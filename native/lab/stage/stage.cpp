// SPDX-License-Identifier: Apache-2.0
#include "lab/stage/stage.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "capture/pictures.h"
#include "capture/undistort.h"
#include "lab/stage/counter.h"
#include "lab/stage/fit.h"
#include "mattes/background_model.h"
#include "mattes/frame_reader.h"
#include "platform/files.h"
#include "platform/video_writer.h"

namespace fourdvt::stage {
namespace {

using Json = nlohmann::ordered_json;
constexpr int kCountedPictures = 1000, kMaxPictures = 4096;  // numbers are modulo 4096
constexpr int kCellAt240Lines_px = 4;
constexpr int kCrf = 16;

Image withoutMatte(const Image& rgba) {
  Image out(rgba.width, rgba.height, 3);
  for (size_t i = 0; i < out.pixels.size() / 3; ++i) std::copy_n(&rgba.pixels[4 * i], 3, &out.pixels[3 * i]);
  return out;
}

Image matteOf(const Image& rgba) {
  Image out(rgba.width, rgba.height, 1);
  for (size_t i = 0; i < out.pixels.size(); ++i) out.pixels[i] = rgba.pixels[4 * i + 3];
  return out;
}

class StageWriter {
 public:
  StageWriter(const capture::Capture& capture, const StageOptions& options, const OpenVideo& open_video)
      : capture_(capture), options_(options), open_video_(open_video) {}

  Status write(const std::function<void(const std::string&, uint32_t)>& progress) {
    FOURDVT_TRY(choose());
    std::error_code failed;
    for (const char* folder : {"cameras", "background", "videos"})
      std::filesystem::create_directories(options_.folder + "/" + folder, failed);
    if (failed)
      return Error{ErrorId::WriteFailed, options_.folder + ": cannot be made; choose a folder that you may write to"};
    std::vector<capture::CaptureCamera> cameras;
    Json sources, places;
    for (const auto& camera : chosen_) {
      const std::string& name = camera.pinhole.name;
      const Fit fit = fitInto(camera.pinhole.width, camera.pinhole.height, options_.width, options_.height);
      cameras.push_back({fitted(camera.pinhole, fit), {}});
      FOURDVT_ASSIGN(const Image plate, writePlate(camera, fit));
      FOURDVT_ASSIGN(places[name], writeVideo(camera, fit, plate, progress));
      sources[name] = "videos/" + name + ".mp4";
    }
    const capture::ColmapText text = capture::colmapText(cameras, 1);
    FOURDVT_TRY(platform::writeFileAtomic(options_.folder + "/cameras/cameras.txt", text.cameras));
    FOURDVT_TRY(platform::writeFileAtomic(options_.folder + "/cameras/images.txt", text.images));
    if (options_.counter) FOURDVT_TRY(writeCounter(places));
    const Json rig{{"name", capture_.name},
                   {"fps", capture_.fps},
                   {"units", "metre"},
                   {"ground_y", capture_.ground_y_m},
                   {"sources", sources}};
    return platform::writeFileAtomic(options_.folder + "/RIG.json", rig.dump(2) + "\n");
  }

 private:
  static Error wrong(const std::string& what) { return {ErrorId::InvalidArgument, what}; }

  Status choose() {
    if (options_.width < 2 || options_.height < 2 || options_.width % 2 || options_.height % 2)
      return wrong("--size must be even");
    sequence_ = options_.sequence.empty() ? &capture_.sequences.at(0) : capture_.find(options_.sequence);
    if (!sequence_) return wrong(capture_.folder + ": no sequence \"" + options_.sequence + "\"");
    for (const auto& camera : capture_.cameras) {
      const auto& only = options_.cameras;
      if (only.empty() || std::find(only.begin(), only.end(), camera.pinhole.name) != only.end())
        chosen_.push_back(camera);
    }
    if (chosen_.empty() || (!options_.cameras.empty() && chosen_.size() != options_.cameras.size()))
      return wrong(capture_.folder + ": --cameras names one that the capture has not");
    const int otherwise = options_.counter ? kCountedPictures : int(sequence_->frame_count);
    pictures_ = options_.pictures > 0 ? options_.pictures : otherwise;
    if (options_.counter && pictures_ > kMaxPictures) return wrong("--pictures must be at most 4096 with --counter");
    cell_px_ = std::max(kCellAt240Lines_px, kCellAt240Lines_px * options_.height / 240);
    return {};
  }

  // Returns the mean of the plates at the stage's size.
  Result<Image> writePlate(const capture::CaptureCamera& camera, const Fit& fit) const {
    FOURDVT_ASSIGN(auto plates, capture::readPlates(capture_, camera,
                                                    "no readable picture of the empty stage, which live keying needs; "
                                                    "add it to the capture"));
    const capture::Undistorter undistorter(camera);
    const Image mean = mattes::meanPicture(mattes::makeBackgroundModel(plates.pictures));
    const std::string stem = options_.folder + "/background/" + camera.pinhole.name;
    if (plates.pictures.size() > 1) std::filesystem::create_directories(stem);
    for (size_t i = 0; i < plates.pictures.size(); ++i) {
      const std::string number = std::to_string(i);
      const std::string path = plates.pictures.size() == 1
                                   ? stem + ".png"
                                   : stem + "/" + std::string(6 - number.size(), '0') + number + ".png";
      FOURDVT_TRY(platform::writeImage(path, fitted(undistorter.apply(std::move(plates.pictures[i])), fit)));
    }
    return fitted(undistorter.apply(mean), fit);
  }

  // Returns the counter's corners; null if not counted.
  Result<Json> writeVideo(const capture::CaptureCamera& camera, const Fit& fit, const Image& plate,
                          const std::function<void(const std::string&, uint32_t)>& progress) const {
    capture::Capture alone = capture_;
    alone.cameras = {camera};
    const auto need = options_.counter ? capture::MatteNeed::Required : capture::MatteNeed::None;
    FOURDVT_ASSIGN(auto reader, mattes::FrameReader::open(alone, *sequence_, open_video_, 0, need));
    const int frames = std::min(pictures_, int(sequence_->frame_count));
    std::vector<Image> pictures;
    std::vector<std::optional<glm::ivec2>> corners;
    Json places = Json::array();
    for (int f = 0; f < frames; ++f) {
      FOURDVT_ASSIGN(const auto frame, reader->next());
      pictures.push_back(fitted(withoutMatte(frame.pictures[0]), fit, plate));
      if (!options_.counter) continue;
      const Image matte = fitted(matteOf(frame.pictures[0]), fit, Image(fit.width, fit.height, 1));
      corners.push_back(counterPlace(matte, cell_px_));
      places.push_back(corners.back() ? Json{corners.back()->x, corners.back()->y} : Json());
    }
    const std::string path = options_.folder + "/videos/" + camera.pinhole.name + ".mp4";
    FOURDVT_ASSIGN(auto video,
                   platform::VideoWriter::create(path, {fit.width, fit.height, 3, capture_.fps, kCrf, "fast"}));
    for (int i = 0; i < pictures_; ++i) {
      if (progress) progress(camera.pinhole.name, uint32_t(i));
      const size_t frame = size_t(i % frames);
      Image picture = pictures[frame];
      if (options_.counter && corners[frame]) drawCounter(picture, *corners[frame], cell_px_, uint32_t(i));
      FOURDVT_TRY(video->write(picture));
    }
    FOURDVT_TRY(video->finish());
    return places;
  }

  Status writeCounter(const Json& places) const {
    const Json out{{"cell_px", cell_px_},
                   {"columns", kCounterColumns},
                   {"rows", kCounterRows},
                   {"pictures", pictures_},
                   {"frames", std::min(pictures_, int(sequence_->frame_count))},
                   {"cameras", places}};
    return platform::writeFileAtomic(options_.folder + "/counter.json", out.dump() + "\n");
  }

  const capture::Capture& capture_;
  const StageOptions& options_;
  const OpenVideo& open_video_;
  const capture::CaptureSequence* sequence_ = nullptr;
  std::vector<capture::CaptureCamera> chosen_;
  int pictures_ = 0, cell_px_ = 0;
};

}  // namespace

Status writeStage(const capture::Capture& capture, const StageOptions& options, const OpenVideo& open_video,
                  const std::function<void(const std::string&, uint32_t)>& progress) {
  return StageWriter(capture, options, open_video).write(progress);
}

}  // namespace fourdvt::stage
