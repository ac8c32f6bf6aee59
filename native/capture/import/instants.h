// SPDX-License-Identifier: Apache-2.0
// The instants that the pictures of a take's clips show, on one clock: from the time stamps and time codes of videos,
// and from the numbers in the names of pictures.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "base/video.h"
#include "capture/import/views.h"

namespace fourdvt::capture {

struct Shown {
  int64_t instant = 0;  // frames since an origin that all clips of a take have in common
  size_t picture = 0;   // number in the video, or in View::pictures
};

// A camera's pictures, or its mattes.
struct Clip {
  std::string camera;
  View view;
  VideoListing listing;      // of a video
  std::vector<Shown> shown;  // ascending in both
  double step_s = 0;         // of a video; 0: no time stamps
  double fps = 0;            // of a video, by its header where that agrees with the time stamps; 0: unknown
  size_t pictures() const { return view.video.empty() ? view.pictures.size() : listing.pictures; }
  // File of a picture, for people: "cam03/000003.jpg", "picture 3 of cam03.mp4".
  std::string nameOf(size_t picture) const;
};

// Rate of the first video, which all others must have; 0: there is none.
double commonRate(const std::vector<Clip>& clips);

struct ClipNotes {
  std::vector<std::string> done, warnings;
};

// Sets the instants of all cameras' pictures. Videos begin together, or by their time codes where all have one and
// `time_codes`. Errors: FileUnreadable (a variable rate, or another one than the first video's), naming the command
// that helps.
Status setInstants(std::vector<Clip>& clips, bool time_codes, ClipNotes& notes);

// Returns true unless cameras differ in what lies between the first numbers of their pictures and their mattes.
bool numberMattesAlike(const std::vector<Clip>& clips, const std::vector<Clip>& mattes);

// Sets those of a camera's mattes from the instants of its pictures: by their numbers, or in order where all cameras
// number their mattes `alike` and otherwise than their pictures.
void setMatteInstants(const Clip& pictures, Clip& mattes, bool alike, ClipNotes& notes);

}  // namespace fourdvt::capture
