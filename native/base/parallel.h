// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/utility.hpp>

namespace fourdvt {

// Calls work(0) … work(count - 1) on OpenCV's threads.
template <class Work>
void inParallel(size_t count, const Work& work) {
  cv::parallel_for_(cv::Range(0, int(count)), [&](const cv::Range& range) {
    for (int i = range.start; i < range.end; ++i) work(i);
  });
}

}  // namespace fourdvt
