// SPDX-License-Identifier: Apache-2.0
#include "mattes/run/matte_sources.h"

#include <algorithm>
#include <filesystem>

#include "base/parallel.h"
#include "capture/matted_pictures.h"
#include "mattes/reduced.h"

namespace fourdvt::mattes {
namespace {

constexpr size_t kMinSamples = 3;

// One frame of one sequence.
struct Instant {
  const capture::CaptureSequence* sequence;
  uint32_t frame;
};

// Samples spread evenly over all sequences.
std::vector<Instant> samplesOf(const capture::Capture& capture) {
  std::vector<Instant> all, out;
  for (const capture::CaptureSequence& s : capture.sequences)
    for (uint32_t frame = 0; frame < s.frame_count; ++frame) all.push_back({&s, frame});
  const size_t count = std::min(all.size(), size_t(kClipSamples));
  for (size_t i = 0; i < count; ++i) out.push_back(all[(2 * i + 1) * all.size() / (2 * count)]);
  return out;
}

// Calls take(picture) for the samples of a camera, in order.
Status readSamples(const capture::CaptureCamera& camera, const std::vector<Instant>& samples,
                   const MattesEnvironment& environment, const std::function<void(Image)>& take) {
  std::optional<capture::PictureStream> stream;
  const capture::CaptureSequence* open = nullptr;
  for (const Instant& at : samples) {
    if (environment.stop && *environment.stop)
      return Error{ErrorId::Interrupted, "stopped while clips were read; nothing is lost, run the command again"};
    if (at.sequence != open) {
      FOURDVT_ASSIGN(const auto place, capture::colourPlace(*at.sequence, camera));
      FOURDVT_ASSIGN(stream, capture::PictureStream::open(place, *at.sequence, camera, 3, environment.open_video));
      open = at.sequence;
    }
    FOURDVT_ASSIGN(auto picture, stream->read(at.frame));
    take(std::move(picture));
  }
  return {};
}

Status firstError(const std::vector<Status>& all) {
  for (const Status& s : all)
    if (!s.ok()) return s.error();
  return {};
}

void tell(const MattesEnvironment& environment, const std::string& stage) {
  if (environment.progress) environment.progress({stage, 0, 0, 0, 0});
}

// Estimates backgrounds of the cameras without plates. All cameras help to find the performer.
Status addClipPlates(const capture::Capture& capture, const MattesEnvironment& environment,
                     std::vector<MatteSource>& sources, const std::vector<bool>& wanted) {
  const std::vector<Instant> samples = samplesOf(capture);
  if (samples.size() < kMinSamples)
    return Error{ErrorId::InvalidArgument,
                 capture.background_folder +
                     ": not every camera has a plate, and there are too few frames to find the "
                     "background in; add plates of the empty room, or mattes"};
  const size_t cameras = capture.cameras.size();
  std::vector<std::vector<Image>> small(cameras);
  std::vector<Status> done(cameras);
  tell(environment, "reading clips for their background");
  inParallel(cameras, [&](size_t i) {
    const int reduction = reductionFor(capture.cameras[i], kClipPixels);
    done[i] = readSamples(capture.cameras[i], samples, environment,
                          [&](Image picture) { small[i].push_back(reduced(picture, reduction)); });
  });
  FOURDVT_TRY(firstError(done));
  tell(environment, "separating performer and background");
  std::vector<ClipCamera> clips = separateClips(capture.cameras, capture.ground_y_m, small);
  tell(environment, "plates from clips");
  inParallel(cameras, [&](size_t i) {
    if (!wanted[i]) return;
    std::vector<Image> pictures;
    done[i] = readSamples(capture.cameras[i], samples, environment,
                          [&](Image picture) { pictures.push_back(std::move(picture)); });
    if (!done[i].ok()) return;
    sources[i].from_clip = plateBehind(pictures, clips[i].masks);
    clips[i].masks.clear();
    sources[i].clip = std::move(clips[i]);
  });
  return firstError(done);
}

}  // namespace

const char* MatteSource::name() const {
  if (from_clip) return "clips";
  if (!key) return "none";
  return key->natural() ? "plates" : "colour key";
}

Result<bool> lacksMattes(const capture::CaptureSequence& sequence, const capture::CaptureCamera& camera,
                         const OpenVideo& open_video) {
  FOURDVT_ASSIGN(const auto origin, capture::matteOrigin(sequence, camera, open_video));
  return origin == capture::MatteOrigin::None;
}

Result<bool> lacksMattes(const capture::Capture& capture, const capture::CaptureCamera& camera,
                         const OpenVideo& open_video) {
  for (const capture::CaptureSequence& sequence : capture.sequences) {
    FOURDVT_ASSIGN(const bool lacks, lacksMattes(sequence, camera, open_video));
    if (lacks) return true;
  }
  return false;
}

Result<bool> wantsMattes(const capture::Capture& capture, const OpenVideo& open_video) {
  std::error_code failed;
  const bool hints = std::filesystem::is_directory(capture.folder + "/" + capture::kHintsFolder, failed);
  for (const capture::CaptureCamera& camera : capture.cameras) {
    FOURDVT_ASSIGN(const bool lacks, lacksMattes(capture, camera, open_video));
    if (!lacks) continue;
    if (hints) return true;
    const auto key = PlateKey::open(capture, camera);
    if (!key.ok() && key.error().id != ErrorId::FileMissing) return key.error();
    if (!key.ok() || key.value().natural()) return true;
  }
  return false;
}

Result<std::vector<MatteSource>> openSources(const capture::Capture& capture, const MattesEnvironment& environment) {
  std::vector<MatteSource> out(capture.cameras.size());
  std::vector<bool> clip(capture.cameras.size(), false);
  for (size_t i = 0; i < out.size(); ++i) {
    const capture::CaptureCamera& camera = capture.cameras[i];
    FOURDVT_ASSIGN(const bool lacks, lacksMattes(capture, camera, environment.open_video));
    if (!lacks) continue;
    auto key = PlateKey::open(capture, camera);
    if (key.ok())
      out[i].key = key.take();
    else if (key.error().id == ErrorId::FileMissing)
      clip[i] = true;
    else
      return key.error();
  }
  if (std::find(clip.begin(), clip.end(), true) != clip.end())
    FOURDVT_TRY(addClipPlates(capture, environment, out, clip));
  return out;
}

}  // namespace fourdvt::mattes
