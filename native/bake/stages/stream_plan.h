// SPDX-License-Identifier: Apache-2.0
// What sequences the character gets: one a captured sequence, then one a motion class. The "warp" stage.
#pragma once

#include "bake/run/bake_run.h"

namespace fourdvt::bake {

// Completes job.streams and grows job.bounds by the classes' interpolated meshes. Errors: those of planClass and
// rootTrack, InvalidArgument (a class's picture is too large), Interrupted.
Status planStreams(BakeRun& run);

// Classes that are baked: none with BakeOptions::classes off.
std::vector<const capture::CaptureClass*> bakedClasses(const Job& job);
// Before planning: phases of a class are the frames of its longest member.
uint32_t expectedPhases(const Job& job, const capture::CaptureClass& motion_class);

}  // namespace fourdvt::bake
