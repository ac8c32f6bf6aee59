// SPDX-License-Identifier: Apache-2.0
// Deformation of a template by a graph of nodes on its surface, and fits of it to quadratic data terms. Source:
// Sumner, Schmid, Pauly: Embedded Deformation for Shape Manipulation. ACM Transactions on Graphics 26(3), 2007.
// Influences and links follow the template's surface, so that parts in contact move independently.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "base/mesh.h"

namespace fourdvt::track {

struct DeformationGraph {
  static constexpr int kInfluences = 4;
  struct Influence {
    uint32_t node = 0;
    double weight = 0;
  };
  struct Link {
    uint32_t from = 0, to = 0;
  };
  std::vector<uint32_t> nodes;                                 // vertices of the template
  std::vector<std::array<Influence, kInfluences>> influences;  // [vertex] weights sum to 1
  std::vector<Link> links;                                     // both directions
};

// Places `node_count` nodes by farthest points along edges, the first at vertex 0's farthest.
DeformationGraph makeGraph(std::span<const glm::uvec3> faces, std::span<const glm::vec3> positions,
                           uint32_t node_count);

// Pose of a graph: node j at g maps x to rotation (x − g) + g + shift.
struct GraphPose {
  std::vector<glm::dmat3> rotations;
  std::vector<glm::dvec3> shifts;  // metres
  static GraphPose identity(size_t nodes);
};

// Positions of `rest`, the template with offsets; nodes stand at `node_positions`.
Positions deformed(const DeformationGraph& graph, std::span<const glm::vec3> node_positions,
                   std::span<const glm::vec3> rest, const GraphPose& pose);
// Blended rotation of each vertex, orthonormal.
std::vector<glm::dmat3> vertexRotations(const DeformationGraph& graph, const GraphPose& pose);

// Data term of one vertex: ½ d·matrix·d − vector·d for its displacement d from the present position, metres.
struct Pull {
  glm::dmat3 matrix{0.0};
  glm::dvec3 vector{0.0};
  // Adds weight/2 (direction·d − residual)².
  void add(const glm::dvec3& direction, double residual, double weight);
};

struct GraphWeights {
  double rigidity = 1;  // weight of a link, relative to one data row of weight 1 per metre²
  double damping = 1e-3;
};

// One Gauss-Newton step of the pose on data and rigidity. Returns the largest shift of a node, metres.
double fitGraph(const DeformationGraph& graph, std::span<const glm::vec3> node_positions,
                std::span<const glm::vec3> rest, std::span<const Pull> pulls, const GraphWeights& weights,
                GraphPose& pose);

struct VertexWeights {
  double stiffness = 1;  // weight of differences along an edge
  double keep = 0;       // weight of the displacement itself
};

// [vertex] displacements that minimise the data terms, smooth along edges.
std::vector<glm::dvec3> fitVertices(std::span<const glm::uvec2> edges, std::span<const Pull> pulls,
                                    const VertexWeights& weights);

// Edges of a mesh, each once.
std::vector<glm::uvec2> edgesOf(std::span<const glm::uvec3> faces);

}  // namespace fourdvt::track
