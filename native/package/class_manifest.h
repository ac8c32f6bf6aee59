// SPDX-License-Identifier: Apache-2.0
// Reads the members and the parameter space of a manifest's sequence. Internal to package/.
#pragma once

#include "package/character.h"
#include "package/field_reader.h"

namespace fourdvt::package {

// Sets members, space and reference_count; name, frame_count, fps and root_velocity_mps have been read. A sequence
// that lists no members has one: itself.
void readMembers(FieldReader& in, const std::string& at, Sequence& sequence);

}  // namespace fourdvt::package
