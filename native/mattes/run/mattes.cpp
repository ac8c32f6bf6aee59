// SPDX-License-Identifier: Apache-2.0
#include "mattes/run/mattes.h"

#include <algorithm>
#include <filesystem>

#include "base/parallel.h"
#include "base/text.h"
#include "capture/folder/linked_capture.h"
#include "capture/folder/result_folder.h"
#include "mattes/frame_reader.h"
#include "mattes/reduced.h"
#include "mattes/run/report.h"
#include "mattes/run/sequence_mattes.h"
#include "mattes/support.h"
#include "platform/files.h"
#include "store/folder.h"

namespace fourdvt::mattes {
namespace {

constexpr uint32_t kShownFrames = 6;          // frames per sequence in its contact sheets
constexpr const char* kVersion = "mattes 1";  // to be raised when the same options give other mattes
const capture::FolderWriter kWriter{"mattes", kReportJson, "reconstruct.json"};

// `count` frames spread evenly, all if there are fewer.
std::vector<uint32_t> spread(uint32_t frames, uint32_t count) {
  std::vector<uint32_t> out;
  const uint32_t n = std::min(frames, count);
  for (uint32_t i = 0; i < n; ++i) out.push_back(uint32_t((2ull * i + 1) * frames / (2ull * n)));
  return out;
}

double shareOf(const Image& matte) {
  size_t inside = 0;
  for (const uint8_t v : matte.pixels) inside += v >= 128;
  return double(inside) / double(std::max<size_t>(1, matte.pixels.size()));
}

class Run {
 public:
  Run(const capture::Capture& capture, std::string part, std::string work, const MattesOptions& options,
      const MattesEnvironment& environment)
      : capture_(capture),
        part_(std::move(part)),
        work_(std::move(work)),
        options_(options),
        environment_(environment) {
    for (const capture::CaptureSequence& s : capture.sequences) total_ += uint32_t(framesOf(s).size());
  }

  Result<MattesSummary> run() {
    MattesSummary out;
    FOURDVT_TRY(platform::makeFolder(work_ + "/mattes"));
    for (const capture::CaptureSequence& s : capture_.sequences) {  // errors in hints stop the run before any work
      FOURDVT_ASSIGN(auto strokes, readStrokes(capture_, s));
      strokes_.push_back(std::move(strokes));
      std::vector<bool>& lacking = lacking_.emplace_back();
      for (const capture::CaptureCamera& camera : capture_.cameras) {
        FOURDVT_ASSIGN(const bool lacks, lacksMattes(s, camera, environment_.open_video));
        lacking.push_back(lacks);
      }
    }
    for (const capture::CaptureSequence& s : capture_.sequences) {
      FOURDVT_ASSIGN(auto figures, runSequence(s));
      out.sequences.push_back(std::move(figures));
    }
    source_names_ = sourceNames();
    for (size_t c = 0; c < capture_.cameras.size(); ++c) out.sources.push_back(sourceName(c));
    out.frames = done_, out.frames_kept = kept_;
    out.wall_s = watch_.seconds();
    out.warnings = warningsOf(capture_, out);
    FOURDVT_TRY(writeReport(part_, cellsFolder(), capture_, options_, out));
    return out;
  }

 private:
  std::vector<uint32_t> framesOf(const capture::CaptureSequence& s) const {
    return spread(s.frame_count, options_.preview > 0 ? uint32_t(options_.preview) : s.frame_count);
  }
  std::string sourcesPath() const { return work_ + "/mattes/sources.bin"; }
  // Sources of the mattes that an earlier run, or this one, made.
  std::vector<std::string> sourceNames() const {
    auto kept = store::load<std::vector<std::string>>(sourcesPath());
    auto out = kept ? kept.take() : std::vector<std::string>();
    out.resize(capture_.cameras.size(), "none");
    return out;
  }
  std::string cellsFolder() const { return work_ + "/cells"; }
  std::string figuresPath(const capture::CaptureSequence& s, uint32_t frame) const {
    return work_ + "/mattes/" + s.name + "/" + capture::frameName(frame) + ".bin";
  }
  // Mattes of a preview are kept apart, so that its folder cannot be mistaken for a capture.
  std::string mattesFolder(const capture::CaptureSequence& s, size_t camera) const {
    const std::string stem = capture::matteStem(capture_.cameras[camera].pinhole.name);
    return part_ + "/" + (options_.preview > 0 ? "preview/" : "") + s.name + "/" + stem;
  }
  // Path of a matte, numbered like the camera's pictures.
  std::string mattePath(const capture::CaptureSequence& s, size_t camera, uint32_t frame) const {
    const uint32_t number = s.pictureOf(capture_.cameras[camera].pinhole.name, frame);
    return mattesFolder(s, camera) + "/" + capture::frameName(number) + ".png";
  }
  std::string sourceName(size_t camera) const {
    const bool lacks = std::any_of(lacking_.begin(), lacking_.end(), [&](const auto& of) { return of[camera]; });
    return lacks ? source_names_.at(camera) : kGivenMattes;
  }

