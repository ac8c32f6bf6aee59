// SPDX-License-Identifier: Apache-2.0
// The resolved plan of one bake: options, capture, mesh order, streams. Does NOT change once planStreams has completed
// it, but for what alignment measures.
#pragma once

#include <string>
#include <vector>

#include "bake/motion/class_plan.h"
#include "bake/run/options.h"
#include "bake/video/encode.h"
#include "bake/video/tile.h"
#include "capture/capture.h"
#include "package/base_mesh.h"

namespace fourdvt::bake {

// One sequence of the character: a captured one, or a class of them with all members' layers in one picture.
struct StreamPlan {
  std::string name;
  // A captured sequence: its own one member at its own frames, without references and parameters.
  ClassPlan motion;
  TileLayout layout;
  EncodeSettings encode;
  std::vector<uint32_t> gop_first_frames;  // ascending, starts with 0
  float detail_correlation = 1;            // of a class's aligned members; set by the align stage
  bool isClass() const { return motion.members.size() > 1; }
  uint32_t frameCount() const { return motion.frame_count; }
  uint32_t gopEnd(size_t gop) const {
    return gop + 1 < gop_first_frames.size() ? gop_first_frames[gop + 1] : frameCount();
  }
  // The frame of the member's source whose pictures and labels stand for this one.
  uint32_t sourceFrame(size_t member, uint32_t frame) const;
};

struct Job {
  BakeOptions options;       // resolved: jobs > 0, sequences listed, folders without a trailing slash
  capture::Capture capture;  // its sequences are surveyed and labelled; streams borrow them
  std::vector<PinholeCamera> cameras;
  std::vector<StreamPlan> streams;  // in the manifest's order: the sequences, then the classes
  package::EncodedBaseMesh mesh;    // THE order of vertices and faces of everything below
  BoundingBox bounds;               // over all frames
  TileLayout layout;                // of one member
  EncodeSettings encode;            // of a captured sequence
  uint32_t total_frames = 0;        // captured
  uint32_t streamFrames() const;    // of all streams
  // Beside the character folder and on its file system: finished GOPs, and the result until it is renamed into place.
  std::string workFolder() const { return options.character_folder + ".work"; }
  std::string resultFolder() const { return workFolder() + "/result"; }
};

// Equal lengths ±1, at most `gop` frames each.
std::vector<uint32_t> planGops(uint32_t frame_count, int gop);

// Positions in the decoded mesh's order.
Positions reordered(const package::EncodedBaseMesh& mesh, const Positions& source);

}  // namespace fourdvt::bake
