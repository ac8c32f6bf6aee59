// SPDX-License-Identifier: Apache-2.0
// Measures of moving and blended appearance: sharpness of a region, flow fields against each other, where a moved
// surface is seen. Does NOT draw characters, compute optical flow or read files.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "base/camera.h"
#include "base/image.h"
#include "measure/metrics.h"

namespace fourdvt::measure {

// Pixels of the region that are further than `pixels` from everything outside it and from the picture's border.
Mask eroded(const Mask& inside, int width, int height, int pixels);

// Mean squares over the pixels inside, of encoded luma. Their stencils reach one pixel further. NaN for an empty
// region.
struct Sharpness {
  double gradient = 0;  // central differences, (levels / pixel)²
  double detail = 0;    // Laplacian of four neighbours: the finest structure, (levels / pixel²)²
};
Sharpness sharpness(const Image& rgb, const Mask& inside);

// What a picture shows at p, another one shows at p + displacement. Pixels, y down.
struct FlowField {
  int width = 0, height = 0;
  std::vector<glm::vec2> displacement;  // NaN where nothing is known
};
// Bilinear between pixels; NaN where a neighbour is NaN.
glm::vec2 flowAt(const FlowField& flow, glm::dvec2 pixel);

// Flow of the surface when its face corners move from `positions` to `moved` ([3 * face + corner]); perspective-correct
// inside a face. NaN off the surface. metres_per_pixel, if not null, gets the size of a pixel on the surface.
FlowField surfaceFlow(const PinholeCamera& camera, const std::vector<glm::uvec3>& faces, const Positions& positions,
                      const std::vector<glm::vec3>& moved, std::vector<float>* metres_per_pixel = nullptr);

// Collects distances; NaN is left out.
class ErrorSamples {
 public:
  void add(float value);
  double mean() const;  // NaN: none
  double tail() const;  // 95th percentile
  size_t count() const { return values_.size(); }

 private:
  std::vector<float> values_;
};
// Adds the lengths of a - b at the pixels inside.
void addDifferences(const FlowField& a, const FlowField& b, const Mask& inside, ErrorSamples& out);

// The fractional frame at which two motions on a common time, blended with weight w of the second, reach `phase`: where
// the w-weighted mean of their own phases is `phase`. first, second: [frame] share of the motion that has passed,
// rising. A loop's shares may begin anywhere and go on beyond 1; the second's turn nearest to the first's is used.
double commonFrame(std::span<const double> first, std::span<const double> second, bool loop, double w, double phase);

// Mean of |a - b| over the three channels, levels, where either picture is covered (alpha >= 128); straight alpha over
// black. 0 if neither is covered anywhere.
double pictureChange(const Image& a, const Image& b);
// Largest distance between points of the same index.
double largestStep_m(const Positions& a, const Positions& b);

}  // namespace fourdvt::measure
