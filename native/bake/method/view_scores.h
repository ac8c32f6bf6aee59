// SPDX-License-Identifier: Apache-2.0
// A picture against the truth it stands for when it may lie elsewhere as a whole. Errors of calibration displace what
// is drawn for a camera that was left out; errors of the surface do not, since cameras on both sides of it are
// displaced to opposite sides.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "base/camera.h"
#include "base/face_buffer.h"
#include "base/image.h"
#include "base/mesh.h"
#include "measure/metrics.h"

namespace fourdvt::bake {

struct RegisteredScore {
  glm::dvec2 shift_px{0};        // of the picture against the truth, in steps of a quarter pixel, at most kMostShift_px
  double psnr_db = 0, ssim = 0;  // inside, once it is moved back
};
constexpr int kMostShift_px = 8;

// RGB of one size; `inside` is not empty.
RegisteredScore registeredScore(const Image& truth, const Image& picture, const measure::Mask& inside);

// Where a view of a surface is blended from cameras on both sides of it, as a visitor's view mostly is. The view of a
// camera that is left out is further from the others than any visitor's: over much of it one camera alone sees the
// surface, or none, and there methods do not differ as they do for visitors. Does NOT look at pictures.

// The least share of FVVR's weights (cosine at the surface × cosine between the rays) that the camera with the second
// largest one has where a view counts as blended.
constexpr double kSharedWeight = 0.25;

class SharedSight {
 public:
  // Borrows the surface. length_scale: base/length_scale.h. Memory: 8 bytes a pixel of all cameras, at most 512 on the
  // longer side of each.
  SharedSight(const std::vector<PinholeCamera>& cameras, const TriangleMesh& surface, double length_scale);
  // Pixels of the view, which may be a camera's own, where at least two of the cameras but `left_out` see the surface
  // with such weights.
  measure::Mask of(const PinholeCamera& view, std::optional<size_t> left_out) const;

 private:
  struct Seen {
    PinholeCamera camera;  // with the pixels of the buffer
    glm::dvec3 centre_in_world;
    FaceBuffer buffer;
  };
  double secondShare(const glm::dvec3& point, const glm::dvec3& normal, const glm::dvec3& to_eye,
                     std::optional<size_t> left_out) const;

  const TriangleMesh& surface_;
  const double tolerance_m_;
  std::vector<glm::vec3> normals_;
  std::vector<Seen> seen_;
};

}  // namespace fourdvt::bake
