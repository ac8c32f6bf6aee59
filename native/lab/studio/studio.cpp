// SPDX-License-Identifier: Apache-2.0
#include "lab/studio/studio.h"

#include <cmath>

#include "base/text.h"
#include "capture/mesh_file.h"
#include "lab/studio/description.h"
#include "lab/studio/filming.h"
#include "lab/studio/truth.h"
#include "lab/studio/video.h"
#include "platform/files.h"

namespace fourdvt::studio {
namespace {

class Run {
 public:
  Run(const StudioOptions& options, StudioSet& set, const OutputFolder& out, Ticker& ticker)
      : options_(options), set_(set), out_(out), ticker_(ticker), filming_(options, set) {}

  Status write() {
    FOURDVT_TRY(calibration());
    FOURDVT_TRY(plates());
    for (size_t m = 0; m < set_.actor().motions().size(); ++m) FOURDVT_TRY(sequence(m));
    FOURDVT_TRY(writeTruth(set_, options_, out_, ticker_));
    return platform::writeFileAtomic(out_.path() + "/capture.json", captureText(set_, options_, filming_.room()));
  }
  uint32_t frames() const { return frames_; }

 private:
  Status calibration() {
    FOURDVT_TRY(writeColmap(out_.path() + "/cameras", miscalibrated(set_.rig().ring, options_.knobs), options_.scale,
                            options_.knobs.lens));
    FOURDVT_TRY(writeColmap(out_.path() + "/cameras_true", set_.rig().ring, options_.scale, options_.knobs.lens));
    return writeColmap(out_.path() + "/cameras_test", set_.rig().test, options_.scale);
  }

  // Writes background/camNN.png, or for several plates background/camNN/000000.png ….
  Status plates() {
    if (options_.plates == 0) return {};
    FOURDVT_TRY(out_.makeFolder("background"));
    const bool several = options_.plates > 1;
    for (size_t c = 0; c < set_.rig().ring.size(); ++c) {
      const std::string stem = out_.path() + "/background/" + set_.rig().ring[c].name;
      if (several) FOURDVT_TRY(platform::makeFolder(stem));
      for (uint32_t take = 0; take < uint32_t(options_.plates); ++take)
        FOURDVT_TRY(
            platform::writeImage(several ? stem + printed("/%06u.png", take) : stem + ".png", filming_.plate(c, take)));
    }
    return {};
  }

  Status openFiles(const std::string& name) {
    const std::string folder = out_.path() + "/" + name;
    const std::string matte_folder = options_.room ? out_.path() + "/mattes_true/" + name : folder;
    if (options_.room) FOURDVT_TRY(out_.makeFolder("mattes_true/" + name));
    colour_.clear();
    mattes_.clear();
    for (const PinholeCamera& camera : set_.rig().ring)
      for (const int channels : {3, 1}) {
        const std::string stem = channels == 3 ? camera.name : "mask" + camera.name.substr(3);
        const std::string& in = channels == 3 ? folder : matte_folder;
        FOURDVT_ASSIGN(auto file, PictureFile::create(in + "/" + stem, {options_.width, options_.height, channels,
                                                                        options_.fps, options_.images}));
        (channels == 3 ? colour_ : mattes_).push_back(std::move(file));
      }
    return {};
  }

