// SPDX-License-Identifier: Apache-2.0
// Functions of the module's second part (more.txt) that the first calls: the optical flow of some alignments and
// characters from cameras. Of abi.txt, looks, scene, room, methods and live streams are there, too.
#pragma once

#include "abi.h"
#include "instance.h"

namespace fourdvt {

// As fdvt_set_align, for one of the flows.
int32_t useFlow(Instance* h, abi::AlignMode mode);
// As fdvt_set_method without a name, unless the canvas has a method.
int32_t useMethodOfCharacter(Instance* h);

}  // namespace fourdvt
