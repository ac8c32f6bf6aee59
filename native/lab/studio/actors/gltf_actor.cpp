// SPDX-License-Identifier: Apache-2.0
// Plays a glTF model: joint transforms of one animation or between several, linear blend skinning, root motion.
#include <algorithm>
#include <cmath>
#include <set>

#include "lab/studio/actors/gltf.h"

namespace fourdvt::studio {
namespace {

constexpr double kLoopShare =
    0.01;  // share of the model's size: an animation loops if its last pose is this close to its first
constexpr double kStill_m = 0.01;  // less travel per cycle counts as none

class GltfActor final : public Actor {
 public:
  explicit GltfActor(GltfModel model) : model_(std::move(model)), world_(model_.nodes.size()) {
    rest_.topology = model_.topology;
    std::vector<NodeTransform> transforms;
    for (const GltfNode& node : model_.nodes) transforms.push_back(node.rest);
    skin(transforms, glm::dvec3(0), rest_.positions);
  }

  Status choose(const std::string& path, const std::vector<std::string>& names) {
    std::string known;
    for (GltfAnimation& animation : model_.animations) {
      animation.name = folderName(animation.name);
      known += (known.empty() ? "" : ", ") + animation.name;
    }
    for (size_t i = 0; names.empty() && i < model_.animations.size(); ++i) FOURDVT_TRY(add(path, i));
    for (const std::string& name : names) {
      const auto it = std::find_if(model_.animations.begin(), model_.animations.end(),
                                   [&](const GltfAnimation& a) { return a.name == name; });
      if (it == model_.animations.end())
        return Error{ErrorId::InvalidArgument, path + ": has no animation \"" + name + "\"; choose among: " + known};
      FOURDVT_TRY(add(path, size_t(it - model_.animations.begin())));
    }
    return {};
  }

  const std::vector<Motion>& motions() const override { return motions_; }
  const RestMesh& surface() const override { return rest_; }
  const RestMesh& tracked() const override { return rest_; }
  const Image& texture() const override { return model_.texture; }

  void pose(std::span<const double> shares, double phase, Positions& out) override {
    std::vector<NodeTransform> transforms;
    glm::dvec3 travelled(0);
    double total = 0;
    for (size_t m = 0; m < shares.size(); ++m) {
      if (shares[m] == 0) continue;
      total += shares[m];
      blend(transformsAt(played_[m], phase), shares[m] / total, transforms);
      travelled += shares[m] * motions_[m].duration_s * motions_[m].root_velocity_mps;
    }
    skin(transforms, phase * travelled, out);
  }

 private:
  // "Armature|walk" → "walk"; characters invalid in a folder's name become "_".
  static std::string folderName(const std::string& name) {
    std::string out = name.substr(name.find_last_of('|') + 1);
    for (char& c : out)
      if (c == '/' || c == '\\' || static_cast<unsigned char>(c) < 32) c = '_';
    if (!out.empty() && out[0] == '.') out[0] = '_';
    return out;
  }

  Status add(const std::string& path, size_t animation) {
    static const std::set<std::string> kTaken{"cameras", "cameras_true", "cameras_test", "background", "truth"};
    const GltfAnimation& source = model_.animations[animation];
    for (const Motion& motion : motions_)
      if (motion.name == source.name)
        return Error{ErrorId::Unsupported, path + ": two animations are called \"" + source.name + "\"; rename one"};
    if (source.name.empty() || kTaken.count(source.name))
      return Error{ErrorId::Unsupported, path + ": an animation is called \"" + source.name + "\"; give it a name"};
    played_.push_back(animation);
    motions_.push_back(measured(source.name, animation));
    return {};
  }

