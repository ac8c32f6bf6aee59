// SPDX-License-Identifier: Apache-2.0
// The report over all pieces of a job: what they cost, which were slow, which were started more than once.
#pragma once

#include "jobs/records.h"

namespace fourdvt::jobs {

inline constexpr const char* kReportHtml = "job.html";
inline constexpr const char* kReportJson = "job.json";

// Writes both into the job folder. Errors: WriteFailed.
Status writeReport(const std::string& job_folder, const Plan& plan, const Progress& progress);
// "123 of 456 pieces, 3 started again, about 12 min of work left", by the seconds of what is done.
std::string progressLine(const Plan& plan, const Progress& progress);

}  // namespace fourdvt::jobs
