// SPDX-License-Identifier: Apache-2.0
#include "capture/import/takes.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "capture/matted_pictures.h"
#include "capture/picture_clock.h"
#include "capture/picture_report.h"
#include "capture/pictures.h"
#include "capture/upright.h"

namespace fourdvt::capture {
namespace {

struct Measured {
  Image first;  // stored orientation
  PictureMarks marks;
  std::vector<std::string> conversions;
  Clip clip;
  std::optional<double> fps;
};

// Number of pictures that decode; nullopt: as many as listed.
Result<std::optional<uint64_t>> countDecoded(VideoSource& video, const OpenVideo& open_video, const std::string& path,
                                             uint64_t listed) {
  if (listed < 2) return std::optional<uint64_t>();
  FOURDVT_TRY(video.skip(static_cast<uint32_t>(listed - 2)));  // after the first picture
  FOURDVT_ASSIGN(const auto last, video.next());
  if (last) return std::optional<uint64_t>();
  FOURDVT_ASSIGN(const auto again, open_video(path, 1));
  for (uint64_t count = 0;; ++count) {
    FOURDVT_ASSIGN(const auto next, again->next());
    if (!next) return std::optional<uint64_t>(count);
  }
}

// Frames per second by the header, or by the time stamps where these differ.
std::optional<double> rateOf(const VideoSource& video, const VideoListing& listing) {
  const std::optional<double> header = video.framesPerSecond();
  const auto clock = clockOf(listing.times_s);
  if (!clock || clock->step_s <= 0) return header;
  const double rate = 1 / clock->step_s, tick = listing.tick_s / listing.times_s.back();
  if (header && std::abs(*header - rate) <= std::max(0.005, 2 * tick) * rate) return header;
  return std::round(1000 * rate) / 1000;
}

Result<Measured> measureVideo(const OpenVideo& open_video, const View& view, int channels) {
  const std::string& path = view.video;
  FOURDVT_ASSIGN(auto video, open_video(path, channels));
  FOURDVT_ASSIGN(VideoListing listing, video->list());
  FOURDVT_ASSIGN(auto first, video->next());
  if (!first) return Error{ErrorId::FileUnreadable, path + ": no picture in it; export the video again"};
  Measured out{std::move(*first), video->marks(), video->conversions(), {}, {}};
  FOURDVT_ASSIGN(const auto decoded, countDecoded(*video, open_video, path, listing.pictures));
  const std::optional<double> fps = rateOf(*video, listing);
  if (decoded) {
    listing.announced = std::max(listing.announced, listing.pictures);
    listing.pictures = *decoded;
    listing.times_s.clear();
  }
  out.clip = Clip{{}, view, std::move(listing), {}, 0, fps.value_or(0)};
  out.fps = fps;
  return out;
}

Result<Measured> measureView(const OpenVideo& open_video, const View& view, int channels) {
  if (!view.video.empty()) return measureVideo(open_video, view, channels);
  Measured out{{}, {}, {}, Clip{{}, view, {}, {}, 0, 0}, std::nullopt};
  FOURDVT_ASSIGN(out.first, readPicture(view.pictures.front(), channels, &out.marks));
  return out;
}

// Sets the camera's size from the picture where the calibration lacks it or cropping changed it.
Status takeSize(const Measured& measured, const std::string& path, CaptureCamera& camera) {
  PictureMarks marks;
  if (measured.marks.turns() && camera.orientation == Orientation::BySize)
    return orientationIsOpen(measured.marks, camera, path);
  if (camera.orientation == Orientation::Marked) marks = measured.marks, marks.pixel_aspect = 1;
  camera.pinhole.width = marks.swapsSides() ? measured.first.height : measured.first.width;
  camera.pinhole.height = marks.swapsSides() ? measured.first.width : measured.first.height;
  return {};
}

// Notes unread pictures and tracks of a video.
void noteUnread(const std::string& path, const VideoListing& listing, ClipNotes& notes) {
  const std::string has = std::to_string(listing.pictures), all = std::to_string(listing.announced);
  const bool fewer = listing.pictures < listing.announced;
  if (listing.cut_off) {
    notes.warnings.push_back(path + ": is cut off: " + has + " pictures are there" +
                             (fewer ? ", its header announces " + all : "") + "; copy it from the camera again");
  } else if (fewer) {
    notes.done.push_back(path + ": shows " + has + " of " + all +
                         " pictures that its header counts, as after a cut by an edit list");
  }
  for (const std::string& track : listing.other_tracks)
    notes.warnings.push_back(path + ": has several video tracks; " + listing.track + " is read, " + track + " is not");
}

// Keeps the first candidate file name of the camera that exists.
void chooseFileName(const std::vector<Take>& takes, ImportedCamera& imported) {
  const auto found = std::find_if(imported.file_names.begin(), imported.file_names.end(), [&](const auto& name) {
    return std::any_of(takes.begin(), takes.end(), [&](const Take& take) { return findView(take.folder, name); });
  });
  if (found == imported.file_names.end()) return;
  const std::string name = *found;
  imported.file_names = {name};
  imported.camera.pinhole.name = plainName(name);
}

std::optional<View> viewOf(const ImportedCamera& imported, const std::string& folder) {
  if (!imported.pictures.empty())
    if (auto view = viewNear((std::filesystem::path(folder) / imported.pictures).string())) return view;
  if (auto view = findView(folder, imported.fileName())) return view;
  return findListed(folder, imported.listed);
}

std::optional<View> mattesOf(const ImportedCamera& imported, const std::string& folder) {
  if (!imported.mattes.empty())
    if (auto view = viewAt((std::filesystem::path(folder) / imported.mattes).string())) return view;
  return findMattes(folder, imported.fileName(), imported.listed);
}

// Returns true if the take uses a file, or a folder with one.
bool uses(const Take& take, const std::string& path) {
  const auto is = [&](const auto& view) {
    const std::string& first = view.second.first();
    return first == path || first.starts_with(path + "/");
  };
  return std::any_of(take.views.begin(), take.views.end(), is) ||
         std::any_of(take.mattes.begin(), take.mattes.end(), is);
}

// Cameras with a capture's test pictures: cameras_test beside its calibration.
std::vector<std::string> heldOutCameras(const ImportedCalibration& calibration) {
  const std::filesystem::path beside = std::filesystem::path(calibration.path).parent_path() / "cameras_test";
  const auto cameras = readColmapCameras(beside.string());
  std::vector<std::string> out;
  if (cameras.ok())
    for (const CaptureCamera& camera : cameras.value()) out.push_back(camera.pinhole.name);
  return out;
}

}  // namespace

void findViews(ImportedCalibration& calibration, std::vector<Take>& takes) {
  for (ImportedCamera& imported : calibration.cameras) {
    chooseFileName(takes, imported);
    const std::string& name = imported.camera.pinhole.name;
    for (Take& take : takes) {
      const std::optional<View> view = viewOf(imported, take.folder);
      if (!view) continue;
      take.views[name] = *view;
      if (auto mattes = mattesOf(imported, take.folder)) take.mattes[name] = *mattes;
    }
  }
}

Status findAlphas(const ImportedCalibration& calibration, const std::string& folder, const OpenVideo& open_video,
                  Take& take) {
  CaptureSequence sequence;
  sequence.folder = folder;
  sequence.frame_count = take.frames;
  for (const ImportedCamera& imported : calibration.cameras) {
    const std::string& name = imported.camera.pinhole.name;
    const auto origin = matteOrigin(sequence, imported.camera, open_video);
    if (!origin.ok()) {  // names the user's file instead of the link
      const std::string& message = origin.error().message;
      const size_t what = message.find(": ");
      return Error{origin.error().id, take.views.at(name).first() + message.substr(std::min(what, message.size()))};
    }
    if (origin.value() == MatteOrigin::ColourAlpha) take.alphas.insert(name);
  }
  return {};
}

Status keepSeenCameras(const std::vector<Take>& takes, ImportedCalibration& calibration,
                       std::vector<std::string>& warnings) {
  std::vector<std::string> names;
  for (const ImportedCamera& imported : calibration.cameras) names.push_back(imported.fileName());
  std::vector<std::string> known = heldOutCameras(calibration);
  known.insert(known.end(), names.begin(), names.end());
  const auto unseen = [&](const ImportedCamera& imported) {
    const std::string& name = imported.camera.pinhole.name;
    for (const Take& take : takes) {
      if (take.views.count(name)) continue;
      warnings.push_back("camera " + name + ": no video and no pictures in " + take.folder +
                         "; it is left out: else name them like the camera");
      return true;
    }
    return false;
  };
  std::erase_if(calibration.cameras, unseen);
  for (const Take& take : takes) {
    for (const auto& [name, view] : take.views)
      for (const std::string& path : videosBeside(view.first()))
        warnings.push_back(path + ": not read, but " + view.first() + "; take the one that is not meant away");
    for (const std::string& path : viewsWithoutCamera(take.folder, known))
      if (!uses(take, path))
        warnings.push_back(path + ": no camera of the calibration has this name; it is left out: else rename it");
  }
  if (!calibration.cameras.empty()) return {};
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  const auto bare = std::find_if(takes.begin(), takes.end(), [](const Take& take) { return take.views.empty(); });
  return Error{ErrorId::CameraMissingVideo,
               (bare == takes.end() ? takes.front() : *bare).folder +
                   ": no video (CAMERA.mp4, .mkv, .mov, .avi, .webm) and no pictures (CAMERA/, " +
                   "CAMERA.png) of any of the cameras " + list + "; name them like the cameras"};
}

Result<PictureMarks> importedMarks(const Image& stored, const PictureMarks& marks, const CaptureCamera& camera,
                                   const std::string& path) {
  auto applied = calibratedMarks(stored, marks, camera, path);
  const PinholeCamera& p = camera.pinhole;
  const bool smaller = stored.width <= p.width && stored.height <= p.height;
  if (applied.ok() || !smaller || (stored.width == p.width && stored.height == p.height)) return applied;
  return Error{
      applied.error().id,
      applied.error().message + ", or give --cropped if they only lack columns at the right or rows at the bottom"};
}

namespace {

// Sets the size if the calibration lacks it, and the rate; checks both, and notes the effect of file marks.
Status useMeasured(const Measured& measured, ImportedCamera& imported, ViewMeasures& measures, ClipNotes& notes) {
  const PinholeCamera& pinhole = imported.camera.pinhole;
  const View& view = measured.clip.view;
  const bool smaller = measured.first.width <= pinhole.width && measured.first.height <= pinhole.height;
  imported.camera.orientation = measures.orientation;
  if (pinhole.width == 0 || (measures.cropped && smaller))
    FOURDVT_TRY(takeSize(measured, view.first(), imported.camera));
  FOURDVT_ASSIGN(const PictureMarks applied,
                 importedMarks(measured.first, measured.marks, imported.camera, view.first()));
  auto done = describeMarks(measured.marks, applied);
  done.insert(done.end(), measured.conversions.begin(), measured.conversions.end());
  for (const std::string& what : done) notes.done.push_back("pictures of " + pinhole.name + ": " + what);
  double& fps = measures.fps;
  if (imported.relative) setLens(*imported.relative, imported.camera.pinhole);
  if (fps == 0 && measured.fps) fps = *measured.fps;
  if (measured.fps && std::abs(*measured.fps - fps) > 0.01 * fps)
    notes.warnings.push_back(view.video + ": its container says " + std::to_string(*measured.fps) +
                             " frames a second; " + std::to_string(fps) + " are written: else give --fps");
  return {};
}

}  // namespace

Status measureViews(const OpenVideo& open_video, ImportedCalibration& calibration, Take& take, ViewMeasures& measures,
                    ClipNotes& notes) {
  std::vector<Clip> clips, mattes;
  ClipNotes rates;  // printed unless clips of different rates are an error
  for (ImportedCamera& imported : calibration.cameras) {
    const std::string& name = imported.camera.pinhole.name;
    FOURDVT_ASSIGN(Measured measured, measureView(open_video, take.views.at(name), 3));
    FOURDVT_TRY(useMeasured(measured, imported, measures, rates));
    measured.clip.camera = name;
    noteUnread(measured.clip.view.video, measured.clip.listing, notes);
    clips.push_back(std::move(measured.clip));
    const auto matte = take.mattes.find(name);
    if (matte == take.mattes.end()) continue;
    FOURDVT_ASSIGN(Measured measured_mattes, measureView(open_video, matte->second, 1));
    measured_mattes.clip.camera = name;
    noteUnread(matte->second.video, measured_mattes.clip.listing, notes);
    mattes.push_back(std::move(measured_mattes.clip));
  }
  FOURDVT_TRY(setInstants(clips, measures.time_codes, notes));
  notes.done.insert(notes.done.end(), rates.done.begin(), rates.done.end());
  notes.warnings.insert(notes.warnings.end(), rates.warnings.begin(), rates.warnings.end());
  const bool alike = numberMattesAlike(clips, mattes);
  for (Clip& matte : mattes)
    for (const Clip& clip : clips)
      if (clip.camera == matte.camera) setMatteInstants(clip, matte, alike, notes);
  return pairPictures(clips, mattes, take, notes);
}

}  // namespace fourdvt::capture
