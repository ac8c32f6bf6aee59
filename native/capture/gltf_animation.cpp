// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>

#include "base/text.h"
#include "capture/gltf.h"

namespace fourdvt::capture {
namespace {

constexpr double kRounding_s = 1e-4;  // tolerance of key times, which are stored as floats

enum class Interpolation { Step, Linear, CubicSpline };

std::string seconds(double s) { return printed("%.4g s", s); }

// One property of one node over time: `width` numbers per key.
class Channel {
 public:
  // Returns false if the keys are not finite and ascending, or have too few values.
  bool set(const GltfNumbers& times, const GltfNumbers& values, Interpolation interpolation, uint64_t components) {
    times_ = times, values_ = values, interpolation_ = interpolation, components_ = components;
    const uint64_t rows = times.count() * parts();
    if (values.count() % rows != 0) return false;
    elements_ = values.count() / rows;
    for (uint64_t k = 0; k < times.count(); ++k)
      if (!std::isfinite(time(k)) || (k > 0 && !(time(k) > time(k - 1)))) return false;
    return true;
  }
  uint64_t width() const { return elements_ * components_; }
  double begin() const { return time(0); }
  double end() const { return time(times_.count() - 1); }

  // Numbers at an instant. `turns`: they are a quaternion.
  std::vector<double> at(double t, bool turns) const {
    uint64_t low = 0, high = times_.count() - 1;
    if (t <= time(low)) return values(low, 0);
    if (t >= time(high)) return values(high, 0);
    while (high - low > 1) (time((low + high) / 2) <= t ? low : high) = (low + high) / 2;
    const double step = time(high) - time(low), share = (t - time(low)) / step;
    // Key times are stored as floats, instants are not: an instant slightly before a key takes the key's value.
    if (interpolation_ == Interpolation::Step) return values(time(high) - t < kRounding_s ? high : low, 0);
    const std::vector<double> from = values(low, 0), to = values(high, 0);
    if (interpolation_ == Interpolation::CubicSpline)
      return spline(from, values(low, 1), values(high, -1), to, share, step);
    if (turns) return slerp(from, to, share);
    std::vector<double> out(width());
    for (size_t i = 0; i < out.size(); ++i) out[i] = from[i] + share * (to[i] - from[i]);
    return out;
  }

 private:
  uint64_t parts() const { return interpolation_ == Interpolation::CubicSpline ? 3 : 1; }
  double time(uint64_t key) const { return times_.at(key, 0); }

  // `part` -1: the in-tangent of a key; 1: its out-tangent; 0: its value.
  std::vector<double> values(uint64_t key, int part) const {
    const uint64_t row = key * parts() + (parts() == 3 ? static_cast<uint64_t>(part + 1) : 0);
    std::vector<double> out;
    for (uint64_t e = 0; e < elements_; ++e)
      for (uint64_t c = 0; c < components_; ++c) out.push_back(values_.at(row * elements_ + e, static_cast<int>(c)));
    return out;
  }

  static std::vector<double> slerp(const std::vector<double>& a, const std::vector<double>& b, double share) {
    const glm::dquat turn = glm::slerp(glm::normalize(glm::dquat(a[3], a[0], a[1], a[2])),
                                       glm::normalize(glm::dquat(b[3], b[0], b[1], b[2])), share);
    return {turn.x, turn.y, turn.z, turn.w};
  }

  static std::vector<double> spline(const std::vector<double>& from, const std::vector<double>& leaving,
                                    const std::vector<double>& arriving, const std::vector<double>& to, double t,
                                    double step) {
    const double t2 = t * t, t3 = t2 * t;
    std::vector<double> out(from.size());
    for (size_t i = 0; i < out.size(); ++i) {
      out[i] = (2 * t3 - 3 * t2 + 1) * from[i] + step * (t3 - 2 * t2 + t) * leaving[i] + (3 * t2 - 2 * t3) * to[i] +
               step * (t3 - t2) * arriving[i];
    }
    return out;
  }

