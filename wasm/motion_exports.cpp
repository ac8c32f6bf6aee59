// SPDX-License-Identifier: Apache-2.0
// C ABI, motion: parameters, transitions, placement, alignment. Ownership of records: exports.cpp.
#include "base/later.h"
#include "instance.h"
#include "motion/blend.h"

using namespace fourdvt;

namespace {

const package::Sequence* sequenceAt(Instance* h, uint32_t index) {
  const package::Character* c = h->player->character();
  return c && index < c->sequences.size() ? &c->sequences[index] : nullptr;
}

}  // namespace

int32_t fdvt_set_parameter(Instance* h, const char* name, uint32_t size, double value, int32_t at_once) {
  makeCurrent(h);
  return keep(h, h->player->setParameter({name, size}, value, at_once != 0));
}
double fdvt_parameter(Instance* h, const char* name, uint32_t size) { return h->player->parameter({name, size}); }
int32_t fdvt_goto(Instance* h, const char* name, uint32_t size) {
  makeCurrent(h);
  return keep(h, h->player->goTo({name, size}));
}
void fdvt_allow_transitions(Instance* h) { h->player->allowTransitions(); }
void fdvt_set_travel(Instance* h, int32_t on) { h->player->setTravel(on != 0); }
void fdvt_place(Instance* h, double x_m, double z_m, double heading_rad) {
  h->player->setPlacement({{x_m, z_m}, static_cast<float>(heading_rad)});
}
void fdvt_steer(Instance* h, double heading_rad) { h->player->steer(heading_rad); }

int32_t fdvt_set_align(Instance* h, abi::AlignMode mode) {
  if (mode < abi::AlignMode::None || mode > abi::AlignMode::FlowOpencv)
    return fail(h, ErrorId::InvalidArgument, "no such alignment");
  makeCurrent(h);
  if (mode >= abi::AlignMode::FlowGpu && !later<&useFlow>(h, mode)) return 0;
  h->player->setAlign(mode == abi::AlignMode::None    ? render::Align::None
                      : mode == abi::AlignMode::Baked ? render::Align::Baked
                                                      : render::Align::Flow);
  return 1;
}

const abi::Parameter* fdvt_sequence_parameter(Instance* h, uint32_t sequence, uint32_t index) {
  const package::Sequence* s = sequenceAt(h, sequence);
  if (!s || index >= s->space.names.size()) return nullptr;
  const motion::Range range = motion::parameterRange(*s, index);
  h->records.parameter = {text(s->space.names[index]), range.min, range.max};
  return &h->records.parameter;
}
const abi::Text* fdvt_sequence_member(Instance* h, uint32_t sequence, uint32_t index) {
  const package::Sequence* s = sequenceAt(h, sequence);
  if (!s || index >= s->members.size()) return nullptr;
  h->records.member = text(s->members[index].name);
  return &h->records.member;
}