  Status sequence(size_t index) {
    const Motion& motion = set_.actor().motions()[index];
    ticker_.begin(motion.name);
    const uint32_t whole = frameCount(motion, options_.fps), count = filmedFrames(motion, options_);
    const std::string folder = out_.path() + "/" + motion.name;
    FOURDVT_TRY(out_.makeFolder(motion.name + "/mesh"));
    for (const PinholeCamera& camera : set_.rig().test) FOURDVT_TRY(out_.makeFolder(motion.name + "/" + camera.name));
    FOURDVT_TRY(openFiles(motion.name));
    std::vector<uint8_t> packed;
    for (uint32_t frame = 0; frame < count; ++frame) {
      filming_.begin({index, frame, whole, frames_});
      const Positions mesh = set_.captured();
      capture::appendPacked(mesh, set_.unitsPerMetre(), packed);
      if (frames_ == 0)
        FOURDVT_TRY(platform::writeFileAtomic(out_.path() + "/mesh_topology.obj",
                                              capture::objText(set_.actor().tracked().topology, mesh, options_.scale)));
      if (frame % options_.test_every == 0) FOURDVT_TRY(holdOut(folder, frame));
      FOURDVT_TRY(photograph());
      ++frames_;
    }
    for (auto* files : {&colour_, &mattes_})
      for (const auto& file : *files) FOURDVT_TRY(file->finish());
    return platform::writeFileAtomic(folder + "/mesh/positions.i16", packed);
  }

  Status photograph() {
    for (size_t c = 0; c < colour_.size(); ++c) {
      FOURDVT_ASSIGN(auto recorded, filming_.record(c));
      FOURDVT_TRY(colour_[c]->write(recorded.colour));
      FOURDVT_TRY(mattes_[c]->write(recorded.matte));
      FOURDVT_TRY(ticker_.tick());
    }
    return {};
  }

  Status holdOut(const std::string& folder, uint32_t frame) {
    for (const PinholeCamera& camera : set_.rig().test) {
      FOURDVT_ASSIGN(auto picture, set_.draw(camera));
      unpremultiply(picture);
      FOURDVT_TRY(platform::writeImage(folder + "/" + camera.name + printed("/%04u.png", frame), picture));
      FOURDVT_TRY(ticker_.tick());
    }
    return {};
  }

  const StudioOptions& options_;
  StudioSet& set_;
  const OutputFolder& out_;
  Ticker& ticker_;
  Filming filming_;
  std::vector<std::unique_ptr<PictureFile>> colour_, mattes_;  // open files of the current sequence
  uint32_t frames_ = 0;
};

Status roomIsLargeEnough(const StudioOptions& options, const Rig& rig) {
  const double min_m = (options.bystander ? 1.25 : 1) * Room::leastSize_m(rig);
  if (options.room_size_m == 0 || options.room_size_m >= min_m) return {};
  const std::string size = printed("%.1f", std::ceil(10 * min_m) / 10);
  return Error{
      ErrorId::InvalidArgument,
      std::string("the cameras (and the bystander behind them) do not fit into the room; its size must be at least ") +
          size + " m"};
}

uint32_t sequencePictures(const StudioSet& set, const StudioOptions& options) {
  uint32_t pictures = 0;
  for (const Motion& motion : set.actor().motions()) {
    const uint32_t frames = filmedFrames(motion, options);
    pictures += frames * uint32_t(set.rig().ring.size());
    pictures += (frames - 1) / options.test_every * uint32_t(set.rig().test.size()) + uint32_t(set.rig().test.size());
  }
  return pictures;
}

}  // namespace

Result<StudioReport> runStudio(const StudioOptions& options, const StudioEnvironment& environment) {
  if (const std::string wrong = options.check(); !wrong.empty()) return Error{ErrorId::InvalidArgument, wrong};
  FOURDVT_ASSIGN(auto out, OutputFolder::open(options.folder));
  FOURDVT_ASSIGN(auto set, StudioSet::open(options, *environment.device));
  FOURDVT_TRY(roomIsLargeEnough(options, set->rig()));
  Ticker ticker(environment, sequencePictures(*set, options) + truthPictures(*set, options));
  Run run(options, *set, out, ticker);
  FOURDVT_TRY(run.write());
  FOURDVT_TRY(out.keep());
  const MeshTopology& mesh = set->actor().tracked().topology;
  return StudioReport{mesh.vertex_count, mesh.faceCount(), run.frames(), ticker.done()};
}

}  // namespace fourdvt::studio
