// SPDX-License-Identifier: Apache-2.0
// C ABI, appearance of characters: methods, looks, montage, flow, scene and room. Ownership of records: exports.cpp.
#include <emscripten.h>

#include <cmath>

#include "base/hash.h"
#include "instance.h"
#include "render/cameras/camera_method.h"
#include "render/flow/flow.h"
#include "render/montage/layered_montage.h"
#include "render/styles/styles.h"

namespace fourdvt {
namespace {

// Computes flow in the page (web/src/more/opencv-flow.ts), as fdvt_flow_farneback of abi.txt. 0: unavailable.
EM_JS(int, fdvt_page_flow, (const uint8_t* a, const uint8_t* b, int width, int height, float* out),
      { return Module['fourdvtFlow'] ? Module['fourdvtFlow'](a, b, width, height, out) : 0; });

Status solveOnPage(const uint8_t* a, const uint8_t* b, int width, int height, float* flow) {
  if (fdvt_page_flow(a, b, width, height, flow)) return {};
  return Error{ErrorId::Unsupported, "the page has no optical flow: load the OpenCV module first"};
}

// Creates the flow of an align mode that uses one. Errors: Unsupported: the device lacks that flow; GpuFailure.
Result<std::unique_ptr<render::FlowSource>> makeFlow(gpu::Device& device, abi::AlignMode mode) {
  if (mode == abi::AlignMode::FlowOpencv) return render::createReadBackFlow(device, solveOnPage);
  render::FlowOptions options;
  options.method = mode == abi::AlignMode::FlowDis ? render::FlowMethod::Dis : render::FlowMethod::Farneback;
  return render::createGpuFlow(device, options);
}

// Sets the method of drawing characters from cameras; an empty name: the manifest's. A method unsupported by device or
// player is replaced by a fallback, with an event. Errors: InvalidArgument: no such method.
Status useMethod(Instance& h, std::string_view name, const package::Character& character) {
  Canvas& canvas = *h.canvas;
  const std::string wanted(name.empty() ? character.method.name : name);
  const std::string known = name.empty() ? render::methodOf(character) : wanted;
  if (canvas.method == known) return {};
  FOURDVT_ASSIGN(auto made, name.empty() ? render::makeMethodOf(*canvas.device, character)
                                         : render::makeSupportedMethod(*canvas.device, name));
  if (!made.notice.empty()) h.fallback = {wanted, made.name, made.notice, true};
  canvas.recipe->setMethod(std::move(made.method));
  canvas.method = known;
  return {};
}

}  // namespace

int32_t useFlow(Instance* h, abi::AlignMode mode) {
  auto flow = makeFlow(*h->canvas->device, mode);
  if (flow.ok()) h->canvas->recipe->setFlow(flow.take());
  return flow.ok() ? 1 : keep(h, flow.error());
}

int32_t useMethodOfCharacter(Instance* h) {
  if (!h->canvas->method.empty()) return 1;
  return fdvt_set_method(h, "", 0, h->player->method().closest, abi::Visibility::Offset);
}

}  // namespace fourdvt

using namespace fourdvt;

int32_t fdvt_set_look(Instance* h, abi::Look look, double strength, double light_turn_deg, const uint8_t* light,
                      int32_t width, int32_t height) {
  makeCurrent(h);
  render::Recipe& recipe = *h->canvas->recipe;
  if (look == abi::Look::None) {
    recipe.setStyle(nullptr);
    return 1;
  }
  if (look != abi::Look::Sketch && look != abi::Look::Relit)
    return fail(h, ErrorId::InvalidArgument, "look must be none, sketch or relit");
  if (!std::isfinite(light_turn_deg))
    return fail(h, ErrorId::InvalidArgument, "light-turn must be a number of degrees");
  render::StyleOptions style;
  style.kind = look == abi::Look::Relit ? render::StyleKind::Relit : render::StyleKind::Sketch;
  style.strength = static_cast<float>(strength);
  style.light_turn_rad = static_cast<float>(glm::radians(light_turn_deg));
  if (light) {
    if (width <= 0 || height <= 0) return fail(h, ErrorId::InvalidArgument, "light must have width and height");
    const std::span pixels(light, size_t{4} * static_cast<size_t>(width) * static_cast<size_t>(height));
    auto read = render::lightFromPicture(pixels, width, height, 4);
    if (!read.ok()) return keep(h, read.error());
    style.light = read.value();
  }
  return keep(h, render::setStyle(*h->canvas->device, recipe, style));
}

int32_t fdvt_use_montage(Instance* h, int32_t on) {
  makeCurrent(h);
  render::Recipe& recipe = *h->canvas->recipe;
  const package::Character* character = h->player->character();
  if (!on || !character || character->appearance == package::AppearanceKind::Cameras)
    recipe.setLayered(nullptr);
  else if (!recipe.hasLayered()) {
    auto made = render::makeLayeredMontage(*h->canvas->device);
    if (!made.ok()) return 0;
    recipe.setLayered(made.take());
  }
  return 1;
}

int32_t fdvt_set_method(Instance* h, const char* name, uint32_t size, int32_t closest, abi::Visibility visibility) {
  if (closest < 0) return fail(h, ErrorId::InvalidArgument, "closest must be 0 (all cameras) or more");
  const package::Character* character = h->player->character();
  if (!character) return fail(h, ErrorId::InvalidArgument, "there is no character yet");
  makeCurrent(h);
  if (!keep(h, useMethod(*h, {name, size}, *character))) return 0;
  h->player->setMethod({.closest = closest, .visibility = static_cast<render::Visibility>(visibility)});
  return 1;
}

void fdvt_clear_scene(Instance* h) {
  makeCurrent(h);
  h->canvas->scene.meshes.clear();
}
int32_t fdvt_add_scene_mesh(Instance* h, const float* corners, uint32_t count, int32_t occluder_only) {
  makeCurrent(h);
  static_assert(sizeof(render::SceneCorner) == 6 * sizeof(float));
  const std::span list(reinterpret_cast<const render::SceneCorner*>(corners), count);
  auto mesh = render::makeSceneMesh(*h->canvas->device, list, occluder_only != 0);
  if (!mesh.ok()) return keep(h, mesh.error());
  h->canvas->scene.meshes.push_back(mesh.take());
  if (const package::Character* c = h->player->character())
    h->canvas->scene.ground_y_m = static_cast<float>(c->ground_y_m);
  return 1;
}
uint32_t fdvt_show_room(Instance* h, const uint8_t* picture, uint32_t size) {
  makeCurrent(h);
  render::Scene& scene = h->canvas->scene;
  scene.room.corners.reset();
  const package::Character* c = h->player->character();
  if (!size || !c) return 0;
  if (fnv1a({picture, size}) != c->room.picture_hash)
    return fail(h, ErrorId::FilesDiffer, "the room's picture is not of this bake");
  if (!keep(h, render::setRoom(*h->canvas->device, c->room, scene))) return 0;
  scene.ground_y_m = static_cast<float>(c->ground_y_m);
  return h->canvas->device->nativeTexture(scene.room_picture.id());
}
