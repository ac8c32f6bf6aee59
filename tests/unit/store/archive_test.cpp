// SPDX-License-Identifier: Apache-2.0
#include "store/archive.h"

#include <gtest/gtest.h>

namespace fourdvt::store {
namespace {

struct Part {
  std::string name;
  std::vector<int> numbers;
};
struct Whole {
  double value = 0;
  std::vector<Part> parts;
  std::map<std::string, uint64_t> hashes;
  std::optional<double> length;
  std::optional<Part> spare;
  std::shared_ptr<const Part> shared;
  PinholeCamera camera;
};
void fields(Archive& a, Part& p) { a(p.name, p.numbers); }
void fields(Archive& a, Whole& w) { a(w.value, w.parts, w.hashes, w.length, w.spare, w.shared, w.camera); }

Whole filled() {
  Whole out;
  out.value = 0.5;
  out.parts = {{"walk", {1, 2, 3}}, {"", {}}};
  out.hashes = {{"run", 7}, {"walk", 1ull << 40}};
  out.spare = Part{"spare", {-1}};
  out.shared = std::make_shared<const Part>(Part{"shared", {4}});
  out.camera.name = "cam00", out.camera.fx = 600;
  return out;
}

TEST(Archive, ReadsBackAllKindsOfFields) {
  const Whole in = filled();
  Whole out;
  out.length = 2, out.hashes = {{"gone", 1}};
  ASSERT_TRUE(readBytes(bytesOf(in), out));
  EXPECT_EQ(out.value, 0.5);
  ASSERT_EQ(out.parts.size(), 2u);
  EXPECT_EQ(out.parts[0].name, "walk");
  EXPECT_EQ(out.parts[0].numbers, in.parts[0].numbers);
  EXPECT_EQ(out.hashes, in.hashes);
  EXPECT_FALSE(out.length.has_value());
  EXPECT_EQ(out.spare->name, "spare");
  EXPECT_EQ(out.shared->numbers, in.shared->numbers);
  EXPECT_EQ(out.camera.fx, 600);
  EXPECT_EQ(bytesOf(out), bytesOf(in));
}

TEST(Archive, RefusesOtherLengths) {
  auto bytes = bytesOf(filled());
  for (size_t n = 0; n < bytes.size(); ++n) {
    Whole out;
    EXPECT_FALSE(readBytes(std::span(bytes).first(n), out)) << n;
  }
  bytes.push_back(0);
  Whole out;
  EXPECT_FALSE(readBytes(bytes, out));
}

TEST(Archive, BelievesNoCountThatDoesNotFit) {
  std::vector<uint8_t> bytes(64, 0xff);
  std::vector<double> numbers;
  std::vector<Part> parts;
  EXPECT_FALSE(readBytes(bytes, numbers));
  EXPECT_FALSE(readBytes(bytes, parts));
  EXPECT_TRUE(numbers.empty() && parts.empty());
}

}  // namespace
}  // namespace fourdvt::store
