// SPDX-License-Identifier: Apache-2.0
// Parts of `assemble`: from layers, from cameras, and shared. Internal to bake/stages/.
#pragma once

#include "bake/run/character_files.h"
#include "bake/stages/stages.h"

namespace fourdvt::bake {

constexpr int kPosterWidth = 720, kPosterHeight = 960;
// Writes the poster, which the page shows before the character has loaded.
Status writePoster(const Job& job, const Image& poster);

// Header of a stream, without the fields that follow from its chunks.
package::StreamIndex streamIndex(const Job& job, const StreamPlan& plan, std::vector<package::SampleTable> tables);
// Appends a GOP's chunk to the index.
void addChunk(const StreamPlan& plan, uint32_t gop, uint32_t bytes, uint64_t hash, package::StreamIndex& index);
// Report of a sequence whose files are written; without the bytes of its chunks.
ReportSequence reportSequence(const package::Sequence& sequence, const StreamPlan& plan);
// Writes the stream's picture into the report's folder.
Status reportPicture(const Job& job, const StreamPlan& plan, const std::vector<uint8_t>& jpeg,
                     const std::string& caption, ReportInput& report);

// Write the files of one stream, and add it to the manifest and to the report. Errors: those of assemble.
Status packLayers(const BakeRun& run, const StreamPlan& plan, package::Character& character, ReportInput& report);
Status packSurfaces(const BakeRun& run, const StreamPlan& plan, package::Character& character, ReportInput& report);

// Writes the poster and the fallback texture for viewers without this extension. Returns the texture's name.
Result<std::string> drawLayeredStills(const BakeRun& run, const package::Character& character);
// Sets the report's pictures, and summarises the classes.
Status describeLayers(const BakeRun& run, const package::Character& character, ReportInput& report);
// Writes the poster, and colours the job's mesh for viewers that read glTF alone. Memory: one picture of every
// camera.
Status drawCameraStills(BakeRun& run, const std::vector<ColourMap>& maps, ReportInput& report);

}  // namespace fourdvt::bake
