// SPDX-License-Identifier: Apache-2.0
// The report folder and what is kept in it between runs. REPORT/steps/key.txt names the settings and the capture that
// the kept files belong to; another key empties steps/, work/ and pictures/. Does NOT know what the steps measure.
#pragma once

#include <functional>
#include <span>
#include <string>

#include "lab/study/run/context.h"

namespace fourdvt::study {

// Hash of settings and capture files (names, sizes, times); a change makes kept rows worthless.
std::string studyKey(const StudyOptions& options, const std::string& version);

// Creates the folder and its parts; empties them if they belong to another key. Errors: InvalidArgument (the folder
// holds something else), WriteFailed.
Status openReportFolder(const std::string& folder, const std::string& key);

// The steps of these names in their own order; all where none is named. Errors: InvalidArgument (no such step).
Result<std::vector<StudyStep>> askedSteps(std::span<const StudyStep> all, const std::vector<std::string>& names);

// Runs the steps whose rows are not kept yet, in order, and keeps each one's rows. After every step `publish` gets all
// rows so far. Progress of a step (share: of the step) becomes progress of the study.
// Errors: those of the steps and of `publish`; Interrupted with how to go on.
Result<Rows> runSteps(const StudyContext& context, std::span<const StudyStep> steps,
                      const std::function<Status(const Rows&)>& publish);

// Runs a part of a step, unless its rows are kept in work(): an interrupted step goes on after its finished parts.
Result<Rows> keptPart(const StudyContext& context, const std::string& name,
                      const std::function<Result<Rows>()>& measure);

// The rows that an earlier step measured. Errors: Internal if it has not run.
Result<Rows> rowsOfStep(const StudyContext& context, const std::string& step);

// Calls the progress callback, where the study has one; share: of the step.
void reportProgress(const StudyContext& context, const std::string& step, const std::string& detail, double share);

// Returns Interrupted once the user has asked to stop.
Status checkStop(const StudyContext& context);

}  // namespace fourdvt::study
