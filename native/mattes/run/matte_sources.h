// SPDX-License-Identifier: Apache-2.0
// Sources of mattes, one per camera: mattes of the capture, a key against plates, or plates estimated from the clips
// (clip_plates.h).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "capture/capture.h"
#include "mattes/clip_plates.h"
#include "mattes/plate_key.h"
#include "mattes/run/options.h"

namespace fourdvt::mattes {

// One camera's plates, if any sequence lacks mattes.
struct MatteSource {
  std::optional<PlateKey> key;               // plates of the capture
  std::optional<BackgroundModel> from_clip;  // without `key`
  ClipCamera clip;                           // with `from_clip`, without its masks
  const char* name() const;                  // "plates", "colour key", "clips" or "none"
};

// True where the capture lacks a camera's mattes in a sequence.
Result<bool> lacksMattes(const capture::CaptureSequence& sequence, const capture::CaptureCamera& camera,
                         const OpenVideo& open_video);
// Returns true where the capture lacks a camera's mattes in any sequence.
Result<bool> lacksMattes(const capture::Capture& capture, const capture::CaptureCamera& camera,
                         const OpenVideo& open_video);
// Returns true where mattes must be made jointly: some camera has neither mattes nor a backdrop for a colour key, or
// there are hints.
Result<bool> wantsMattes(const capture::Capture& capture, const OpenVideo& open_video);

// One source per camera. Errors: FileUnreadable, FrameSize, InvalidArgument (too few frames to estimate a background),
// Interrupted, those of pictures.
Result<std::vector<MatteSource>> openSources(const capture::Capture& capture, const MattesEnvironment& environment);

}  // namespace fourdvt::mattes
