// SPDX-License-Identifier: Apache-2.0
// The subcommands of `fourdvt-lab`; each parses, checks, calls the library and returns the exit code (tools/args.h).
#pragma once

namespace fourdvt::lab {

int stageCommand(int argc, char** argv);
int streamCommand(int argc, char** argv);
int studioCommand(int argc, char** argv);
int bakeCommand(int argc, char** argv);
int studyCommand(int argc, char** argv);
int scoreCommand(int argc, char** argv);
int methodsCommand(int argc, char** argv);
int mattesCommand(int argc, char** argv);
int surfacesCommand(int argc, char** argv);

}  // namespace fourdvt::lab