  const Strokes& strokesOf(const capture::CaptureSequence& s) const {
    return strokes_[size_t(&s - capture_.sequences.data())];
  }
  // [camera] true: no mattes of its own.
  const std::vector<bool>& lackingOf(const capture::CaptureSequence& s) const {
    return lacking_[size_t(&s - capture_.sequences.data())];
  }

  Status openSourcesOnce() {
    if (joint_) return {};
    FOURDVT_ASSIGN(sources_, openSources(capture_, environment_));
    std::vector<std::string> names;
    for (const MatteSource& source : sources_) names.push_back(source.name());
    FOURDVT_TRY(store::save(sourcesPath(), names));
    JointOptions joint;
    joint.alone = options_.alone;
    joint.background_unseen =
        std::any_of(sources_.begin(), sources_.end(), [](const MatteSource& s) { return s.from_clip.has_value(); });
    if (joint.background_unseen) joint.demanded_nats = 0;  // colours alone are weak evidence against the demand
    joint_ = std::make_unique<JointMattes>(capture_.cameras, capture_.ground_y_m, joint);
    watch_ = {};
    return {};
  }

  Status makeFolders(const capture::CaptureSequence& s) const {
    for (size_t c = 0; c < capture_.cameras.size(); ++c) {
      FOURDVT_TRY(platform::makeFolder(cellsFolder() + "/" + s.name + "/" + capture_.cameras[c].pinhole.name));
      if (!lackingOf(s)[c]) continue;
      // A folder of this name without mattes may be a link: nothing is written into the capture.
      std::error_code none;
      if (std::filesystem::is_symlink(mattesFolder(s, c), none)) std::filesystem::remove(mattesFolder(s, c), none);
      FOURDVT_TRY(platform::makeFolder(mattesFolder(s, c)));
    }
    return platform::makeFolder(work_ + "/mattes/" + s.name);
  }

  // Figures of a frame; nullopt unless all its mattes exist.
  std::optional<std::vector<CameraFigures>> keptFigures(const capture::CaptureSequence& s, uint32_t frame,
                                                        const std::vector<bool>& lacking) const {
    std::error_code none;
    for (size_t c = 0; c < capture_.cameras.size(); ++c)
      if (lacking[c] && !std::filesystem::exists(mattePath(s, c, frame), none)) return std::nullopt;
    auto kept = store::load<std::vector<CameraFigures>>(figuresPath(s, frame));
    return kept && kept.value().size() == capture_.cameras.size() ? std::optional(kept.take()) : std::nullopt;
  }

  Result<SequenceFigures> runSequence(const capture::CaptureSequence& s) {
    SequenceFigures out{s.name, {}, framesOf(s)};
    const std::vector<uint32_t> shown = spread(s.frame_count, kShownFrames);
    FOURDVT_TRY(makeFolders(s));
    const std::vector<bool>& lacking = lackingOf(s);
    std::optional<SequenceMattes> mattes;
    for (const uint32_t frame : out.numbers) {
      if (auto kept = keptFigures(s, frame, lacking)) {
        agreed_ = s.name;
        out.frames.push_back(std::move(*kept));
        ++kept_, ++done_;
        continue;
      }
      if (environment_.stop && *environment_.stop)
        return Error{ErrorId::Interrupted, "stopped; finished frames are kept in " + work_ + " for --resume"};
      if (!mattes) {
        FOURDVT_TRY(openSourcesOnce());
        FOURDVT_ASSIGN(mattes,
                       SequenceMattes::open(capture_, s, sources_, *joint_, strokesOf(s), environment_.open_video));
      }
      FOURDVT_ASSIGN(const auto made, mattes->make(frame));
      FOURDVT_TRY(checkAgreement(s, frame, made));
      const bool in_sheet = options_.preview > 0 || std::find(shown.begin(), shown.end(), frame) != shown.end();
      FOURDVT_ASSIGN(auto figures, save(s, frame, *mattes, made, in_sheet));
      out.frames.push_back(std::move(figures));
      ++done_, ++made_;
      tell("mattes " + s.name + " " + std::to_string(frame + 1) + "/" + std::to_string(s.frame_count));
    }
    return out;
  }

