// SPDX-License-Identifier: Apache-2.0
// Puts a bake's plan into the package's terms, as far as it is known before the files are written.
#pragma once

#include "bake/run/job.h"
#include "package/character.h"

namespace fourdvt::bake {

constexpr const char* kManifestFile = "character.gltf";
constexpr const char* kRefinedCameras = "cameras_refined";  // folder, in the report's
constexpr const char* kMeshFile = "mesh.bin";               // before its hash
constexpr const char* kPosterFile = "poster.webp";

// Everything but sequences and graph, the mesh's file without its hash; from cameras, also but the counts of vertices
// and faces.
package::Character describeCharacter(const Job& job);
// Everything but the sizes of the files, the hashes in their names and the codec strings; renditions as in the plan,
// the highest first.
package::Sequence describeStream(const StreamPlan& plan);

}  // namespace fourdvt::bake
