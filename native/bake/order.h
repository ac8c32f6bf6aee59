// SPDX-License-Identifier: Apache-2.0
// Labels: which cameras a face takes its layers from, best first.
// Does NOT look at neighbouring faces or frames: PaperPenalty is the papers' naive order ("NO"). An optimised labelling
// is another LabelMode and replaces only labelFaces.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/camera.h"
#include "base/mesh.h"

namespace fourdvt::bake {

enum class LabelMode { PaperPenalty };

struct LabelOptions {
  LabelMode mode = LabelMode::PaperPenalty;
  int layers = 3;
  float visible_fraction = 0.99f;   // of a face's sample points, for a camera to qualify
  float fallback_fraction = 0.30f;  // asked for where no camera qualifies
};

// 4DVT Eq. 1: 1 - (n·ô)², n the unit face normal and ô the unit optical axis. Blind to the sign: see facesCamera.
double penalty(const glm::dvec3& normal, const glm::dvec3& optical_axis);

// The facing test that Eq. 1 needs: the camera centre lies in front of the face.
bool facesCamera(const glm::dvec3& normal, const glm::dvec3& face_centre, const glm::dvec3& camera_centre);

// `fractions`: camera-major [camera][face], 0..1. Result: [layer][face], camera index or package::kNoCamera.
std::vector<uint8_t> labelFaces(const LabelOptions& options, std::span<const PinholeCamera> cameras,
                                const MeshTopology& topology, const Positions& positions,
                                std::span<const float> fractions);

}  // namespace fourdvt::bake
