// SPDX-License-Identifier: Apache-2.0
// Refines the surface along every view ray within a band about the given surface: a plane sweep over the chosen
// cameras, semi-global matching on short paths, then the cameras' blend at the points found. Outlines are unchanged:
// rays that miss the given surface show nothing. Requires no float targets.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "render/cameras/figure_cameras.h"
#include "render/cameras/surface_picture.h"
#include "render/method.h"

namespace fourdvt::render {

class Sweep final : public Method {
 public:
  // Maximum depth of the band before the surface: the performer lies behind hulls and outset meshes.
  static constexpr float kBefore_m = 0.004f;
  static constexpr int kMaxPlanes = 32, kPlanesPerBlock = 4;

  // Errors: as Method, and InvalidArgument for unsupported planes or band (SweepOptions).
  Status prepare(gpu::Device& device, size_t number, const CharacterModel& model, const CameraLook& look,
                 const CharacterView& view, const MethodOptions& options) override;
  void draw(gpu::Device& device, size_t number, const CharacterModel& model, const CameraLook& look,
            const CharacterView& view, const MethodOptions& options) const override;

  // Returns the shift of each ray's point behind the surface, metres, after prepare, for inspection; NaN: no surface.
  // Rows from the top, at half the view's size. Errors: those of readPixels.
  Result<std::vector<float>> readShifts(gpu::Device& device, size_t number) const;

 private:
  // Cache key of the shifts.
  struct Cause {
    uint64_t geometry = 0, picture = 0;
    glm::mat4 clip_from_character{0};
    int width = 0, height = 0, planes = 0;
    float band_m = 0, min_cosine = 0;
    Visibility visibility = Visibility::None;
    std::vector<size_t> cameras;
    bool operator==(const Cause&) const = default;
  };
  struct SweptFigure {
    FigureCameras cameras;
    gpu::Texture depths;  // depths of the surface, at the sweep's size
    ViewPicture normals, shifts;
    float reach_m = 0;       // metres for a shift of 1
    float length_scale = 1;  // the model's
    Cause cause;
  };
  // Costs of the planes, four to a layer. Shared by all figures.
  struct Costs {
    gpu::Texture texture;
    std::vector<gpu::Target> targets;  // indexed by layer
  };
  // Picture in preparation.
  struct Job {
    const CameraLook& look;
    const CharacterView& view;
    const MethodOptions& options;
    const glm::mat4 character_from_clip;
    const std::string defines;
  };

  Status resize(gpu::Device& device, int width, int height, int blocks, SweptFigure& figure);
  Status makePrograms(gpu::Device& device, const std::string& defines, int planes);
  Status make(gpu::Device& device, const std::string& name, const char* vertex, const char* fragment,
              const std::string& defines);
  void drawCosts(gpu::Device& device, const Job& job, const SweptFigure& figure, const glm::vec2& band_m);
  void drawSupport(gpu::Device& device, const Job& job, const SweptFigure& figure);
  void drawShifts(gpu::Device& device, const Job& job, const SweptFigure& figure, const glm::vec2& band_m);
  void drawSurface(gpu::Device& device, const CharacterModel& model, const CharacterView& view,
                   const SweptFigure& figure) const;

  std::vector<SweptFigure> figures_;              // indexed by figure
  std::map<std::string, gpu::Program> programs_;  // keyed by name and defines
  Costs costs_[2];
  int width_ = 0, height_ = 0, blocks_ = 0;  // size of the costs
};

}  // namespace fourdvt::render
