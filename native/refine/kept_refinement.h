// SPDX-License-Identifier: Apache-2.0
// A refinement as bytes, to be kept between bakes. Only the machine that wrote them reads them: this is not a format.
#pragma once

#include <span>
#include <vector>

#include "refine/refine.h"

namespace fourdvt::refine {

// With a checksum at the end.
std::vector<uint8_t> refinementBytes(const Refinement& refinement);
// Of what it changes in a capture, not of what it measured.
uint64_t changeHash(const Refinement& refinement);
// False if the bytes are damaged, or not exactly one refinement of this capture.
bool refinementFrom(std::span<const uint8_t> bytes, const capture::Capture& capture, Refinement& out);

}  // namespace fourdvt::refine
