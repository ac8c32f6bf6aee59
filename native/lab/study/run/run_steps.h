// SPDX-License-Identifier: Apache-2.0
// Report folder and the data kept in it between runs. REPORT/steps/key.txt identifies the settings and the capture of
// the kept files; another key empties steps/, work/ and pictures/. Independent of the steps' measures.
#pragma once

#include <functional>
#include <span>
#include <string>

#include "base/image.h"
#include "lab/study/run/context.h"
#include "report/document.h"

namespace fourdvt::study {

// Hash of settings and capture files (names, sizes, times); a change invalidates kept rows.
std::string studyKey(const StudyOptions& options, const std::string& version);

// Creates the folder and its parts; empties them if they belong to another key. Errors: InvalidArgument (the folder
// holds something else), WriteFailed.
Status openReportFolder(const std::string& folder, const std::string& key);

// Steps of these names in their own order; all if none is named. Errors: InvalidArgument (no such step).
Result<std::vector<StudyStep>> askedSteps(std::span<const StudyStep> all, const std::vector<std::string>& names);

// Runs the steps without kept rows, in order, and keeps each one's rows. Calls `publish` after each step with all rows
// so far. Maps progress of a step to progress of the study. Errors: those of the steps and of `publish`; Interrupted,
// with the way to resume.
Result<Rows> runSteps(const StudyContext& context, std::span<const StudyStep> steps,
                      const std::function<Status(const Rows&)>& publish);

// Runs the steps and writes <stem>.csv, <stem>.json and report.html after each one. `conclude` (null: none) returns
// rows that follow from the others; the document is made without them. Returns all rows.
Result<Rows> publishSteps(const StudyContext& context, std::span<const StudyStep> steps,
                          const std::function<report::Document(const Rows&)>& makeDocument,
                          Rows (*conclude)(const Rows&) = nullptr);

// Runs a part of a step, unless its rows are kept in work(), and appends its rows: an interrupted step resumes after
// its finished parts.
Status addPart(const StudyContext& context, const std::string& name, const std::function<Result<Rows>()>& measure,
               Rows& out);

// Writes a file into the report's pictures and appends its row: `shown` with the table and "file=…" added.
Status addPicture(const StudyContext& context, const std::string& file, const Image& picture, Row shown, Rows& out,
                  int quality = 90);
std::string sizeSetting(const Image& picture);  // "width=640 height=480"

// Rows of an earlier step. Errors: Internal if it has not run.
Result<Rows> rowsOfStep(const StudyContext& context, const std::string& step);

// Calls the study's progress callback, if set; share: of the step.
void reportProgress(const StudyContext& context, const std::string& step, const std::string& detail, double share);

// Returns Interrupted once the user has asked to stop.
Status checkStop(const StudyContext& context);

}  // namespace fourdvt::study