  // Judges the first frame of each sequence in which enough cameras see something.
  Status checkAgreement(const capture::CaptureSequence& s, uint32_t frame, const MattesFrame& made) {
    if (options_.alone || options_.any_silhouettes || agreed_ == s.name) return {};
    std::vector<cv::Mat> masks;
    size_t seeing = 0;
    // Uses the cameras' own keys: joint mattes would agree with one another. Keys against plates from clips are too
    // rough to be judged.
    for (size_t c = 0; c < made.mattes.size(); ++c) {
      const CameraMatte& m = made.mattes[c];
      masks.push_back(sources_[c].from_clip ? cv::Mat(matrixOf(m.matte) >= 128) : m.own);
      seeing += cv::countNonZero(masks.back()) > 0;
    }
    if (seeing < 3) return {};
    agreed_ = s.name;
    const auto why = disagreement(capture_.cameras, masks);
    if (!why) return {};
    return Error{ErrorId::InvalidArgument,
                 s.folder + ", frame " + std::to_string(frame) + ": " + *why +
                     "; check that camera's matte, calibration and synchronisation, leave it out (--leave-out NAME), "
                     "or go on all the same (--any-silhouettes; --mattes-alone: cameras do not help each other)"};
  }

  Result<std::vector<CameraFigures>> save(const capture::CaptureSequence& s, uint32_t frame,
                                          const SequenceMattes& mattes, const MattesFrame& made, bool in_sheet) const {
    std::vector<CameraFigures> out(made.mattes.size());
    std::vector<Status> done(made.mattes.size());
    inParallel(out.size(), [&](size_t c) {
      const CameraMatte& m = made.mattes[c];
      out[c] = {m.shift_pixels, m.gain, m.residual_levels, m.supported, m.kept, shareOf(m.matte)};
      if (mattes.made(c)) done[c] = platform::writeImage(mattePath(s, c, frame), m.matte);
      if (done[c].ok() && in_sheet)
        done[c] = platform::writeImage(cellsFolder() + "/" + s.name + "/" + capture_.cameras[c].pinhole.name + "/" +
                                           capture::frameName(frame) + ".png",
                                       contactCell(made.pictures[c], m));
    });
    for (const Status& status : done)
      if (!status.ok()) return status.error();
    FOURDVT_TRY(store::save(figuresPath(s, frame), out));
    return out;
  }

  void tell(const std::string& stage) const {
    if (!environment_.progress) return;
    FrameProgress p{stage, done_, total_, 0, 0};
    p.frames_per_s = made_ / watch_.seconds();
    p.left_s = (total_ - done_) / p.frames_per_s;
    environment_.progress(p);
  }

  const capture::Capture& capture_;
  const std::string part_, work_;
  const MattesOptions& options_;
  const MattesEnvironment& environment_;
  std::vector<MatteSource> sources_;
  std::vector<std::string> source_names_;
  std::vector<Strokes> strokes_;            // [sequence]
  std::vector<std::vector<bool>> lacking_;  // [sequence][camera]
  std::unique_ptr<JointMattes> joint_;
  std::string agreed_;  // name of the last sequence whose silhouettes were judged
  Watch watch_;
  uint32_t total_ = 0, done_ = 0, made_ = 0, kept_ = 0;
};

std::string settingsKey(const MattesOptions& o, const capture::Capture& capture) {
  return capture::inputsKey(capture) + " " + kVersion + (o.alone ? " alone" : "") + " preview " +
         std::to_string(o.preview) + "\n";
}

}  // namespace

Result<MattesSummary> addMattes(const capture::Capture& capture, const std::string& part_folder,
                                const std::string& work_folder, const MattesOptions& options,
                                const MattesEnvironment& environment) {
  return Run(capture, part_folder, work_folder, options, environment).run();
}

Result<MattesSummary> makeMattes(const MattesOptions& options, const MattesEnvironment& environment) {
  FOURDVT_ASSIGN(const auto target, capture::checkedTarget(options.folder, options.capture_folder, kWriter));
  if (options.jobs > 0) cv::setNumThreads(options.jobs);
  FOURDVT_ASSIGN(auto capture, openCapture(options.capture_folder, environment.open_video, options.sequences,
                                           capture::MeshNeed::Nothing, capture::MatteNeed::None));
  FOURDVT_TRY(capture::leaveOut(options.leave_out, capture));
  const capture::ResultFolder folder(target, kWriter);
  FOURDVT_TRY(folder.open(settingsKey(options, capture), options.resume));
  if (options.preview == 0) {
    std::vector<std::string> names;
    for (const capture::CaptureSequence& s : capture.sequences) names.push_back(s.name);
    capture::LinkOptions link;
    link.sequences = names;
    link.leave_out = options.leave_out;
    FOURDVT_TRY(capture::linkCapture(capture, folder.partFolder(), link));
    FOURDVT_TRY(mattes::openLinked(folder.partFolder(), capture.folder, names, environment.open_video));
  }
  FOURDVT_ASSIGN(auto summary, addMattes(capture, folder.partFolder(), folder.workFolder(), options, environment));
  FOURDVT_TRY(folder.finish());
  return summary;
}

}  // namespace fourdvt::mattes
