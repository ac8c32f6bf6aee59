// SPDX-License-Identifier: Apache-2.0
// The sound of a sequence, and of the steps of a class: reads it with the pictures' time, cuts it into segments,
// encodes them. Holds one segment of samples at a time, and the encoded file.
#pragma once

#include "bake/report/report.h"
#include "bake/run/bake_run.h"
#include "package/sound.h"

namespace fourdvt::bake {

// Opens every sound that the job has, and finds out whether anything of it is heard; what is not goes into job.notes.
// Errors: those of AudioReader, CaptureJson (a sound that lies outside its sequence).
Status checkSounds(Job& job, const BakeEnvironment& environment);

// Writes the files of all streams that have sound into the result folder, and their bytes into the report. Errors:
// those of AudioReader and encodeSegment, WriteFailed, Interrupted; those of reading meshes.
Result<package::Sounds> writeSounds(BakeRun& run, ReportInput& report);

}  // namespace fourdvt::bake
