// SPDX-License-Identifier: Apache-2.0
// Sources of mattes, one a camera: mattes that the capture has, a key against plates, or plates that
// are made from the clips (clip_plates.h). Does NOT make mattes.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "capture/capture.h"
#include "mattes/clip_plates.h"
#include "mattes/plate_key.h"
#include "mattes/run/options.h"

namespace fourdvt::mattes {

// One camera's plates, if mattes have to be made of any sequence.
struct MatteSource {
  std::optional<PlateKey> key;               // plates of the capture
  std::optional<BackgroundModel> from_clip;  // else
  ClipCamera clip;                           // with `from_clip`, without its masks
  const char* name() const;                  // "plates", "colour key", "clips" or "none"
};

// True where the capture lacks a camera's mattes in a sequence.
Result<bool> lacksMattes(const capture::CaptureSequence& sequence, const capture::CaptureCamera& camera,
                         const OpenVideo& open_video);
// The same of a camera and any sequence.
Result<bool> lacksMattes(const capture::Capture& capture, const capture::CaptureCamera& camera,
                         const OpenVideo& open_video);
// True where mattes must be made together: some camera has neither mattes nor a backdrop for a colour key, or there are
// hints.
Result<bool> wantsMattes(const capture::Capture& capture, const OpenVideo& open_video);

// One source a camera. Errors: FileUnreadable, FrameSize, InvalidArgument (too few frames to find a background in),
// Interrupted, those of pictures.
Result<std::vector<MatteSource>> openSources(const capture::Capture& capture, const MattesEnvironment& environment);

}  // namespace fourdvt::mattes
