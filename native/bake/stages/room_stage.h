// SPDX-License-Identifier: Apache-2.0
// The picture of the room that capture.json gives, from the cameras' plates.
#pragma once

#include <optional>
#include <vector>

#include "bake/run/bake_run.h"
#include "bake/texels/colour_calibration.h"
#include "package/character.h"

namespace fourdvt::bake {

struct BakedRoom {
  package::Room room;            // complete; the picture's name without its hash
  std::vector<uint8_t> picture;  // the bytes of the file that it names
};

// Refuses a room that does not hold the performer in all frames, and one without plates. Errors: CaptureJson, those of
// capture::readRoomPlate.
Status checkRoom(const Job& job);
// None if the capture has no room. `colour_maps`: one per camera, or none. Errors: those of capture::readRoomPlate,
// Internal.
Result<std::optional<BakedRoom>> makeRoom(BakeRun& run, const std::vector<ColourMap>& colour_maps);

}  // namespace fourdvt::bake