  GltfNumbers times_, values_;
  Interpolation interpolation_ = Interpolation::Linear;
  uint64_t components_ = 1, elements_ = 1;  // numbers per element of the values; elements per key
};

struct MovedProperty {
  const char *name, *type;
  uint64_t width;  // 0: any
};
constexpr MovedProperty kTranslation{"translation", "VEC3", 3}, kRotation{"rotation", "VEC4", 4},
    kScale{"scale", "VEC3", 3}, kWeights{"weights", "SCALAR", 0};
constexpr const MovedProperty* kProperties[] = {&kTranslation, &kRotation, &kScale, &kWeights};

struct Moved {
  size_t node = 0;
  const MovedProperty* property = nullptr;
  Channel channel;
};

void apply(const Moved& moved, double t, GltfPose& pose) {
  const std::vector<double> v = moved.channel.at(t, moved.property == &kRotation);
  if (moved.property == &kWeights) {
    pose.weights = v;
    return;
  }
  pose.matrix.reset();
  if (moved.property == &kTranslation) pose.translation = {v[0], v[1], v[2]};
  if (moved.property == &kScale) pose.scale = {v[0], v[1], v[2]};
  if (moved.property == &kRotation) pose.rotation = glm::normalize(glm::dquat(v[3], v[0], v[1], v[2]));
}

class PoseReader {
 public:
  PoseReader(GltfBytes& bytes, const MeshInstant& instant) : bytes_(bytes), instant_(instant) {}

  Result<std::vector<GltfPose>> read() {
    const Json& nodes = jsonMember(bytes_.root(), "nodes");
    for (size_t i = 0; nodes.is_array() && i < nodes.size(); ++i) {
      FOURDVT_ASSIGN(auto pose, restOf(nodes[i]));
      poses_.push_back(std::move(pose));
    }
    FOURDVT_ASSIGN(const Json* animation, chosen());
    std::vector<Moved> moved;
    if (animation) {
      FOURDVT_ASSIGN(moved, channelsOf(*animation));
    }
    double begin = std::numeric_limits<double>::infinity(), end = -begin;
    for (const Moved& m : moved) begin = std::min(begin, m.channel.begin()), end = std::max(end, m.channel.end());
    FOURDVT_TRY(checkLength(moved.empty() ? 0 : end - begin));
    for (const Moved& m : moved) apply(m, begin + instant_.time_s, poses_[m.node]);
    return std::move(poses_);
  }

 private:
  Result<GltfPose> restOf(const Json& node) const {
    GltfPose pose;
    const Json& matrix = jsonMember(node, "matrix");
    if (!matrix.is_null() && !jsonNumbers(matrix, 16, &pose.matrix.emplace()[0][0]))
      return bytes_.error("a node's matrix cannot be read");
    glm::dvec4 turn(0, 0, 0, 1);  // x, y, z, w
    const auto read = [&](const char* key, size_t count, double* out) {
      const Json& list = jsonMember(node, key);
      return list.is_null() || jsonNumbers(list, count, out);
    };
    if (!read("translation", 3, &pose.translation[0]) || !read("rotation", 4, &turn[0]) ||
        !read("scale", 3, &pose.scale[0]))
      return bytes_.error("a node's transform cannot be read");
    pose.rotation = {turn.w, turn.x, turn.y, turn.z};
    const Json& weights = jsonMember(node, "weights");
    if (weights.is_null()) return pose;
    pose.weights.emplace(weights.size());
    if (!jsonNumbers(weights, weights.size(), pose.weights->data()))
      return bytes_.error("a node's morph weights cannot be read");
    return pose;
  }

