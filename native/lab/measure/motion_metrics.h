// SPDX-License-Identifier: Apache-2.0
// Measures of moving and blended appearance: sharpness of a region, differences of flow fields, flow of a moving
// surface.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "base/camera.h"
#include "base/image.h"
#include "measure/metrics.h"

namespace fourdvt::measure {

// Pixels of the region farther than `pixels` from its outside and from the picture's border.
Mask eroded(const Mask& inside, int width, int height, int pixels);

// Mean squares over the pixels inside, of encoded luma. The stencils reach one pixel further. NaN for an empty region.
struct Sharpness {
  double gradient = 0;  // central differences, (levels / pixel)²
  double detail = 0;    // Laplacian of four neighbours: the finest structure, (levels / pixel²)²
};
Sharpness sharpness(const Image& rgb, const Mask& inside);

// Flow from one picture to another: content at p moves to p + displacement. Pixels, y down.
struct FlowField {
  int width = 0, height = 0;
  std::vector<glm::vec2> displacement;  // NaN if unknown
};
// Bilinear between pixels; NaN where a neighbour is NaN.
glm::vec2 flowAt(const FlowField& flow, glm::dvec2 pixel);

// Surface flow for face corners that move from `positions` to `moved` ([3 * face + corner]); perspective-correct inside
// a face. NaN off the surface. metres_per_pixel, if not null, receives the size of a pixel on the surface.
FlowField surfaceFlow(const PinholeCamera& camera, const std::vector<glm::uvec3>& faces, const Positions& positions,
                      const std::vector<glm::vec3>& moved, std::vector<float>* metres_per_pixel = nullptr);

// Distances, excluding NaN.
class ErrorSamples {
 public:
  void add(float value);
  double mean() const;  // NaN without samples
  double tail() const;  // 95th percentile
  size_t count() const { return values_.size(); }

 private:
  std::vector<float> values_;
};
// Adds the lengths of a - b at the pixels inside.
void addDifferences(const FlowField& a, const FlowField& b, const Mask& inside, ErrorSamples& out);

// Fractional frame at which two motions on a common time, blended with weight w of the second, reach `phase`: the
// w-weighted mean of their own phases is `phase`. first, second: [frame] elapsed share of the motion, ascending. A
// loop's shares may begin anywhere and continue beyond 1; uses the second's turn nearest to the first's.
double commonFrame(std::span<const double> first, std::span<const double> second, bool loop, double w, double phase);

// Mean of |a - b| over the three channels, levels, over the union of both silhouettes (alpha >= 128); straight alpha
// over black. 0 for an empty union.
double pictureChange(const Image& a, const Image& b);
// Maximum distance between points of the same index.
double largestStep_m(const Positions& a, const Positions& b);

}  // namespace fourdvt::measure
