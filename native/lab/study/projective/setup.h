// SPDX-License-Identifier: Apache-2.0
// What every step of the projective study works with: the methods that there are, the cameras, a stage that draws, and
// what a condition shows of a frame. Does NOT measure.
#pragma once

#include <limits>
#include <map>
#include <memory>

#include "bake/method/frame_drawing.h"
#include "lab/study/projective/conditions.h"
#include "lab/study/projective/proxies.h"
#include "lab/study/run/context.h"

namespace fourdvt::study {

constexpr float kStill = std::numeric_limits<float>::infinity();  // elapsed seconds: no earlier frame counts

// One frame under a condition.
struct FrameScene {
  TriangleMesh surface;         // of a plane: the body that it stands for
  std::vector<Image> pictures;  // one per camera, RGBA
  bool plane = false;           // the surface shown depends on the view
};

class ProjectiveSetup {
 public:
  // `device`: where methods draw, the context's or one that stands before it. Errors: those of captures, GpuFailure.
  static Result<std::unique_ptr<ProjectiveSetup>> create(const StudyContext& context, gpu::Device& device);

  const StudyContext& context() const { return context_; }
  bake::FrameDrawing& stage() { return *stage_; }
  const std::vector<PinholeCamera>& cameras() const { return cameras_; }
  const std::vector<PinholeCamera>& testCameras() const { return test_cameras_; }
  // Those of the condition that this device can draw.
  std::vector<std::string> methodsOf(const Condition& condition) const;
  const std::vector<std::string>& methods() const { return methods_; }

  // Errors: those of captures and proxies.
  Result<FrameScene> scene(const Condition& condition, FrameWindow& frames, uint32_t frame);
  // Puts it on the stage, with the cameras as the condition has them.
  Status show(const Condition& condition, const FrameScene& scene, const PinholeCamera& view);

  // Lives on while the stage draws with others.
  using Shared = std::shared_ptr<render::Method>;
  Result<std::map<std::string, Shared>> make(const std::vector<std::string>& names);
  // Of a plane only what the truth shows is kept: it has no outline of its own.
  Result<Image> draw(const Shared& method, const Condition& condition, const FrameScene& scene,
                     const PinholeCamera& view, const Image& truth, float elapsed_s);

 private:
  ProjectiveSetup(const StudyContext& context, gpu::Device& device);

  const StudyContext& context_;
  gpu::Device& device_;
  std::vector<PinholeCamera> cameras_, test_cameras_;
  std::vector<std::string> methods_;
  std::unique_ptr<bake::FrameDrawing> stage_;
  std::string shown_;  // condition on the stage
  Proxies proxies_;
};

// The methods that this device can draw, of those asked for or of all; with why the others are left out.
struct MethodChoice {
  std::vector<std::string> methods;
  std::vector<std::string> left_out;  // "sweep: the device has no …"
};
// Errors: InvalidArgument where there is no such method.
Result<MethodChoice> chooseMethods(gpu::Device& device, const std::vector<std::string>& asked);

// The picture of an input camera as a truth: without the backdrop in its matte's edges.
Image inputTruth(Image picture);

}  // namespace fourdvt::study
