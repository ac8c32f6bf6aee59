// SPDX-License-Identifier: Apache-2.0
// What sequences the character gets: one a captured sequence, then one a motion class. The "warp" stage.
#pragma once

#include "bake/run/environment.h"
#include "bake/run/job.h"

namespace fourdvt::bake {

// Completes job.streams and grows job.bounds by the classes' interpolated meshes. `share` of the stage, 0..1, with the
// class at work; not called where there are no classes. Errors: those of planClass and rootTrack, InvalidArgument (a
// class's picture is too large), Interrupted.
using OnWarp = std::function<void(const std::string& class_name, double share)>;
Status planStreams(Job& job, const BakeEnvironment& environment, const OnWarp& on_progress);

// Classes that are baked: none with BakeOptions::classes off.
std::vector<const capture::CaptureClass*> bakedClasses(const Job& job);
// Before planning: phases of a class are the frames of its longest member.
uint32_t expectedPhases(const Job& job, const capture::CaptureClass& motion_class);

}  // namespace fourdvt::bake
