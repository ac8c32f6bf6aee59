// SPDX-License-Identifier: Apache-2.0
// The "regions" stage of a character from cameras: what every camera shows of the surfaces, and the sequences' tiles.
#pragma once

#include "bake/run/bake_run.h"

namespace fourdvt::bake {

// Reads every surface once, one at a time, and the sequences' first ones before that: a tiled picture that is too large
// is an error as early as can be. Sets job.regions, job.bounds and job.mesh, the first surface. Errors: those
// of capture, NothingVisible, InvalidArgument, Interrupted.
Status planCameraSurfaces(Job& job, const BakeEnvironment& environment);

// The surface of a frame as it is streamed, but for the grid of its positions.
TriangleMesh streamedSurface(const Job& job, const capture::CaptureFrame& frame);

// Completes job.streams: one per captured sequence. Errors: InvalidArgument (the tiled picture is too large).
Status planCameraStreams(BakeRun& run);

}  // namespace fourdvt::bake
