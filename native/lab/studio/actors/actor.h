// SPDX-License-Identifier: Apache-2.0
// Actor of the virtual studio: a moving textured surface, and the mesh that a capture system would track on it. The
// surface is the truth; the tracked mesh may be coarser and slide over it. Call pose() from one thread only.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/image.h"
#include "base/mesh.h"
#include "base/result.h"

namespace fourdvt::studio {

struct Motion {
  std::string name;
  double duration_s = 1;
  bool loop = false;
  glm::dvec3 root_velocity_mps{0};  // subtracted from the poses
  bool is_gait = false;             // the built-in actor's: blends with other gaits only
};

// Mesh in the actor's rest pose.
struct RestMesh {
  MeshTopology topology;
  Positions positions;
};

class Actor {
 public:
  virtual ~Actor() = default;
  virtual const std::vector<Motion>& motions() const = 0;
  virtual const RestMesh& surface() const = 0;  // drawn surface; its UVs lie in texture()
  virtual const RestMesh& tracked() const = 0;  // captured mesh
  virtual const Image& texture() const = 0;     // RGB, sRGB
  // Sets `out` to the surface's vertices at phase 0…1 (elapsed share of a motion's duration) of the motion with these
  // `shares` of all motions (sum 1). Between motions this is the exact intermediate motion, not a blend of vertices.
  virtual void pose(std::span<const double> shares, double phase, Positions& out) = 0;
};

// The built-in actor: a smooth closed body with the gaits "walk", "jog" and "run", which are one motion with a
// parameter (0, 0.5, 1): every joint curve, stance, cadence and speed is a function of it. Feet on the ground do not
// slide against the root velocity. Further motions, which do not blend: "stand", a loop of 2 s with breathing and a
// sway of some millimetres, and "raise", which in 2 s raises the arms sideways from hanging down. `mesh_cell_m`: size
// of the tracked mesh's faces; 0.025 makes about 4000 vertices. `motions`: names among those five. `plain_clothes`:
// shirt, trousers and shoes of one colour each. Errors: InvalidArgument.
Result<std::unique_ptr<Actor>> createProceduralActor(const std::vector<std::string>& motions, double mesh_cell_m,
                                                     bool plain_clothes = false);

// Opens a rigged, textured glTF or GLB: its skinned meshes welded to one, its animations by name. Between animations:
// joint by joint (slerp). Travel of a cyclic animation becomes root velocity. Morph targets are ignored. `motions`
// empty: all animations. Errors: FileMissing, FileUnreadable, Unsupported (no rig, no animation, unknown kind of data),
// MeshNoUvs, MeshUvRange, InvalidArgument (no animation of a name).
Result<std::unique_ptr<Actor>> openGltfActor(const std::string& path, const std::vector<std::string>& motions);

// Actor whose gaits are clips with an end, of that many strides. `travel`: they lead by the root velocity through the
// place at which the given actor walks, which is reached at half of the clip.
std::unique_ptr<Actor> withStrides(std::unique_ptr<Actor> actor, double strides, bool travel);

}  // namespace fourdvt::studio
