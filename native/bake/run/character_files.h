// SPDX-License-Identifier: Apache-2.0
// A stream's two files, from what the work folder holds: the .mp4 of all GOPs, and the .bin of header and chunks.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "bake/run/bake_run.h"
#include "bake/run/job.h"
#include "base/result.h"
#include "encode/mp4.h"
#include "package/character.h"

namespace fourdvt::bake {
constexpr const char* kGenerator = "fourdvt 0.1.0";

// Writes the videos of all renditions of `sequence`, which describeStream made, and sets what is now known of them:
// names, bytes, codecs, and their order, the fewest bytes first. Returns their sample tables in that order. Errors:
// WriteFailed, Internal.
Result<std::vector<package::SampleTable>> packVideos(const StreamPlan& plan, const BakeRun& run,
                                                     package::Sequence& sequence);

// Writes the .bin, with one chunk in memory at a time, and sets the sequence's stream fields. The
// index's chunks have no offsets yet. Errors: InvalidArgument (memory limits), WriteFailed, Internal.
Status writeStream(package::StreamIndex index, const BakeRun& run, const StreamPlan& plan, package::Sequence& sequence);

// Library → version of what coded the pictures.
std::vector<std::pair<std::string, std::string>> encoderVersions();

// Puts a bake's plan into the package's terms, as far as it is known before the files are written.

constexpr const char* kManifestFile = "character.gltf";
constexpr const char* kRefinedCameras = "cameras_refined";  // folder, in the report's
constexpr const char* kMeshFile = "mesh.bin";               // before its hash
constexpr const char* kPosterFile = "poster.webp";

// Returns true for names that a bake gives to files; a manifest may come from elsewhere.
bool isFileName(const std::string& name);
// Everything but sequences and graph, the mesh's file without its hash; from cameras, also but the counts of vertices
// and faces.
package::Character describeCharacter(const Job& job);
// Everything but the sizes of the files, the hashes in their names and the codec strings; renditions as in the plan,
// the highest first.
package::Sequence describeStream(const StreamPlan& plan);

// Puts a finished character into its folder, which a web server may be serving, and names its files by their content.

// Moves the files of `from` into `to`, the manifest last, then removes the files of the bake that was there: those that
// its manifest names, and the report that bakes once put there. Other files stay. At every moment the manifest in `to`
// has its files beside it; on failure the earlier one still has. A folder that does not exist yet appears complete.
// Removes `from`. Errors: WriteFailed.
Status publish(const std::string& from, const std::string& to);
// Puts a finished report in the place of an earlier one. Errors: WriteFailed.
Status publishReport(const std::string& from, const std::string& to);

// Names of files that hold a hash of their content, so that no two contents have one name (package/FORMAT.md). Only for
// files that are found through the manifest.

// "walk.bin" → "walk.3f9a1c20.bin": the first 8 of the hash's 16 hexadecimal digits.
std::string contentName(const std::string& name, uint64_t hash);
// Writes the file under its contentName, which it returns. Errors: WriteFailed.
Result<std::string> writeNamed(const std::string& folder, const std::string& name, std::span<const uint8_t> bytes);
// Gives a finished file its contentName, which it returns. Holds one part of the file in memory at a time. Errors:
// FileUnreadable, WriteFailed.
Result<std::string> nameByContent(const std::string& folder, const std::string& name);

}  // namespace fourdvt::bake
