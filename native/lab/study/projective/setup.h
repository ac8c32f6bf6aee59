// SPDX-License-Identifier: Apache-2.0
// Shared setup of the projective study's steps: available methods, cameras, a drawing stage, and a frame's scene under
// a condition.
#pragma once

#include <limits>
#include <map>
#include <memory>

#include "bake/method/frame_drawing.h"
#include "lab/study/projective/conditions.h"
#include "lab/study/projective/proxies.h"
#include "lab/study/run/context.h"

namespace fourdvt::study {

constexpr float kStill = std::numeric_limits<float>::infinity();  // elapsed seconds: ignores earlier frames

// One frame under a condition.
struct FrameScene {
  TriangleMesh surface;         // for a plane: the body that it replaces
  std::vector<Image> pictures;  // one per camera, RGBA
  bool plane = false;           // view-dependent surface
};

class ProjectiveSetup {
 public:
  // `device`: drawing device of the methods, the context's or a wrapper of it. Errors: those of captures, GpuFailure.
  static Result<std::unique_ptr<ProjectiveSetup>> create(const StudyContext& context, gpu::Device& device);

  const StudyContext& context() const { return context_; }
  bake::FrameDrawing& stage() { return *stage_; }
  const std::vector<PinholeCamera>& cameras() const { return cameras_; }
  const std::vector<PinholeCamera>& testCameras() const { return test_cameras_; }
  // Methods of the condition supported by this device.
  std::vector<std::string> methodsOf(const Condition& condition) const;
  const std::vector<std::string>& methods() const { return methods_; }

  // Errors: those of captures and proxies.
  Result<FrameScene> scene(const Condition& condition, FrameWindow& frames, uint32_t frame);
  // Sets the scene on the stage, with the condition's cameras.
  Status show(const Condition& condition, const FrameScene& scene, const PinholeCamera& view);

  // Shared, so that a method survives while the stage draws with others.
  using Shared = std::shared_ptr<render::Method>;
  Result<std::map<std::string, Shared>> make(const std::vector<std::string>& names);
  // Masks a plane's picture by the truth: a plane has no outline of its own.
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

// Requested methods supported by this device, and the reasons for leaving out others.
struct MethodChoice {
  std::vector<std::string> methods;
  std::vector<std::string> left_out;  // "sweep: the device has no …"
};
// Errors: InvalidArgument (unknown method).
Result<MethodChoice> chooseMethods(gpu::Device& device, const std::vector<std::string>& asked);

// Ground truth from an input camera's picture: removes the backdrop from its matte's edges.
Image inputTruth(Image picture);

}  // namespace fourdvt::study
