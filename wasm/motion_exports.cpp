// SPDX-License-Identifier: Apache-2.0
// The C ABI's share of motion: parameters, transitions, placement, alignment, scene. Conventions: exports.cpp.
#include "flow_modes.h"
#include "instance.h"
#include "motion/parameter_space.h"

using namespace fourdvt;

namespace {

const package::Sequence* sequenceAt(Instance* h, uint32_t index) {
  const package::Character* c = h->player->character();
  return c && index < c->sequences.size() ? &c->sequences[index] : nullptr;
}

}  // namespace

FDVT int fdvt_set_parameter(Instance* h, const char* name, uint32_t size, double value, int32_t at_once) {
  makeCurrent(h);
  return keep(h, h->player->setParameter({name, size}, value, at_once != 0));
}
FDVT double fdvt_parameter(Instance* h, const char* name, uint32_t size) { return h->player->parameter({name, size}); }
FDVT int fdvt_goto(Instance* h, const char* name, uint32_t size) {
  makeCurrent(h);
  return keep(h, h->player->goTo({name, size}));
}
FDVT void fdvt_set_travel(Instance* h, int32_t on) { h->player->setTravel(on != 0); }
FDVT void fdvt_place(Instance* h, double x_m, double z_m, double heading_rad) {
  h->player->setPlacement({{x_m, z_m}, static_cast<float>(heading_rad)});
}
FDVT void fdvt_steer(Instance* h, double heading_rad) { h->player->steer(heading_rad); }

// AlignMode. A flow that this device cannot run leaves the alignment as it was: 0.
FDVT int fdvt_set_align(Instance* h, int32_t mode) {
  if (mode < kNone || mode > kPageFlow) return fail(h, ErrorId::InvalidArgument, "no such alignment");
  makeCurrent(h);
  if (mode >= kFarneback) {
    auto flow = makeFlow(*h->stage->device, static_cast<AlignMode>(mode));
    if (!flow.ok()) return keep(h, flow.error());
    h->stage->recipe->setFlow(flow.take());
  }
  h->player->setAlign(mode == kNone    ? render::Align::None
                      : mode == kBaked ? render::Align::Baked
                                       : render::Align::Flow);
  return 1;
}

FDVT void fdvt_clear_scene(Instance* h) {
  makeCurrent(h);
  h->stage->scene.meshes.clear();
}
// corners: count × 6 floats, position in metres, colour 0..1.
FDVT int fdvt_add_scene_mesh(Instance* h, const float* corners, uint32_t count, int32_t occluder_only) {
  makeCurrent(h);
  std::vector<render::SceneCorner> list(count);
  for (uint32_t i = 0; i < count; ++i) {
    const float* c = corners + 6 * size_t(i);
    list[i] = {{c[0], c[1], c[2]}, {c[3], c[4], c[5]}};
  }
  auto mesh = render::makeSceneMesh(*h->stage->device, list, occluder_only != 0);
  if (!mesh.ok()) return keep(h, mesh.error());
  h->stage->scene.meshes.push_back(mesh.take());
  if (const package::Character* c = h->player->character())
    h->stage->scene.ground_y_m = static_cast<float>(c->ground_y_m);
  return 1;
}

// Null: no such parameter.
FDVT const ParameterBlock* fdvt_sequence_parameter(Instance* h, uint32_t sequence, uint32_t index) {
  const package::Sequence* s = sequenceAt(h, sequence);
  if (!s || index >= s->space.names.size()) return nullptr;
  const motion::Range range = motion::parameterRange(*s, index);
  h->parameter = {text(s->space.names[index]), range.min, range.max};
  return &h->parameter;
}
// Null: no such member.
FDVT const Text* fdvt_sequence_member(Instance* h, uint32_t sequence, uint32_t index) {
  const package::Sequence* s = sequenceAt(h, sequence);
  if (!s || index >= s->members.size()) return nullptr;
  h->member = text(s->members[index].name);
  return &h->member;
}
