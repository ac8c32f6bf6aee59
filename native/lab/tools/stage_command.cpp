// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <tuple>

#include "lab/stage/stage.h"
#include "lab/tools/commands.h"
#include "lab/tools/progress.h"
#include "tools/args.h"
#include "tools/session.h"

namespace fourdvt::lab {
namespace {

const tools::CommandHelp& help() {
  static const tools::CommandHelp text{
      "stage CAPTURE -o FOLDER [options]",
      "Turns a capture into the stage of a live system, for `fourdvt live FOLDER/RIG.json`: scaled cameras and plates, "
      "and per camera a video that is played in a loop.",
      {{"-o", "FOLDER", "folder to write (required)"},
       {"--size", "WxH", "pixels of a camera's picture, even (default 320x240)"},
       {"--sequence", "NAME", "sequence to show (default: the capture's first)"},
       {"--cameras", "A,B", "only these cameras (default: all)"},
       {"--pictures", "N",
        "pictures in a video, the sequence over and over (default: the sequence once; with --counter 1000)"},
       {"--counter", nullptr,
        "paint each picture's number on the performer; counter.json says where, which tests read"}}};
  return text;
}

Status write(const std::string& folder, const stage::StageOptions& options) {
  const std::vector<std::string> only =
      options.sequence.empty() ? std::vector<std::string>{} : std::vector{options.sequence};
  const auto need = options.counter ? capture::MatteNeed::Required : capture::MatteNeed::None;
  FOURDVT_ASSIGN(auto capture,
                 capture::openCapture(folder, tools::videoOpener(), only, capture::MeshNeed::Nothing, need));
  const FrameLine line;
  const Status written = stage::writeStage(capture, options, tools::videoOpener(), line);
  line.end();
  if (written.ok()) std::printf("%s/RIG.json\n", options.folder.c_str());
  return written;
}

}  // namespace

int stageCommand(int argc, char** argv) {
  tools::Args args(help(), argc, argv);
  const std::string capture = args.positional();
  stage::StageOptions options;
  options.folder = args.required("-o");
  if (const auto size = args.size("--size", 4094)) std::tie(options.width, options.height) = *size;
  options.sequence = args.text("--sequence");
  options.cameras = args.list("--cameras");
  options.counter = args.has("--counter");
  options.pictures = args.integer("--pictures", 0, 1, 1000000);
  if (const auto code = tools::helpOrProblem(help(), args)) return *code;
  const Status written = write(capture, options);
  return written.ok() ? tools::kOk : tools::fail(written.error());
}

}  // namespace fourdvt::lab
