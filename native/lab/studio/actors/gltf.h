// SPDX-License-Identifier: Apache-2.0
// Rigged glTF model as plain data: one welded mesh in skeleton space, one texture, nodes, animations. Private to the
// studio. Morph targets, cameras, lights and further sets of four weights per vertex are ignored.
#pragma once

#include <array>
#include <glm/gtc/quaternion.hpp>

#include "lab/studio/actors/actor.h"

namespace fourdvt::studio {

struct NodeTransform {
  glm::dvec3 translation{0}, scale{1};
  glm::dquat rotation{1, 0, 0, 0};
};

struct GltfNode {
  int parent = -1;
  NodeTransform rest;
};

struct GltfChannel {
  enum class Path { Translation, Rotation, Scale };
  enum class Between { Linear, Step, Cubic };
  int node = 0;
  Path path = Path::Translation;
  Between between = Between::Linear;
  std::vector<double> times;           // seconds, increasing
  std::vector<glm::dvec4> values;      // one per time; Cubic: three per time (in-tangent, value, out-tangent)
  glm::dvec4 at(double time_s) const;  // rotations are not normalised
};

struct GltfAnimation {
  std::string name;
  double start_s = 0, end_s = 0;
  std::vector<GltfChannel> channels;
};

// Joint of the skeleton; a vertex refers to up to four.
struct GltfJoint {
  int node = 0;
  glm::dmat4 bind{1};  // joint from mesh
};

struct GltfVertex {
  glm::vec3 position{0};  // mesh space
  std::array<uint16_t, 4> joints{};
  std::array<float, 4> weights{1, 0, 0, 0};
};

struct GltfModel {
  MeshTopology topology;
  std::vector<GltfVertex> vertices;
  Image texture;  // RGB
  std::vector<GltfNode> nodes;
  std::vector<int> node_order;  // parents first
  std::vector<GltfJoint> joints;
  std::vector<GltfAnimation> animations;
};

// Errors: see openGltfActor.
Result<GltfModel> readGltf(const std::string& path);

}  // namespace fourdvt::studio