  Motion measured(const std::string& name, size_t animation) {
    const GltfAnimation& source = model_.animations[animation];
    Motion motion{name, source.end_s - source.start_s};
    Positions first, last;
    skin(transformsAt(animation, 0), glm::dvec3(0), first);
    skin(transformsAt(animation, 1), glm::dvec3(0), last);
    glm::dvec3 travel(0), low(first[0]), high(first[0]);
    for (size_t v = 0; v < first.size(); ++v) {
      travel += glm::dvec3(last[v] - first[v]) / double(first.size());
      low = glm::min(low, glm::dvec3(first[v]));
      high = glm::max(high, glm::dvec3(first[v]));
    }
    travel.y = 0;
    double difference = 0;
    for (size_t v = 0; v < first.size(); ++v)
      difference = std::max(difference, glm::length(glm::dvec3(last[v] - first[v]) - travel));
    motion.loop = difference <= kLoopShare * glm::length(high - low);
    if (motion.loop && glm::length(travel) > kStill_m) motion.root_velocity_mps = travel / motion.duration_s;
    return motion;
  }

  std::vector<NodeTransform> transformsAt(size_t animation, double phase) const {
    const GltfAnimation& source = model_.animations[animation];
    const double time_s = glm::mix(source.start_s, source.end_s, phase);
    std::vector<NodeTransform> out;
    for (const GltfNode& node : model_.nodes) out.push_back(node.rest);
    for (const GltfChannel& channel : source.channels) {
      const glm::dvec4 value = channel.at(time_s);
      NodeTransform& node = out[channel.node];
      if (channel.path == GltfChannel::Path::Translation) node.translation = glm::dvec3(value);
      if (channel.path == GltfChannel::Path::Scale) node.scale = glm::dvec3(value);
      if (channel.path == GltfChannel::Path::Rotation)
        node.rotation = glm::normalize(glm::dquat(value.w, value.x, value.y, value.z));
    }
    return out;
  }

  // Adds share * (from - into) to `into`, rotations along the shorter arc; the first call copies `from`.
  static void blend(std::vector<NodeTransform> from, double share, std::vector<NodeTransform>& into) {
    if (into.empty()) {
      into = std::move(from);
      return;
    }
    for (size_t i = 0; i < into.size(); ++i) {
      into[i].translation = glm::mix(into[i].translation, from[i].translation, share);
      into[i].scale = glm::mix(into[i].scale, from[i].scale, share);
      into[i].rotation = glm::slerp(into[i].rotation, from[i].rotation, share);
    }
  }

  void skin(const std::vector<NodeTransform>& transforms, const glm::dvec3& travelled, Positions& out) {
    for (const int node : model_.node_order) {
      const NodeTransform& t = transforms[node];
      glm::dmat4 local = glm::mat4_cast(t.rotation);
      for (int k = 0; k < 3; ++k) local[k] *= t.scale[k];
      local[3] = glm::dvec4(t.translation, 1);
      const int parent = model_.nodes[node].parent;
      world_[node] = parent >= 0 ? world_[parent] * local : local;
    }
    std::vector<glm::mat4> joints;
    for (const GltfJoint& joint : model_.joints) joints.emplace_back(world_[joint.node] * joint.bind);
    out.resize(model_.vertices.size());
    for (size_t v = 0; v < out.size(); ++v) {
      const GltfVertex& vertex = model_.vertices[v];
      glm::vec4 sum(0);
      for (int k = 0; k < 4; ++k)
        if (vertex.weights[k] > 0)
          sum += vertex.weights[k] * (joints[vertex.joints[k]] * glm::vec4(vertex.position, 1));
      out[v] = glm::vec3(sum) - glm::vec3(travelled);
    }
  }

  GltfModel model_;
  RestMesh rest_;
  std::vector<size_t> played_;  // [motion] animation
  std::vector<Motion> motions_;
  std::vector<glm::dmat4> world_;  // [node], last pose
};

}  // namespace

Result<std::unique_ptr<Actor>> openGltfActor(const std::string& path, const std::vector<std::string>& motions) {
  FOURDVT_ASSIGN(auto model, readGltf(path));
  auto actor = std::make_unique<GltfActor>(std::move(model));
  FOURDVT_TRY(actor->choose(path, motions));
  return std::unique_ptr<Actor>(std::move(actor));
}

}  // namespace fourdvt::studio
