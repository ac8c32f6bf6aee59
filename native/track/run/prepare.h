// SPDX-License-Identifier: Apache-2.0
// Serial part of tracking, in one process before the fits: opens the capture with its surfaces, links the new folder to
// its pictures, crops these, chooses the template's frame and makes the template.
#pragma once

#include <string>
#include <vector>

#include "capture/capture.h"
#include "capture/folder/result_folder.h"
#include "track/run/options.h"
#include "track/run/work.h"

namespace fourdvt::track {

inline constexpr const char* kTrackJson = "track.json";
capture::ResultFolder resultFolder(const TrackOptions& options);

struct Prepared {
  TrackOptions options;      // absolute folders, named sequences
  capture::Capture capture;  // input, with surfaces
  std::string settings_key;  // one line: settings that determine the result
};

// Settings that fits depend on, with names, sizes and times of the input's files.
std::string settingsKey(const TrackOptions& options, const capture::Capture& capture);

// Opens and checks the input, and prepares the folders. Errors: those of openCapture (no surfaces, with a remedy);
// InvalidArgument (folders, classes, the template's frame, work of other settings); WriteFailed.
Result<Prepared> prepare(const TrackOptions& options, capture::Earlier earlier, const TrackEnvironment& environment);

// Interrupted, once the user stopped the run.
Status stopped(const Prepared& job, const TrackEnvironment& environment);

// Surface of a frame, metres. Errors: those of readSurfaceFrame.
Result<TriangleMesh> surfaceOf(const Prepared& job, const Work& work, uint32_t frame);

// Stores the pictures of all frames. Errors: those of pictures; WriteFailed; Interrupted.
Status storePictures(const Prepared& job, const Work& work, const TrackEnvironment& environment);

// Returns the stored template, or makes it. Errors: InvalidArgument (no frame suits, or not the given one; two people;
// surfaces that are not of these pictures; less than half of the surface is seen), each with the frame and a remedy;
// those of templateMesh.
Result<ChosenTemplate> makeTemplateOf(const Prepared& job, const Work& work, const TrackEnvironment& environment);

}  // namespace fourdvt::track
