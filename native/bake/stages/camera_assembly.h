// SPDX-License-Identifier: Apache-2.0
// Makes the character folder of a character from cameras from finished GOPs; see assemble.h.
#pragma once

#include "bake/report/report.h"
#include "bake/run/bake_run.h"
#include "bake/stages/room_stage.h"

namespace fourdvt::bake {

// maps: as CameraGops; the poster's pictures get them, too. Errors: those of assemble.
Status assembleCameras(BakeRun& run, const std::vector<ColourMap>& maps, const std::optional<BakedRoom>& room,
                       ReportInput& report);

}  // namespace fourdvt::bake
