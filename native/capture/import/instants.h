// SPDX-License-Identifier: Apache-2.0
// Instants of a take's pictures on one clock: from time stamps and time codes of videos, and from numbers in the names
// of pictures.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "base/video.h"
#include "capture/import/views.h"

namespace fourdvt::capture {

struct Shown {
  int64_t instant = 0;  // frames since a common origin of the take's clips
  size_t picture = 0;   // number in the video, or index into View::pictures
};

// Pictures of a camera, or its mattes.
struct Clip {
  std::string camera;
  View view;
  VideoListing listing;      // video only
  std::vector<Shown> shown;  // ascending in both
  double step_s = 0;         // video only; 0: no time stamps
  double fps = 0;            // video only, by its header if that agrees with the time stamps; 0: unknown
  size_t pictures() const { return view.video.empty() ? view.pictures.size() : listing.pictures; }
  // File of a picture, for display: "cam03/000003.jpg", "picture 3 of cam03.mp4".
  std::string nameOf(size_t picture) const;
};

// Rate of the first video, required of all others; 0: no videos.
double commonRate(const std::vector<Clip>& clips);

struct ClipNotes {
  std::vector<std::string> done, warnings;
};

// Sets the instants of all cameras' pictures. Aligns videos by time codes if all have one and `time_codes` is set;
// otherwise by their first pictures. Errors: FileUnreadable (a variable rate, or one that differs from the first
// video's), with the command that helps.
Status setInstants(std::vector<Clip>& clips, bool time_codes, ClipNotes& notes);

// Returns false if the offset between the first numbers of pictures and mattes differs between cameras.
bool numberMattesAlike(const std::vector<Clip>& clips, const std::vector<Clip>& mattes);

// Sets the instants of a camera's mattes from those of its pictures: by their numbers; in order if all cameras number
// their mattes `alike` and differently from their pictures.
void setMatteInstants(const Clip& pictures, Clip& mattes, bool alike, ClipNotes& notes);

}  // namespace fourdvt::capture
