// SPDX-License-Identifier: Apache-2.0
#include "tools/commands.h"
#include "tools/program.h"

namespace {

using namespace fourdvt::tools;

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

}  // namespace

int main(int argc, char** argv) { return runProgram("fourdvt", kCommands, argc, argv); }
