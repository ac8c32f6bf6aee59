// SPDX-License-Identifier: Apache-2.0
#include "capture/picture_report.h"

#include <filesystem>
#include <utility>

#include "base/text.h"
#include "capture/matted_pictures.h"
#include "capture/mesh_sequence.h"
#include "capture/picture_clock.h"
#include "capture/pictures.h"
#include "capture/still_marks.h"
#include "capture/text.h"
#include "capture/upright.h"

namespace fourdvt::capture {
namespace {

void addListing(const VideoListing& listing, PictureReport& out) {
  if (listing.cut_off) out.done.push_back("the file is cut off");
  if (!listing.timecode.empty()) out.done.push_back("time code " + listing.timecode);
  const auto clock = clockOf(listing.times_s);
  if (!listing.times_s.empty() && !clock) out.done.push_back("the frame rate is variable");
  for (const ClockGap& gap : clock ? gapsOf(*clock, 0, clock->instants.size()) : std::vector<ClockGap>())
    out.done.push_back(printed("lacks %llu at %.3f s", static_cast<unsigned long long>(gap.lost), gap.time_s));
  for (const std::string& track : listing.other_tracks) out.done.push_back("not read: " + track);
}

Result<PictureReport> reportOnVideo(const std::string& path, const CaptureCamera& camera, const OpenVideo& open_video) {
  FOURDVT_ASSIGN(auto video, open_video(path, 3));
  FOURDVT_ASSIGN(auto picture, video->next());
  if (!picture) return Error{ErrorId::VideoTooShort, path + ": no picture in it; export the video again"};
  PictureReport out{path, picture->width, picture->height, std::nullopt, video->framesPerSecond(), {}};
  FOURDVT_ASSIGN(const PictureMarks applied, calibratedMarks(*picture, video->marks(), camera, path));
  out.done = describeMarks(video->marks(), applied);
  for (const std::string& conversion : video->conversions()) out.done.push_back(conversion);
  FOURDVT_ASSIGN(const VideoListing listing, video->list());
  out.pictures = listing.pictures;
  addListing(listing, out);
  return out;
}

Result<PictureReport> reportOnStills(const std::string& path, const CaptureCamera& camera) {
  PictureMarks marks;
  FOURDVT_ASSIGN(const Image stored, readPicture(path, 3, &marks));
  PictureReport out{path, stored.width, stored.height, std::nullopt, std::nullopt, {}};
  FOURDVT_ASSIGN(const PictureMarks applied, calibratedMarks(stored, marks, camera, path));
  out.done = describeMarks(marks, applied);
  std::string name;
  if (const auto bytes = readText(path); bytes && changesColours(stillMarks(*bytes).profile, &name))
    out.done.push_back((name.empty() ? "colour profile" : name) + " → sRGB");
  return out;
}

}  // namespace

std::vector<std::string> describeMarks(const PictureMarks& marks, const PictureMarks& applied) {
  std::vector<std::string> out;
  PictureMarks turn = marks, stretch;
  turn.pixel_aspect = 1;
  stretch.pixel_aspect = marks.pixel_aspect;
  if (turn.turns() && applied.turns()) out.push_back(describe(turn));
  if (turn.turns() && !applied.turns())
    out.push_back("not " + describe(turn) + ": the calibration is of stored pictures");
  if (marks.stretches())
    out.push_back(describe(stretch) + (applied.stretches() ? ": made square" : ": left as stored"));
  return out;
}

Result<PictureReport> reportOnPictures(const CaptureSequence& sequence, const CaptureCamera& camera,
                                       const OpenVideo& open_video) {
  FOURDVT_ASSIGN(const PicturePlace place, colourPlace(sequence, camera));
  if (!place.numbered) return reportOnVideo(place.path, camera, open_video);
  return reportOnStills(framePath(place.path, sequence.pictureOf(camera.pinhole.name, 0)), camera);
}

Status checkMattes(const CaptureSequence& sequence, const CaptureCamera& camera, const OpenVideo& open_video) {
  FOURDVT_ASSIGN(auto pictures, MattedPictures::open(sequence, camera, open_video, MatteNeed::Required));
  const auto first = pictures.read(0);
  return first.ok() ? Status() : Status(first.error());
}

std::string matteSource(const Capture& capture, const CaptureSequence& sequence, const CaptureCamera& camera,
                        const OpenVideo& open_video) {
  const auto inCapture = [&](const std::string& path) {
    return std::filesystem::path(path).lexically_relative(capture.folder).string();
  };
  const std::string& name = camera.pinhole.name;
  if (const auto place = findPictures(sequence.folder, matteStem(name))) return inCapture(place->path);
  if (const auto origin = matteOrigin(sequence, camera, open_video);
      origin.ok() && origin.value() == MatteOrigin::ColourAlpha)
    return "alpha of the pictures";
  const auto plates = readPlates(capture, camera, "none");
  return plates.ok() ? "keyed against " + inCapture(plates.value().path) : "none";
}

}  // namespace fourdvt::capture
