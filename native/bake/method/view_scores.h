// SPDX-License-Identifier: Apache-2.0
// Scores of rendered views against recorded pictures. Registers a picture against its ground truth by a translation
// before comparing: errors of calibration displace the rendered view of a left-out camera as a whole; errors of the
// surface do not, since cameras on either side of the view are displaced in opposite directions. Then masks the
// pixels that are blended (SharedSight).
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
  glm::dvec2 shift_px{0};        // picture against truth, in steps of a quarter pixel, at most kMaxShift_px
  double psnr_db = 0, ssim = 0;  // inside the mask, after registration
};
constexpr int kMaxShift_px = 8;

// RGB of one size; `inside` is not empty.
RegisteredScore registeredScore(const Image& truth, const Image& picture, const measure::Mask& inside);

// Mask of the pixels of a view that are blended from cameras on both sides of it, like most of a visitor's view. A
// left-out camera's view is further from the others than any visitor's: much of it is seen by one camera only, or by
// none, and methods differ less there than they do for visitors. Computed from geometry alone.

// Minimum share of FVVR's weights (cosine at the surface × cosine between the rays) that the camera with the second
// largest one has in a blended pixel.
constexpr double kSharedWeight = 0.25;

class SharedSight {
 public:
  // Borrows the surface. length_scale: lengthScale in base/mesh.h. Memory: 8 bytes per pixel of all cameras, at most
  // 512 on the longer side of each.
  SharedSight(const std::vector<PinholeCamera>& cameras, const TriangleMesh& surface, double length_scale);
  // Pixels of the view, which may be a camera's own, at which at least two cameras other than `left_out` see the
  // surface, the second with a share of kSharedWeight or more.
  measure::Mask of(const PinholeCamera& view, std::optional<size_t> left_out) const;

 private:
  struct Seen {
    PinholeCamera camera;  // picture size: that of the buffer
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
