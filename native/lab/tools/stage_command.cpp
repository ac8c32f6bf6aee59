// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "lab/stage/stage.h"
#include "lab/tools/commands.h"
#include "lab/tools/progress.h"
#include "mattes/frame_reader.h"
#include "tools/args.h"
#include "tools/session.h"

namespace fourdvt::lab {
namespace {

Status write(const std::string& folder, const stage::StageOptions& options) {
  const std::vector<std::string> only =
      options.sequence.empty() ? std::vector<std::string>{} : std::vector{options.sequence};
  const auto need = options.counter ? capture::MatteNeed::Required : capture::MatteNeed::None;
  FOURDVT_ASSIGN(auto capture,
                 mattes::openCapture(folder, tools::videoOpener(), only, capture::MeshNeed::Nothing, need));
  const FrameLine line;
  const Status written = stage::writeStage(capture, options, tools::videoOpener(), line);
  line.end();
  if (written.ok()) std::printf("%s/RIG.json\n", options.folder.c_str());
  return written;
}

}  // namespace

Result<int> stageCommand(int argc, char** argv) {
  std::string capture;
  stage::StageOptions o;
  const tools::Args args(
      {"stage CAPTURE -o FOLDER [options]",
       "Turns a capture into the stage of a live system, for `fourdvt live FOLDER/RIG.json`: scaled cameras and "
       "plates, "
       "and per camera a video that is played in a loop.",
       {&capture},
       {{"-o FOLDER", tools::required(o.folder), "folder to write (required)"},
        {"--size WxH", tools::size(o.width, o.height, 4094), "pixels of a camera's picture, even (default 320x240)"},
        {"--sequence NAME", tools::text(o.sequence), "sequence to show (default: the capture's first)"},
        {"--cameras A,B", tools::list(o.cameras), "only these cameras (default: all)"},
        {"--pictures N", tools::number(o.pictures, 1, 1000000),
         "pictures in a video, the sequence over and over (default: the sequence once; with --counter 1000)"},
        {"--counter", tools::flag(o.counter),
         "paint each picture's number on the performer; counter.json says where, which tests read"}}},
      argc, argv);
  if (const auto code = args.helpOrProblem()) return *code;
  FOURDVT_TRY(write(capture, o));
  return tools::kOk;
}

}  // namespace fourdvt::lab
