// SPDX-License-Identifier: Apache-2.0
// Checks that all objects created on a device have been released.
#pragma once

#include <gtest/gtest.h>

#include "gpu/device.h"

namespace fourdvt::testing {

inline void expectNothingLives(gpu::Device& device) {
  const gpu::Counters& counters = device.counters();
  EXPECT_EQ(counters.live_textures, 0u);
  EXPECT_EQ(counters.live_texture_bytes, 0u);
  EXPECT_EQ(counters.live_targets, 0u);
  EXPECT_EQ(counters.live_target_bytes, 0u);
  EXPECT_EQ(counters.live_index_buffers, 0u);
  EXPECT_EQ(counters.live_programs, 0u);
  EXPECT_EQ(device.takeErrors(), "");
}

}  // namespace fourdvt::testing
