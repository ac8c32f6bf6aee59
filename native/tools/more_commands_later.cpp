// SPDX-License-Identifier: Apache-2.0
// Commands of a program that is linked without fourdvt_more_tools, so that a first page need not wait for their
// libraries. Each prints how to get it.
#include <cstdio>

#include "tools/args.h"
#include "tools/commands.h"

namespace fourdvt::tools {
namespace {

int notBuiltYet(const char* command) {
  std::fprintf(stderr,
               "%s: \"%s\" is not built yet. site/demo.sh builds it once the page is served, in some minutes "
               "(build/rest.log); site/demo.sh --prepare builds everything at once\n",
               programName(), command);
  return kFailed;
}

}  // namespace

int importCommand(int, char**) { return notBuiltYet("import"); }
int calibrateCommand(int, char**) { return notBuiltYet("calibrate"); }
int mattesCommand(int, char**) { return notBuiltYet("mattes"); }
int reconstructCommand(int, char**) { return notBuiltYet("reconstruct"); }
int planCommand(int, char**) { return notBuiltYet("plan"); }
int pieceCommand(int, char**) { return notBuiltYet("piece"); }
int finishCommand(int, char**) { return notBuiltYet("finish"); }
int jobCommand(int, char**) { return notBuiltYet("job"); }
int liveCommand(int, char**) { return notBuiltYet("live"); }
int liveCameraCommand(int, char**) { return notBuiltYet("live-camera"); }

}  // namespace fourdvt::tools
