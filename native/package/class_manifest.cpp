// SPDX-License-Identifier: Apache-2.0
#include "package/class_manifest.h"

#include <algorithm>
#include <cmath>

namespace fourdvt::package {
namespace {

constexpr int kMaxSamples = 4096, kMaxSimplices = 8192;
constexpr double kMaxDuration_s = 1e6, kMaxParameter = 1e6, kMaxCoefficient = 1000;
constexpr double kWeightSlack = 1e-3;  // of single weights and of their sum

std::vector<float> readFactors(FieldReader& in, const std::string& at, size_t count, double low, double high) {
  const std::vector<double> numbers = in.numbers(at, count, low, high);
  return {numbers.begin(), numbers.end()};
}

ParameterSample readSample(FieldReader& in, const std::string& at, const Sequence& s) {
  ParameterSample sample;
  sample.at = in.numbers(at, "/at", s.space.names.size(), -kMaxParameter, kMaxParameter);
  sample.weights = readFactors(in, at + "/weights", s.members.size(), -kWeightSlack, 1 + kWeightSlack);
  sample.offsets = readFactors(in, at + "/offsets", s.reference_count, -kMaxCoefficient, kMaxCoefficient);
  double sum = 0;
  for (float weight : sample.weights) sum += weight;
  if (in.ok() && !(std::abs(sum - 1) <= kWeightSlack)) in.fail(at, "/weights", "must add up to 1");
  for (float& weight : sample.weights) weight = std::clamp(weight, 0.0f, 1.0f);  // the renderer refuses negative ones
  return sample;
}

// Length of an interval, or twice the area of a triangle. A look-up divides by it.
double extent(const ParameterSpace& space, const std::array<uint16_t, 3>& simplex) {
  const auto &a = space.samples[simplex[0]].at, &b = space.samples[simplex[1]].at, &c = space.samples[simplex[2]].at;
  if (a.size() == 1) return b[0] - a[0];
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

void readSimplex(FieldReader& in, const std::string& at, ParameterSpace& space) {
  std::array<uint16_t, 3> simplex{};
  for (int i = 0; i < 3; ++i)
    simplex[size_t(i)] = uint16_t(in.integer(item(at, i), 0, double(space.samples.size()) - 1));
  if (!in.ok()) return;
  if (space.names.size() == 1 && simplex[1] != simplex[2]) in.fail(at, "must repeat its second index");
  if (!(std::abs(extent(space, simplex)) > 1e-9)) in.fail(at, "has no extent");
  space.simplices.push_back(simplex);
}

void readSpace(FieldReader& in, const std::string& at, Sequence& s) {
  const int samples = in.arraySize(at, "/samples", 2, kMaxSamples);
  for (int i = 0; i < samples && in.ok(); ++i) s.space.samples.push_back(readSample(in, item(at + "/samples", i), s));
  const int simplices = in.arraySize(at, "/simplices", 1, kMaxSimplices);
  for (int i = 0; i < simplices && in.ok(); ++i) readSimplex(in, item(at + "/simplices", i), s.space);
}

Member readMember(FieldReader& in, const std::string& at, size_t parameters) {
  Member member;
  member.name = in.text(at, "/name", 128);
  member.parameter = in.numbers(at, "/parameter", parameters, -kMaxParameter, kMaxParameter);
  member.duration_s = in.number(at, "/duration", 1e-3, kMaxDuration_s);
  member.travel = in.vec3(at, "/travel");
  return member;
}

std::vector<std::string> readParameterNames(FieldReader& in, const std::string& at) {
  std::vector<std::string> names;
  const int count = in.arraySize(at, 1, kMaxParameters);
  for (int i = 0; i < count; ++i) names.push_back(in.text(item(at, i), 128));
  if (names.size() == 2 && names[0] == names[1]) in.fail(at, "names a parameter twice");
  return names;
}

Member itself(const Sequence& s) {
  const double duration_s = s.duration_s();
  return {s.name, {}, duration_s, glm::dvec3(s.root_velocity_mps.x, s.root_velocity_mps.z, 0) * duration_s};
}

}  // namespace

void readMembers(FieldReader& in, const std::string& at, Sequence& s) {
  if (!in.ok()) return;
  const int members = in.arraySize(at, "/members", 0, kMaxMembers);
  if (members > 1) s.space.names = readParameterNames(in, at + "/parameterSpace/names");
  for (int m = 0; m < members && in.ok(); ++m) {
    const std::string here = item(at + "/members", m);
    s.members.push_back(readMember(in, here, s.space.names.size()));
    for (int other = 0; other < m; ++other) {
      if (s.members[size_t(other)].name == s.members.back().name) in.fail(here, "/name", "appears twice");
    }
  }
  if (members == 0) s.members.push_back(itself(s));
  if (members <= 1) return;
  s.reference_count = uint32_t(in.integer(at, "/referenceCount", 0, kMaxReferences));
  if (in.has(at, "/detailCorrelation")) s.detail_correlation = float(in.number(at, "/detailCorrelation", 0, 1));
  readSpace(in, at + "/parameterSpace", s);
}

}  // namespace fourdvt::package
