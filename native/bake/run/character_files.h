// SPDX-License-Identifier: Apache-2.0
// Files of a finished character, from the work folder: a stream's .mp4 of all GOPs and .bin of header and chunks, the
// manifest's description, content names, and publication.
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

// Writes the videos of all renditions of `sequence`, from describeStream, and sets the fields that follow from them:
// names, bytes, codecs, and their order by ascending bytes. Returns their sample tables in that order. Errors:
// WriteFailed, Internal.
Result<std::vector<package::SampleTable>> packVideos(const StreamPlan& plan, const BakeRun& run,
                                                     package::Sequence& sequence);

// Writes the .bin, with one chunk in memory at a time, and sets the sequence's stream fields. The index's chunks have
// no offsets yet. Errors: InvalidArgument (memory limits), WriteFailed, Internal.
Status writeStream(package::StreamIndex index, const BakeRun& run, const StreamPlan& plan, package::Sequence& sequence);

// Library → version of the picture codecs.
std::vector<std::pair<std::string, std::string>> encoderVersions();

// Translates a bake's plan into the package's structures, as far as possible before the files are written.

constexpr const char* kManifestFile = "character.gltf";
constexpr const char* kRefinedCameras = "cameras_refined";  // folder, in the report's
constexpr const char* kMeshFile = "mesh.bin";               // without its hash
constexpr const char* kPosterFile = "poster.webp";

// True for names that a bake gives to files; a manifest may have another origin.
bool isFileName(const std::string& name);
// All fields but sequences and graph, the mesh's file without its hash; from cameras, without the counts of vertices
// and faces.
package::Character describeCharacter(const Job& job);
// All fields but the sizes of the files, the hashes in their names and the codec strings; renditions as in the plan,
// the highest first.
package::Sequence describeStream(const StreamPlan& plan);

// Publishes a finished character in its folder, which a web server may be serving, and names its files by their
// content.

// Moves the files of `from` into `to`, the manifest last, then removes the files of the previous bake: those in its
// manifest, and the report in its former place. Other files stay. At every moment the files of the manifest in `to`
// are complete; after a failure those of the earlier one still are. A new folder appears complete. Removes `from`.
// Errors: WriteFailed.
Status publish(const std::string& from, const std::string& to);
// Replaces an earlier report by a finished one. Errors: WriteFailed.
Status publishReport(const std::string& from, const std::string& to);

// Names files by a hash of their content, so that different contents have different names (package/FORMAT.md). Only
// for files that are found through the manifest.

// "walk.bin" → "walk.3f9a1c20.bin": the first 8 of the hash's 16 hexadecimal digits.
std::string contentName(const std::string& name, uint64_t hash);
// Writes the file under its contentName, which it returns. Errors: WriteFailed.
Result<std::string> writeNamed(const std::string& folder, const std::string& name, std::span<const uint8_t> bytes);
// Renames a finished file to its contentName, which it returns. Memory: one part of the file at a time. Errors:
// FileUnreadable, WriteFailed.
Result<std::string> nameByContent(const std::string& folder, const std::string& name);

}  // namespace fourdvt::bake
