// SPDX-License-Identifier: Apache-2.0
// Motion classes from meshes alone (ALGORITHMS 4): common time by monotone dynamic time warping, root motion from the
// feet, hybrid blend references within an error bound, the parameter's table. Does NOT look at pictures.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "capture/capture.h"
#include "package/character.h"

namespace fourdvt::bake {

// Positions of one captured frame in the decoded mesh's order, metres.
using ReadPositions = std::function<Result<Positions>(const capture::CaptureSequence&, uint32_t frame)>;

struct ClassOptions {
  double blend_error_m = 0.003;  // hybrid against full non-linear blend, largest vertex distance
  int max_references = 8;        // corrections a frame; more are never stored: the report says what error is left
  int check_weights = 17;        // weights an interval at which the bound is checked
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
                            const MeshTopology& topology, const ReadPositions& read, const ClassOptions& options,
                            const std::function<bool(double)>& progress);

// The plan's members alone, without a look at how they blend. read: asked for every frame, and for each several times.
Result<std::vector<ClassMember>> classMembers(const capture::Capture& capture, const capture::CaptureClass& source,
                                              const MeshTopology& topology, const ReadPositions& read);

// Of a captured sequence: metres along x and z, radians about y since frame 0, [frame_count + 1]: the last entry is the
// whole pass. From vertices that stand on the ground (they must not slide), between contacts by velocity. Where their
// mean speed and a declared root velocity differ by more than a fifth, the latter is used and `note` says so.
// Does NOT measure turns: the angle is 0.
Result<std::vector<glm::vec3>> rootTrack(const capture::Capture& capture, const capture::CaptureSequence& sequence,
                                         const MeshTopology& topology, const ReadPositions& read,
                                         std::string* note = nullptr);

// Positions of a member at a phase, interpolated between the source's frames (4 points, so that motion stays smooth).
Result<Positions> memberPositions(const ClassMember& member, uint32_t phase, const ReadPositions& read);

// Deformation-gradient blending: T = exp(Σ w log R) · Σ w S a face, solved for vertices with a prefactorised sparse
// Cholesky (ALGORITHMS 4.3; "CTGH13" of 4DVT). A part of the mesh is placed where the linear blend has those of its
// faces that turn least between the members: it is exact for what does not turn.
class NonlinearBlend {
 public:
  // `reference`: any pose of the mesh. Errors: MeshTopology (a face without area everywhere, nothing to anchor).
  static Result<std::unique_ptr<NonlinearBlend>> create(const MeshTopology& topology, const Positions& reference);
  virtual ~NonlinearBlend() = default;
  virtual Positions blend(std::span<const Positions> members, std::span<const float> weights) const = 0;
};
Positions linearBlend(std::span<const Positions> members, std::span<const float> weights);

// Corrections of one phase: [reference][vertex] = D such that Σ φ_j(w) D_j joins the non-linear blend at the
// references.
std::vector<Positions> referenceOffsets(const NonlinearBlend& blend, const ClassPlan& plan,
                                        std::span<const Positions> members);

}  // namespace fourdvt::bake
