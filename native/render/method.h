// SPDX-License-Identifier: Apache-2.0
// A method textures a figure from camera pictures at run time ("cameras" instead of layers): it selects cameras,
// determines their visibility and gives every fragment a blend weight per camera. The recipe draws such a figure
// through the method set by Recipe::setMethod, and returns Unsupported without one. Implementations: render/cameras/.
#pragma once

#include <limits>
#include <span>
#include <string_view>

#include "base/camera.h"
#include "package/character.h"
#include "render/character_model.h"
#include "render/view.h"

namespace fourdvt::render {

// Default method of characters from cameras whose manifest names none; recommended by `fourdvt-lab methods`
// (algorithms/cameras.md).
inline constexpr std::string_view kDefaultMethod = "sweep";

// Rectangle of one camera's picture in a decoded picture.
struct CameraSource {
  glm::vec4 source{0};  // x, y, width, height of the region in the tile, pixels; width 0: no picture
  glm::vec4 tile{0};    // x, y, width, height in texture coordinates of the decoded picture
};

// Camera pictures of a figure; its surface is in the figure's model.
struct CameraLook {
  std::span<const PinholeCamera> cameras;  // all of the character's, in its frame
  std::span<const CameraSource> sources;   // one per camera
  const PictureTextures* picture = nullptr;
  glm::vec2 picture_size{1};  // texels
  uint64_t serial = 0;        // changes with picture and sources
};

// Visibility test of a surface point from a camera (LVDT 2 step 2, OVH03 5.2.2).
enum class Visibility {
  None,      // no test: every camera textures the surface that faces it
  Plain,     // depth maps of the unmodified mesh
  Offset,    // offset multi-draw
  Fattened,  // edges as wide lines, set back in depth, then the faces
};

// Colour of surface that no camera sees.
enum class Unseen {
  Transparent,
  BestFacing,     // the best-facing camera, occlusion ignored
  Neighbourhood,  // colours of the surface nearby; without any: BestFacing
};

struct FloatingOptions {
  float radius_px = 12;  // radius of the soft visibility (FT Eq. 8), 1 to 128
};

struct SweepOptions {
  int planes = 12;  // depths tested at each pixel; a multiple of 4, at most 32
  // Depth of the search behind the surface of a person (CharacterModel::length_scale), unless the character has its
  // own; the depth before the surface is smaller (sweep.h).
  float band_m = 0.032f;
};

struct MontageOptions {
  float exponent = 2;            // α of M4D Eq. 2
  float view_exponent = 8;       // α of M4D Eq. 4
  float discontinuity_px = 4;    // ε: reach of occlusions over depth discontinuities, at most 8
  float vote_threshold = 0.15f;  // δ of M4D Eq. 3; 0: no vote
  float vote_reach_px = 8;       // montage4d: distance to a depth discontinuity within which votes are held; at most 8
  float clamp_m = 0.15f;         // distance from a person's seams at which γ is 1
  float settling_s = 0.17f;      // time constant of the temporal fields; 0: no smoothing
};

struct MethodOptions {
  int closest = 4;  // M of N: cameras nearest in angle to the view (camerasTowards); 0: as many as the draw allows
  Visibility visibility = Visibility::Offset;
  Unseen unseen = Unseen::Neighbourhood;
  float min_cosine = 0.1f;  // cosine of surface normal and ray below which a camera is rejected
  // Uncertainty of the surface along a view ray, to either side: the blur width of "filtered" and "band-limited". About
  // the mean distance between a person's visual hull and the surface inside it.
  float depth_uncertainty_m = 0.01f;
  // Seconds since the figure's previous picture, for temporal fields; infinite: a still.
  float elapsed_s = std::numeric_limits<float>::infinity();
  FloatingOptions floating;
  SweepOptions sweep;
  MontageOptions montage;
};

class Method {
 public:
  virtual ~Method() = default;
  // Prepares programs and depth maps of the cameras in use before the main pass. Reuses results while geometry, picture
  // and chosen cameras are unchanged. number: the figure's index in the picture. Errors: GpuFailure, InvalidArgument.
  virtual Status prepare(gpu::Device& device, size_t number, const CharacterModel& model, const CameraLook& look,
                         const CharacterView& view, const MethodOptions& options) = 0;
  // Makes one draw inside the caller's pass, after prepare with the same arguments.
  virtual void draw(gpu::Device& device, size_t number, const CharacterModel& model, const CameraLook& look,
                    const CharacterView& view, const MethodOptions& options) const = 0;
};

}  // namespace fourdvt::render
