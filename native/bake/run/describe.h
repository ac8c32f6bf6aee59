// SPDX-License-Identifier: Apache-2.0
// Puts a bake's plan into the package's terms, as far as it is known before the files are written.
#pragma once

#include "bake/run/job.h"
#include "package/character.h"

namespace fourdvt::bake {

constexpr const char* kMeshFile = "mesh.bin";
constexpr const char* kPosterFile = "poster.webp";

// Everything but sequences and graph; from cameras, also but the counts of vertices and faces.
package::Character describeCharacter(const Job& job);
// Everything but the sizes of the files and the codec strings; renditions as in the plan, the highest first.
package::Sequence describeStream(const StreamPlan& plan);

}  // namespace fourdvt::bake
