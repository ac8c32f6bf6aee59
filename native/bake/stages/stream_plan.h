// SPDX-License-Identifier: Apache-2.0
// The "warp" stage: plans the sequences of the character, one per captured sequence, then one per motion class.
#pragma once

#include "bake/run/bake_run.h"

namespace fourdvt::bake {

// Completes job.streams and grows job.bounds by the classes' interpolated meshes. Errors: those of planClass and
// rootTrack, InvalidArgument (a class's picture is too large), Interrupted.
Status planStreams(BakeRun& run);

// The classes that are baked; none if options.classes.bake is off.
std::vector<const capture::CaptureClass*> bakedClasses(const Job& job);
// The number of phases that a class will have: the frames of its longest member.
uint32_t expectedPhases(const Job& job, const capture::CaptureClass& motion_class);

}  // namespace fourdvt::bake