  // The selected animation; null without one.
  Result<const Json*> chosen() const {
    const Json& all = jsonMember(bytes_.root(), "animations");
    if (!all.is_array() || all.empty()) return static_cast<const Json*>(nullptr);
    if (all.size() == 1) return &all[0];
    std::string names;
    for (const Json& animation : all) {
      const std::string text = jsonText(jsonMember(animation, "name"));
      if (!text.empty() && text == instant_.take) return &animation;
      if (names.size() < 200) names += (names.empty() ? "\"" : ", \"") + text + "\"";
    }
    return bytes_.unsupported("has " + std::to_string(all.size()) + " animations (" + names + "), none called \"" +
                              instant_.take + "\"; export the take's alone, or give it that name");
  }

  Result<std::vector<Moved>> channelsOf(const Json& animation) {
    std::vector<Moved> out;
    for (const Json& channel : jsonMember(animation, "channels")) {
      const Json& target = jsonMember(channel, "target");
      const auto node = gltfNumber(target, "node");
      const Json& path = jsonMember(target, "path");
      const auto property = std::find_if(std::begin(kProperties), std::end(kProperties),
                                         [&](const MovedProperty* p) { return path == p->name; });
      if (!node || property == std::end(kProperties)) continue;  // belongs to an extension: moves no node
      if (*node >= poses_.size()) return bytes_.error("an animation moves a node that is missing (damaged)");
      out.push_back({*node, *property, {}});
      FOURDVT_TRY(read(gltfEntry(animation, "samplers", gltfNumber(channel, "sampler")), out.back()));
    }
    return out;
  }

  Status read(const Json& sampler, Moved& moved) {
    const MovedProperty& property = *moved.property;
    FOURDVT_ASSIGN(const auto times, bytes_.accessor(gltfNumber(sampler, "input"), "SCALAR", "its animation's times"));
    FOURDVT_ASSIGN(const auto values,
                   bytes_.accessor(gltfNumber(sampler, "output"), property.type, "its animation's values"));
    const Json& given = jsonMember(sampler, "interpolation");
    const Interpolation interpolation = given == "STEP"          ? Interpolation::Step
                                        : given == "CUBICSPLINE" ? Interpolation::CubicSpline
                                                                 : Interpolation::Linear;
    const uint64_t components = std::max<uint64_t>(1, property.width);
    if (!moved.channel.set(times, values, interpolation, components) ||
        (property.width > 0 && moved.channel.width() != property.width))
      return bytes_.error(std::string("its animation's keys of \"") + property.name +
                          "\" are out of order, or as many as its times are not there");
    return {};
  }

  // Error for a take longer than its animation, and for a file of one frame whose animation continues.
  Status checkLength(double length_s) const {
    const bool checked = instant_.frame_s > 0;
    if (checked && instant_.whole_take && instant_.time_s > length_s + instant_.frame_s / 2) {
      const std::string what =
          length_s > 0 ? "its animation lasts " + seconds(length_s) : "it has no animation that moves";
      return Error{
          ErrorId::VideoTooShort,
          bytes_.path() + ": " + what + ", but take \"" + instant_.take + "\" goes on to " + seconds(instant_.time_s) +
              "; export the whole animation or one mesh a frame, or correct \"frames\" or \"fps\" in capture.json"};
    }
    if (!checked || instant_.whole_take || length_s <= 1.5 * instant_.frame_s) return {};
    return bytes_.unsupported(
        "is the mesh of one frame, but its animation lasts " + seconds(length_s) +
        "; export every frame with its pose applied, or give one animated file as the \"mesh\" of "
        "the whole take");
  }

  GltfBytes& bytes_;
  const MeshInstant& instant_;
  std::vector<GltfPose> poses_;
};

}  // namespace

glm::dmat4 GltfPose::parentFromNode() const {
  if (matrix) return *matrix;
  return glm::scale(glm::translate(glm::dmat4(1), translation) * glm::mat4_cast(rotation), scale);
}

Result<std::vector<GltfPose>> gltfPoses(GltfBytes& bytes, const MeshInstant& instant) {
  return PoseReader(bytes, instant).read();
}

}  // namespace fourdvt::capture
