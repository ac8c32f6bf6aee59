// SPDX-License-Identifier: Apache-2.0
// What classes still lack after their GOPs are encoded: alignment of what the decoded pictures show, and the chunks.
// Measured phases are kept in the work folder, so that an interrupted bake goes on. Completes the classes' plans by how
// much of their detail correlates.
#pragma once

#include "bake/run/bake_run.h"

namespace fourdvt::bake {

// Errors: GpuFailure, VideoInvalid, WriteFailed, Interrupted.
Status alignClasses(BakeRun& run);
// One class of them.
Status alignClass(BakeRun& run, StreamPlan& plan);
// Measures the phases of one GOP of a class, whose GOP is finished.
Status alignGop(BakeRun& run, const StreamPlan& plan, uint32_t gop);

}  // namespace fourdvt::bake
