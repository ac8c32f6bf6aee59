// SPDX-License-Identifier: Apache-2.0
// Makes a capture folder that links to the videos, mattes, plates and calibrations of another one, and has a
// capture.json of its own. Its own meshes or mattes, which replace the links, are written by the caller.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "capture/capture.h"

namespace fourdvt::capture {

inline constexpr const char* kMeshFolder = "mesh";                 // name in a sequence's folder
inline constexpr const char* kPackedPositions = "positions.i16";   // name in the mesh folder
inline constexpr const char* kMeshTopology = "mesh_topology.obj";  // name in the capture's folder

// Meshes of the new capture.
enum class LinkedMeshes {
  AsGiven,   // linked
  PerFrame,  // its own, of per-frame topology: <sequence>/mesh/%06d.ply
  Packed,    // its own, one mesh that moves: mesh_topology.obj for all, and <sequence>/mesh/positions.i16
};

struct LinkOptions {
  std::vector<std::string> sequences;  // sequences to include
  LinkedMeshes meshes = LinkedMeshes::AsGiven;
  double units_per_metre = 0;          // Packed: scale of the positions
  std::vector<CaptureClass> classes;   // Packed: motion classes, without footsteps
  std::vector<std::string> leave_out;  // cameras to remove; the new capture has its own calibration without them
  bool own_calibration = false;        // cameras as in `capture`, rather than as in its folder
  bool own_times = false;              // frames, first_frame and offset_frames as in `capture`
  bool own_motion = false;             // loop, root_velocity and travel as in `capture`
};

// Links the contents of `capture`'s folder into `to`, which exists: everything but capture.json, reports, excluded
// sequences, and meshes that are replaced. Links are relative, so that both folders can be moved together; where links
// are impossible, files are copied. Existing entries stay, including texts that would not change; `to` may be renamed
// within its parent folder later. Then writes capture.json; with meshes of per-frame topology motion classes, which
// require one topology, are left out. Errors: WriteFailed, CaptureJson, FileMissing.
//
// Packed: the caller writes objText (mesh_file.h) to kMeshTopology, and appendPacked of each frame to the positions. As
// frames are counted from the first picture, `first_frame` frames that nothing reads precede frame 0.
Status linkCapture(const Capture& capture, const std::string& to, const LinkOptions& options);

// Removes cameras from an opened capture. Errors: InvalidArgument (a name that no camera has; fewer than two cameras
// left).
Status leaveOut(const std::vector<std::string>& names, Capture& capture);

}  // namespace fourdvt::capture
