// SPDX-License-Identifier: Apache-2.0
// A method textures a figure from camera pictures at run time ("cameras" instead of layers): it chooses the cameras,
// finds out what they see, and gives every fragment a weight per camera. The recipe draws such a figure through the
// method that it was given (Recipe::setMethod); without one it refuses. Implementations: render/cameras/.
#pragma once

#include <limits>
#include <span>
#include <string_view>

#include "base/camera.h"
#include "package/character.h"
#include "render/character_model.h"
#include "render/view.h"

namespace fourdvt::render {

// The name of the method of a character from cameras whose manifest names none: what `fourdvt-lab methods` says to
// take (algorithms/cameras.md).
inline constexpr std::string_view kDefaultMethod = "sweep";

// Where one camera's picture lies in a decoded one.
struct CameraSource {
  glm::vec4 source{0};  // x, y, width, height of the region that the tile shows, pixels; width 0: there is none
  glm::vec4 tile{0};    // x, y, width, height in texture coordinates of the decoded picture
};

// What a figure from cameras shows; the figure's model holds its surface.
struct CameraLook {
  std::span<const PinholeCamera> cameras;  // in the character's frame; all of the character's
  std::span<const CameraSource> sources;   // one per camera
  const PictureTextures* picture = nullptr;
  glm::vec2 picture_size{1};  // texels
  uint64_t serial = 0;        // changes with picture and sources
};

// How a camera's view of a point is tested (LVDT 2 step 2, OVH03 5.2.2).
enum class Visibility {
  None,      // every camera textures what faces it
  Plain,     // depth maps of the mesh as it is
  Offset,    // offset multi-draw
  Fattened,  // edges as wide lines that lie further back, and then the faces
};

// What no camera sees.
enum class Unseen {
  Transparent,
  BestFacing,     // takes the camera that faces it best in spite of occlusion
  Neighbourhood,  // takes the colours round it on the surface; where there are none: BestFacing
};

struct FloatingOptions {
  float radius_px = 12;  // of the soft visibility (FT Eq. 8), 1 to 128
};

struct SweepOptions {
  int planes = 12;  // depths tried at each pixel; a multiple of 4, at most 32
  // Behind the surface of a person (CharacterModel::length_scale), unless the character has its own; before it less
  // (sweep.h).
  float band_m = 0.032f;
};

struct MontageOptions {
  float exponent = 2;            // α of M4D Eq. 2
  float view_exponent = 8;       // α of M4D Eq. 4
  float discontinuity_px = 4;    // ε: how far occlusions reach over depth discontinuities, at most 8
  float vote_threshold = 0.15f;  // δ of M4D Eq. 3; 0: there is no vote
  float vote_reach_px = 8;       // montage4d holds votes so near to depth discontinuities only; at most 8
  float clamp_m = 0.15f;         // distance from a person's seams at which γ is 1
  float settling_s = 0.17f;      // time constant of the temporal fields; 0: none
};

struct MethodOptions {
  int closest = 4;  // M of N: cameras that look most as the view does (camerasTowards); 0: as many as can be
  Visibility visibility = Visibility::Offset;
  Unseen unseen = Unseen::Neighbourhood;
  float least_cosine = 0.1f;  // of surface and ray; cameras that see a point more from aside are not used
  // Of the surface along a view's ray, to either side: what "filtered" and "band-limited" blur for. About the mean
  // distance between a visual hull and the surface inside it, of a person.
  float depth_uncertainty_m = 0.01f;
  // Seconds from the figure's last picture to this one, for what follows with time; infinite: a still.
  float elapsed_s = std::numeric_limits<float>::infinity();
  FloatingOptions floating;
  SweepOptions sweep;
  MontageOptions montage;
};

class Method {
 public:
  virtual ~Method() = default;
  // Everything that goes before the main pass: programs, depth maps of the cameras in use. What neither geometry,
  // picture nor choice of cameras has changed is kept. `number`: of the figure in the picture. Errors: GpuFailure,
  // InvalidArgument.
  virtual Status prepare(gpu::Device& device, size_t number, const CharacterModel& model, const CameraLook& look,
                         const CharacterView& view, const MethodOptions& options) = 0;
  // One draw inside the caller's pass, after prepare with the same arguments.
  virtual void draw(gpu::Device& device, size_t number, const CharacterModel& model, const CameraLook& look,
                    const CharacterView& view, const MethodOptions& options) const = 0;
};

}  // namespace fourdvt::render
