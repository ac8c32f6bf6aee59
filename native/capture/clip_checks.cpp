// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "base/text.h"
#include "capture/picture_clock.h"
#include "capture/pictures.h"

namespace fourdvt::capture {
namespace {

struct Clip {
  std::string path;
  size_t first = 0;  // number of frame 0's picture
  PictureClock clock;
};

// Listing of a video's pictures; empty for sources without one, whose pictures are counted on reading.
Result<VideoListing> listed(const PicturePlace& place, const CaptureSequence& sequence, const std::string& camera,
                            const OpenVideo& open_video) {
  FOURDVT_ASSIGN(const auto video, open_video(place.path, 3));
  auto listing = video->list();
  if (!listing.ok() && listing.error().id == ErrorId::Unsupported) return VideoListing();
  const NeededPictures needed(sequence, camera);
  if (!listing.ok() || listing.value().pictures >= needed.count) return listing;
  const char* why = listing.value().cut_off ? ", where the file is cut off," : "";
  return needed.tooFew(place.path, std::to_string(listing.value().pictures) + " frames" + why);
}

// Steps between the pictures of frames f-1 and f.
int64_t stepsTo(const Clip& clip, size_t frame) {
  return clip.clock.instants[clip.first + frame] - clip.clock.instants[clip.first + frame - 1];
}

Error lacksPicture(const Clip& clip, size_t frame, const std::string& other, double fps) {
  const size_t before = clip.first + frame - 1;
  const std::string time = printed("%.3f", double(clip.clock.instants[before] + 1) * clip.clock.step_s);
  return {ErrorId::VideoTooShort,
          clip.path + ": lacks a picture at " + time + " s, after picture " + std::to_string(before) + ", which " +
              other + " has: later ones would be out of step; fill the gap (" + constantRateCommand(clip.path, fps) +
              "), or import the clips again, which cuts the take there"};
}

// Returns an error unless all clips advance by equal steps from frame to frame.
Status checkInStep(const std::vector<Clip>& clips, uint32_t frames, double fps) {
  for (uint32_t frame = 1; frame < frames; ++frame) {
    const auto less = [&](const Clip& a, const Clip& b) { return stepsTo(a, frame) < stepsTo(b, frame); };
    const auto [least, most] = std::minmax_element(clips.begin(), clips.end(), less);
    if (stepsTo(*least, frame) != stepsTo(*most, frame)) return lacksPicture(*most, frame, least->path, fps);
  }
  return {};
}

}  // namespace

Status checkClips(const Capture& capture, const CaptureSequence& sequence, const OpenVideo& open_video,
                  MatteNeed mattes) {
  std::vector<Clip> clips;
  for (const CaptureCamera& camera : capture.cameras) {
    const std::string& name = camera.pinhole.name;
    FOURDVT_ASSIGN(const PicturePlace place, colourPlace(sequence, camera));
    if (!place.numbered) {
      FOURDVT_ASSIGN(const VideoListing listing, listed(place, sequence, name, open_video));
      auto clock = clockOf(listing.times_s);
      const uint32_t first = sequence.pictureOf(name, 0), last = sequence.pictureOf(name, sequence.frame_count - 1);
      if (clock && last == first + sequence.frame_count - 1)  // excludes loops that begin elsewhere
        clips.push_back({place.path, first, std::move(*clock)});
    }
    if (mattes == MatteNeed::None) continue;
    const auto matte = findPictures(sequence.folder, matteStem(name));
    if (!matte || matte->numbered) continue;
    FOURDVT_ASSIGN(const VideoListing listing, listed(*matte, sequence, name, open_video));
  }
  if (clips.size() < 2) return {};
  return checkInStep(clips, sequence.frame_count, capture.fps);
}

}  // namespace fourdvt::capture
