// SPDX-License-Identifier: Apache-2.0
#include "capture/gltf.h"

namespace fourdvt::capture {

Result<GltfShape> GltfShape::open(GltfBytes& bytes, const Json& primitive, std::span<const double> weights,
                                  bool skinned) {
  GltfShape shape;
  const Json& attributes = jsonMember(primitive, "attributes");
  FOURDVT_ASSIGN(shape.positions_, bytes.accessor(gltfNumber(attributes, "POSITION"), "VEC3", "its positions"));
  size_t target_index = 0;
  for (const Json& target : jsonMember(primitive, "targets")) {
    const double weight = target_index < weights.size() ? weights[target_index] : 0;
    ++target_index;
    if (jsonMember(target, "POSITION").is_null()) continue;  // moves normals alone
    FOURDVT_ASSIGN(const auto offsets, bytes.accessor(gltfNumber(target, "POSITION"), "VEC3", "its morph targets"));
    if (offsets.count() != shape.count()) return bytes.error("a morph target is not as long as its mesh");
    shape.targets_.push_back({offsets, weight});
  }
  for (size_t set = 0; skinned; ++set) {
    const std::string number = std::to_string(set), joints_key = "JOINTS_" + number, weights_key = "WEIGHTS_" + number;
    const auto joints = gltfNumber(attributes, joints_key.c_str()), of = gltfNumber(attributes, weights_key.c_str());
    if (!joints || !of) break;
    Joints four;
    FOURDVT_ASSIGN(four.joints, bytes.accessor(joints, "VEC4", "its joints"));
    FOURDVT_ASSIGN(four.weights, bytes.accessor(of, "VEC4", "its joints' weights"));
    if (four.joints.count() != shape.count() || four.weights.count() != shape.count())
      return bytes.error("its joints are not as many as its vertices");
    shape.joints_.push_back(four);
  }
  if (skinned && shape.joints_.empty())
    return bytes.unsupported("has a skin, but a mesh without JOINTS_0 and WEIGHTS_0; export the skin's weights");
  return shape;
}

glm::dvec3 GltfShape::morphed(uint64_t i) const {
  glm::dvec3 out = rest(i);
  for (const Target& target : targets_)
    if (target.weight != 0) out += target.weight * vectorAt(target.offsets, i);
  return out;
}

bool GltfShape::skinned(uint64_t i, std::span<const glm::dmat4> world_from_rest, glm::dvec3& out) const {
  glm::dmat4 mean(0);
  double sum = 0;
  for (const Joints& four : joints_) {
    for (int c = 0; c < 4; ++c) {
      const double weight = four.weights.at(i, c), joint = four.joints.at(i, c);
      if (!(weight > 0)) continue;
      if (!(joint >= 0 && joint < static_cast<double>(world_from_rest.size()))) return false;
      mean += weight * world_from_rest[static_cast<size_t>(joint)];
      sum += weight;
    }
  }
  if (!(sum > 0)) mean = world_from_rest[0], sum = 1;  // follows the first joint, as in other readers
  out = glm::dvec3(mean * glm::dvec4(morphed(i), 1)) / sum;
  return true;
}

bool GltfShape::isSame(uint64_t i, const GltfShape& other, uint64_t j) const {
  if (rest(i) != other.rest(j) || targets_.size() != other.targets_.size() || joints_.size() != other.joints_.size())
    return false;
  for (size_t t = 0; t < targets_.size(); ++t)
    if (vectorAt(targets_[t].offsets, i) != vectorAt(other.targets_[t].offsets, j)) return false;
  for (size_t s = 0; s < joints_.size(); ++s) {
    for (int c = 0; c < 4; ++c) {
      if (joints_[s].joints.at(i, c) != other.joints_[s].joints.at(j, c) ||
          joints_[s].weights.at(i, c) != other.joints_[s].weights.at(j, c))
        return false;
    }
  }
  return true;
}

}  // namespace fourdvt::capture
