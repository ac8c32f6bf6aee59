// SPDX-License-Identifier: Apache-2.0
// Report over all pieces of a job: cost, slowest pieces, pieces with several starts.
#pragma once

#include "jobs/records.h"

namespace fourdvt::jobs {

inline constexpr const char* kReportHtml = "job.html";
inline constexpr const char* kReportJson = "job.json";

// Writes the report as HTML and JSON into the job folder. Errors: WriteFailed.
Status writeReport(const std::string& job_folder, const Plan& plan, const Progress& progress);
// "123 of 456 pieces, 3 started again, about 12 min of work left", extrapolated from the seconds of finished pieces.
std::string progressLine(const Plan& plan, const Progress& progress);

}  // namespace fourdvt::jobs
