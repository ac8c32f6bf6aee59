// SPDX-License-Identifier: Apache-2.0
// Per-frame label costs: the cameras that qualify for each face, and the penalty of each.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/camera.h"
#include "base/mesh.h"

namespace fourdvt::bake {

// All penalties lie in 0…1; lower is better.
enum class Penalty {
  Axis,  // 4DVT Eq. 1 (Casas et al. 2014, labelling.h): 1 - (n·ô)², ô the unit optical axis, or the ray through the
         // picture's centre if that differs
  Ray,   // the same with the unit ray from the camera's centre to the face's centre
  Resolution,  // 1 - pixels of the face in this camera / pixels if the rig's best camera saw it frontally
};

struct FaceCostOptions {
  Penalty penalty = Penalty::Axis;
  float visible_fraction = 0.99f;   // share of a face's sample points that qualifies a camera
  float fallback_fraction = 0.30f;  // the same where no camera qualifies
};

// Penalty of any camera on an unseen face: slightly below that of an empty rank, so that smoothness decides.
constexpr float kUnseenPenalty = 1.9f;

struct FaceCosts {
  int camera_count = 0;
  std::vector<uint32_t> feasible;  // per face: bit c = camera c sees it and it faces camera c
  // Per face: cameras that face it and see at least `fallback_fraction` of it, but are not feasible. Empty: none.
  // Used by the joint labelling only, where that saves a seam or a flip.
  std::vector<uint32_t> partial;
  // Per face, 1: no camera is feasible or partial. kJoint may then assign any camera at kUnseenPenalty, so that the
  // neighbours' label continues across the face (its texels are filled in); the papers' rules leave its ranks empty. An
  // empty vector means all 0.
  std::vector<uint8_t> unseen;
  // [face * camera_count + camera]. Feasible cameras: p; partial ones: p + (1 - p) · (hidden share)²; others: 1, on
  // unseen faces kUnseenPenalty.
  std::vector<float> penalty;
};

// 4DVT Eq. 1: 1 - (n·ô)², n the unit face normal and ô the unit optical axis. Ignores the sign: see
// facesCamera.
double penalty(const glm::dvec3& normal, const glm::dvec3& optical_axis);

// Facing test that complements this penalty: the camera centre lies in front of the face.
bool facesCamera(const glm::dvec3& normal, const glm::dvec3& face_centre, const glm::dvec3& camera_centre);

// `fractions`: [camera][face], 0..1, of Visibility::measure.
FaceCosts measureFaceCosts(const FaceCostOptions& options, std::span<const PinholeCamera> cameras,
                           const MeshTopology& topology, const Positions& positions, std::span<const float> fractions);

// Visibility hysteresis: `after[f]` of frame f is the majority value of the frames f-radius..f+radius (at least half
// of them), per face and camera, which removes changes of a frame or two. A camera that does not see a face at all in
// frame f (fraction below `fallback_fraction`) is never added. Works on fractions of a window of frames: fractions[k]
// is frame first+k; returns those of the middle frame `middle`.
std::vector<float> steadyFractions(std::span<const std::vector<float>> fractions, size_t middle,
                                   const FaceCostOptions& options);

}  // namespace fourdvt::bake
