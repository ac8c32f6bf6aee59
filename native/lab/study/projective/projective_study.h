// SPDX-License-Identifier: Apache-2.0
// `fourdvt-lab methods CAPTURE -o REPORT`: comparison of the methods for camera-based characters, before the codec, as
// a list of steps like study.h's: rows in projective.csv and .json, pictures, report.html. Finished conditions of a
// sequence are kept, so that an interrupted study resumes after them. Memory: a window of captured frames
// (frame_window.h).
//
// Papers: Eisemann, De Decker, Magnor, Bekaert, de Aguiar, Ahmed, Theobalt, Sellent: Floating Textures, Computer
// Graphics Forum 27(2), 2008. Du, Chuang, Chang, Hoppe, Varshney: Montage4D: Real-time Seamless Fusion and Stylization
// of Multiview Video Textures, Journal of Computer Graphics Techniques 8(1), 2019.
#pragma once

#include <vector>

#include "lab/study/run/context.h"

namespace fourdvt::study {

// The steps. Errors: those of captures, proxies, methods; Interrupted.
Result<Rows> runProxyConditions(const StudyContext& context);
Result<Rows> runCameraConditions(const StudyContext& context);
Result<Rows> runCalibrationConditions(const StudyContext& context);
Result<Rows> runCrossValidation(const StudyContext& context);  // Du et al. 2019, Table 2
Result<Rows> runChoice(const StudyContext& context);           // the bake's choices
Result<Rows> runMethodStages(const StudyContext& context);     // Du et al. 2019, Table 3
Result<Rows> runMethodPictures(const StudyContext& context);   // Eisemann et al. 2008, Fig. 8; worst views

// Sequences of the options with held-out pictures.
std::vector<const capture::CaptureSequence*> projectiveSequences(const StudyContext& context);
// Number of consecutive frames for flicker and times; the first one is not timed.
uint32_t runFrames(const StudyOptions& options);
// Maximum test frames per sequence in the cross-validation.
uint32_t crossFrames(const StudyOptions& options);

// Runs the whole study. The context needs folders, capture, device and open_video. Errors: those of the steps;
// InvalidArgument (no such method; the folder holds something else); FileMissing (no sequence has test frames);
// WriteFailed.
Result<Rows> runProjectiveStudy(const StudyContext& context);

}  // namespace fourdvt::study
