// SPDX-License-Identifier: Apache-2.0
// `fourdvt-lab`: captures with known truth, and evaluation of methods; unnecessary for making characters.
#include "lab/tools/commands.h"
#include "tools/commands.h"

namespace {

using namespace fourdvt;

constexpr tools::Command kCommands[] = {
    {"studio", "render a model, or a built-in actor, as a capture folder", lab::studioCommand},
    {"stage", "turn a capture into the stage of a live system", lab::stageCommand},
    {"stream", "read which pictures a recorded live stream shows", lab::streamCommand},
    {"track", "track as fourdvt does, with parts switched off", lab::trackCommand},
    {"bake", "bake as fourdvt does, or with the papers' labellings", lab::bakeCommand},
    {"study", "measure the papers' tables on a capture", lab::studyCommand},
    {"score", "score a character against its capture's pictures", lab::scoreCommand},
    {"methods", "compare the methods of characters from cameras", lab::methodsCommand},
    {"mattes", "score a virtual studio's mattes", lab::mattesCommand},
    {"surfaces", "score a capture's surfaces", lab::surfacesCommand},
    {"drift", "measure how far tracked meshes drift", lab::driftCommand},
};

}  // namespace

int main(int argc, char** argv) { return tools::runProgram("fourdvt-lab", kCommands, argc, argv); }
