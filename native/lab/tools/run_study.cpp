// SPDX-License-Identifier: Apache-2.0
#include "lab/tools/run_study.h"

#include <cstdio>

#include "base/watch.h"
#include "lab/tools/progress.h"
#include "mattes/frame_reader.h"
#include "tools/args.h"
#include "tools/session.h"
#include "tools/terminal.h"

namespace fourdvt::lab {

Result<int> runStudyCommand(const study::StudyOptions& options, capture::MeshNeed need, StudyRunner run) {
  FOURDVT_ASSIGN(const auto capture,
                 mattes::openCapture(options.capture_folder, tools::videoOpener(), options.sequences, need));
  const std::atomic<bool>* stop = tools::listenForStop();
  FOURDVT_ASSIGN(const auto gpu, tools::openGpu());
  StudyLine line;
  study::StudyContext context;
  context.options = options;
  context.options.generator = "fourdvt-lab " FOURDVT_VERSION;
  context.capture = &capture;
  context.open_video = tools::videoOpener();
  context.device = gpu.device.get();
  context.progress = [&](const study::StudyProgress& p) { line.show(p); };
  context.stop = stop;
  const Watch watch;
  FOURDVT_ASSIGN(const auto rows, run(context));
  line.end();
  const double seconds = watch.seconds();
  const char* folder = options.report_folder.c_str();
  std::printf("%zu rows in %.0f s\nrows: %s/%s.csv\nreport: %s/report.html\n", rows.size(), seconds, folder,
              options.stem.c_str(), folder);
  return tools::kOk;
}

}  // namespace fourdvt::lab
