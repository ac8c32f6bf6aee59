// SPDX-License-Identifier: Apache-2.0
// `fourdvt-lab methods CAPTURE -o REPORT`: the methods of characters from cameras against each other, before
// the codec, as a list of steps like study.h's: rows in projective.csv and .json, pictures, report.html. A finished
// condition of a sequence is kept, so that a study that was stopped goes on after it. Memory: a window of captured
// frames (frame_window.h).
#pragma once

#include <vector>

#include "lab/study/run/context.h"

namespace fourdvt::study {

// The steps. Errors: those of captures, proxies, methods; Interrupted.
Result<Rows> runProxyConditions(const StudyContext& context);
Result<Rows> runCameraConditions(const StudyContext& context);
Result<Rows> runCalibrationConditions(const StudyContext& context);
Result<Rows> runCrossValidation(const StudyContext& context);  // M4D Table 2
Result<Rows> runChoice(const StudyContext& context);           // what the bake would choose
Result<Rows> runMethodStages(const StudyContext& context);     // M4D Table 3
Result<Rows> runMethodPictures(const StudyContext& context);   // FT Fig. 8, worst views

// Those of the options that have held-out pictures.
std::vector<const capture::CaptureSequence*> projectiveSequences(const StudyContext& context);
// Consecutive frames that flicker and times are measured on; the first one is not timed.
uint32_t runFrames(const StudyOptions& options);
// Test frames of a sequence that the cross-validation has at most.
uint32_t crossFrames(const StudyOptions& options);

// The whole study. The context needs folders, capture, device and open_video. Errors: those of the steps;
// InvalidArgument (no such method; the folder holds something else); FileMissing (no sequence has test frames);
// WriteFailed.
Result<Rows> runProjectiveStudy(const StudyContext& context);

}  // namespace fourdvt::study
