// SPDX-License-Identifier: Apache-2.0
// A bake's plan in the package's words, as far as it is known before the files are written.
#pragma once

#include "bake/run/job.h"
#include "package/character.h"

namespace fourdvt::bake {

constexpr const char* kMeshFile = "mesh.bin";
constexpr const char* kPosterFile = "poster.webp";

// Without sequences and graph.
package::Character describeCharacter(const Job& job);
// Without the sizes of its files and the codec; one rendition.
package::Sequence describeStream(const StreamPlan& plan);

}  // namespace fourdvt::bake
