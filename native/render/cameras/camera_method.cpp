// SPDX-License-Identifier: Apache-2.0
#include "render/cameras/camera_method.h"

#include "render/cameras/floating.h"
#include "render/cameras/floating_static.h"
#include "render/cameras/montage.h"
#include "render/cameras/shader_method.h"
#include "render/cameras/sweep.h"

namespace fourdvt::render {
namespace {

using Made = Result<std::unique_ptr<Method>>;

struct Row {
  const char* name;
  MethodGroup group;
  bool needs_half_float_targets;
  Made (*make)(gpu::Device&, const Row&);
  const char* fragment_file = nullptr;  // of methods that are one shader
};

template <ShaderCameras cameras>
Made ofShader(gpu::Device&, const Row& row) {
  return makeShaderMethod(row.fragment_file, cameras);
}

Made ofMontage(gpu::Device& device, const Row& row) { return makeMontage(device, row.name); }

template <class Class>
Made ofClass(gpu::Device&, const Row&) {
  return std::unique_ptr<Method>(std::make_unique<Class>());
}

template <FloatingForm form>
Made floating(gpu::Device& device, const Row&) {
  return makeFloating(device, form);
}

Made floatingStatic(gpu::Device& device, const Row&) { return makeFloatingStatic(device); }

constexpr MethodGroup kTextured = MethodGroup::Textured, kInspection = MethodGroup::Inspection;

// A method's only registration.
constexpr Row kRows[] = {
    {kDefaultMethod.data(), kTextured, false, ofClass<Sweep>},
    {"fvvr", kTextured, false, ofShader<ShaderCameras::Chosen>, "camera_fvvr.frag"},
    {"lumigraph", kTextured, false, ofShader<ShaderCameras::Bounded>, "camera_lumigraph.frag"},
    {"filtered", kTextured, false, ofShader<ShaderCameras::Bounded>, "camera_filtered.frag"},
    {"band-limited", kTextured, false, ofShader<ShaderCameras::Bounded>, "camera_band_limited.frag"},
    {"linear", kTextured, true, floating<FloatingForm::Linear>},
    {"floating", kTextured, true, floating<FloatingForm::Star>},
    {"floating-pairs", kTextured, true, floating<FloatingForm::Pairs>},
    {"floating-static", kTextured, true, floatingStatic},
    {"holoportation", kTextured, false, ofMontage},
    {"montage4d", kTextured, true, ofMontage},
    {"montage4d-seams", kInspection, true, ofMontage},
    {"montage4d-weights", kInspection, true, ofMontage},
    {"wireframe", kInspection, false, ofShader<ShaderCameras::None>, "camera_wireframe.frag"},
    {"silhouette", kInspection, false, ofShader<ShaderCameras::None>, "camera_silhouette.frag"},
};

constexpr const char* kMethodOfEveryDevice = "lumigraph";

bool isKnown(std::string_view name) {
  for (const Row& row : kRows)
    if (row.name == name) return true;
  return false;
}

}  // namespace

std::vector<std::string> cameraMethodNames(MethodGroup group) {
  std::vector<std::string> names;
  for (const Row& row : kRows)
    if (row.group == group) names.emplace_back(row.name);
  return names;
}

Result<std::unique_ptr<Method>> makeCameraMethod(gpu::Device& device, std::string_view name) {
  for (const Row& row : kRows) {
    if (row.name != name) continue;
    if (row.needs_half_float_targets && !device.caps().half_float_targets)
      return Error{ErrorId::Unsupported, "this device cannot draw into half-float textures"};
    return row.make(device, row);
  }
  return Error{ErrorId::InvalidArgument, "there is no method " + std::string(name)};
}

Result<MethodThatServes> makeMethodThatServes(gpu::Device& device, std::string_view name) {
  MethodThatServes out{nullptr, std::string(name), ""};
  auto made = makeCameraMethod(device, name);
  if (made.ok()) {
    out.method = made.take();
    return out;
  }
  if (made.error().id != ErrorId::Unsupported) return made.error();
  out.notice = made.error().message + ": " + kMethodOfEveryDevice + " is drawn in place of " + out.name;
  out.name = kMethodOfEveryDevice;
  FOURDVT_ASSIGN(out.method, makeCameraMethod(device, kMethodOfEveryDevice));
  return out;
}

std::string methodOf(const package::Character& character) {
  return isKnown(character.method.name) ? character.method.name : std::string(kDefaultMethod);
}

Result<MethodThatServes> makeMethodOf(gpu::Device& device, const package::Character& character) {
  FOURDVT_ASSIGN(auto out, makeMethodThatServes(device, methodOf(character)));
  const std::string& wanted = character.method.name;
  if (!wanted.empty() && !isKnown(wanted))
    out.notice = "this player does not know the method " + wanted + ": " + out.name + " is drawn in place of it";
  return out;
}

}  // namespace fourdvt::render
