// SPDX-License-Identifier: Apache-2.0
#include "tools/commands.h"

namespace {

using namespace fourdvt;
using namespace fourdvt::tools;

using Run = Result<int> (*)(int argc, char** argv);
// Returns a command of fourdvt_more_tools, or null in a program linked without it.
constexpr Run more(Run run) { return FOURDVT_MORE_TOOLS ? run : nullptr; }

constexpr Command kCommands[] = {
    {"import", "make a capture folder from another program's calibration", more(importCommand)},
    {"calibrate", "put a capture's cameras in step and in place", more(calibrateCommand)},
    {"mattes", "make mattes for a capture's cameras", more(mattesCommand)},
    {"reconstruct", "make surfaces for a capture without meshes", more(reconstructCommand)},
    {"track", "move one mesh with texture coordinates through surfaces",
     more([](int argc, char** argv) { return trackCommand(argc, argv); })},
    {"bake", "turn a capture folder into a character folder",
     [](int argc, char** argv) { return bakeCommand(argc, argv); }},
    {"plan", "cut a bake, a reconstruction or tracking into pieces", more(planCommand)},
    {"piece", "compute one piece of a plan", more(pieceCommand)},
    {"finish", "write the result of a plan whose pieces are done", more(finishCommand)},
    {"job", "show how far a plan is, and what its pieces cost", more(jobCommand)},
    {"inspect", "list the contents of a character and check every byte", inspectCommand},
    {"render", "draw a frame or a movie of a character", renderCommand},
    {"live", "show a performer before cameras in pages while he moves", more(liveCommand)},
    {"live-camera", "send one camera of a live stage", more(liveCameraCommand)},
};

}  // namespace

int main(int argc, char** argv) { return runProgram("fourdvt", kCommands, argc, argv); }
