// SPDX-License-Identifier: Apache-2.0
// Motion classes from meshes alone (ALGORITHMS 4): common time by monotone dynamic time warping, root motion from the
// feet, hybrid blend references within an error bound, the parameter's table. Does NOT look at pictures.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bake/motion/nonlinear_blend.h"
#include "bake/motion/root_track.h"
#include "capture/capture.h"
#include "package/character.h"

namespace fourdvt::bake {

struct ClassOptions {
  double blend_error_m = 0.003;  // hybrid against full non-linear blend, largest vertex distance
  int max_references = 8;        // corrections a frame; more are never stored: the report says what error is left
  int check_weights = 17;        // weights an interval at which the bound is checked
};

// All meshes of a capture, in one order of vertices.
struct CapturedMeshes {
  const MeshTopology& topology;
  ReadPositions read;
};

struct ClassMember {
  const capture::CaptureSequence* source = nullptr;
  // [phase] position in the source in frames, fractional, never decreasing; a loop's may pass its end: modulo.
  std::vector<double> source_frame;
  std::vector<glm::vec3> root;  // [phase]: ChunkFrames::root
};

struct ClassPlan {
  const capture::CaptureClass* source = nullptr;
  uint32_t frame_count = 0;  // phases: the longest member's frames
  double fps = 0;            // frame_count / mean duration of the members
  bool loop = false;
  std::vector<ClassMember> members;
  std::vector<package::Member> manifest;  // one a member
  package::ParameterSpace space;
  std::vector<std::vector<float>> reference_weights;  // [reference][member]
  double linear_error_m = 0, hybrid_error_m = 0;      // largest vertex distance to the non-linear blend, at the checks
  std::vector<std::string> notes;                     // for the report: one sentence each
};

// Errors: CaptureJson (class that cannot be: loops mixed with others, unknown parameter without values), those of read,
// Interrupted (progress returned false). progress: share 0..1. read: neighbouring phases ask for the same frames.
Result<ClassPlan> planClass(const capture::Capture& capture, const capture::CaptureClass& source,
                            const CapturedMeshes& meshes, const ClassOptions& options,
                            const std::function<bool(double)>& progress);

// The plan's members alone, without a look at how they blend. read: asked for every frame, and for each several times.
Result<std::vector<ClassMember>> classMembers(const capture::Capture& capture, const capture::CaptureClass& source,
                                              const ReadPositions& read);

// Positions of a member at a phase, interpolated between the source's frames (4 points, so that motion stays smooth).
Result<Positions> memberPositions(const ClassMember& member, uint32_t phase, const ReadPositions& read);

// Corrections of one phase: [reference][vertex] = D such that Σ φ_j(w) D_j joins the non-linear blend at the
// references.
std::vector<Positions> referenceOffsets(const NonlinearBlend& blend, const ClassPlan& plan,
                                        std::span<const Positions> members);

}  // namespace fourdvt::bake
