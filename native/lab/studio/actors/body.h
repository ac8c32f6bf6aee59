// SPDX-License-Identifier: Apache-2.0
// The procedural actor's shape: rounded cones on a skeleton, smoothly joined, meshed, unwrapped and weighted. Metres;
// A-pose, facing +Z with Y up, soles at y = 0. Deterministic.
#pragma once

#include <array>

#include "lab/studio/actors/actor.h"

namespace fourdvt::studio {

enum Bone {
  Pelvis,
  Spine,
  Chest,
  Head,
  UpperArmL,
  ForearmL,
  HandL,
  UpperArmR,
  ForearmR,
  HandR,
  ThighL,
  ShinL,
  FootL,
  ThighR,
  ShinR,
  FootR,
  kBoneCount
};

// Left is the actor's own, +X.
constexpr glm::dvec3 kHipRest{0.10, 0.92, 0}, kKneeRest{0.13, 0.50, 0.01}, kAnkleRest{0.15, 0.09, -0.01};
constexpr glm::dvec3 kShoulderRest{0.20, 1.40, 0}, kElbowRest{0.40, 1.18, 0}, kWristRest{0.58, 1.00, 0.02};
constexpr glm::dvec3 kPelvisRest{0, 0.95, 0}, kWaistRest{0, 1.05, 0}, kNeckRest{0, 1.45, 0};

// Signed distance to the body, negative inside.
double bodyDistance(const glm::dvec3& p);
// Smooth skinning weights at a point near the skin; sum 1.
std::array<float, kBoneCount> boneWeights(const glm::dvec3& p);
// Bone with the maximum weight at that point.
Bone boneAt(const glm::dvec3& p);
// Returns a closed and connected mesh with one atlas, vertices on the body and faces counter-clockwise seen from
// outside. `cell_m`: approximate edge length.
RestMesh meshBody(double cell_m);
// Splits each face into four. New vertices are moved onto the body, UVs stay in their charts.
RestMesh subdivideOnBody(const RestMesh& mesh);
// The actor's clothes and skin on the mesh's atlas: plaid, weave and grain at several scales, rows of glyphs; or with
// `plain_clothes`, of which each is of one colour.
Image paintBody(const RestMesh& mesh, int side, bool plain_clothes);

}  // namespace fourdvt::studio
