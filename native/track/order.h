// SPDX-License-Identifier: Apache-2.0
// Order in which frames are tracked: a tree over the similarity of their pictures. Drift grows with the depth of a
// frame in the tree, not with time. Source: Budd, Huang, Klaudiny, Hilton: Global Non-rigid Alignment of
// Surface Sequences. International Journal of Computer Vision 102, 2013.
#pragma once

#include <opencv2/core.hpp>
#include <span>
#include <vector>

#include "base/camera.h"
#include "base/image.h"

namespace fourdvt::track {

// Small pictures of a frame, one per camera, all of the same region in every frame.
struct FrameThumbnails {
  std::vector<cv::Mat> pictures;  // RGBA, premultiplied; empty: not seen
};
// `pictures`: RGBA, one per camera.
FrameThumbnails thumbnailsOf(std::span<const Image> pictures);

// 0 for equal pictures; about 1 for silhouettes without a common pixel.
double dissimilarity(const FrameThumbnails& a, const FrameThumbnails& b);

struct TrackingStep {
  uint32_t frame = 0, parent = 0;  // indices into the frames
  double dissimilarity = 0;
  uint32_t depth = 0;
};
// Steps from the root to all frames, parents before their children: shortest paths along edges between frames that are
// neighbours, and those of a minimum spanning tree. An edge counts the square of its dissimilarity. A loop is followed
// in both directions; a leap to a pose that only looks alike, such as the mirrored one half a stride later, is no edge.
std::vector<TrackingStep> trackingOrder(std::span<const FrameThumbnails> frames, uint32_t root);

}  // namespace fourdvt::track
