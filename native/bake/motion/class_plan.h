// SPDX-License-Identifier: Apache-2.0
// Plans motion classes from meshes alone (algorithms/motion.md): time-aligns the members, selects the references of
// the hybrid blend within an error bound, and tabulates the parameter.
#pragma once

#include <cstdint>
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
  double blend_error_m = 0.001;  // largest vertex distance of the hybrid from the full non-linear blend
  int max_references = 8;        // maximum number of corrections per frame; the report gives the residual error
  int check_weights = 25;        // weights per interval at which the bound is checked
};

// All meshes of a capture, in one order of vertices.
struct CapturedMeshes {
  const MeshTopology& topology;
  ReadPositions read;
};

struct ClassMember {
  const capture::CaptureSequence* source = nullptr;
  // [phase] captured frame, fractional and non-decreasing; a loop's continues past its end, modulo its length.
  std::vector<double> source_frame;
  std::vector<glm::vec3> root;  // [phase]: ChunkFrames::root
};

struct ClassPlan {
  const capture::CaptureClass* source = nullptr;
  uint32_t frame_count = 0;  // phases: the longest member's frames
  double fps = 0;            // frame_count / mean duration of the members
  bool loop = false;
  std::vector<ClassMember> members;
  std::vector<package::Member> manifest;  // one per member
  package::ParameterSpace space;
  std::vector<std::vector<float>> reference_weights;  // [reference][member]
  double linear_error_m = 0,
         hybrid_error_m = 0;       // largest vertex distances from the non-linear blend at the checked weights
  std::vector<std::string> notes;  // for the report, one sentence each
};

// Checks a class as far as possible without meshes, before a bake reads pictures. Error: CaptureJson.
Status checkClass(const capture::Capture& capture, const capture::CaptureClass& source);

// `progress` receives the finished share, 0…1, and returns false to stop. Neighbouring phases read the same frames.
// Errors: those of checkClass, CaptureJson (two members have the same speed), those of meshes.read, Interrupted.
Result<ClassPlan> planClass(const capture::Capture& capture, const capture::CaptureClass& source,
                            const CapturedMeshes& meshes, const ClassOptions& options,
                            const std::function<bool(double)>& progress);

// The plan's members only, without measuring their blend. Reads every frame several times.
Result<std::vector<ClassMember>> classMembers(const capture::Capture& capture, const capture::CaptureClass& source,
                                              const ReadPositions& read);

// Positions of a member at a phase, interpolated between four captured frames so that the motion stays smooth.
Result<Positions> memberPositions(const ClassMember& member, uint32_t phase, const ReadPositions& read);

// Corrections of one phase: [reference][vertex] = D, such that the linear blend plus Σ φ_j(w) D_j is the non-linear
// blend at the references.
std::vector<Positions> referenceOffsets(const NonlinearBlend& blend, const ClassPlan& plan,
                                        std::span<const Positions> members);

// Common phases of a class at which a foot touches down. Pure functions.

// Phases in 0..1, ascending, of one member's footfalls. frames: captured ones; source_frame: ClassMember::source_frame;
// loop_frames: frames of the member's loop, or 0; phases: their number in the class. Frames outside the pass are left
// out.
std::vector<double> stepPhases(std::span<const uint32_t> frames, std::span<const double> source_frame,
                               uint32_t loop_frames, uint32_t phases);

// The first member's footfalls, each averaged with the nearest phases of the other members. The first member's alone
// where the members' numbers differ.
std::vector<double> meanSteps(const std::vector<std::vector<double>>& members, bool loop);

}  // namespace fourdvt::bake
