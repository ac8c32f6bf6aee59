// SPDX-License-Identifier: Apache-2.0
// `fourdvt-lab study CAPTURE -o REPORT`: the papers' tables on one capture, as a list of steps. A step measures,
// returns rows of evaluate.csv and writes its pictures into REPORT/pictures. A finished step's rows are kept in
// REPORT/steps/<name>.csv, so that an interrupted study resumes; the document is made from rows only.
//
// Papers: Volino, Hilton: Layered View-Dependent Texture Maps, CVMP 2013. Casas, Volino, Collomosse, Hilton: 4D Video
// Textures for Interactive Character Appearance, Computer Graphics Forum 33(2), 2014.
#pragma once

#include <vector>

#include "lab/study/run/context.h"

namespace fourdvt::study {

// The steps in order.
std::vector<StudyStep> studySteps();
// Checks the report folder, runs missing steps and writes evaluate.csv, evaluate.json and report.html after each step.
// The context needs folders, capture, device and open_video. Errors: those of the steps; Interrupted; InvalidArgument
// (the report folder holds something else; no such step); WriteFailed.
Result<Rows> runStudy(const StudyContext& context);

}  // namespace fourdvt::study
