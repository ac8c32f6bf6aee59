// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <filesystem>
#include <string>

#include "base/text.h"
#include "lab/stage/recorded_stream.h"
#include "lab/tools/commands.h"
#include "platform/files.h"
#include "tools/args.h"
#include "tools/session.h"

namespace fourdvt::lab {
namespace {

std::string objOf(const TriangleMesh& mesh) {
  std::string out;
  char line[120];
  for (const glm::vec3& p : mesh.positions) {
    std::snprintf(line, sizeof line, "v %.5f %.5f %.5f\n", p.x, p.y, p.z);
    out += line;
  }
  for (const glm::uvec3& f : mesh.faces) {
    std::snprintf(line, sizeof line, "f %u %u %u\n", f.x + 1, f.y + 1, f.z + 1);
    out += line;
  }
  return out;
}

Status writeSurfaces(const std::vector<TriangleMesh>& surfaces, const std::string& folder) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  for (size_t frame = 0; frame < surfaces.size(); ++frame) {
    const std::string name = printed("/%06zu.obj", frame);
    if (!surfaces[frame].faces.empty()) FOURDVT_TRY(platform::writeFileAtomic(folder + name, objOf(surfaces[frame])));
  }
  return {};
}

Status read(const std::string& recorded, const std::string& stage_folder, const std::string& surfaces_folder) {
  FOURDVT_ASSIGN(const auto stream, stage::readRecordedStream(recorded, stage_folder));
  if (!surfaces_folder.empty()) FOURDVT_TRY(writeSurfaces(stream.surfaces, surfaces_folder));
  std::fputs(stage::recordedStreamJson(stream).c_str(), stdout);
  return {};
}

}  // namespace

Result<int> streamCommand(int argc, char** argv) {
  std::string recorded, stage_folder, surfaces_folder;
  const tools::Args args(
      {"stream RECORDED --stage FOLDER",
       "Says as JSON which pictures the frames of a recorded live stream show, by the numbers that `fourdvt-lab stage "
       "--counter` painted on the performer. RECORDED has manifest.json, the stream's first message, and frames.bin, "
       "its frames, each after its length in bytes (uint32, little-endian).",
       {&recorded},
       {{"--stage FOLDER", tools::required(stage_folder), "the stage that was played (required)"},
        {"--surfaces FOLDER", tools::text(surfaces_folder),
         "write the first surface of each frame of the stage's sequence, 000000.obj …"}}},
      argc, argv);
  if (const auto code = args.helpOrProblem()) return *code;
  FOURDVT_TRY(read(recorded, stage_folder, surfaces_folder));
  return tools::kOk;
}

}  // namespace fourdvt::lab
