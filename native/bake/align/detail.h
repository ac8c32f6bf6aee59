// SPDX-License-Identifier: Apache-2.0
// How much detail survives when looks of one surface are averaged: their gradients' correlation. Noise, compression and
// folds that differ between motions do not correlate however well they are aligned; their mean has less contrast than
// each of them (Heitz and Neyret 2018, variance-preserving blending). The renderer puts it back (render/layered_pass).
#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace fourdvt::bake {

// Gradient energies of the looks of one view, on the pixels that all of them show.
struct DetailEnergy {
  std::vector<double> own;  // [member]
  double sum = 0;           // of the looks' sum
};

// [member] CV_8UC4 of one view, two or more, the same outline.
DetailEnergy detailEnergy(const std::vector<cv::Mat>& looks);

// 0..1: the mean of n looks keeps (1 + (n - 1) value) / n of their gradient energy. 1: nothing was seen.
float detailCorrelation(const std::vector<DetailEnergy>& views);

}  // namespace fourdvt::bake
