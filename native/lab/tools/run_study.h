// SPDX-License-Identifier: Apache-2.0
// Runs a study for `study` and `methods -o`: capture, GPU, progress and the closing lines.
#pragma once

#include "lab/study/run/context.h"

namespace fourdvt::lab {

using StudyRunner = Result<study::Rows> (*)(const study::StudyContext& context);
// Runs the study and returns the exit code.
Result<int> runStudyCommand(const study::StudyOptions& options, capture::MeshNeed need, StudyRunner run);

}  // namespace fourdvt::lab
