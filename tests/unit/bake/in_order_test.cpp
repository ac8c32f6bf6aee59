// SPDX-License-Identifier: Apache-2.0
#include "bake/align/in_order.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

namespace fourdvt::bake {
namespace {

TEST(InOrder, ResultsComeAsGivenHoweverLongTheyTake) {
  for (const int at_once : {1, 2, 5}) {
    InOrder<int> tasks(at_once);
    for (int i = 0; i < 12; ++i)
      tasks.add([i] {
        std::this_thread::sleep_for(std::chrono::milliseconds(i % 3 ? 0 : 4));
        return i;
      });
    const std::vector<int> results = tasks.take();
    ASSERT_EQ(results.size(), 12u);
    for (int i = 0; i < 12; ++i) EXPECT_EQ(results[i], i) << at_once;
    EXPECT_TRUE(tasks.take().empty());
  }
}

TEST(InOrder, NoMoreAtWorkThanAllowed) {
  for (const int at_once : {1, 3}) {
    std::atomic<int> working{0}, largest{0};
    InOrder<int> tasks(at_once);
    for (int i = 0; i < 12; ++i)
      tasks.add([&] {
        const int now = ++working;
        if (now > largest) largest = now;
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
        return --working;
      });
    tasks.take();
    EXPECT_LE(largest, at_once);
  }
}

TEST(InOrder, OneAtATimeStaysOnTheCallingThread) {
  InOrder<std::thread::id> tasks(1);
  for (int i = 0; i < 3; ++i) tasks.add([] { return std::this_thread::get_id(); });
  for (const std::thread::id id : tasks.take()) EXPECT_EQ(id, std::this_thread::get_id());
}

}  // namespace
}  // namespace fourdvt::bake
