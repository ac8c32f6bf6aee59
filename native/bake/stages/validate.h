// SPDX-License-Identifier: Apache-2.0
// Checks everything that can fail early: options, capture, output folder, disk space.
#pragma once

#include "bake/run/job.h"
#include "bake/run/options.h"

namespace fourdvt::bake {

// Opens the capture, encodes the base mesh and finds the bounds of all frames. Reads every mesh once, one at a time.
// `options.character_folder` has no trailing slash. Errors: InvalidArgument, WriteFailed, those of capture,
// Interrupted.
Result<Job> validate(const BakeOptions& options, const BakeEnvironment& environment);

// Encodes the base mesh and finds the bounds of all frames, from the meshes as the job's capture reads them now; from
// cameras, planCameraSurfaces.
// Errors: those of capture, Interrupted, InvalidArgument.
Status planSurface(Job& job, const BakeEnvironment& environment);

constexpr double kVideoBytesPerTexel = 0.05;  // generous: crf 23 needs a fifth of it
// Errors: WriteFailed if the disk has no room for a character of this size and for the work folder.
Status checkSpace(const Job& job, double character_bytes);
// Sets job.length_scale from the frames' longest sides, unless an earlier call has, and with it the lengths that the
// options leave open. Errors: InvalidArgument if the bounds are too many position steps wide.
Status settleLengths(Job& job, std::vector<double> longest_sides_m);

// The files of a sequence, its meshes, the cameras, the plates (path, size, time), wherever capture.json places them;
// the meshes' topology, and capture.json.
std::string filesKey(const capture::Capture& capture, const capture::CaptureSequence& sequence);
// Hash of what visibility depends on: those files, the mesh's order, the refinement. Reads no file once settleKeys has.
std::string captureKey(const Job& job, const capture::CaptureSequence& sequence);
// What labels depend on in addition.
std::string labelKey(const BakeOptions& options);

// Hash of everything that finished GOPs depend on: options, capture files (path, size, time), the bake's version.
std::string settingsKey(const Job& job);

// Sets the job's keys and digests; once, after its streams are planned.
void settleKeys(Job& job);
// Refuses files that are not those which settleKeys found: those of one of a sequence's windows (kInputWindow), or
// those that all frames need. Errors: InvalidArgument.
Status checkInputs(const Job& job, const capture::CaptureSequence& sequence, uint32_t window);
Status checkMeshInputs(const Job& job, const capture::CaptureSequence& sequence);
Status checkSounds(const Job& job);
Status checkCommonInputs(const Job& job);

}  // namespace fourdvt::bake
