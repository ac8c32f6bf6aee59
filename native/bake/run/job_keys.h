// SPDX-License-Identifier: Apache-2.0
// Keys of files that are kept between bakes: hashes of the files and settings that they depend on; and the test for
// changes of input files since planning.
#pragma once

#include "bake/run/job.h"

namespace fourdvt::bake {

// The files of a sequence, its meshes, the cameras, the plates (path, size, time), wherever capture.json places them;
// the meshes' topology, and capture.json.
std::string filesKey(const capture::Capture& capture, const capture::CaptureSequence& sequence);
// Hash of the inputs of visibility: those files, the mesh's order, the refinement. Reads no file after settleKeys.
std::string captureKey(const Job& job, const capture::CaptureSequence& sequence);
// Additional inputs of labels.
std::string labelKey(const BakeOptions& options);

// Hash of all inputs of finished GOPs: options, capture files (path, size, time), the bake's version.
std::string settingsKey(const Job& job);

// Sets the job's keys and digests; once, after its streams are planned.
void settleKeys(Job& job);

}  // namespace fourdvt::bake
