// SPDX-License-Identifier: Apache-2.0
// Keys of what is kept between bakes: hashes of the files and settings that it depends on; and whether files are still
// those that a plan was made for.
#pragma once

#include "bake/run/job.h"

namespace fourdvt::bake {

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

}  // namespace fourdvt::bake
