// SPDX-License-Identifier: Apache-2.0
#include <cstring>

#include "tools/commands.h"
#include "tools/program.h"

namespace {

using namespace fourdvt::tools;

constexpr const char* kBuildLab = "   (built by tests/run.sh, or with cmake -DFOURDVT_LAB=ON)";

std::string presentStudio(int, char**) { return std::string("fourdvt-lab studio MODEL -o CAPTURE") + kBuildLab; }

std::string presentEvaluate(int argc, char** argv) {
  const auto has = [&](const char* option) {
    for (int i = 0; i < argc; ++i)
      if (std::strncmp(argv[i], option, std::strlen(option)) == 0) return true;
    return false;
  };
  const char* present = has("--character")    ? "fourdvt-lab score CHARACTER --capture CAPTURE"
                        : has("--surface")    ? "fourdvt-lab surfaces CAPTURE"
                        : has("--projective") ? "fourdvt-lab methods CAPTURE"
                                              : "fourdvt-lab study CAPTURE -o REPORT";
  return std::string(present) + kBuildLab;
}

constexpr Command kCommands[] = {
    {"import", "make a capture folder from another program's calibration", importCommand},
    {"calibrate", "put a capture's cameras in step and in place", calibrateCommand},
    {"mattes", "make mattes for a capture's cameras", mattesCommand},
    {"reconstruct", "make surfaces for a capture without meshes", reconstructCommand},
    {"bake", "turn a capture folder into a character folder",
     [](int argc, char** argv) { return bakeCommand(argc, argv); }},
    {"plan", "cut a bake or a reconstruction into pieces", planCommand},
    {"piece", "compute one piece of a plan", pieceCommand},
    {"finish", "write the result of a plan whose pieces are done", finishCommand},
    {"job", "show how far a plan is, and what its pieces cost", jobCommand},
    {"inspect", "list the contents of a character and check every byte", inspectCommand},
    {"render", "draw a frame or a movie of a character", renderCommand},
    {"live", "show a performer before cameras in pages while he moves", liveCommand},
    {"live-camera", "send one camera of a live stage", liveCameraCommand},
};

constexpr FormerCommand kFormer[] = {{"studio", presentStudio}, {"evaluate", presentEvaluate}};

}  // namespace

int main(int argc, char** argv) { return runProgram("fourdvt", kCommands, kFormer, argc, argv); }
