// SPDX-License-Identifier: Apache-2.0
// Ground truth of a motion class, in truth/CLASS of a studio capture: the exact intermediate motions, and the alignment
// of the members' appearance on the tracked mesh.
//
//   truth.json            index of the files below, and the members' captured frame per phase
//   cameras/              COLMAP text, exact: the held-out cameras and some of the ring
//   wNNN/CAMERA/%04d.png  straight alpha, no noise, no gain; NNN: 100 × position among the members (000 the first, 100
//                         the last); the file's number: the phase
//   wNNN/mesh/positions.i16   the exact tracked mesh, packed as a sequence's, one frame per phase
//   alignment/MEMBER/%04d.bin for each phase, per vertex of mesh_topology.obj: face (uint32), barycentric shares of its
//                         second and third corner (2 × float32), little-endian: the point of the mesh at which MEMBER
//                         has the first member's appearance at the vertex. Independent of the pose: on a mesh P the
//                         displacement is Σ share_k P[corner_k] - P[vertex].
#pragma once

#include "lab/studio/set.h"
#include "lab/studio/writer.h"

namespace fourdvt::studio {

// Number of pictures drawn by writeTruth.
uint32_t truthPictures(const StudioSet& set, const StudioOptions& options);
// Writes the truth of all classes of the set. Errors: WriteFailed, GpuFailure, Interrupted.
Status writeTruth(StudioSet& set, const StudioOptions& options, const OutputFolder& out, Ticker& ticker);

}  // namespace fourdvt::studio
